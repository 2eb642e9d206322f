//! The stages of a step, by name.

/// A part of one step. The solver knows no clock: who wants to time it passes a function to
/// [`crate::Simulation::step_observed`] that is called with the stage that has just ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Velocities and positions, supports included.
    Motion,
    /// Velocity gradients, stress update and hourglass memory: the first sweep over neighbours.
    Gradients,
    /// Internal forces: the second sweep over neighbours.
    Forces,
    /// Tool and self-contact.
    Contact,
    /// Density diffusion and heat conduction.
    Diffusion,
    /// Update of the reference: storage order, neighbours, corrections, and the sweeps repeated.
    ReferenceUpdate,
}

impl Stage {
    /// All stages, in the order of a step.
    pub const ALL: [Self; 6] = [
        Self::Motion,
        Self::Gradients,
        Self::Forces,
        Self::Contact,
        Self::Diffusion,
        Self::ReferenceUpdate,
    ];

    /// Short name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Gradients => "gradients",
            Self::Forces => "forces",
            Self::Contact => "contact",
            Self::Diffusion => "diffusion",
            Self::ReferenceUpdate => "reference update",
        }
    }
}
