//! The most probable nuisances and parameters, and the evidence there.

use crate::gaussian::log_determinant;
use crate::predictor::{Active, Predictor};
use crate::problem::Problem;
use nalgebra::{DMatrix, DVector};

/// Step of the unknowns, in standard deviations of their priors, over which the model is differenced.
const STEP: f64 = 0.02;
/// Steps after which a fit ends.
const MOST_STEPS: usize = 30;
/// Decrease of the target below which a fit has ended; it is twice a logarithm of probability.
const ENOUGH: f64 = 1e-4;

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
    /// log of the evidence by Laplace's method.
    pub log_evidence: f64,
}

impl Fit {
    /// The effects with the SI values of their parameters.
    #[must_use]
    pub fn active(&self, predictor: &dyn Predictor, nuisances: usize) -> Vec<Active> {
        active(predictor, &self.effects, &self.unknowns.as_slice()[nuisances..])
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
/// which is exact where f is linear. `start` holds the coordinates of the parameters of `effects` at the start. `None`
/// if the model has no answer there.
///
/// What the model does not know of an effect grows with its strength: where it does, the covariance is that at the first minimum,
/// and the fit goes on from there.
#[must_use]
pub fn fit(
    problem: &Problem,
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
    problem: &Problem,
    predictor: &dyn Predictor,
    effects: &[usize],
    start: &DVector<f64>,
) -> Option<Fit> {
    let system = System { problem, predictor, effects, measured: problem.measured() };
    let mut unknowns = start.clone();
    let mut prediction = system.predict(&unknowns);
    let mut target = system.target(&prediction, &unknowns)?;
    let mut damping = 1e-3;
    let mut jacobian = system.jacobian(&unknowns, &prediction);
    for _ in 0..MOST_STEPS {
        let white = problem.noise.whiten(jacobian.clone());
        let residual = problem.noise.whiten_vector(&system.measured - &prediction);
        let slope = white.tr_mul(&residual) - &unknowns;
        let normal = white.tr_mul(&white) + DMatrix::identity(unknowns.len(), unknowns.len());
        let (mut gain, mut moved) = (0.0, false);
        for _ in 0..12 {
            let mut damped = normal.clone();
            for k in 0..unknowns.len() {
                damped[(k, k)] *= 1.0 + damping;
            }
            let next = &unknowns + damped.cholesky()?.solve(&slope);
            let there = system.predict(&next);
            if let Some(lower) = system.target(&there, &next).filter(|t| *t <= target) {
                (gain, moved) = (target - lower, true);
                (unknowns, prediction, target) = (next, there, lower);
                damping = (damping * 0.1).max(1e-9);
                break;
            }
            damping *= 10.0;
        }
        if moved {
            jacobian = system.jacobian(&unknowns, &prediction);
        }
        if gain < ENOUGH {
            break;
        }
    }
    let white = problem.noise.whiten(jacobian.clone());
    let normal = white.tr_mul(&white) + DMatrix::identity(unknowns.len(), unknowns.len());
    let log_evidence =
        -0.5 * (target + problem.noise.log_determinant() + log_determinant(normal.clone())?);
    Some(Fit {
        effects: effects.to_vec(),
        covariance: normal.cholesky()?.inverse(),
        residual: &system.measured - prediction,
        unknowns,
        jacobian,
        log_evidence,
    })
}

struct System<'a> {
    problem: &'a Problem,
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

    fn target(&self, prediction: &DVector<f64>, unknowns: &DVector<f64>) -> Option<f64> {
        let white = self.problem.noise.whiten_vector(&self.measured - prediction);
        let target = white.norm_squared() + unknowns.norm_squared();
        target.is_finite().then_some(target)
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
