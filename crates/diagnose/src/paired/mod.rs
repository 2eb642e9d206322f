//! What each effect changes, told by paired runs of the particle solver: the same cut with and without it.

mod change;
mod field;
mod model;
#[cfg(test)]
mod tests;

pub(crate) use change::can_be_run;
pub use change::{Change, changes, support};
pub use model::{PairedRun, PairedRuns};
