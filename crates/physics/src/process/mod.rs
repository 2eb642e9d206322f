//! What machine and spindle do to the path of the tool.
//!
//! One file each, with its equation and its parameters; [`ENTRIES`] is the only registration. Without
//! the table in the scenario none of them exists, bit for bit.

mod compliance;
mod run_out;

pub use compliance::{COMPLIANCE, Oscillator};
pub use run_out::{RUN_OUT, RunOut};

use crate::Parameter;

/// A process effect of the catalogue.
#[derive(Debug)]
pub struct ProcessEntry {
    /// Name in the scenario file: `[tool.NAME]`.
    pub key: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The equation in one line of text.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Where it holds and what it neglects.
    pub validity: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

/// All process effects.
pub const ENTRIES: &[&ProcessEntry] = &[&COMPLIANCE, &RUN_OUT];
