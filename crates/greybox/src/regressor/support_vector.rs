//! Support vector regression with radial basis functions (Eqs. 10 and 11).
//!
//! ```text
//! f(x) = sum_i (a_i - a_i*) exp(-gamma |x - x_i|^2) + b
//! min 1/2 |w|^2 + C sum_i (xi_i + xi_i*),   |y_i - f(x_i)| <= epsilon + xi_i
//! ```
//!
//! on standardised inputs and targets: the tube epsilon is a share of the targets' standard deviation. The dual
//! is solved by sequential minimal optimisation with pairs chosen by second-order information (Fan, Chen and Lin
//! 2005), until no pair violates the conditions of the optimum by more than a thousandth of a standard
//! deviation, or the number of steps is used up.

use super::Regressor;
use super::scaling::{InputScale, Scaling};
use crate::samples::{Input, TrainingRows};
use serde::{Deserialize, Serialize};

/// C, epsilon and gamma.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SupportVectorSettings {
    /// C: weight of deviations beyond the tube (J in Eq. 11).
    pub penalty: f64,
    /// Half width of the tube in standard deviations of the target.
    pub tube: f64,
    /// gamma of the kernel, for standardised inputs.
    pub sharpness: f64,
    /// What the kernel sees.
    pub input_scale: InputScale,
}

/// A sum of radial basis functions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SupportVector {
    scaling: Scaling,
    sharpness: f64,
    vectors: Vec<Input>,
    weights: Vec<f64>,
    offset: f64,
}

/// Violation of the optimum that is accepted.
const TOLERANCE: f64 = 1e-3;
/// Most steps. A flat kernel with a large C would take a hundred times as many for the last thousandth; the fit is then
/// the one that was reached, and is judged like every other by what it predicts.
const MOST_STEPS: usize = 20_000;
/// Curvature that takes the place of none at all, where two rows have the same inputs.
const LEAST_CURVATURE: f64 = 1e-12;

impl SupportVectorSettings {
    /// The solution for `samples`.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows) -> SupportVector {
        let scaling = Scaling::of(samples, self.input_scale);
        let scaled = scaling.samples(samples);
        let mut dual = Dual::new(self, &scaled);
        for _ in 0..MOST_STEPS {
            let Some((first, second)) = dual.pair() else { break };
            dual.step(first, second);
        }
        let offset = dual.offset();
        let (vectors, weights) = (scaled.inputs.iter().zip(dual.weights()))
            .filter(|(_, weight)| *weight != 0.0)
            .map(|(&vector, weight)| (vector, weight))
            .unzip();
        SupportVector { scaling, sharpness: self.sharpness, vectors, weights, offset }
    }
}

/// exp(-gamma |a - b|^2).
fn kernel(a: Input, b: Input, sharpness: f64) -> f64 {
    (-sharpness * ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2))).exp()
}

impl Regressor for SupportVector {
    fn predict(&self, input: Input) -> f64 {
        let x = self.scaling.input(input);
        let terms = self.vectors.iter().zip(&self.weights);
        let sum: f64 = terms.map(|(&v, weight)| weight * kernel(x, v, self.sharpness)).sum();
        self.scaling.undo(sum + self.offset)
    }
}

/// The dual problem: 2 n multipliers, those of the upper sides of the tube first.
///
/// ```text
/// min 1/2 sum s_i s_j a_i a_j K_ij + sum p_i a_i,   sum s_i a_i = 0,   0 <= a_i <= C
/// s = 1, p = epsilon - y above;   s = -1, p = epsilon + y below
/// ```
struct Dual {
    count: usize,
    penalty: f64,
    kernel: Vec<f64>,
    multipliers: Vec<f64>,
    /// Minus s times the gradient: what a step along s would gain.
    pull: Vec<f64>,
}

impl Dual {
    fn new(settings: &SupportVectorSettings, scaled: &TrainingRows) -> Self {
        let count = scaled.len();
        let inputs = &scaled.inputs;
        let kernel = inputs
            .iter()
            .flat_map(|&a| inputs.iter().map(move |&b| kernel(a, b, settings.sharpness)))
            .collect();
        let above = scaled.targets.iter().map(|y| y - settings.tube);
        let below = scaled.targets.iter().map(|y| y + settings.tube);
        Self {
            count,
            penalty: settings.penalty,
            kernel,
            multipliers: vec![0.0; 2 * count],
            pull: above.chain(below).collect(),
        }
    }

    fn sign(&self, k: usize) -> f64 {
        if k < self.count { 1.0 } else { -1.0 }
    }

    /// Whether s a may grow.
    fn may_grow(&self, k: usize) -> bool {
        if k < self.count { self.multipliers[k] < self.penalty } else { self.multipliers[k] > 0.0 }
    }

    /// Whether s a may shrink.
    fn may_shrink(&self, k: usize) -> bool {
        if k < self.count { self.multipliers[k] > 0.0 } else { self.multipliers[k] < self.penalty }
    }

    /// The pair that gains most: the strongest pull upwards, and its best partner by second order. `None` at the
    /// optimum.
    fn pair(&self) -> Option<(usize, usize)> {
        let mut first = None;
        let mut most = f64::NEG_INFINITY;
        for k in 0..2 * self.count {
            if self.pull[k] > most && self.may_grow(k) {
                (most, first) = (self.pull[k], Some(k));
            }
        }
        let first = first?;
        let row = self.row(first);
        let (mut best, mut second, mut least) = (0.0, None, f64::INFINITY);
        for k in 0..2 * self.count {
            if !self.may_shrink(k) {
                continue;
            }
            least = least.min(self.pull[k]);
            let gap = most - self.pull[k];
            if gap > 0.0 {
                let shared = row[k % self.count];
                let gain = gap * gap / (2.0 - 2.0 * shared).max(LEAST_CURVATURE);
                if gain > best {
                    (best, second) = (gain, Some(k));
                }
            }
        }
        if most - least < TOLERANCE { None } else { second.map(|second| (first, second)) }
    }

    fn row(&self, k: usize) -> &[f64] {
        let start = (k % self.count) * self.count;
        &self.kernel[start..start + self.count]
    }

    /// Moves s a of `first` up and of `second` down by the same amount, as far as is best and allowed.
    fn step(&mut self, first: usize, second: usize) {
        let curvature = 2.0 - 2.0 * self.row(first)[second % self.count];
        let wanted = (self.pull[first] - self.pull[second]) / curvature.max(LEAST_CURVATURE);
        let room = |k: usize, up: bool| {
            let grows = (k < self.count) == up;
            if grows { self.penalty - self.multipliers[k] } else { self.multipliers[k] }
        };
        let limits = [room(first, true), room(second, false)];
        let amount = wanted.min(limits[0]).min(limits[1]);
        for (k, direction, limit) in [(first, 1.0, limits[0]), (second, -1.0, limits[1])] {
            let step = self.sign(k) * direction;
            // At a border exactly, so that rounding leaves nothing behind.
            self.multipliers[k] = match (amount >= limit, step > 0.0) {
                (true, true) => self.penalty,
                (true, false) => 0.0,
                (false, _) => self.multipliers[k] + step * amount,
            };
        }
        let (a, b) = ((first % self.count) * self.count, (second % self.count) * self.count);
        for k in 0..self.count {
            let change = amount * (self.kernel[a + k] - self.kernel[b + k]);
            self.pull[k] -= change;
            self.pull[self.count + k] -= change;
        }
    }

    /// Weight of each row.
    fn weights(&self) -> Vec<f64> {
        (0..self.count).map(|k| self.multipliers[k] - self.multipliers[self.count + k]).collect()
    }

    /// b: the pull of the multipliers between the borders, or the middle of what the borders allow.
    fn offset(&self) -> f64 {
        let free: Vec<f64> = (0..2 * self.count)
            .filter(|&k| self.may_grow(k) && self.may_shrink(k))
            .map(|k| self.pull[k])
            .collect();
        if !free.is_empty() {
            return crate::samples::mean(&free);
        }
        let all = || 0..2 * self.count;
        let low = all()
            .filter(|&k| self.may_grow(k))
            .map(|k| self.pull[k])
            .fold(f64::NEG_INFINITY, f64::max);
        let high = all()
            .filter(|&k| self.may_shrink(k))
            .map(|k| self.pull[k])
            .fold(f64::INFINITY, f64::min);
        0.5 * (low + high)
    }
}
