//! Which input matters: permutation importance and Sobol indices.

use crate::metrics::quantile;
use crate::random::Random;
use crate::regressor::{Model, Regressor};
use crate::samples::{Input, TrainingRows, mean, spread};
use crate::validation::HeldOut;
use serde::{Deserialize, Serialize};

/// Loss of R^2 when the values of an input are shuffled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Permutation {
    /// Mean over the repetitions.
    pub mean: f64,
    /// Central 95 % of the repetitions.
    pub range: [f64; 2],
}

/// Repetitions of the shuffle.
const REPETITIONS: u64 = 50;

/// The loss for v_c and for h: every row is predicted by the model that has not seen it, with one input taken
/// from another row. `None` if the targets do not vary.
#[must_use]
pub fn permutation(
    samples: &TrainingRows,
    parts: &[HeldOut],
    seed: u64,
) -> Option<[Permutation; 2]> {
    let variation = spread(&samples.targets).powi(2);
    if variation <= 1e-18 * mean(&samples.targets).powi(2) || variation == 0.0 {
        return None;
    }
    let mean_square = |inputs: &[Input]| {
        let squares: Vec<f64> = parts
            .iter()
            .flat_map(|part| part.rows.iter().map(move |&row| (row, &part.model)))
            .map(|(row, model)| (samples.targets[row] - model.predict(inputs[row])).powi(2))
            .collect();
        mean(&squares)
    };
    let baseline = mean_square(&samples.inputs);
    Some([0, 1].map(|axis| {
        let mut losses: Vec<f64> = (0..REPETITIONS)
            .map(|repetition| {
                let mut column: Vec<f64> = samples.inputs.iter().map(|x| x[axis]).collect();
                Random::new(seed, &[0x9e2, axis as u64, repetition]).shuffle(&mut column);
                let mut inputs = samples.inputs.clone();
                inputs.iter_mut().zip(column).for_each(|(input, value)| input[axis] = value);
                (mean_square(&inputs) - baseline) / variation
            })
            .collect();
        losses.sort_by(f64::total_cmp);
        Permutation {
            mean: mean(&losses),
            range: [quantile(&losses, 0.025), quantile(&losses, 0.975)],
        }
    }))
}

/// Sobol indices of v_c and h, mean and standard deviation over the outer folds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sobol {
    /// First order: the share of the variance that an input explains alone.
    pub first: [f64; 2],
    /// Standard deviations between folds.
    pub first_spread: [f64; 2],
    /// Total: the share that is lost if everything but the input were known.
    pub total: [f64; 2],
    /// Standard deviations between folds.
    pub total_spread: [f64; 2],
}

/// Points along each side of the box.
const POINTS: usize = 48;

/// Indices over the box of `inputs`, both uniform in it and independent.
#[must_use]
pub fn sobol(inputs: &[Input], parts: &[HeldOut]) -> Option<Sobol> {
    let found: Vec<[f64; 4]> =
        parts.iter().filter_map(|part| indices(inputs, &part.model)).collect();
    if found.is_empty() {
        return None;
    }
    let column = |k: usize| found.iter().map(|row| row[k]).collect::<Vec<_>>();
    let of = |a: usize, b: usize| [mean(&column(a)), mean(&column(b))];
    let spread_of = |a: usize, b: usize| [spread(&column(a)), spread(&column(b))];
    Some(Sobol {
        first: of(0, 1),
        first_spread: spread_of(0, 1),
        total: of(2, 3),
        total_spread: spread_of(2, 3),
    })
}

/// S_1, S_2, S_T1, S_T2 by the midpoint rule on a grid: with two inputs the integrals of their
/// definition are done outright.
///
/// ```text
/// S_1 = Var_x1(E_x2 f) / Var f,   S_T1 = 1 - Var_x2(E_x1 f) / Var f
/// ```
fn indices(inputs: &[Input], model: &Model) -> Option<[f64; 4]> {
    let at = |axis: usize, k: usize| {
        let column = inputs.iter().map(|x| x[axis]);
        let low = column.clone().fold(f64::INFINITY, f64::min);
        let high = column.fold(f64::NEG_INFINITY, f64::max);
        low + (high - low) * (k as f64 + 0.5) / POINTS as f64
    };
    let axes = [0, 1].map(|axis| (0..POINTS).map(|k| at(axis, k)).collect::<Vec<_>>());
    let values: Vec<Vec<f64>> =
        axes[0].iter().map(|&x| axes[1].iter().map(|&y| model.predict([x, y])).collect()).collect();
    from_grid(&values)
}

fn from_grid(values: &[Vec<f64>]) -> Option<[f64; 4]> {
    let all: Vec<f64> = values.iter().flatten().copied().collect();
    let variance = spread(&all).powi(2);
    if variance <= 1e-18 * mean(&all).powi(2) || variance == 0.0 {
        return None;
    }
    let over_rows: Vec<f64> = values.iter().map(|row| mean(row)).collect();
    let over_columns: Vec<f64> = (0..values[0].len())
        .map(|k| mean(&values.iter().map(|row| row[k]).collect::<Vec<_>>()))
        .collect();
    let first = [spread(&over_rows).powi(2) / variance, spread(&over_columns).powi(2) / variance];
    Some([first[0], first[1], 1.0 - first[1], 1.0 - first[0]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_of_a_sum_and_a_product() {
        let grid = |f: fn(f64, f64) -> f64| {
            let at = |k: usize| (k as f64 + 0.5) / 200.0;
            (0..200).map(|i| (0..200).map(|k| f(at(i), at(k))).collect()).collect::<Vec<Vec<f64>>>()
        };
        // x + 2 y on the unit square: variances 1/12 and 4/12.
        let found = from_grid(&grid(|x, y| x + 2.0 * y)).unwrap();
        for (value, expected) in found.iter().zip([0.2, 0.8, 0.2, 0.8]) {
            assert!((value - expected).abs() < 1e-9, "{found:?}");
        }
        // x y: Var = 1/9 - 1/16 = 7/144, first order each (1/4)(1/12) = 3/144.
        let found = from_grid(&grid(|x, y| x * y)).unwrap();
        for (value, expected) in found.iter().zip([3.0 / 7.0, 3.0 / 7.0, 4.0 / 7.0, 4.0 / 7.0]) {
            // The midpoint rule with 200 points is good to 1e-5.
            assert!((value - expected).abs() < 1e-4, "{found:?}");
        }
        assert_eq!(from_grid(&grid(|_, _| 3.0)), None);
    }
}
