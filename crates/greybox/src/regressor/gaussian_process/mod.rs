//! Gaussian process with noise (Rasmussen and Williams 2006, algorithms 2.1 and 5.1).
//!
//! ```text
//! y ~ N(0, K),   K_ij = s^2 k(r_ij) + sigma^2 delta_ij,   r^2 = sum_d (x_d - x'_d)^2 / l_d^2
//! k(r) = (1 + sqrt(5) r + 5/3 r^2) exp(-sqrt(5) r)                         (Matern, nu = 5/2)
//! ```
//!
//! on standardised inputs and targets. Signal s, noise sigma and both lengths l maximise the evidence; so does the
//! choice between the inputs and their logarithms, if it is left open. The process gives a standard deviation for every prediction:
//! that of a new measurement. It takes the noise to be the same everywhere.

use super::Regressor;
use super::scaling::{InputScale, Scaling};
use crate::random::Random;
use crate::samples::{Input, TrainingRows};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::{Deserialize, Serialize};

mod evidence;

use evidence::{Hyperparameters, covariance, matern, maximise};

/// What the process may see.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GaussianProcessSettings {
    /// The scales among which the evidence chooses.
    pub input_scales: Vec<InputScale>,
}

/// A process given its data.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct GaussianProcess {
    stored: Stored,
    factor: Cholesky<f64, Dyn>,
    weights: DVector<f64>,
}

/// What is stored; the factor follows from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Stored {
    scaling: Scaling,
    hyperparameters: Hyperparameters,
    inputs: Vec<Input>,
    targets: Vec<f64>,
}

impl PartialEq for GaussianProcess {
    fn eq(&self, other: &Self) -> bool {
        self.stored == other.stored
    }
}

/// Rows that the evidence is computed with; of more, so many are drawn.
const MOST_EVIDENCE_ROWS: usize = 300;

impl GaussianProcessSettings {
    /// The process with the largest evidence.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows, seed: u64) -> GaussianProcess {
        let mut best: Option<(f64, Stored)> = None;
        for &scale in &self.input_scales {
            let scaling = Scaling::of(samples, scale);
            let scaled = scaling.samples(samples);
            let (evidence, hyperparameters) = maximise(&drawn(&scaled, seed));
            if best.as_ref().is_none_or(|(largest, _)| evidence > *largest) {
                let TrainingRows { inputs, targets, .. } = scaled;
                best = Some((evidence, Stored { scaling, hyperparameters, inputs, targets }));
            }
        }
        let (_, stored) = best.expect("a process has at least one scale");
        GaussianProcess::try_from(stored).expect("the noise keeps the matrix positive definite")
    }
}

/// The rows the evidence is computed with.
fn drawn(samples: &TrainingRows, seed: u64) -> TrainingRows {
    if samples.len() <= MOST_EVIDENCE_ROWS {
        return samples.clone();
    }
    let mut rows: Vec<usize> = (0..samples.len()).collect();
    Random::new(seed, &[0x6a05]).shuffle(&mut rows);
    let mut kept = rows[..MOST_EVIDENCE_ROWS].to_vec();
    kept.sort_unstable();
    samples.filtered(|row| kept.binary_search(&row).is_ok())
}

impl TryFrom<Stored> for GaussianProcess {
    type Error = String;

    fn try_from(stored: Stored) -> Result<Self, String> {
        if stored.inputs.len() != stored.targets.len() || stored.inputs.is_empty() {
            return Err("a Gaussian process with unequal numbers of inputs and targets".to_owned());
        }
        let matrix = covariance(&stored.inputs, &stored.hyperparameters);
        let factor = Cholesky::new(matrix)
            .ok_or("a Gaussian process whose covariance is not positive definite")?;
        let weights = factor.solve(&DVector::from_vec(stored.targets.clone()));
        Ok(Self { stored, factor, weights })
    }
}

impl From<GaussianProcess> for Stored {
    fn from(process: GaussianProcess) -> Self {
        process.stored
    }
}

impl GaussianProcess {
    /// Covariances of the standardised `input` with the training rows.
    fn with_rows(&self, input: Input) -> DVector<f64> {
        let hyper = &self.stored.hyperparameters;
        let rows = self.stored.inputs.iter().map(|&row| hyper.signal * matern(input, row, hyper));
        DVector::from_iterator(self.stored.inputs.len(), rows)
    }

    /// The standard deviation of the noise, in the unit of the target.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.stored.hyperparameters.noise.sqrt() * self.stored.scaling.target_spread()
    }
}

impl Regressor for GaussianProcess {
    fn predict(&self, input: Input) -> f64 {
        let shared = self.with_rows(self.stored.scaling.input(input));
        self.stored.scaling.undo(shared.dot(&self.weights))
    }

    fn deviation(&self, input: Input) -> Option<f64> {
        let shared = self.with_rows(self.stored.scaling.input(input));
        let hyper = &self.stored.hyperparameters;
        let explained = shared.dot(&self.factor.solve(&shared));
        let variance = (hyper.signal - explained).max(0.0) + hyper.noise;
        Some(variance.sqrt() * self.stored.scaling.target_spread())
    }
}

/// A square matrix from a function of its indices that is symmetric.
fn symmetric(count: usize, value: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(count, count);
    for column in 0..count {
        for row in column..count {
            let entry = value(row, column);
            matrix[(row, column)] = entry;
            matrix[(column, row)] = entry;
        }
    }
    matrix
}
