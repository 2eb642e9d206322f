//! Whether a diagnosis can be trusted: held-out validation, self-test, the corrected scenario run again.

pub(crate) mod forecast;
pub(crate) mod held_out;
pub(crate) mod rerun;
pub(crate) mod self_test;
