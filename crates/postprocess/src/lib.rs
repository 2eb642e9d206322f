//! What a run means: steady state, forces with their uncertainty, chip, balances.

#[cfg(any(test, feature = "synthetic"))]
pub mod synthetic;
