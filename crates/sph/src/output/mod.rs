//! What a simulation tells: samples, snapshots, checkpoints.

pub(crate) mod checkpoint;
pub mod observation;
pub(crate) mod sample;
pub(crate) mod snapshot;
