//! Which cuts would tell more.

pub(crate) mod next_experiment;
