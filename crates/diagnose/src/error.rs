//! What keeps a diagnosis from being made.

use sphcut_physics::Channel;
use std::fmt;

/// Why recordings cannot be diagnosed.
#[derive(Debug, Clone, PartialEq)]
pub enum DiagnoseError {
    /// Too few different conditions.
    TooFewConditions {
        /// Those found.
        found: usize,
        /// Those needed.
        needed: usize,
    },
    /// Nothing was measured that the model predicts.
    NothingPredicted,
    /// Neither repeats nor standard deviations tell the noise of a channel.
    UnknownNoise {
        /// The channel.
        channel: Channel,
        /// Degrees of freedom that the repeats have.
        freedom: f64,
        /// Those needed.
        needed: f64,
    },
    /// A value that has no logarithm.
    NotPositive {
        /// The channel.
        channel: Channel,
        /// Number of the recording from 1.
        recording: usize,
        /// The value.
        value: f64,
    },
    /// The model has no answer at a condition.
    NoPrediction {
        /// v_c in m/s.
        cutting_speed: f64,
        /// h in m.
        uncut_chip_thickness: f64,
        /// The channel that is missing.
        channel: Channel,
    },
    /// Noise and priors give no covariance that can be inverted.
    Singular,
    /// Too few tools to leave one out.
    TooFewTools {
        /// Those found.
        found: usize,
        /// Those needed.
        needed: usize,
    },
    /// A tool with too few segments.
    TooFewSegments {
        /// The tool.
        tool: f64,
        /// Those found.
        found: usize,
        /// Those needed.
        needed: usize,
    },
    /// The closed-form model does not have what a scenario has.
    Scenario {
        /// What it has.
        what: String,
    },
    /// Paired runs cannot be made of a scenario.
    NoPairedRuns {
        /// Why.
        what: String,
        /// What to do; empty where nothing is known.
        help: &'static str,
    },
    /// A table of the file of a diagnosis cannot be used.
    Table {
        /// Its section.
        section: &'static str,
        /// Why.
        reason: Box<Self>,
    },
}

impl fmt::Display for DiagnoseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewConditions { found, needed } => write!(
                f,
                "{found} different conditions are too few: {needed} are needed before a trend over speed and \
                 thickness can be told from its curvature; four are enough where every value has its standard deviation \
                 (`F_c_sd`, without `n`) and a condition has three values that the model predicts, on average"
            ),
            Self::NothingPredicted => {
                write!(f, "nothing that was measured is predicted by the model")
            }
            Self::UnknownNoise { channel, freedom, needed } => write!(
                f,
                "the noise of {} is unknown: its repeats have {freedom:.0} degrees of freedom, {needed:.0} are \
                 needed; repeat some conditions in random order, or state the standard deviations in a column \
                 `{}_sd`",
                channel.symbol(),
                channel.symbol()
            ),
            Self::NotPositive { channel, recording, value } => write!(
                f,
                "recording {recording}: {} = {value} has no logarithm; leave the cell empty",
                channel.symbol()
            ),
            Self::NoPrediction { cutting_speed, uncut_chip_thickness, channel } => write!(
                f,
                "the model has no {} at a cutting speed of {cutting_speed} m/s and an uncut chip thickness of \
                 {uncut_chip_thickness} m",
                channel.title()
            ),
            Self::Singular => write!(f, "noise and priors give no covariance that can be inverted"),
            Self::TooFewTools { found, needed } => write!(
                f,
                "{found} tools are too few: {needed} are needed, so that one can be left out and the others still scatter"
            ),
            Self::TooFewSegments { tool, found, needed } => {
                write!(f, "tool {tool} has {found} segments; {needed} are needed")
            }
            Self::Scenario { what } => {
                write!(f, "the closed-form model cannot take the scenario: {what}")
            }
            Self::NoPairedRuns { what, .. } => {
                write!(f, "paired runs cannot be made of the scenario: {what}")
            }
            Self::Table { section, reason } => write!(f, "the table of [{section}]: {reason}"),
        }
    }
}

impl std::error::Error for DiagnoseError {}
