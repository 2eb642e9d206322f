//! How many experiments are enough: the error on conditions left out over the number of conditions used.

use super::progress::FitProgress;
use super::{Context, median};
use crate::metrics::quantile;
use crate::random::Random;
use crate::regressor::{Method, Regressor};
use crate::samples::{TrainingRows, mean};
use crate::validation::{Scoring, tune};
use rayon::prelude::*;

/// The error with a number of conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearningPoint {
    /// Conditions used.
    pub conditions: usize,
    /// Mean absolute error on the others in N: median over the draws.
    pub mae: f64,
    /// Smallest and largest of the draws.
    pub range: [f64; 2],
    /// The same method without the simulation: median.
    pub alone: f64,
}

/// Shares of the conditions that are used.
const SHARES: [f64; 7] = [0.1, 0.15, 0.25, 0.4, 0.55, 0.7, 0.85];
/// Draws of each.
const DRAWS: u64 = 8;
/// Fewest conditions a regressor is taught with.
const FEWEST: usize = 6;
/// Inner folds: half of those of the fit, for the curve shows a trend.
const FOLDS: usize = 5;
/// Number of tasks, in those of the fit.
pub(super) const TASKS: u64 = SHARES.len() as u64 * DRAWS;

/// The curve of a method, tuned anew for every draw.
pub(super) fn curve(
    context: &Context<'_>,
    method: Method,
    progress: &FitProgress<'_>,
) -> Vec<LearningPoint> {
    let measured = context.pairs.measured(context.force);
    let alone = context.samples.with_targets(measured);
    let conditions = context.pairs.conditions.len();
    let mut sizes: Vec<usize> =
        SHARES.iter().map(|share| (share * conditions as f64).round() as usize).collect();
    sizes.retain(|&size| size >= FEWEST);
    sizes.dedup();
    let tasks: Vec<(usize, u64)> =
        sizes.iter().flat_map(|&size| (0..DRAWS).map(move |draw| (size, draw))).collect();
    let seed = context.options.seed;
    let errors: Vec<[f64; 2]> = tasks
        .par_iter()
        .with_max_len(1)
        .map(|&(size, draw)| {
            let used = drawn(conditions, size, seed, draw);
            let found =
                [context.samples, &alone].map(|samples| error(samples, &used, method, seed));
            progress.advance(method);
            found
        })
        .collect();
    sizes
        .iter()
        .zip(errors.chunks(DRAWS as usize))
        .map(|(&conditions, chunk)| {
            let mut grey: Vec<f64> = chunk.iter().map(|pair| pair[0]).collect();
            grey.sort_by(f64::total_cmp);
            LearningPoint {
                conditions,
                mae: quantile(&grey, 0.5),
                range: [grey[0], grey[grey.len() - 1]],
                alone: median(chunk.iter().map(|pair| pair[1]).collect()),
            }
        })
        .collect()
}

/// Which conditions a draw uses.
fn drawn(conditions: usize, size: usize, seed: u64, draw: u64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..conditions).collect();
    Random::new(seed, &[0x1ea2, size as u64, draw]).shuffle(&mut order);
    let mut used = vec![false; conditions];
    order[..size].iter().for_each(|&condition| used[condition] = true);
    used
}

/// Mean absolute error on the conditions that are not used.
fn error(samples: &TrainingRows, used: &[bool], method: Method, seed: u64) -> f64 {
    let training = samples.filtered(|row| used[samples.groups[row]]);
    let held = samples.filtered(|row| !used[samples.groups[row]]);
    let model =
        tune(method, &training, FOLDS, seed, Scoring::IfNeeded).settings.fit(&training, seed);
    let errors: Vec<f64> =
        held.inputs.iter().zip(&held.targets).map(|(&x, y)| (y - model.predict(x)).abs()).collect();
    mean(&errors)
}
