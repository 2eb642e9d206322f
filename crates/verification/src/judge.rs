//! From values to findings: one function per metric.

use crate::case::{Case, Expectation, Metric, Reference};
use crate::error::CaseError;
use crate::replicates::{Difference, differences, summary};
use crate::variants;
use crate::verdict::Finding;

/// What one run contributes to the judgement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunValues {
    /// Particle spacing in m.
    pub(crate) spacing: f64,
    /// One value for every expectation of the case that is about this run.
    pub(crate) values: Vec<Option<f64>>,
}

/// Judges every expectation of `case` on the values of its runs (in the order of the runs).
pub(crate) fn judge(case: &Case, runs: &[RunValues]) -> Result<Vec<Finding>, CaseError> {
    let mut findings = Vec::new();
    for (index, expectation) in case.expectations.iter().enumerate() {
        let mut points = Vec::new();
        for run in &expectation.runs {
            let value = runs[*run].values[index].ok_or_else(|| CaseError::Unobservable {
                observable: expectation.observable.name.to_owned(),
                reason: format!("no value for run `{}`", case.runs[*run].name),
            })?;
            points.push(Point { run: *run, spacing: runs[*run].spacing, value });
        }
        if expectation.metric.joins_runs() {
            findings.push(joint_finding(case, expectation, points));
        } else {
            for point in points {
                findings.push(single_finding(case, expectation, &point)?);
            }
        }
    }
    Ok(findings)
}

#[derive(Debug, Clone, Copy)]
struct Point {
    run: usize,
    spacing: f64,
    value: f64,
}

fn single_finding(
    case: &Case,
    expectation: &Expectation,
    point: &Point,
) -> Result<Finding, CaseError> {
    let run = &case.runs[point.run].name;
    let (low, high) = match &expectation.reference {
        Reference::Number(number) => (*number, *number),
        Reference::Band(low, high) => (*low, *high),
        Reference::Column(column) => {
            let number = case
                .reference
                .lookup("run", variants::stem(run), column)
                .map_err(|reason| CaseError::invalid(case.folder.join("reference.csv"), reason))?;
            (number, number)
        }
        Reference::None => (f64::NAN, f64::NAN),
    };
    let (value, tolerance) = (point.value, expectation.tolerance);
    let result = match expectation.metric {
        Metric::RelativeError => (value - low) / low.abs(),
        Metric::AbsoluteError => value - low,
        Metric::Within => (value - high).max(0.0) + (value - low).min(0.0),
        _ => value,
    };
    let holds = match expectation.metric {
        Metric::AtMost => value <= low + tolerance,
        Metric::AtLeast => value >= low - tolerance,
        Metric::Shown => true,
        _ => result.abs() <= tolerance,
    };
    let reference =
        if low == high { number(low) } else { format!("{}..{}", number(low), number(high)) };
    Ok(finding(expectation, run.clone(), vec![value], reference, result, holds))
}

fn joint_finding(case: &Case, expectation: &Expectation, mut points: Vec<Point>) -> Finding {
    let by_spacing = matches!(
        expectation.metric,
        Metric::ConvergenceOrder | Metric::FallingError | Metric::Rising
    );
    if by_spacing {
        points.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    }
    let values: Vec<f64> = points.iter().map(|point| point.value).collect();
    let spacings: Vec<f64> = points.iter().map(|point| point.spacing).collect();
    let known = if let Reference::Number(number) = expectation.reference { number } else { 0.0 };
    let errors: Vec<f64> = values.iter().map(|value| (value - known).abs()).collect();
    let tolerance = expectation.tolerance;
    let names: Vec<&str> = points.iter().map(|point| case.runs[point.run].name.as_str()).collect();
    let (result, holds) = match expectation.metric {
        Metric::ConvergenceOrder => {
            let order = order(&spacings, &errors);
            (order, order >= tolerance)
        }
        Metric::FallingError => {
            let falls = errors.windows(2).all(|pair| pair[1] < pair[0]);
            let finest = errors[errors.len() - 1];
            (finest, falls && finest <= tolerance)
        }
        Metric::Rising => {
            let rises = values.windows(2).map(|pair| pair[1] - pair[0]);
            let least = rises.fold(f64::INFINITY, f64::min);
            (least, least >= tolerance)
        }
        Metric::Identical => {
            let same = values
                .iter()
                .all(|value| value.is_finite() && value.to_bits() == values[0].to_bits());
            (if same { 0.0 } else { 1.0 }, same)
        }
        Metric::DifferenceOfMeans => {
            at_most(differences(&names, &values).iter().map(Difference::seen), tolerance)
        }
        Metric::IntervalOfDifference => {
            at_most(differences(&names, &values).iter().map(|found| found.interval), tolerance)
        }
        _ => {
            let spread = spread(&values);
            (spread, spread <= tolerance)
        }
    };
    let reference = match expectation.reference {
        Reference::Number(known) => number(known),
        _ => "the runs among themselves".to_owned(),
    };
    if expectation.metric.needs_replicates() {
        let (groups, means) = summary(&names, &values);
        return finding(expectation, groups.join(", "), means, reference, result, holds);
    }
    finding(expectation, names.join(", "), values, reference, result, holds)
}

fn finding(
    expectation: &Expectation,
    run: String,
    values: Vec<f64>,
    reference: String,
    result: f64,
    holds: bool,
) -> Finding {
    Finding {
        run,
        observable: expectation.arguments.label(expectation.observable),
        unit: expectation.observable.unit.to_owned(),
        metric: expectation.metric,
        values,
        reference,
        result,
        tolerance: expectation.tolerance,
        holds,
        known_gap: expectation.known_gap.clone(),
        because: expectation.because.clone(),
    }
}

/// The largest value and whether it is at most `tolerance`; what is not a number never is.
fn at_most(values: impl Iterator<Item = f64>, tolerance: f64) -> (f64, bool) {
    let largest = values.fold(f64::NEG_INFINITY, |largest, value| {
        if largest.is_nan() || value.is_nan() { f64::NAN } else { largest.max(value) }
    });
    (largest, largest <= tolerance)
}

/// Least-squares slope of ln(error) over ln(spacing).
fn order(spacings: &[f64], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> =
        spacings.iter().zip(errors).map(|(spacing, error)| (spacing.ln(), error.ln())).collect();
    let count = points.len() as f64;
    let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|point| point.1).sum::<f64>() / count;
    let covariance: f64 = points.iter().map(|point| (point.0 - mean_x) * (point.1 - mean_y)).sum();
    let variance: f64 = points.iter().map(|point| (point.0 - mean_x).powi(2)).sum();
    covariance / variance
}

/// (largest - smallest) / |mean|.
fn spread(values: &[f64]) -> f64 {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (largest - smallest) / mean.abs()
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
    use approx::assert_relative_eq;

    #[test]
    fn the_order_of_a_power_law_is_its_exponent() {
        let spacings = [4.0, 2.0, 1.0];
        let errors: Vec<f64> = spacings.iter().map(|spacing: &f64| 0.3 * spacing.powi(2)).collect();
        assert_relative_eq!(order(&spacings, &errors), 2.0, max_relative = 1e-12);
    }

    #[test]
    fn spread_is_relative_to_the_mean() {
        assert_relative_eq!(spread(&[9.0, 11.0, 10.0]), 0.2, max_relative = 1e-12);
    }

    #[test]
    fn numbers_carry_four_digits() {
        assert_eq!(number(0.254_12), "0.2541");
        assert_eq!(number(1234.567), "1235");
        assert_eq!(number(2.0), "2");
        assert_eq!(number(1.23456e-9), "1.235e-9");
        assert_eq!(number(0.0), "0");
    }
}
