//! Standardisation: mean 0 and standard deviation 1, from the training rows alone.

use crate::samples::{Input, TrainingRows, mean, spread};
use serde::{Deserialize, Serialize};

/// Whether a regressor sees v_c and h or their logarithms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputScale {
    /// The values.
    Linear,
    /// Their natural logarithms: for plans that span decades. Both are above 0.
    Logarithmic,
}

impl InputScale {
    fn apply(self, input: Input) -> Input {
        match self {
            Self::Linear => input,
            Self::Logarithmic => input.map(f64::ln),
        }
    }
}

/// A standardisation that was taken from training rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Scaling {
    input_scale: InputScale,
    input_mean: Input,
    input_spread: Input,
    target_mean: f64,
    target_spread: f64,
}

impl Scaling {
    /// The standardisation of `samples`.
    pub(super) fn of(samples: &TrainingRows, input_scale: InputScale) -> Self {
        let inputs: Vec<Input> = samples.inputs.iter().map(|&x| input_scale.apply(x)).collect();
        let column = |axis: usize| inputs.iter().map(|x| x[axis]).collect::<Vec<_>>();
        Self {
            input_scale,
            input_mean: [mean(&column(0)), mean(&column(1))],
            input_spread: [0, 1].map(|axis| or_one(spread(&column(axis)), mean(&column(axis)))),
            target_mean: mean(&samples.targets),
            target_spread: or_one(spread(&samples.targets), mean(&samples.targets)),
        }
    }

    pub(super) fn input(&self, input: Input) -> Input {
        let input = self.input_scale.apply(input);
        [0, 1].map(|axis| (input[axis] - self.input_mean[axis]) / self.input_spread[axis])
    }

    pub(super) fn target(&self, target: f64) -> f64 {
        (target - self.target_mean) / self.target_spread
    }

    pub(super) fn undo(&self, target: f64) -> f64 {
        self.target_mean + self.target_spread * target
    }

    pub(super) fn target_spread(&self) -> f64 {
        self.target_spread
    }

    pub(super) fn samples(&self, samples: &TrainingRows) -> TrainingRows {
        TrainingRows {
            inputs: samples.inputs.iter().map(|&x| self.input(x)).collect(),
            targets: samples.targets.iter().map(|&y| self.target(y)).collect(),
            groups: samples.groups.clone(),
        }
    }
}

/// A column that does not vary, rounding aside, is left at its size.
fn or_one(spread: f64, mean: f64) -> f64 {
    if spread > 1e-12 * mean.abs() && spread > 0.0 { spread } else { 1.0 }
}
