//! What keeps a diagnosis from being made.

use sphcut_physics::Channel;

/// Why recordings cannot be diagnosed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiagnoseError {
    /// Too few different conditions.
    #[error(
        "{found} different conditions are too few: {needed} are needed before a trend over speed and \
         thickness can be told from its curvature; four are enough where every value has its standard deviation \
         (`F_c_sd`, without `n`) and a condition has three values that the model predicts, on average"
    )]
    TooFewConditions {
        /// Those found.
        found: usize,
        /// Those needed.
        needed: usize,
    },
    /// Nothing was measured that the model predicts.
    #[error("nothing that was measured is predicted by the model")]
    NothingPredicted,
    /// Neither repeats nor standard deviations tell the noise of a channel.
    #[error(
        "the noise of {} is unknown: its repeats have {freedom:.0} degrees of freedom, {needed:.0} are \
         needed; repeat some conditions in random order, or state the standard deviations in a column \
         `{}_sd`",
        .channel.symbol(), .channel.symbol()
    )]
    UnknownNoise {
        /// The channel.
        channel: Channel,
        /// Degrees of freedom that the repeats have.
        freedom: f64,
        /// Those needed.
        needed: f64,
    },
    /// Repeats that do not differ at all.
    #[error(
        "all repeats of {} agree to the last digit, as no measurement does: give every reading with its own digits, or one line \
         for each condition with its standard deviation in a column `{}_sd`",
        .channel.symbol(), .channel.symbol()
    )]
    NoScatter {
        /// The channel.
        channel: Channel,
    },
    /// A table that is wrong in a way that shows.
    #[error("{what}")]
    Mistake {
        /// What is probably wrong, and what to do.
        what: String,
    },
    /// A value that has no logarithm.
    #[error(
        "recording {recording}: {} = {value} has no logarithm; leave the cell empty",
        .channel.symbol()
    )]
    NotPositive {
        /// The channel.
        channel: Channel,
        /// Number of the recording from 1.
        recording: usize,
        /// The value.
        value: f64,
    },
    /// The model has no answer at a condition.
    #[error(
        "the model has no {} at a cutting speed of {cutting_speed} m/s and an uncut chip thickness of \
         {uncut_chip_thickness} m",
        .channel.title()
    )]
    NoPrediction {
        /// v_c in m/s.
        cutting_speed: f64,
        /// h in m.
        uncut_chip_thickness: f64,
        /// The channel that is missing.
        channel: Channel,
    },
    /// Noise and priors give no covariance that can be inverted.
    #[error("noise and priors give no covariance that can be inverted")]
    Singular,
    /// Too few tools to leave one out.
    #[error(
        "{found} tools are too few: {needed} are needed, so that one can be left out and the others still scatter"
    )]
    TooFewTools {
        /// Those found.
        found: usize,
        /// Those needed.
        needed: usize,
    },
    /// A tool with too few segments.
    #[error("tool {tool} has {found} segments; {needed} are needed")]
    TooFewSegments {
        /// The tool.
        tool: String,
        /// Those found.
        found: usize,
        /// Those needed.
        needed: usize,
    },
    /// Segments over a life of which a column says nothing.
    #[error("{column} {what}: was it measured?")]
    NoSeries {
        /// The column.
        column: &'static str,
        /// What it does.
        what: &'static str,
    },
    /// The closed-form model does not have what a scenario has.
    #[error("the closed-form model cannot take the scenario: {what}")]
    Scenario {
        /// What it has.
        what: String,
    },
    /// Paired runs cannot be made of a scenario.
    #[error("paired runs cannot be made of the scenario: {what}")]
    NoPairedRuns {
        /// Why.
        what: String,
        /// What to do; empty where nothing is known.
        help: &'static str,
    },
    /// A table of the file of a diagnosis cannot be used.
    #[error("the table of [{section}]: {reason}")]
    Table {
        /// Its section.
        section: &'static str,
        /// Why.
        reason: Box<Self>,
    },
}
