//! Smoothed particle hydrodynamics of solids for metal cutting.
//!
//! The crate turns a [`setup::Setup`] into a [`Simulation`] and steps it. It
//! does no I/O: what happens is told as plain data ([`observation`]).

mod account;
mod contact;
mod contact_friction;
mod contact_surface;
mod crowding;
mod density_diffusion;
mod engine;
mod equation_of_state;
pub mod error;
mod heat_conduction;
mod heat_source;
mod history;
pub mod kernel;
mod lanes;
mod laplacian;
mod lattice;
mod material_point;
mod motion;
mod neighbours;
pub mod observation;
mod observe;
pub mod options;
mod refresh;
pub mod setup;
mod simulation;
mod stage;
mod strain_gradient;
mod strangers;
mod support_shape;
mod supports;
mod surface_point;
mod sweeps;
mod tensor;
mod thermoelasticity;
mod tool_heat;
mod tool_holder;
mod tool_motion;
mod tool_surface;
mod window;

/// Version of the results: the same setup gives the same bits as long as it is the same. It goes up with every
/// change of the solver that changes bits; stored results of another version are not used again
/// (`crates/sweep/tests/results_version.rs` notices most changes).
pub const RESULTS_VERSION: u32 = 3;

pub use error::{Diverged, SetupError};
pub use observation::{CHANNELS, ChannelId, CheckpointState, Sample, Snapshot};
pub use setup::Setup;
pub use simulation::{Estimate, Simulation, StepReport};
pub use stage::Stage;
pub use tool_heat::ToolMeshFacts;
