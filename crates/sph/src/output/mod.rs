//! What a simulation tells: samples, snapshots, checkpoints, accounts of energy and momentum.

pub(crate) mod account;
pub mod observation;
pub(crate) mod observe;
