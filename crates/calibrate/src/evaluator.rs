//! What computes cuts: the particle solver by way of the caller, or the quick model.

use crate::emulator::PriorModel;
use crate::{Channels, CutValues, RunPoint};
use std::convert::Infallible;

/// Computes cuts with given constants.
pub trait CutEvaluator {
    /// Why there are no results.
    type Error;

    /// The channels of every point, in its order; `None` where a run has none. `round` names the runs.
    ///
    /// # Errors
    /// Whatever keeps all of them from being made.
    fn evaluate(&mut self, round: &str, points: &[RunPoint])
    -> Result<Vec<CutValues>, Self::Error>;
}

/// Scatter that the closed form is given where it stands for runs: that of draft runs over thirty thicknesses.
const SCATTER: Channels<f64> = [0.01, 0.03, 0.05, 0.01, 0.03, 0.06, 0.2];

/// The quick model in place of runs: a first answer in seconds, and what runs would tell.
pub struct QuickEvaluator<'m>(pub &'m dyn PriorModel);

impl CutEvaluator for QuickEvaluator<'_> {
    type Error = Infallible;

    fn evaluate(&mut self, _: &str, points: &[RunPoint]) -> Result<Vec<CutValues>, Infallible> {
        let of = |point: &RunPoint| {
            let logs = self.0.logs(&point.condition, &point.t);
            std::array::from_fn(|k| {
                logs[k].is_finite().then_some((logs[k], SCATTER[k] * SCATTER[k]))
            })
        };
        Ok(points.iter().map(of).collect())
    }
}
