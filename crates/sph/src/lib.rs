//! Smoothed particle hydrodynamics of solids for metal cutting.
//!
//! The crate turns a [`setup::Setup`] into a [`Simulation`] and steps it. It
//! does no I/O: what happens is told as plain data ([`observation`]).

pub mod error;
pub mod kernel;
pub mod observation;
pub mod options;
pub mod setup;
mod simulation;

pub use error::{Diverged, SetupError};
pub use observation::{CHANNELS, ChannelId, CheckpointState, Sample, Snapshot};
pub use setup::Setup;
pub use simulation::{Estimate, Simulation, StepReport};
