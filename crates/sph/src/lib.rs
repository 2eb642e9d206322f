//! Smoothed particle hydrodynamics of solids for metal cutting.
//!
//! The crate turns a [`setup::Setup`] into a [`Simulation`] and steps it. It
//! does no I/O: what happens is told as plain data ([`observation`]).

mod contact;
mod engine;
pub mod error;
mod heat;
pub mod kernel;
mod lanes;
mod ledger;
mod material;
mod numerics;
mod operators;
pub mod options;
pub mod output;
mod parallel;
mod particles;
mod passes;
pub mod setup;
mod simulation;
mod stage;
mod tensor;

/// Version of the results: the same setup gives the same bits as long as it is the same. It goes up with every
/// change of the solver that changes bits; stored results of another version are not used again
/// (`crates/sweep/tests/results_version.rs` notices most changes).
pub const RESULTS_VERSION: u32 = 6;

pub use error::{Diverged, SetupError};
pub use output::observation::{CHANNELS, ChannelId, CheckpointState, Sample, Snapshot};
pub use setup::Setup;
pub use simulation::{Estimate, Simulation, StepReport};
pub use stage::Stage;
