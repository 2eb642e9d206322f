//! How values are compared with references.

use serde::Deserialize;

/// How values and reference are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// |value - reference| / |reference| at most the tolerance; for every run.
    RelativeError,
    /// |value - reference| at most the tolerance; for every run.
    AbsoluteError,
    /// Distance of the value from the band at most the tolerance; for every run.
    Within,
    /// value at most reference + tolerance; for every run.
    AtMost,
    /// value at least reference - tolerance; for every run.
    AtLeast,
    /// Slope of ln |value - reference| over ln spacing, over all runs, at least the tolerance.
    ConvergenceOrder,
    /// |value - reference| falls with every finer spacing, to at most the tolerance at the finest.
    FallingError,
    /// The value rises with every finer spacing by at least the tolerance.
    Rising,
    /// (largest - smallest) / |mean| over the runs at most the tolerance.
    Spread,
    /// All runs give the same value, bit by bit.
    Identical,
    /// Largest difference of the mean of a group of replicates from that of the first group that
    /// exceeds its own 95 % interval, as a share of the mean; at most the tolerance.
    DifferenceOfMeans,
    /// Widest of these intervals (half width) as a share of the mean; at most the tolerance.
    IntervalOfDifference,
    /// Nothing is expected: a variant beside what is judged.
    #[serde(skip)]
    Shown,
}

impl Metric {
    /// Whether one number is made of all runs rather than one per run.
    #[must_use]
    pub fn joins_runs(self) -> bool {
        matches!(
            self,
            Self::ConvergenceOrder
                | Self::FallingError
                | Self::Rising
                | Self::Spread
                | Self::Identical
        ) || self.needs_replicates()
    }

    /// Whether it compares means of replicates.
    #[must_use]
    pub fn needs_replicates(self) -> bool {
        matches!(self, Self::DifferenceOfMeans | Self::IntervalOfDifference)
    }

    /// Name as in the case file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RelativeError => "relative error",
            Self::AbsoluteError => "absolute error",
            Self::Within => "within band",
            Self::AtMost => "at most",
            Self::AtLeast => "at least",
            Self::ConvergenceOrder => "convergence order",
            Self::FallingError => "falling error",
            Self::Rising => "rising",
            Self::Spread => "spread",
            Self::Identical => "identical",
            Self::DifferenceOfMeans => "difference of means",
            Self::IntervalOfDifference => "interval of the difference of means",
            Self::Shown => "shown",
        }
    }
}

/// What a value is compared with, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceValue {
    /// Nothing: the runs are compared among themselves.
    None,
    /// One number.
    Number(f64),
    /// A band from low to high.
    Band(f64, f64),
    /// A column of `reference.csv`; the row is the one whose cell `run` is the run's name.
    Column(String),
}

impl Metric {
    /// What the metric makes of one value and the reference from `low` to `high`, and whether that holds.
    pub(crate) fn compare(
        self,
        value: f64,
        (low, high): (f64, f64),
        tolerance: f64,
    ) -> (f64, bool) {
        let result = match self {
            Self::RelativeError => (value - low) / low.abs(),
            Self::AbsoluteError => value - low,
            Self::Within => (value - high).max(0.0) + (value - low).min(0.0),
            _ => value,
        };
        let holds = match self {
            Self::AtMost => value <= low + tolerance,
            Self::AtLeast => value >= low - tolerance,
            Self::Shown => true,
            _ => result.abs() <= tolerance,
        };
        (result, holds)
    }
}

/// `low` if both are the same, `low..high` otherwise.
pub(crate) fn band(low: f64, high: f64) -> String {
    if low == high { number(low) } else { format!("{}..{}", number(low), number(high)) }
}

/// A number with four significant digits.
pub(crate) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&magnitude) {
        let digits = (3 - magnitude.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_carry_four_digits() {
        assert_eq!(number(0.254_12), "0.2541");
        assert_eq!(number(1234.567), "1235");
        assert_eq!(number(2.0), "2");
        assert_eq!(number(1.23456e-9), "1.235e-9");
        assert_eq!(number(0.0), "0");
    }
}
