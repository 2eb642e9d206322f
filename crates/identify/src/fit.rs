//! The joint fit: all parameters from all curves at once, robust, with intervals.

use crate::law::stress_at;
use crate::{CurvePoint, LawChoice, References};
use nalgebra::{DMatrix, DVector};
use sphcut_physics::flow_stress::{FlowState, FlowStressModel};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// One parameter of a fit. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// As in material files.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
    /// Half width of its 95 % interval; infinite where the curves do not determine it.
    pub half_width: f64,
    /// Whether it sits at a limit of its range: then the interval means nothing.
    pub at_limit: bool,
}

/// A law fitted to all points.
#[derive(Debug)]
pub struct LawFit {
    /// Which law.
    pub law: LawChoice,
    /// What was stated.
    pub references: References,
    /// The parameters.
    pub parameters: Vec<Fitted>,
    /// Their correlations.
    pub correlation: Vec<Vec<f64>>,
    /// Root mean square of ln(model / measured), every curve with the same weight.
    pub deviation: f64,
    /// ln(model / measured) of each point.
    pub residuals: Vec<f64>,
    /// The law itself.
    pub model: Box<dyn FlowStressModel>,
}

impl LawFit {
    /// The value of a parameter.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        self.parameters.iter().find(|p| p.key == key).map(|p| p.value)
    }

    /// The flow stress in Pa at a plastic strain, a rate in 1/s and a temperature in K.
    #[must_use]
    pub fn stress(&self, plastic_strain: f64, plastic_strain_rate: f64, temperature: f64) -> f64 {
        self.model.flow_stress(&FlowState { plastic_strain, plastic_strain_rate, temperature })
    }
}

/// Residuals beyond so many scales count less (Huber, Ann. Math. Stat. 35 (1964) 73: 95 % efficiency).
const HUBER: f64 = 1.345;
/// Rounds of new weights.
const ROUNDS: usize = 8;
/// Steps of each round.
const STEPS: usize = 40;
/// Relative gain of a step that is not worth another.
const GAIN: f64 = 1e-9;
/// Relative change of all parameters that is none.
const MOVED: f64 = 1e-5;
/// Softer than any metal: a law that predicts no strength at all still has a logarithm.
const LEAST_STRESS: f64 = 1e4;

/// The points and what each counts: every curve the same, however densely it was sampled.
struct Problem<'a> {
    law: LawChoice,
    references: References,
    points: &'a [CurvePoint],
    weights: Vec<f64>,
    limits: Vec<(f64, f64)>,
}

impl Problem<'_> {
    /// r = ln(model / measured): errors of a test are shares of the stress.
    fn residuals(&self, x: &[f64]) -> Option<DVector<f64>> {
        let law = self.law.build(x, self.references)?;
        let of = |p: &CurvePoint| (stress_at(law.as_ref(), p).max(LEAST_STRESS) / p.stress).ln();
        Some(DVector::from_iterator(self.points.len(), self.points.iter().map(of)))
    }

    fn inside(&self, x: &DVector<f64>) -> Vec<f64> {
        x.iter().zip(&self.limits).map(|(v, (low, high))| v.clamp(*low, *high)).collect()
    }

    /// Central differences, one-sided at a limit.
    fn jacobian(&self, x: &[f64], scales: &[f64]) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(self.points.len(), x.len());
        for k in 0..x.len() {
            let step = 1e-5 * x[k].abs().max(1e-2 * scales[k]);
            let moved = |sign: f64| {
                let mut y = x.to_vec();
                y[k] = (y[k] + sign * step).clamp(self.limits[k].0, self.limits[k].1);
                y
            };
            let (low, high) = (moved(-1.0), moved(1.0));
            let width = high[k] - low[k];
            let slope = (self.residuals(&high)? - self.residuals(&low)?) / width;
            jacobian.set_column(k, &slope);
        }
        Some(jacobian)
    }

    fn cost(&self, residuals: &DVector<f64>, robust: &[f64]) -> f64 {
        residuals.iter().zip(&self.weights).zip(robust).map(|((r, w), h)| w * h * r * r).sum()
    }
}

/// Fits the free parameters of `law` to `points` from `start`.
///
/// Minimised is the sum over curves of the mean square of ln(model / measured), with Huber's weights from
/// the scale of the residuals (median of absolute values over 0.6745), by Levenberg and Marquardt (J. SIAM
/// 11 (1963) 431) within limits. Points of one curve share the error of their test, so the covariance is
/// that of clusters (jackknife, see below) with Student's t of curves less parameters.
#[must_use]
pub fn fit(
    law: LawChoice,
    references: References,
    points: &[CurvePoint],
    start: &[f64],
) -> Option<LawFit> {
    fit_within(ROUNDS, law, references, points, start)
}

/// The same with at most so many rounds of weights: from a good start two are enough.
pub(crate) fn fit_within(
    rounds: usize,
    law: LawChoice,
    references: References,
    points: &[CurvePoint],
    start: &[f64],
) -> Option<LawFit> {
    let free = law.free();
    let limits: Vec<(f64, f64)> = free.iter().map(|f| (f.1, f.2)).collect();
    let problem = Problem { law, references, points, weights: weights(points), limits };
    let mut x = problem.inside(&DVector::from_column_slice(start));
    let scales: Vec<f64> = x.iter().map(|v| v.abs().max(0.05)).collect();
    let mut robust = vec![1.0; points.len()];
    for _ in 0..rounds {
        let before = x.clone();
        x = minimise(&problem, x, &scales, &robust)?;
        let residuals = problem.residuals(&x)?;
        let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let scale = (sizes[sizes.len() / 2] / 0.6745).max(1e-9);
        robust = residuals.iter().map(|r| (HUBER * scale / r.abs().max(1e-300)).min(1.0)).collect();
        let moved = x.iter().zip(&before).zip(&scales).map(|((a, b), s)| ((a - b) / s).abs());
        if moved.fold(0.0, f64::max) < MOVED {
            break;
        }
    }
    finished(&problem, x, &scales, &robust)
}

/// One over the points of the curve, so that they add up to one for each curve.
pub(crate) fn weights(points: &[CurvePoint]) -> Vec<f64> {
    let most = points.iter().map(|p| p.curve + 1).max().unwrap_or(0);
    let mut counts = vec![0.0; most];
    points.iter().for_each(|p| counts[p.curve] += 1.0);
    points.iter().map(|p| 1.0 / counts[p.curve]).collect()
}

fn minimise(
    problem: &Problem<'_>,
    start: Vec<f64>,
    scales: &[f64],
    robust: &[f64],
) -> Option<Vec<f64>> {
    let mut x = start;
    let mut residuals = problem.residuals(&x)?;
    let mut cost = problem.cost(&residuals, robust);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let jacobian = problem.jacobian(&x, scales)?;
        let weighted = weighted(&jacobian, problem, robust);
        let gradient = weighted.transpose() * &residuals;
        let normal = weighted.transpose() * &jacobian;
        let mut improved = false;
        while damping < 1e12 {
            let mut damped = normal.clone();
            for k in 0..x.len() {
                damped[(k, k)] += damping * normal[(k, k)].max(1e-12 / (scales[k] * scales[k]));
            }
            let step = damped.cholesky().map(|factor| factor.solve(&gradient));
            if let Some(step) = step {
                let trial = problem.inside(&(DVector::from_column_slice(&x) - step));
                let found = problem.residuals(&trial)?;
                let lower = problem.cost(&found, robust);
                if lower < cost {
                    improved = (cost - lower) > GAIN * cost;
                    (x, residuals, cost) = (trial, found, lower);
                    damping = (damping * 0.2).max(1e-12);
                    break;
                }
            }
            damping *= 4.0;
        }
        if !improved {
            break;
        }
        damping = damping.min(1e6);
    }
    Some(x)
}

/// The rows of the Jacobian times their weights.
fn weighted(jacobian: &DMatrix<f64>, problem: &Problem<'_>, robust: &[f64]) -> DMatrix<f64> {
    let mut rows = jacobian.clone();
    for (k, mut row) in rows.row_iter_mut().enumerate() {
        row *= problem.weights[k] * robust[k];
    }
    rows
}

fn finished(problem: &Problem<'_>, x: Vec<f64>, scales: &[f64], robust: &[f64]) -> Option<LawFit> {
    let residuals = problem.residuals(&x)?;
    let jacobian = problem.jacobian(&x, scales)?;
    let rows = weighted(&jacobian, problem, robust);
    let curves = problem.weights.iter().sum::<f64>().round();
    let freedom = curves - x.len() as f64;
    let covariance = (freedom >= 1.0).then(|| clusters(problem, &jacobian, &rows, &residuals));
    let covariance = covariance.flatten();
    let quantile = t_quantile(freedom);
    let at_limit = |k: usize| {
        let (low, high) = problem.limits[k];
        let near = 1e-6 * (high - low).min(scales[k]);
        x[k] - low <= near || high - x[k] <= near
    };
    let deviation = |k: usize| covariance.as_ref().map_or(f64::INFINITY, |c| c[(k, k)].sqrt());
    let parameters = problem.law.free().into_iter().enumerate().map(|(k, free)| Fitted {
        key: free.0,
        value: x[k],
        half_width: quantile * deviation(k),
        at_limit: at_limit(k),
    });
    let correlation = |i: usize, j: usize| {
        covariance.as_ref().map_or(f64::NAN, |c| c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt())
    };
    let ones = vec![1.0; residuals.len()];
    Some(LawFit {
        law: problem.law,
        references: problem.references,
        parameters: parameters.collect(),
        correlation: (0..x.len())
            .map(|i| (0..x.len()).map(|j| correlation(i, j)).collect())
            .collect(),
        deviation: (problem.cost(&residuals, &ones) / curves).sqrt(),
        residuals: residuals.iter().copied().collect(),
        model: problem.law.build(&x, problem.references)?,
    })
}

/// B M B (G - 1) / G: B the inverse of J'WJ, M the sum over curves of t t' with t = (I - J_g'WJ_g B)^-1 s and
/// s = J_g'W r. The factor before s undoes that a curve pulls the fit towards itself; without it the intervals
/// of few curves are too narrow (jackknife over clusters, CR3: Bell and McCaffrey, Survey Methodology 28
/// (2002) 169). It does not exist where one curve alone determines a parameter: then there is no interval.
fn clusters(
    problem: &Problem<'_>,
    jacobian: &DMatrix<f64>,
    rows: &DMatrix<f64>,
    residuals: &DVector<f64>,
) -> Option<DMatrix<f64>> {
    let count = jacobian.ncols();
    // A parameter without influence makes the matrix singular: the pseudo-inverse would hide that.
    let bread = (rows.transpose() * jacobian).try_inverse()?;
    let most = problem.points.iter().map(|p| p.curve + 1).max()?;
    let mut scores = vec![DVector::zeros(count); most];
    let mut shares = vec![DMatrix::zeros(count, count); most];
    for (k, point) in problem.points.iter().enumerate() {
        scores[point.curve] += rows.row(k).transpose() * residuals[k];
        shares[point.curve] += rows.row(k).transpose() * jacobian.row(k);
    }
    let mut meat = DMatrix::zeros(count, count);
    for (score, share) in scores.iter().zip(&shares) {
        let pull = DMatrix::identity(count, count) - share * &bread;
        let freed = pull.try_inverse()? * score;
        meat += &freed * freed.transpose();
    }
    let curves = problem.weights.iter().sum::<f64>();
    let covariance = &bread * meat * &bread * ((curves - 1.0) / curves);
    covariance.iter().all(|v| v.is_finite()).then_some(covariance)
}

fn t_quantile(freedom: f64) -> f64 {
    if freedom < 1.0 {
        return f64::INFINITY;
    }
    StudentsT::new(0.0, 1.0, freedom)
        .expect("scale and degrees of freedom are positive")
        .inverse_cdf(0.975)
}
