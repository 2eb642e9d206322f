//! The zero of a channel: offset and drift from the air before and after the cut.

use super::Fault;
use super::detection::Span;
use sphcut_postprocess::steady::mean_interval;

/// A level in the air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirLevel {
    /// Middle of the stretch in samples.
    pub centre: f64,
    /// Mean in N.
    pub mean: f64,
    /// Its standard error, correlation taken into account.
    pub standard_error: f64,
    /// Degrees of freedom of that error.
    pub degrees_of_freedom: f64,
}

/// The zero line of a channel: through both levels of the air, or level with the only one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZeroLine {
    /// Air before the cut.
    pub before: Option<AirLevel>,
    /// Air after it.
    pub after: Option<AirLevel>,
}

impl ZeroLine {
    /// The zero at `sample`.
    #[must_use]
    pub fn at(&self, sample: f64) -> f64 {
        match (self.before, self.after) {
            (Some(before), Some(after)) => {
                let share = (sample - before.centre) / (after.centre - before.centre);
                before.mean + share * (after.mean - before.mean)
            }
            (Some(only), None) | (None, Some(only)) => only.mean,
            (None, None) => 0.0,
        }
    }

    /// Standard error of the zero at `sample`, and its degrees of freedom: the errors of both levels
    /// are independent. How far a drift leaves a straight line is not in it: nothing in the record
    /// tells.
    #[must_use]
    pub fn error_at(&self, sample: f64) -> (f64, f64) {
        match (self.before, self.after) {
            (Some(before), Some(after)) => {
                let share = (sample - before.centre) / (after.centre - before.centre);
                combine(&[
                    ((1.0 - share) * before.standard_error, before.degrees_of_freedom),
                    (share * after.standard_error, after.degrees_of_freedom),
                ])
            }
            (Some(only), None) | (None, Some(only)) => {
                (only.standard_error, only.degrees_of_freedom)
            }
            (None, None) => (0.0, f64::INFINITY),
        }
    }

    /// Change of the zero over the record in N.
    #[must_use]
    pub fn drift(&self) -> Option<f64> {
        Some(self.after?.mean - self.before?.mean)
    }
}

/// The standard error of a sum of independent parts and its degrees of freedom (Welch and
/// Satterthwaite: Biometrics Bulletin 2 (1946) 110).
pub(super) fn combine(parts: &[(f64, f64)]) -> (f64, f64) {
    let variance: f64 = parts.iter().map(|(error, _)| error * error).sum();
    if !variance.is_finite() {
        return (f64::INFINITY, 1.0);
    }
    let shares: f64 = parts.iter().map(|(error, freedom)| error.powi(4) / freedom).sum();
    let freedom = if shares > 0.0 { variance * variance / shares } else { f64::INFINITY };
    (variance.sqrt(), freedom)
}

/// The stretches of air, `guard` samples away from the cut, that are at least `shortest` long.
///
/// # Errors
/// None at all.
pub(super) fn air(
    span: Span,
    samples: usize,
    guard: usize,
    shortest: usize,
    rate: f64,
) -> Result<[Option<(usize, usize)>; 2], Fault> {
    let before = (0, span.entry.saturating_sub(guard));
    let after = ((span.exit + guard).min(samples), samples);
    let long = |(from, to): (usize, usize)| (to - from >= shortest.max(20)).then_some((from, to));
    let found = [long(before), long(after)];
    if found == [None, None] {
        let seconds = |(from, to): (usize, usize)| (to - from) as f64 / rate;
        let found = [seconds(before), seconds(after)];
        return Err(Fault::NoAirCut { found, needed: shortest.max(20) as f64 / rate });
    }
    Ok(found)
}

/// The zero line of a channel from its stretches of air.
pub(super) fn zero_line(values: &[f64], air: [Option<(usize, usize)>; 2]) -> ZeroLine {
    let [before, after] = air.map(|stretch| {
        let (from, to) = stretch?;
        let interval = mean_interval(&values[from..to], None);
        Some(AirLevel {
            centre: 0.5 * (from + to - 1) as f64,
            mean: interval.mean,
            standard_error: interval.standard_error,
            degrees_of_freedom: interval.degrees_of_freedom,
        })
    });
    ZeroLine { before, after }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_drift_are_taken_out_exactly() {
        let line = |k: usize| 12.0 + 0.01 * k as f64;
        let values: Vec<f64> = (0..1000)
            .map(|k| line(k) + if (300..700).contains(&k) { 100.0 } else { 0.0 })
            .collect();
        let air = air(Span { entry: 300, exit: 700 }, 1000, 10, 50, 100.0).unwrap();
        assert_eq!(air, [Some((0, 290)), Some((710, 1000))]);
        let zero = zero_line(&values, air);
        for k in [0, 500, 999] {
            assert!((zero.at(k as f64) - line(k)).abs() < 1e-9);
        }
        // From the middle of 0..290 to that of 710..1000: 710 samples.
        assert!((zero.drift().unwrap() - 7.1).abs() < 1e-9);
    }

    #[test]
    fn one_side_gives_an_offset_and_none_is_named() {
        let one = air(Span { entry: 300, exit: 1000 }, 1000, 10, 50, 100.0).unwrap();
        assert_eq!(one, [Some((0, 290)), None]);
        let zero = zero_line(&[5.0; 1000], one);
        assert_eq!((zero.at(900.0), zero.drift()), (5.0, None));
        let none = air(Span { entry: 20, exit: 990 }, 1000, 10, 50, 100.0);
        assert!(matches!(none, Err(Fault::NoAirCut { .. })));
    }

    #[test]
    fn errors_of_two_parts_combine_as_welch_and_satterthwaite() {
        // Equal errors with nine degrees of freedom each: eighteen together.
        let (error, freedom) = combine(&[(3.0, 9.0), (3.0, 9.0)]);
        assert!((error - 18_f64.sqrt()).abs() < 1e-12 && (freedom - 18.0).abs() < 1e-9);
    }
}
