//! What can go wrong in the solver.

use crate::setup::Vector;
use std::fmt;

/// A setup that cannot be built.
#[derive(Debug, Clone, PartialEq)]
pub enum SetupError {
    /// No particle lies in any body.
    NoParticles,
    /// A body contains no particle at this spacing.
    EmptyBody {
        /// Name of the body.
        body: String,
    },
    /// The tool overlaps the workpiece at the start.
    InitialOverlap {
        /// Position of the deepest particle in m.
        position: Vector,
        /// Depth of the overlap in m.
        depth: f64,
        /// Number of particles concerned.
        count: usize,
    },
    /// The tool's surface is not a closed, outward-oriented surface.
    ToolSurface {
        /// What is wrong, with the number of the facet.
        reason: String,
    },
    /// Heat in the tool cannot be computed.
    ToolHeat {
        /// What is wrong.
        reason: String,
    },
    /// A stored state does not belong to this setup.
    Checkpoint {
        /// What does not fit.
        reason: String,
    },
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoParticles => {
                write!(f, "no particle lies in any body: is the spacing too large?")
            }
            Self::EmptyBody { body } => {
                write!(f, "body `{body}` contains no particle at this spacing")
            }
            Self::InitialOverlap { position, depth, count } => write!(
                f,
                "the tool overlaps the workpiece at the start: {count} particle(s), deepest by \
                 {:.3} um at x = {:.4} mm, y = {:.4} mm",
                depth * 1e6,
                position[0] * 1e3,
                position[1] * 1e3
            ),
            Self::ToolSurface { reason } => write!(f, "the tool's surface is unusable: {reason}"),
            Self::ToolHeat { reason } => write!(f, "heat in the tool: {reason}"),
            Self::Checkpoint { reason } => write!(f, "the checkpoint does not fit: {reason}"),
        }
    }
}

impl std::error::Error for SetupError {}

/// A number that blew up. The simulation is then of no further use; the last good state is that of
/// the last checkpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct Diverged {
    /// Step in which it happened.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// Identifier of the particle.
    pub particle: u64,
    /// Its last position in m.
    pub position: Vector,
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
}

impl fmt::Display for Diverged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "diverged in step {} at {:.6e} s: {} of particle {} is {:e} at x = {:.4} mm, y = {:.4} mm",
            self.step,
            self.time,
            self.quantity,
            self.particle,
            self.value,
            self.position[0] * 1e3,
            self.position[1] * 1e3
        )
    }
}

impl std::error::Error for Diverged {}
