//! What can go wrong in the solver.

use crate::setup::Vector;
use sphcut_geometry::tool_surface::ToolSurfaceError;
use sphcut_tool_heat::ToolHeatError;

/// A setup that cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// No particle lies in any body.
    #[error("no particle lies in any body: is the spacing too large?")]
    NoParticles,
    /// A body contains no particle at this spacing.
    #[error("body `{body}` contains no particle at this spacing")]
    EmptyBody {
        /// Name of the body.
        body: String,
    },
    /// The tool overlaps the workpiece at the start.
    #[error(
        "the tool overlaps the workpiece at the start: {count} particle(s), deepest by {:.3} um at \
         x = {:.4} mm, y = {:.4} mm",
        .depth * 1e6, .position[0] * 1e3, .position[1] * 1e3
    )]
    InitialOverlap {
        /// Position of the deepest particle in m.
        position: Vector,
        /// Depth of the overlap in m.
        depth: f64,
        /// Number of particles concerned.
        count: usize,
    },
    /// The tool's surface is not a closed, outward-oriented surface.
    #[error(transparent)]
    ToolSurface(#[from] ToolSurfaceError),
    /// Heat in the tool cannot be computed.
    #[error(transparent)]
    ToolHeat(#[from] ToolHeatError),
    /// A stored state does not belong to this setup.
    #[error("the checkpoint does not fit: {reason}")]
    Checkpoint {
        /// What does not fit.
        reason: String,
    },
}

/// A number that blew up. The simulation is then of no further use; the last good state is that of
/// the last checkpoint.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "diverged in step {step} at {time:.6e} s: {quantity} of particle {particle} is {value:e} at x = {:.4} mm, \
     y = {:.4} mm",
    .position[0] * 1e3, .position[1] * 1e3
)]
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
    pub quantity: String,
    /// Its value.
    pub value: f64,
}
