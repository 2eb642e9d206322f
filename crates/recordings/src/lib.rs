//! From raw recordings of a dynamometer to mean forces with their uncertainty.
//!
//! ```text
//! file -> channels on one clock -> N -> cut found -> zero taken out -> response undone -> low-pass
//!      -> steady window -> mean with interval, spectrum -> repeats pooled -> table
//! ```
//!
//! What is wrong with a record is a [`Fault`] with its figures; nothing is repaired that the user has
//! not allowed. `docs/recordings.md` says what each step does and where it ends.

mod cut;
mod detection;
mod fault;
pub mod file;
mod filter;
pub mod formats;
mod pooled;
mod raw;
mod response;
mod spectrum;
mod table;
#[cfg(test)]
mod tests;
mod zero;

pub use cut::{
    ComponentResult, Conditions, CutResult, EvaluationSettings, ForceChannel, Unsteady,
    evaluate_cut,
};
pub use detection::{Detection, Span};
pub use fault::{Fault, NotSteady};
pub use file::{RecordingCut, RecordingFormat, RecordingPlan, load_recordings};
pub use filter::LowPass;
pub use pooled::{Pooled, PooledCuts, PooledForce, Repeatability, pool};
pub use raw::{Channels, RawColumn, RawTable, TimeSource};
pub use response::Response;
pub use spectrum::{Peak, RevolutionLine, Spectrum};
pub use table::{SCHEMA_VERSION, cuts_csv, forces_csv, recordings_json};
pub use zero::{AirLevel, ZeroLine};
