//! The fit under the null hypothesis: several starts, because one that stops short makes an effect out of its own shortfall.

use crate::inference::fit::{Fit, fit};
use crate::inference::problem::RegressionProblem;
use crate::model::predictor::Predictor;
use nalgebra::DVector;

/// By how much another start has to raise the logarithm of the evidence to take the place of the fit.
const BETTER: f64 = 1e-3;

/// The best fit without an effect from three starts: the means of all nuisances, and the fits of the reference alone and of the
/// diagnosed rows alone, where the problem has both.
#[must_use]
pub fn null_fit(problem: &RegressionProblem, predictor: &dyn Predictor) -> Option<Fit> {
    let zero = DVector::zeros(problem.unknowns());
    let (diagnosed, others): (Vec<usize>, Vec<usize>) =
        (0..problem.rows.len()).partition(|&row| problem.is_diagnosed(row));
    let mut starts = vec![zero.clone()];
    if !others.is_empty() {
        let parts = [others, diagnosed].into_iter().filter_map(|rows| {
            let part = problem.select(&rows).ok()?;
            Some(fit(&part, predictor, &[], &zero)?.unknowns)
        });
        starts.extend(parts);
    }
    let fits = starts.iter().filter_map(|start| fit(problem, predictor, &[], start));
    fits.max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// A better fit without an effect than `null`, started from what the fits of the candidate effects make of the nuisances; `None`
/// if none is better.
///
/// The null hypothesis is nested in every candidate: where a candidate has found a better place for the nuisances, the null
/// hypothesis is owed it before the two are compared.
pub(crate) fn better_null(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    null: &Fit,
    candidates: &[Fit],
) -> Option<Fit> {
    let count = problem.unknowns();
    candidates
        .iter()
        .filter_map(|found| {
            let start = found.unknowns.rows(0, count).into_owned();
            fit(problem, predictor, &[], &start)
        })
        .filter(|found| found.log_evidence > null.log_evidence + BETTER)
        .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::problem::RegressionProblem;
    use crate::model::predictor::Active;
    use crate::session::Compared;
    use crate::tests::twin::{Altered, Twin};
    use proptest::prelude::*;
    use sphcut_physics::CuttingCondition;

    /// The twin with nuisances that act in waves, so that the null hypothesis has many local optima.
    fn wavy(twin: &Twin, at: &CuttingCondition, nuisances: &[f64], active: &[Active]) -> Vec<f64> {
        let waves: Vec<f64> = nuisances.iter().map(|x| x + 0.1 * (25.0 * x).sin()).collect();
        twin.log_observables(at, &waves, active)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// What a candidate has found for the nuisances the null hypothesis has, too: no alarm is carried by a fit that stopped short.
        #[test]
        fn the_null_is_never_below_an_optimum_found_from_a_finalist(
            seed in 0_u64..1000, effect in 0_usize..4, amplitude in -0.3_f64..0.3,
        ) {
            let model = Altered { twin: Twin::new(), answer: wavy };
            let hidden = Active { effect, values: vec![amplitude] };
            let recordings = model.twin.recorded(&[hidden], 0.02, seed);
            let problem =
                RegressionProblem::new(&recordings, &model, &crate::tests::twin::INSTRUMENTS).unwrap();
            let found = Compared::new(problem, &model).unwrap();
            for candidate in &found.fits {
                let start = candidate.unknowns.rows(0, found.problem.unknowns()).into_owned();
                let nested = fit(&found.problem, &model, &[], &start).unwrap();
                prop_assert!(
                    found.null.log_evidence >= nested.log_evidence - BETTER,
                    "{} {}", found.null.log_evidence, nested.log_evidence
                );
            }
        }
    }
}
