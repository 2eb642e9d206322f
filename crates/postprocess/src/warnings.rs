//! What to keep in mind before the numbers of a run are used.

/// Largest error of the energy balance.
pub(crate) const ENERGY_CLOSURE: f64 = 0.01;
/// Largest error of the momentum balance.
pub(crate) const MOMENTUM_CLOSURE: f64 = 0.005;
/// Fewest particles across a length that matters.
pub(crate) const FEWEST_PARTICLES: f64 = 5.0;

/// One thing to keep in mind.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    /// The run ended because a quantity blew up.
    #[error("The run {message}.")]
    Diverged {
        /// What happened.
        message: String,
    },
    /// The run is a part of what was asked for.
    #[error("The run was interrupted after {} of its time.", percent(.share))]
    Interrupted {
        /// Travel or time done, as a share.
        share: f64,
    },
    /// The means are not those of a steady cut.
    #[error(
        "The cutting force is not steady: {reason}; its mean holds for this travel only, {advice}."
    )]
    NotSteady {
        /// Why.
        reason: String,
        /// What to do.
        advice: &'static str,
    },
    /// The feed force is not steady though the cutting force is.
    #[error("The cutting force is steady, the feed force is not: {reason}; {advice}.")]
    FeedNotSteady {
        /// Why.
        reason: String,
        /// What to do.
        advice: &'static str,
    },
    /// The moving window takes the chip where it may still press on the tool.
    #[error(
        "The moving window follows {} of the chip, {} of it in contact with the rake face: what has left may have \
         pressed on the tool and held the chip back, so that both forces may be too low; a `behind` of {} in [window] tells.",
        millimetres(.followed), millimetres(.contact), millimetres(&(2.0 * .behind))
    )]
    ChipCutOff {
        /// Contact length on the rake face in m.
        contact: f64,
        /// Length of the chip that is followed in m.
        followed: f64,
        /// `behind` of the window in m.
        behind: f64,
    },
    /// The energy balance does not close.
    #[error(
        "The energy balance misses {} of the work; at most {} is allowed.",
        percent(.share), percent(&ENERGY_CLOSURE)
    )]
    EnergyClosure {
        /// Share of the work.
        share: f64,
    },
    /// Numerical terms take a large share of the work.
    #[error(
        "Numerical terms take {} of the work (allowed: {}): refine the particles.",
        percent(.share), percent(.allowed)
    )]
    NumericalShare {
        /// Gross share.
        share: f64,
        /// What it should not exceed.
        allowed: f64,
    },
    /// The momentum balance does not close.
    #[error(
        "Contact force and support reaction differ by {} beyond the change of momentum; at most {} is allowed.",
        percent(.share), percent(&MOMENTUM_CLOSURE)
    )]
    MomentumClosure {
        /// Share of the contact impulse.
        share: f64,
    },
    /// Too few particles across a length.
    #[error("Only {particles:.1} particles span the {length}; {FEWEST_PARTICLES} are the least.")]
    Resolution {
        /// The length.
        length: &'static str,
        /// Particles across it.
        particles: f64,
    },
    /// Inertia matters.
    #[error(
        "Kinetic energy reaches {} of the work at a mass scaling of {mass_scaling}: inertia is no side effect any more.",
        percent(.share)
    )]
    KineticShare {
        /// Largest share of the work.
        share: f64,
        /// Factor on the inertia.
        mass_scaling: f64,
    },
    /// Particles have lost the material.
    #[error("{count} {} parted from the material.", if *.count == 1 { "particle has" } else { "particles have" })]
    LooseParticles {
        /// Their number.
        count: usize,
    },
    /// A particle had no neighbour at all.
    #[error(
        "A particle was left without any neighbour: it flies on by itself, with its momentum and energy in the balances."
    )]
    LostParticle,
    /// The parting line has moved to another row of particles.
    #[error(
        "The machined surface has a step of {}: the parting line has jumped, and forces before and after it are not \
         those of the same cut.",
        micrometres(.jump)
    )]
    SurfaceJump {
        /// Highest minus lowest level of the machined surface in m.
        jump: f64,
    },
    /// The machined surface is not where the tool's edge passed.
    #[error("The machined surface lies {} off its nominal height.", micrometres(.error))]
    SurfaceDepth {
        /// Height minus nominal height in m.
        error: f64,
    },
    /// Heat has reached the sides where the tool is cut off.
    #[error(
        "Heat has reached the sides where the model of the tool ends ({} of the heat that entered it, or of its highest \
         rise of temperature): its temperatures depend on what is kept there (`outer` under [tool.heat]).",
        percent(.share)
    )]
    ToolCutOff {
        /// Of the heat that entered, or of the highest rise of temperature.
        share: f64,
    },
    /// Said before the run started.
    #[error("{}", as_sentence(.message))]
    Scenario {
        /// The text.
        message: String,
    },
}

impl Warning {
    /// Identifier in `summary.json`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Diverged { .. } => "diverged",
            Self::Interrupted { .. } => "interrupted",
            Self::NotSteady { .. } => "not_steady",
            Self::FeedNotSteady { .. } => "feed_not_steady",
            Self::ChipCutOff { .. } => "chip_cut_off",
            Self::EnergyClosure { .. } => "energy_closure",
            Self::NumericalShare { .. } => "numerical_share",
            Self::MomentumClosure { .. } => "momentum_closure",
            Self::Resolution { .. } => "resolution",
            Self::KineticShare { .. } => "kinetic_share",
            Self::LooseParticles { .. } => "loose_particles",
            Self::LostParticle => "lost_particle",
            Self::SurfaceJump { .. } => "surface_jump",
            Self::SurfaceDepth { .. } => "surface_depth",
            Self::ToolCutOff { .. } => "tool_cut_off",
            Self::Scenario { .. } => "scenario",
        }
    }
}

fn percent(share: &f64) -> String {
    format!("{:.1} %", share * 100.0)
}

fn millimetres(length: &f64) -> String {
    format!("{:.2} mm", length * 1e3)
}

fn micrometres(length: &f64) -> String {
    format!("{:.1} \u{b5}m", length * 1e6)
}

/// A message with a capital at its start and a full stop at its end.
fn as_sentence(message: &str) -> String {
    let mut letters = message.trim_end_matches('.').chars();
    let first = letters.next().map(char::to_uppercase);
    format!("{}{}.", first.into_iter().flatten().collect::<String>(), letters.as_str())
}
