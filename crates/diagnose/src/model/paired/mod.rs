//! What each effect changes, told by paired runs of the particle solver: the same cut with and without it.

mod change;
mod field;
mod keys;
mod model;
#[cfg(test)]
mod tests;

pub(crate) use change::can_be_run;
pub use change::{Change, EffectStrength, changes, effect_strengths, run_effects, support};
pub use keys::PairedScenario;
pub use model::{PairedRun, PairedRuns};
