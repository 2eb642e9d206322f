//! From the values of runs to judgements.

use super::replicates::{Difference, differences, summary};
use super::{Expectation, ScenarioRuns, variants};
use crate::error::CaseError;
use crate::head::CaseHead;
use crate::metric::{Metric, ReferenceValue, band, number};
use crate::verdict::Judgement;

/// What one run contributes to the judgement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunValues {
    /// Particle spacing in m.
    pub(crate) spacing: f64,
    /// One value for every expectation of the case that is about this run.
    pub(crate) values: Vec<Option<f64>>,
}

/// Judges every expectation of `case` on the values of its runs (in the order of the runs).
pub(super) fn judge(
    case: &ScenarioRuns,
    head: &CaseHead,
    runs: &[RunValues],
) -> Result<Vec<Judgement>, CaseError> {
    let mut judged = Vec::new();
    for (index, expectation) in case.expectations.iter().enumerate() {
        let mut points = Vec::new();
        for run in &expectation.runs {
            let name = case.runs[*run].name.as_str();
            let missing = || {
                let reason = format!("no value for run `{name}`");
                CaseError::unobservable(expectation.observable.name, reason)
            };
            let value = runs[*run].values[index].ok_or_else(missing)?;
            points.push(ValueOfRun { run: name, spacing: runs[*run].spacing, value });
        }
        if expectation.metric.joins_runs() {
            judged.push(judge_together(expectation, points));
        } else {
            for point in points {
                judged.push(judge_one(case, head, expectation, &point)?);
            }
        }
    }
    Ok(judged)
}

#[derive(Debug, Clone, Copy)]
struct ValueOfRun<'a> {
    run: &'a str,
    spacing: f64,
    value: f64,
}

fn judge_one(
    case: &ScenarioRuns,
    head: &CaseHead,
    expectation: &Expectation,
    point: &ValueOfRun<'_>,
) -> Result<Judgement, CaseError> {
    let (low, high) = match &expectation.reference {
        ReferenceValue::Number(number) => (*number, *number),
        ReferenceValue::Band(low, high) => (*low, *high),
        ReferenceValue::Column(column) => {
            let found = case.reference.lookup("run", variants::stem(point.run), column);
            let wrong = |reason| CaseError::invalid(head.folder.join("reference.csv"), reason);
            let number = found.map_err(wrong)?;
            (number, number)
        }
        ReferenceValue::None => (f64::NAN, f64::NAN),
    };
    let compared = expectation.metric.compare(point.value, (low, high), expectation.tolerance);
    Ok(judgement(expectation, point.run.to_owned(), vec![point.value], band(low, high), compared))
}

fn judge_together(expectation: &Expectation, mut points: Vec<ValueOfRun<'_>>) -> Judgement {
    let by_spacing = matches!(
        expectation.metric,
        Metric::ConvergenceOrder | Metric::FallingError | Metric::Rising
    );
    if by_spacing {
        points.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    }
    let values: Vec<f64> = points.iter().map(|point| point.value).collect();
    let spacings: Vec<f64> = points.iter().map(|point| point.spacing).collect();
    let known =
        if let ReferenceValue::Number(number) = expectation.reference { number } else { 0.0 };
    let errors: Vec<f64> = values.iter().map(|value| (value - known).abs()).collect();
    let tolerance = expectation.tolerance;
    let names: Vec<&str> = points.iter().map(|point| point.run).collect();
    let compared = match expectation.metric {
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
        ReferenceValue::Number(known) => number(known),
        _ => "the runs among themselves".to_owned(),
    };
    if expectation.metric.needs_replicates() {
        let (groups, means) = summary(&names, &values);
        return judgement(expectation, groups.join(", "), means, reference, compared);
    }
    judgement(expectation, names.join(", "), values, reference, compared)
}

fn judgement(
    expectation: &Expectation,
    run: String,
    values: Vec<f64>,
    reference: String,
    (result, holds): (f64, bool),
) -> Judgement {
    Judgement {
        run,
        observable: expectation.label(),
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
}
