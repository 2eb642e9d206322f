//! Nested cross-validation: the grid is searched inside the training rows of every outer fold.
//!
//! Nothing of a held-out row is seen before it is predicted: its fold is not in the standardisation, the grid
//! search, the early stopping or the fit. Repeats of one condition are always in the same fold.

use crate::folds::{distinct, grouped_folds};
use crate::regressor::{Method, Model, Regressor, RegressorSettings};
use crate::samples::{TrainingRows, mean};

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// The settings with the least error.
    pub settings: RegressorSettings,
    /// Their mean squared error over the inner folds (Eq. 9); `None` if there was nothing to choose.
    pub score: Option<f64>,
}

/// Whether settings without alternative are scored too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scoring {
    /// Only where there is a choice.
    IfNeeded,
    /// Always: methods are to be compared.
    Always,
}

/// Searches the grid of `method` by cross-validation of `samples` alone.
#[must_use]
pub fn tune(
    method: Method,
    samples: &TrainingRows,
    folds: usize,
    seed: u64,
    scoring: Scoring,
) -> Tuned {
    let grid = method.grid();
    if grid.len() == 1 && scoring == Scoring::IfNeeded {
        let settings = grid.into_iter().next().expect("a grid has one point at least");
        return Tuned { settings, score: None };
    }
    let folds = grouped_folds(&samples.groups, folds, seed);
    let parts: Vec<(TrainingRows, TrainingRows)> = distinct(&folds)
        .into_iter()
        .map(|fold| {
            (samples.filtered(|row| folds[row] != fold), samples.filtered(|row| folds[row] == fold))
        })
        .filter(|(training, _)| !training.is_empty())
        .collect();
    let mut best: Option<(f64, RegressorSettings)> = None;
    for settings in grid {
        let score = mean_square(&settings, &parts, seed);
        if best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, settings));
        }
    }
    let (score, settings) = best.expect("a grid has one point at least");
    Tuned { settings, score: Some(score) }
}

fn mean_square(
    settings: &RegressorSettings,
    parts: &[(TrainingRows, TrainingRows)],
    seed: u64,
) -> f64 {
    let mut squares = Vec::new();
    for (training, held) in parts {
        let model = settings.fit(training, seed);
        squares.extend(
            held.inputs.iter().zip(&held.targets).map(|(&x, y)| (y - model.predict(x)).powi(2)),
        );
    }
    let score = mean(&squares);
    if score.is_finite() { score } else { f64::INFINITY }
}

/// One outer fold: what was learnt without it, and what that says about it.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// The rows of the fold.
    pub rows: Vec<usize>,
    /// Predictions for them.
    pub predicted: Vec<f64>,
    /// Standard deviations of new measurements there, if the method knows them.
    pub deviations: Option<Vec<f64>>,
    /// What was found in the other folds.
    pub tuned: Tuned,
    /// The model of the other folds.
    pub model: Model,
}

/// Predicts the rows of `fold` by what the other rows teach.
#[must_use]
pub fn hold_out(
    method: Method,
    samples: &TrainingRows,
    folds: &[usize],
    fold: usize,
    options: &Inner,
) -> HeldOut {
    let training = samples.filtered(|row| folds[row] != fold);
    let tuned = tune(method, &training, options.folds, options.seed, options.scoring);
    let model = tuned.settings.fit(&training, options.seed);
    let rows: Vec<usize> = (0..samples.len()).filter(|&row| folds[row] == fold).collect();
    let inputs = || rows.iter().map(|&row| samples.inputs[row]);
    HeldOut {
        predicted: inputs().map(|x| model.predict(x)).collect(),
        deviations: inputs().map(|x| model.deviation(x)).collect(),
        tuned,
        model,
        rows,
    }
}

/// How the inside of an outer fold is searched.
#[derive(Debug, Clone, Copy)]
pub struct Inner {
    /// Number of inner folds.
    pub folds: usize,
    /// Seed of folds, forests and networks.
    pub seed: u64,
    /// Whether methods are to be compared.
    pub scoring: Scoring,
}

/// Predictions of all rows, put together from the folds.
#[must_use]
pub fn assemble(parts: &[HeldOut], count: usize) -> (Vec<f64>, Option<Vec<f64>>) {
    let mut predicted = vec![f64::NAN; count];
    let mut deviations = vec![f64::NAN; count];
    for part in parts {
        for (k, &row) in part.rows.iter().enumerate() {
            predicted[row] = part.predicted[k];
            if let Some(all) = &part.deviations {
                deviations[row] = all[k];
            }
        }
    }
    let known = deviations.iter().all(|deviation| deviation.is_finite());
    (predicted, known.then_some(deviations))
}
