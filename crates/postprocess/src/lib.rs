//! What a run means: steady state, forces with their uncertainty, chip, balances.

pub mod steady;
#[cfg(any(test, feature = "synthetic"))]
pub mod synthetic;
