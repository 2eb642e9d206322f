//! The evidence of a Gaussian process and its maximum.

use super::symmetric;
use crate::samples::{Input, TrainingRows};
use nalgebra::{Cholesky, DMatrix, DVector, SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// Variances and lengths, for standardised inputs and targets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Hyperparameters {
    /// s^2.
    pub signal: f64,
    /// Lengths of both inputs.
    pub lengths: Input,
    /// sigma^2.
    pub noise: f64,
}

/// Logarithms of s^2, both lengths and sigma^2.
type Point = SVector<f64, 4>;

/// Range of each: signals up to a hundred standard deviations of the target, lengths from a twentieth to a
/// hundred standard deviations of the input, noise from a thousandth to three standard deviations.
const RANGES: [(f64, f64); 4] = [(1e-4, 1e4), (0.05, 100.0), (0.05, 100.0), (1e-6, 10.0)];
/// Starts of the search: both lengths and sigma^2, with s^2 = 1.
const STARTS: [[f64; 2]; 2] = [[1.0, 0.1], [3.0, 0.003]];
const MOST_STEPS: usize = 60;
/// Steps whose gain of evidence is below end the search.
const TOLERANCE: f64 = 1e-5;

/// The kernel for standardised inputs, without its variance.
pub(super) fn matern(a: Input, b: Input, hyper: &Hyperparameters) -> f64 {
    let r = (5.0 * square(a, b, hyper)).sqrt();
    (1.0 + r + r * r / 3.0) * (-r).exp()
}

fn square(a: Input, b: Input, hyper: &Hyperparameters) -> f64 {
    (0..2).map(|axis| ((a[axis] - b[axis]) / hyper.lengths[axis]).powi(2)).sum()
}

/// K with the noise.
pub(super) fn covariance(inputs: &[Input], hyper: &Hyperparameters) -> DMatrix<f64> {
    symmetric(inputs.len(), |row, column| {
        let noise = if row == column { hyper.noise } else { 0.0 };
        hyper.signal * matern(inputs[row], inputs[column], hyper) + noise
    })
}

/// The largest evidence found and its hyper-parameters.
pub(super) fn maximise(samples: &TrainingRows) -> (f64, Hyperparameters) {
    let mut best: Option<(f64, Point)> = None;
    for [length, noise] in STARTS {
        let start = free(&Point::new(0.0, length.ln(), length.ln(), noise.ln()));
        let found = ascend(samples, start);
        if best.as_ref().is_none_or(|(evidence, _)| found.0 > *evidence) {
            best = Some(found);
        }
    }
    let (evidence, point) = best.expect("there is a start");
    (evidence, hyperparameters(&point))
}

/// From the bounded logarithm to a free number, and back: a logistic function across each range.
fn free(point: &Point) -> Point {
    Point::from_fn(|k, _| {
        let (low, high) = (RANGES[k].0.ln(), RANGES[k].1.ln());
        let share = ((point[k] - low) / (high - low)).clamp(1e-3, 1.0 - 1e-3);
        (share / (1.0 - share)).ln()
    })
}

fn share(free: f64) -> f64 {
    1.0 / (1.0 + (-free).exp())
}

fn hyperparameters(point: &Point) -> Hyperparameters {
    let value = |k: usize| {
        let (low, high) = (RANGES[k].0.ln(), RANGES[k].1.ln());
        (low + (high - low) * share(point[k])).exp()
    };
    Hyperparameters { signal: value(0), lengths: [value(1), value(2)], noise: value(3) }
}

/// BFGS with backtracking, upwards; returns the evidence and the free point.
fn ascend(samples: &TrainingRows, start: Point) -> (f64, Point) {
    let mut at = start;
    let (mut value, mut gradient) = evidence(samples, &at);
    let mut inverse = SMatrix::<f64, 4, 4>::identity() * 0.1;
    for _ in 0..MOST_STEPS {
        let mut direction = inverse * gradient;
        if direction.dot(&gradient) <= 0.0 {
            inverse = SMatrix::identity() * 0.1;
            direction = inverse * gradient;
        }
        // A step of the logistic numbers beyond two would cross most of a range.
        let mut length = (2.0 / direction.amax().max(1e-300)).min(1.0);
        let mut next = None;
        for _ in 0..12 {
            let there = at + direction * length;
            let (there_value, there_gradient) = evidence(samples, &there);
            if there_value > value + 1e-4 * length * direction.dot(&gradient) {
                next = Some((there, there_value, there_gradient));
                break;
            }
            length *= 0.4;
        }
        let Some((there, there_value, there_gradient)) = next else { break };
        let (step, change) = (there - at, gradient - there_gradient);
        let product = step.dot(&change);
        if product > 1e-12 {
            let left = SMatrix::<f64, 4, 4>::identity() - step * change.transpose() / product;
            inverse = left * inverse * left.transpose() + step * step.transpose() / product;
        }
        let gained = there_value - value;
        (at, value, gradient) = (there, there_value, there_gradient);
        if gained < TOLERANCE {
            break;
        }
    }
    (value, at)
}

/// Logarithm of the evidence and its gradient by the free numbers.
fn evidence(samples: &TrainingRows, point: &Point) -> (f64, Point) {
    let hyper = hyperparameters(point);
    let count = samples.len();
    let Some(factor) = Cholesky::new(covariance(&samples.inputs, &hyper)) else {
        return (f64::NEG_INFINITY, Point::zeros());
    };
    let targets = DVector::from_column_slice(&samples.targets);
    let weights = factor.solve(&targets);
    let half_determinant: f64 = (0..count).map(|k| factor.l_dirty()[(k, k)].ln()).sum();
    let value = -0.5 * targets.dot(&weights)
        - half_determinant
        - 0.5 * count as f64 * std::f64::consts::TAU.ln();
    // d/d theta = 1/2 tr((w w^T - K^-1) dK/d theta)
    let inverse = factor.inverse();
    let mut slopes = Point::zeros();
    for column in 0..count {
        for row in column..count {
            let twice = if row == column { 0.5 } else { 1.0 };
            let pull = twice * (weights[row] * weights[column] - inverse[(row, column)]);
            let (a, b) = (samples.inputs[row], samples.inputs[column]);
            let r = (5.0 * square(a, b, &hyper)).sqrt();
            let decay = (-r).exp();
            slopes[0] += pull * hyper.signal * (1.0 + r + r * r / 3.0) * decay;
            let common = pull * hyper.signal * 5.0 / 3.0 * (1.0 + r) * decay;
            for axis in 0..2 {
                slopes[1 + axis] += common * ((a[axis] - b[axis]) / hyper.lengths[axis]).powi(2);
            }
            if row == column {
                slopes[3] += pull * hyper.noise;
            }
        }
    }
    let chain = Point::from_fn(|k, _| {
        let s = share(point[k]);
        (RANGES[k].1.ln() - RANGES[k].0.ln()) * s * (1.0 - s)
    });
    (value, slopes.component_mul(&chain))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> TrainingRows {
        let inputs: Vec<Input> =
            (0..20).map(|k| [f64::from(k % 5) - 2.0, f64::from(k / 5) - 1.5]).collect();
        let targets = inputs
            .iter()
            .enumerate()
            .map(|(k, x)| (0.8 * x[0]).sin() + 0.3 * x[1] + 0.05 * f64::from((k * 7 % 5) as u32));
        TrainingRows { targets: targets.collect(), groups: (0..20).collect(), inputs }
    }

    #[test]
    fn the_gradient_is_that_of_the_evidence() {
        let point = Point::new(0.2, -0.4, 0.3, -0.8);
        let (_, gradient) = evidence(&samples(), &point);
        for k in 0..4 {
            let step = 1e-5;
            let moved = |by: f64| {
                let mut there = point;
                there[k] += by;
                evidence(&samples(), &there).0
            };
            let difference = (moved(step) - moved(-step)) / (2.0 * step);
            // Central differences: truncation and rounding are about 1e-9 of the evidence.
            assert!((difference - gradient[k]).abs() < 1e-6, "{k}: {difference} {}", gradient[k]);
        }
    }

    #[test]
    fn the_search_ends_where_the_gradient_vanishes() {
        let samples = samples();
        let start = free(&Point::new(0.0, 0.0, 0.0, 0.1_f64.ln()));
        let (value, at) = ascend(&samples, start);
        let (again, gradient) = evidence(&samples, &at);
        assert_eq!(again, value);
        assert!(value > evidence(&samples, &start).0);
        assert!(gradient.amax() < 0.05, "{gradient}");
    }
}
