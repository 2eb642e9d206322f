//! The most probable nuisances and parameters, and the evidence there.

use crate::inference::change_error::{self, Loose};
use crate::inference::gaussian::log_determinant;
use crate::inference::law::{Eigenpairs, Factor, GaussianLaw};
use crate::inference::problem::RegressionProblem;
use crate::model::paired::Change;
use crate::model::predictor::{Active, Predictor};
use nalgebra::{DMatrix, DVector};

/// Step of the unknowns, in standard deviations of their priors, over which the model is differenced.
const STEP: f64 = 0.02;
/// Steps after which a fit ends.
const MOST_STEPS: usize = 60;
/// Length of a step, in standard deviations of the priors, below which the derivative is kept for the next.
const SMALL: f64 = 0.3;
/// Damping of the first step, and of the first with a new derivative after a step that failed.
const DAMPING: f64 = 1e-3;
/// Tenfold increases of the damping after which a step has failed.
const MOST_TRIES: usize = 12;
/// Rounds in which the error of the change and the fit follow each other.
const ERROR_ROUNDS: usize = 1;
/// Share of the largest eigenvalue below which a direction of an error does not count.
pub(crate) const NEGLIGIBLE: f64 = 1e-10;
/// Decrease of the target that a full step still promises, g' H^-1 g, below which a fit has converged; it is twice a logarithm of
/// probability.
const CONVERGED: f64 = 1e-3;

/// The most probable unknowns under one hypothesis.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Effects of the hypothesis, by their place in [`Predictor::effects`].
    pub effects: Vec<usize>,
    /// Nuisances of the model, those of the instruments, parameters of the effects; all standard normal before the data.
    pub unknowns: DVector<f64>,
    /// Their covariance given the data.
    pub covariance: DMatrix<f64>,
    /// log y less its prediction.
    pub residual: DVector<f64>,
    /// Derivative of the prediction by the unknowns.
    pub jacobian: DMatrix<f64>,
    /// The most probable error of the model in what the effects change.
    pub(crate) error: Option<Factor>,
    /// log of the evidence by Laplace's method.
    pub log_evidence: f64,
}

impl Fit {
    /// The effects with the SI values of their parameters.
    #[must_use]
    pub fn active(&self, predictor: &dyn Predictor, nuisances: usize) -> Vec<Active> {
        active(predictor, &self.effects, &self.unknowns.as_slice()[nuisances..])
    }

    /// What it changes in the scenario, for an edge that has cut `cut_length` in m before.
    pub(crate) fn change(
        &self,
        problem: &RegressionProblem,
        predictor: &dyn Predictor,
        cut_length: f64,
    ) -> Change {
        let own = problem.nuisances(&self.unknowns, 0);
        let keys = predictor.nuisances().iter().map(|nuisance| nuisance.key);
        let mut change = Change { nuisances: keys.zip(own).collect(), ..Change::default() };
        for active in self.active(predictor, problem.unknowns()) {
            let key = predictor.effects()[active.effect].key;
            if key == "flank_wear" {
                change.wear_land = Some(active.values[0] * cut_length);
            } else {
                change.effects.push((key, active.values));
            }
        }
        change
    }
}

/// The effects with their parameters at the coordinates `t`.
pub(crate) fn active(predictor: &dyn Predictor, effects: &[usize], t: &[f64]) -> Vec<Active> {
    let mut left = t;
    effects
        .iter()
        .map(|&effect| {
            let parameters = &predictor.effects()[effect].parameters;
            let (own, rest) = left.split_at(parameters.len());
            left = rest;
            let values = parameters.iter().zip(own).map(|(p, &t)| p.prior.value(t)).collect();
            Active { effect, values }
        })
        .collect()
}

/// The derivative of the prediction by the unknowns at `found`, of all rows of another problem with the same unknowns.
pub(crate) fn slopes(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    found: &Fit,
) -> DMatrix<f64> {
    let system =
        System { problem, predictor, effects: &found.effects, measured: problem.measured() };
    system.jacobian(&found.unknowns, &system.predict(&found.unknowns))
}

/// Minimises the target
///
/// ```text
/// Phi(u) = (y - f(u))' Sigma^-1 (y - f(u)) + u'u
/// ```
///
/// over nuisances and parameters u, all standard normal before the data, by damped Gauss-Newton steps (Levenberg,
/// Quart. Appl. Math. 2 (1944) 164-168), and approximates the evidence by Laplace's method:
///
/// ```text
/// log Z = -Phi / 2 - log |2 pi Sigma| / 2 - log |J' Sigma^-1 J + I| / 2
/// ```
///
/// which is exact where f is linear. What the model says of effects may be wrong by one of the shares
/// [`Predictor::change_errors`], each channel by its own: Sigma then has E A E' more, E taken at the fit, and Z is the mean over the
/// shares. `start` holds the coordinates of the parameters of `effects` at the start. `None` if the model has no answer there.
///
/// What the model does not know of an effect grows with its strength: where it does, the covariance is that at the first minimum,
/// and the fit goes on from there.
#[must_use]
pub fn fit(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    effects: &[usize],
    start: &DVector<f64>,
) -> Option<Fit> {
    let first = descend(problem, predictor, effects, start)?;
    let active = first.active(predictor, problem.unknowns());
    match problem.with_effects_uncertain(predictor, &active) {
        Some(uncertain) => descend(&uncertain, predictor, effects, &first.unknowns),
        None => Some(first),
    }
}

fn descend(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    effects: &[usize],
    start: &DVector<f64>,
) -> Option<Fit> {
    let system = System { problem, predictor, effects, measured: problem.measured() };
    let errors = predictor.change_errors();
    let mut point = system.descend(&problem.noise, system.point(start)?)?;
    if effects.is_empty() || errors.iter().all(|error| *error == 0.0) {
        return system.end(point, &problem.noise, None, None);
    }
    for _ in 0..ERROR_ROUNDS {
        let columns = system.error(&point);
        let (best, _) = system.loose(&point, &columns).most_probable(errors);
        let own = problem.noise.whiten(change_error::scaled(columns, &best));
        let law = problem.noise.tilted(&Eigenpairs::of(&own, NEGLIGIBLE));
        point = system.descend(&law, point)?;
    }
    let columns = system.error(&point);
    let (best, evidence) = system.loose(&point, &columns).most_probable(errors);
    let own = change_error::scaled(columns, &best);
    let law = problem.noise.tilted(&Eigenpairs::of(&problem.noise.whiten(own.clone()), NEGLIGIBLE));
    let evidence = evidence - 0.5 * problem.noise.log_determinant();
    system.end(point, &law, Some(Factor::of_all(own)), Some(evidence))
}

/// Where a descent has come to.
struct Point {
    unknowns: DVector<f64>,
    prediction: DVector<f64>,
    jacobian: DMatrix<f64>,
    /// Of the law of the last descent.
    target: f64,
}

struct System<'a> {
    problem: &'a RegressionProblem,
    predictor: &'a dyn Predictor,
    effects: &'a [usize],
    measured: DVector<f64>,
}

impl System<'_> {
    fn predict(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let nuisances = self.problem.unknowns();
        let active = active(self.predictor, self.effects, &unknowns.as_slice()[nuisances..]);
        let own = unknowns.rows(self.problem.model_unknowns(), self.problem.instrument.ncols());
        self.problem.predict(self.predictor, unknowns, &active) + &self.problem.instrument * own
    }

    fn target(
        &self,
        law: &GaussianLaw,
        prediction: &DVector<f64>,
        u: &DVector<f64>,
    ) -> Option<f64> {
        let white = law.whiten_vector(&self.measured - prediction);
        let target = white.norm_squared() + u.norm_squared();
        target.is_finite().then_some(target)
    }

    fn point(&self, unknowns: &DVector<f64>) -> Option<Point> {
        let prediction = self.predict(unknowns);
        let target = self.target(&self.problem.noise, &prediction, unknowns)?;
        let jacobian = self.jacobian(unknowns, &prediction);
        Some(Point { unknowns: unknowns.clone(), prediction, jacobian, target })
    }

    /// Damped Gauss-Newton steps. The derivative is kept over small steps and taken anew after others, after a step that failed and
    /// before the fit may end: it ends only where a full step with the derivative of that very place promises no more than
    /// [`CONVERGED`], or where no step lowers the target.
    fn descend(&self, law: &GaussianLaw, start: Point) -> Option<Point> {
        let Point { mut unknowns, mut prediction, mut jacobian, .. } = start;
        let mut target = self.target(law, &prediction, &unknowns)?;
        let mut damping = DAMPING;
        let mut is_fresh = true;
        for _ in 0..MOST_STEPS {
            let white = law.whiten(jacobian.clone());
            let residual = law.whiten_vector(&self.measured - &prediction);
            let slope = white.tr_mul(&residual) - &unknowns;
            let normal = white.tr_mul(&white) + DMatrix::identity(unknowns.len(), unknowns.len());
            let promised = slope.dot(&normal.clone().cholesky()?.solve(&slope));
            let mut moved = None;
            for _ in 0..if promised < CONVERGED { 0 } else { MOST_TRIES } {
                let mut damped = normal.clone();
                for k in 0..unknowns.len() {
                    damped[(k, k)] *= 1.0 + damping;
                }
                let next = &unknowns + damped.cholesky()?.solve(&slope);
                let there = self.predict(&next);
                if let Some(lower) = self.target(law, &there, &next).filter(|t| *t < target) {
                    moved = Some((&next - &unknowns).norm());
                    (unknowns, prediction, target) = (next, there, lower);
                    damping = (damping * 0.1).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            match moved {
                Some(length) if length <= SMALL => is_fresh = false,
                None if is_fresh => break,
                _ => {
                    jacobian = self.jacobian(&unknowns, &prediction);
                    is_fresh = true;
                    if moved.is_none() {
                        damping = DAMPING;
                    }
                }
            }
        }
        if !is_fresh {
            jacobian = self.jacobian(&unknowns, &prediction);
        }
        Some(Point { unknowns, prediction, jacobian, target })
    }

    /// The columns of the error in what the effects change, of all rows.
    fn error(&self, point: &Point) -> DMatrix<f64> {
        let problem = self.problem;
        let own = point.unknowns.rows(problem.model_unknowns(), problem.instrument.ncols());
        let plain = problem.predict(self.predictor, &point.unknowns, &[]);
        let change = &point.prediction - &problem.instrument * own - plain;
        change_error::everywhere(problem, &change, None)
    }

    fn loose(&self, point: &Point, columns: &DMatrix<f64>) -> Loose {
        let noise = &self.problem.noise;
        let deviation = &self.measured - &point.prediction + &point.jacobian * &point.unknowns;
        let slopes = noise.whiten(point.jacobian.clone());
        let channels = self.problem.channels().len();
        let columns = noise.whiten(columns.clone());
        Loose::new(&columns, channels, &slopes, &noise.whiten_vector(deviation))
    }

    fn end(
        &self,
        point: Point,
        law: &GaussianLaw,
        error: Option<Factor>,
        log_evidence: Option<f64>,
    ) -> Option<Fit> {
        let Point { unknowns, prediction, jacobian, target } = point;
        let white = law.whiten(jacobian.clone());
        let normal = white.tr_mul(&white) + DMatrix::identity(unknowns.len(), unknowns.len());
        let laplace = -0.5 * (target + law.log_determinant() + log_determinant(normal.clone())?);
        // Where the model has no answer without the effects, the error of what they change is not known, and no evidence is.
        let log_evidence = log_evidence.unwrap_or(laplace);
        if !log_evidence.is_finite() {
            return None;
        }
        Some(Fit {
            effects: self.effects.to_vec(),
            covariance: normal.cholesky()?.inverse(),
            residual: &self.measured - prediction,
            unknowns,
            jacobian,
            error,
            log_evidence,
        })
    }

    fn jacobian(&self, unknowns: &DVector<f64>, prediction: &DVector<f64>) -> DMatrix<f64> {
        let problem = self.problem;
        let (model, nuisances) = (problem.model_unknowns(), problem.unknowns());
        let mut jacobian = DMatrix::zeros(problem.rows.len(), unknowns.len());
        for k in (0..model).chain(nuisances..unknowns.len()) {
            jacobian.set_column(k, &self.derivative(unknowns, prediction, k));
        }
        jacobian.columns_mut(model, nuisances - model).copy_from(&problem.instrument);
        jacobian
    }

    /// Where the model has no answer ahead it is asked behind.
    fn derivative(
        &self,
        unknowns: &DVector<f64>,
        prediction: &DVector<f64>,
        k: usize,
    ) -> DVector<f64> {
        for step in [STEP, -STEP] {
            let mut moved = unknowns.clone();
            moved[k] += step;
            let slope = (self.predict(&moved) - prediction) / step;
            if slope.iter().all(|value| value.is_finite()) {
                return slope;
            }
        }
        DVector::zeros(prediction.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Compared;
    use crate::tests::twin::{Altered, INSTRUMENTS, Twin};
    use sphcut_physics::CuttingCondition;

    /// One explanation without an evidence must not take the probabilities of all others with it: of a twin that without an effect
    /// has no answer at all where the nuisances have moved.
    #[test]
    fn a_fit_without_evidence_is_none() {
        let answer = |twin: &Twin, at: &CuttingCondition, nuisances: &[f64], active: &[Active]| {
            let logs = twin.log_observables(at, nuisances, active);
            let has_no_answer = active.is_empty() && nuisances[0] > 0.03;
            logs.into_iter().map(|log| if has_no_answer { f64::NAN } else { log }).collect()
        };
        let mut twin = Twin::new();
        twin.errors = vec![0.2];
        let model = Altered { twin, answer };
        let mut without = 0;
        for seed in 0..12 {
            let hidden = Active { effect: 0, values: vec![0.2] };
            let recordings = model.twin.recorded(&[hidden], 0.02, seed);
            let problem = RegressionProblem::new(&recordings, &model, &INSTRUMENTS).unwrap();
            let mut start = DVector::zeros(problem.unknowns() + 1);
            start[0] = 1.0;
            start[problem.unknowns()] = 2.0;
            match fit(&problem, &model, &[0], &start) {
                None => without += 1,
                Some(found) => assert!(found.log_evidence.is_finite()),
            }
            let Ok(all) = Compared::new(problem, &model) else { continue };
            assert!(all.fits.iter().all(|fit| fit.log_evidence.is_finite()));
        }
        assert!((1..12).contains(&without), "{without} of 12");
    }
}
