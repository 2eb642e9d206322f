//! Which regressor to use, and why.

use super::MethodFit;
use crate::metrics::BootstrapEstimate;
use crate::regressor::Method;
use crate::samples::mean;
use serde::{Deserialize, Serialize};

/// The choice of a regressor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// The one to use: of those that cannot be told from the best, the one that extrapolates best.
    pub method: Method,
    /// The one with the least error in interpolation.
    pub best: Method,
    /// Those whose error cannot be told from that of the best, itself included: the 95 % interval of
    /// the paired difference of their mean absolute errors holds 0.
    pub tied: Vec<Method>,
}

/// Chooses by the held-out errors; `difference` compares two sets of predictions.
pub(super) fn choose(
    methods: &[MethodFit],
    difference: impl Fn([&[f64]; 2]) -> BootstrapEstimate,
) -> Choice {
    let error = |fit: &&MethodFit| fit.interpolation.scores.mae.value;
    let best = methods
        .iter()
        .min_by(|a, b| error(a).total_cmp(&error(b)))
        .expect("at least one method is fitted");
    let tied: Vec<&MethodFit> = methods
        .iter()
        .filter(|fit| {
            let gap = difference([&fit.interpolation.predicted, &best.interpolation.predicted]);
            fit.method == best.method || gap.low <= 0.0
        })
        .collect();
    let chosen = tied
        .iter()
        .min_by(|a, b| beyond(a).total_cmp(&beyond(b)))
        .map_or(best.method, |fit| fit.method);
    Choice { method: chosen, best: best.method, tied: tied.iter().map(|fit| fit.method).collect() }
}

/// Mean of the errors in extrapolation, or the error in interpolation without any.
pub(super) fn beyond(fit: &MethodFit) -> f64 {
    let errors: Vec<f64> =
        fit.extrapolation.iter().flatten().map(|part| part.all.scores.mae.value).collect();
    if errors.is_empty() { fit.interpolation.scores.mae.value } else { mean(&errors) }
}

/// Predictions of the method that the inner folds of each outer fold prefer.
pub(super) fn procedure(trials: &[super::tasks::Trials], count: usize) -> Vec<f64> {
    let mut predicted = vec![f64::NAN; count];
    let folds = trials.first().map_or(0, |first| first.interpolation.len());
    for fold in 0..folds {
        let score = |part: &crate::validation::HeldOut| part.tuned.score.unwrap_or(f64::INFINITY);
        let held = trials
            .iter()
            .map(|trial| &trial.interpolation[fold])
            .min_by(|a, b| score(a).total_cmp(&score(b)))
            .expect("at least one method is fitted");
        held.rows.iter().zip(&held.predicted).for_each(|(&row, p)| predicted[row] = *p);
    }
    predicted
}
