//! What each effect would change, tabulated at the null fit; with it everything else is linear algebra.

use crate::error::DiagnoseError;
use crate::inference::change_error::{self, Loose};
use crate::inference::fit::{Fit, NEGLIGIBLE, active};
use crate::inference::gaussian::{Whitener, log_determinant};
use crate::inference::law::{Eigenpairs, Factor, GaussianLaw, principal};
use crate::inference::places::{AXES, scaled_places};
use crate::inference::problem::RegressionProblem;
use crate::model::nodes::{coordinates, filled, weights};
use crate::model::predictor::Predictor;
use nalgebra::{DMatrix, DVector};
use sphcut_greybox::Random;

/// Draws of the prior of which the expected change is the median.
const DRAWS: usize = 33;
/// Amplitudes of the smooth discrepancy of "none of these", as shares of the value.
pub(crate) const AMPLITUDES: [f64; 6] = [0.0, 0.01, 0.02, 0.04, 0.08, 0.16];
/// Least share of "none of these" that is left when what stands for nothing missing is taken off.
const LEAST: f64 = 1e-3;
/// Share of the largest eigenvalue below which a direction of the discrepancy does not count.
const COARSE: f64 = 1e-4;
/// Length over which it changes, in shares of the range of log v_c, log h, cut length, rake and edge radius.
const LENGTH: f64 = 0.5;
/// Share of the largest eigenvalue below which a direction of a smooth process does not count.
pub(crate) const SMOOTH: f64 = 1e-8;
/// Rounds in which the error of the change and the parameters follow each other.
const ERROR_ROUNDS: usize = 1;
/// Steps after which the search for the parameters ends.
const MOST_STEPS: usize = 40;

/// The change of each diagnosed row by an effect, on a grid of its coordinates.
#[derive(Debug, Clone)]
struct Table {
    parameters: usize,
    /// One column per node, the first parameter changing fastest.
    nodes: DMatrix<f64>,
    /// The same, whitened.
    white: DMatrix<f64>,
}

/// A linearised problem: under "nothing missing" the deviation d = r + G u of the data from the model at the means of
/// all nuisances is normal around 0 with the covariance V = Sigma + G G'. An effect with the parameters t moves its mean by
/// a tabulated change, and the evidence of a hypothesis needs its parameters alone:
///
/// ```text
/// log Z = -|e - d(t)|^2 / 2 - t't / 2 - log |2 pi V| / 2 - log |D'D + I| / 2,    D = dd/dt
/// ```
///
/// with all vectors whitened by V. That is [`fit`](crate::fit())'s evidence for a model linear in its nuisances, whose
/// nuisances do not change what an effect does, and whose effects add up. Effects act on the diagnosed rows alone: V is that of
/// these rows given the others, and what the others say of nothing missing is one number more in each whitened vector.
#[derive(Debug, Clone)]
pub struct Templates {
    problem: RegressionProblem,
    errors: Vec<f64>,
    pub(crate) power: f64,
    tables: Vec<Table>,
    diagnosed: Vec<usize>,
    given: Option<Given>,
    whitener: Whitener,
    log_determinant: f64,
    /// Derivative of the prediction by the nuisances.
    gradient: DMatrix<f64>,
    discrepancy: Vec<DMatrix<f64>>,
}

/// Rows on which no effect acts.
#[derive(Debug, Clone)]
struct Given {
    rows: Vec<usize>,
    law: GaussianLaw,
    /// What all rows have in common, as columns.
    common: DMatrix<f64>,
    /// The part of it in these rows, whitened.
    white: DMatrix<f64>,
}

impl Given {
    fn new(
        problem: &RegressionProblem,
        rows: Vec<usize>,
        gradient: &DMatrix<f64>,
    ) -> Result<Self, DiagnoseError> {
        let mut columns: Vec<DVector<f64>> =
            gradient.column_iter().map(|column| column.into_owned()).collect();
        for factor in &problem.covariance.factors {
            for column in factor.columns.column_iter() {
                let mut all = DVector::zeros(problem.rows.len());
                factor.rows.iter().zip(column.iter()).for_each(|(&row, x)| all[row] = *x);
                columns.push(all);
            }
        }
        let common = DMatrix::from_columns(&columns);
        let mut covariance = problem.covariance.clone();
        covariance.factors.push(Factor::of_all(gradient.clone()));
        let law = GaussianLaw::new(&covariance.select(&rows))?;
        let white = law.whiten(common.select_rows(&rows));
        Ok(Self { rows, law, common, white })
    }
}

/// Where the parameters of some effects explain the data best.
#[derive(Debug, Clone)]
pub(crate) struct EvidencePeak {
    pub coordinates: Vec<f64>,
    pub log_evidence: f64,
}

impl Templates {
    /// Asks the model what every effect changes at the nuisances of the fit in which nothing is missing.
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub fn new(
        problem: &RegressionProblem,
        predictor: &dyn Predictor,
        null: &Fit,
    ) -> Result<Self, DiagnoseError> {
        let gradient = null.jacobian.clone();
        let (diagnosed, others): (Vec<usize>, Vec<usize>) =
            (0..problem.rows.len()).partition(|&row| problem.is_diagnosed(row));
        let mut own = problem.covariance.clone();
        own.factors.push(Factor::of_all(gradient.clone()));
        let mut covariance = own.select(&diagnosed).dense();
        let given = (!others.is_empty()).then(|| Given::new(problem, others, &gradient));
        let given = given.transpose()?;
        let mut log_determinant = 0.0;
        if let Some(given) = &given {
            // V_dd - V_do V_oo^-1 V_od with V_do = B_d B_o'.
            let common = given.common.select_rows(&diagnosed);
            covariance -= &common * given.white.tr_mul(&given.white) * common.transpose();
            log_determinant += given.law.log_determinant();
        }
        let whitener = Whitener::new(covariance)?;
        log_determinant += whitener.log_determinant();
        let base = problem.predict(predictor, &null.unknowns, &[]);
        let mut found = Self {
            problem: problem.clone(),
            errors: predictor.change_errors().to_vec(),
            power: predictor.likelihood_power(),
            tables: Vec::new(),
            diagnosed,
            given,
            whitener,
            log_determinant,
            gradient,
            discrepancy: Vec::new(),
        };
        for effect in 0..predictor.effects().len() {
            let parameters = predictor.effects()[effect].parameters.len();
            let columns: Vec<DVector<f64>> = coordinates(parameters)
                .iter()
                .map(|t| {
                    let active = active(predictor, &[effect], t);
                    let change = problem.predict(predictor, &null.unknowns, &active) - &base;
                    change.select_rows(&found.diagnosed)
                })
                .collect();
            let nodes = filled(parameters, columns);
            let white = found.whiten_own(nodes.clone());
            found.tables.push(Table { parameters, nodes, white });
        }
        found.discrepancy = found.whitened_discrepancy();
        Ok(found)
    }

    /// Of diagnosed rows, with a last number that nothing in them changes.
    fn whiten_own(&self, columns: DMatrix<f64>) -> DMatrix<f64> {
        let count = columns.nrows();
        self.whitener.whiten(columns).insert_row(count, 0.0)
    }

    /// A vector over all rows, 0 where no effect acts.
    pub(crate) fn whiten(&self, vector: &DVector<f64>) -> DVector<f64> {
        let own = DMatrix::from_columns(&[vector.select_rows(&self.diagnosed)]);
        self.whiten_own(own).column(0).into_owned()
    }

    /// The whitened deviation e of a null fit of data with the design of these templates.
    #[must_use]
    pub fn signal(&self, null: &Fit) -> DVector<f64> {
        let nuisances = null.unknowns.rows(0, self.gradient.ncols());
        let deviation = &null.residual + &self.gradient * nuisances;
        let Some(given) = &self.given else { return self.whiten(&deviation) };
        let white = given.law.whiten_vector(deviation.select_rows(&given.rows));
        let expected = &given.common * given.white.tr_mul(&white);
        let mut signal = self.whiten(&(deviation - expected));
        let last = signal.len() - 1;
        signal[last] = white.norm();
        signal
    }

    /// Number of effects.
    #[must_use]
    pub fn effects(&self) -> usize {
        self.tables.len()
    }

    /// Whether the model could say what an effect does at all conditions.
    #[must_use]
    pub fn is_known(&self, effect: usize) -> bool {
        self.tables[effect].white.iter().all(|value| value.is_finite())
    }

    /// By how much chi^2 falls on average when an effect of typical strength is missing and put in: the median of
    /// d(t)' V^-1 d(t) over its prior.
    #[must_use]
    pub fn expected_gain(&self, effect: usize) -> f64 {
        let mut random = Random::new(17, &[effect as u64]);
        let mut gains: Vec<f64> = (0..DRAWS)
            .map(|_| {
                let t: Vec<f64> =
                    (0..self.tables[effect].parameters).map(|_| random.normal()).collect();
                self.change(&[effect], &t).norm_squared()
            })
            .collect();
        gains.sort_by(f64::total_cmp);
        gains[DRAWS / 2]
    }

    /// The whitened change by some effects at the coordinates of all their parameters.
    pub(crate) fn change(&self, effects: &[usize], t: &[f64]) -> DVector<f64> {
        self.sum(effects, t, |table| &table.white)
    }

    fn sum(
        &self,
        effects: &[usize],
        t: &[f64],
        of: impl Fn(&Table) -> &DMatrix<f64>,
    ) -> DVector<f64> {
        let mut left = t;
        let mut sum: Option<DVector<f64>> = None;
        for &effect in effects {
            let table = &self.tables[effect];
            let (own, rest) = left.split_at(table.parameters);
            left = rest;
            let part = of(table) * DVector::from_vec(weights(own));
            sum = Some(sum.map_or_else(|| part.clone(), |sum| sum + &part));
        }
        sum.unwrap_or_else(|| DVector::zeros(self.diagnosed.len()))
    }

    /// What the model may get wrong in that change, whitened.
    fn error(&self, effects: &[usize], t: &[f64]) -> DMatrix<f64> {
        let change = self.sum(effects, t, |table| &table.nodes);
        self.whiten_own(change_error::columns(&self.problem, &self.diagnosed, &change))
    }

    /// log Z of "nothing missing".
    pub(crate) fn log_evidence_of_nothing(&self, signal: &DVector<f64>) -> f64 {
        -0.5 * (signal.norm_squared() + self.log_determinant)
    }

    /// log Z of "none of these": in every channel a normal process of the conditions of its own, its amplitude one of
    /// [`AMPLITUDES`] with equal probabilities. The mean over the amplitudes of a channel is taken with the others at their
    /// most probable, as if channels were independent; that all are 0 is "nothing missing" and taken off.
    pub(crate) fn log_evidence_of_none(&self, signal: &DVector<f64>) -> f64 {
        let count = self.discrepancy.len();
        let loose = self.with_discrepancy(signal);
        let (_, all) = loose.most_probable(&AMPLITUDES);
        // Z = sum_k p_k Z_k with all amplitudes 0 among the k.
        let nothing = loose.log_evidence(&vec![0.0; count]);
        let share = (count as f64 * -(AMPLITUDES.len() as f64).ln()).exp();
        let rest = (1.0 - share * (nothing - all).exp()).max(LEAST);
        all + rest.ln() - (1.0 - share).ln() - 0.5 * self.log_determinant
    }

    fn with_discrepancy(&self, deviation: &DVector<f64>) -> Loose {
        let columns: Vec<&DMatrix<f64>> = self.discrepancy.iter().collect();
        let groups = columns.iter().enumerate().flat_map(|(c, own)| vec![c; own.ncols()]);
        Loose::grouped(&columns, groups.collect(), deviation)
    }

    /// How much of what is wrong with the null hypothesis `effects` explain as the model has them, without errors of their own:
    ///
    /// ```text
    /// share = (Phi_0 - Phi_1) / (Phi_0 - Phi_2),   Phi_0 = |e|^2,   Phi_1 = |e - d(t)|^2 + t't
    /// ```
    ///
    /// at the most probable t, where Phi_2 has in place of |e - d|^2 what is left of it when a smooth residual of every channel, that of
    /// an unmodelled effect, is fitted to e - d as well. An effect that is the cause leaves noise; one that stands in for another leaves a
    /// pattern. 0 if the effects explain nothing.
    pub(crate) fn explained(&self, signal: &DVector<f64>, effects: &[usize]) -> Option<f64> {
        let rigid = self.rigid(signal, effects)?;
        let left = signal - self.change(effects, &rigid.coordinates);
        let own: f64 = rigid.coordinates.iter().map(|t| t * t).sum();
        let loose = self.with_discrepancy(&left);
        let (amplitudes, _) = loose.most_probable(&AMPLITUDES);
        let (square, _) = loose.square_and_determinant(&amplitudes)?;
        let by_effects = (signal.norm_squared() - left.norm_squared() - own).max(0.0);
        let by_residual = left.norm_squared() - square;
        let all = by_effects + by_residual;
        Some(if all > 0.0 { by_effects / all } else { 0.0 })
    }

    /// The most probable parameters of `effects` and the evidence there; `None` where the model had no answer.
    pub(crate) fn peak(&self, signal: &DVector<f64>, effects: &[usize]) -> Option<EvidencePeak> {
        let rigid = self.rigid(signal, effects)?;
        if self.errors.iter().all(|error| *error == 0.0) {
            Some(rigid)
        } else {
            self.loosened(signal, effects, rigid)
        }
    }

    /// Without errors of the change.
    fn rigid(&self, signal: &DVector<f64>, effects: &[usize]) -> Option<EvidencePeak> {
        if !effects.iter().all(|&effect| self.is_known(effect)) {
            return None;
        }
        let starts = self.starts(signal, effects).into_iter();
        starts
            .filter_map(|start| self.climb(signal, effects, start, None))
            .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
    }

    /// With the error of the change, as in [`fit`](crate::fit()).
    fn loosened(
        &self,
        signal: &DVector<f64>,
        effects: &[usize],
        rigid: EvidencePeak,
    ) -> Option<EvidencePeak> {
        let most_probable = |t: &[f64], columns: &DMatrix<f64>| {
            let slopes = self.slopes(effects, &DVector::from_column_slice(t));
            let left = signal - self.change(effects, t);
            let deviation = left + &slopes * DVector::from_column_slice(t);
            let channels = self.problem.channels().len();
            Loose::new(columns, channels, &slopes, &deviation).most_probable(&self.errors)
        };
        let mut t = rigid.coordinates;
        for _ in 0..ERROR_ROUNDS {
            let columns = self.error(effects, &t);
            let (errors, _) = most_probable(&t, &columns);
            let spectrum = Eigenpairs::of(&change_error::scaled(columns, &errors), NEGLIGIBLE);
            t = self.climb(signal, effects, t, Some(&spectrum))?.coordinates;
        }
        let (_, log) = most_probable(&t, &self.error(effects, &t));
        let log_evidence = log - 0.5 * self.log_determinant;
        log_evidence.is_finite().then_some(EvidencePeak { coordinates: t, log_evidence })
    }

    /// The best node of each effect after the others, in both orders for a pair, and the middle of the prior.
    fn starts(&self, signal: &DVector<f64>, effects: &[usize]) -> Vec<Vec<f64>> {
        let total = effects.iter().map(|&effect| self.tables[effect].parameters).sum();
        let mut starts = vec![vec![0.0; total]];
        let orders: &[bool] = if effects.len() > 1 { &[false, true] } else { &[false] };
        for &backwards in orders {
            let mut found: Vec<Vec<f64>> = vec![Vec::new(); effects.len()];
            let mut left = signal.clone();
            let mut places: Vec<usize> = (0..effects.len()).collect();
            if backwards {
                places.reverse();
            }
            for place in places {
                let node = self.best_node(&left, effects[place]);
                left -= self.change(&effects[place..=place], &node);
                found[place] = node;
            }
            starts.push(found.concat());
        }
        starts
    }

    fn best_node(&self, signal: &DVector<f64>, effect: usize) -> Vec<f64> {
        let table = &self.tables[effect];
        let cost = |(k, t): &(usize, Vec<f64>)| {
            (signal - table.white.column(*k)).norm_squared() + t.iter().map(|t| t * t).sum::<f64>()
        };
        coordinates(table.parameters)
            .into_iter()
            .enumerate()
            .min_by(|a, b| cost(a).total_cmp(&cost(b)))
            .map_or_else(Vec::new, |(_, t)| t)
    }

    /// Damped Gauss-Newton steps as in [`fit`](crate::fit()).
    fn climb(
        &self,
        signal: &DVector<f64>,
        effects: &[usize],
        start: Vec<f64>,
        error: Option<&Eigenpairs>,
    ) -> Option<EvidencePeak> {
        let mut t = DVector::from_vec(start);
        let tilted = |columns: DMatrix<f64>| match error {
            Some(spectrum) => spectrum.whiten(&columns),
            None => columns,
        };
        let residual = |t: &DVector<f64>| {
            let left = signal - self.change(effects, t.as_slice());
            if error.is_none() {
                left
            } else {
                tilted(DMatrix::from_columns(&[left])).column(0).into_owned()
            }
        };
        let mut left = residual(&t);
        let mut target = left.norm_squared() + t.norm_squared();
        let mut damping = 1e-3;
        let mut slopes = tilted(self.slopes(effects, &t));
        for _ in 0..MOST_STEPS {
            let normal = slopes.tr_mul(&slopes) + DMatrix::identity(t.len(), t.len());
            let slope = slopes.tr_mul(&left) - &t;
            let mut damped = normal;
            for k in 0..t.len() {
                damped[(k, k)] *= 1.0 + damping;
            }
            let next = &t + damped.cholesky()?.solve(&slope);
            let there = residual(&next);
            let lower = there.norm_squared() + next.norm_squared();
            if lower <= target {
                let gain = target - lower;
                (t, left, target) = (next, there, lower);
                slopes = tilted(self.slopes(effects, &t));
                damping = (damping * 0.1).max(1e-9);
                if gain < 1e-6 {
                    break;
                }
            } else if damping > 1e8 {
                break;
            } else {
                damping *= 10.0;
            }
        }
        let normal = slopes.tr_mul(&slopes) + DMatrix::identity(t.len(), t.len());
        let log_evidence = -0.5 * (target + self.log_determinant + log_determinant(normal)?);
        log_evidence
            .is_finite()
            .then(|| EvidencePeak { coordinates: t.as_slice().to_vec(), log_evidence })
    }

    /// The discrepancy of each channel with amplitude 1 as columns, whitened.
    fn whitened_discrepancy(&self) -> Vec<DMatrix<f64>> {
        let problem = &self.problem;
        let places = scaled_places(problem);
        let mut found = Vec::new();
        for channel in problem.channels() {
            let mut parts: Vec<DVector<f64>> = Vec::new();
            let rows: Vec<usize> = (0..self.diagnosed.len())
                .filter(|&k| problem.rows[self.diagnosed[k]].channel == channel)
                .collect();
            let kernel = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
                let (a, b) = (places[self.diagnosed[rows[i]]], places[self.diagnosed[rows[j]]]);
                let square: f64 = (0..AXES).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
                (-0.5 * square / (LENGTH * LENGTH)).exp()
            });
            let (values, vectors) = principal(kernel, COARSE);
            for (k, value) in values.iter().enumerate() {
                let mut column = DVector::zeros(self.diagnosed.len());
                for (i, &row) in rows.iter().enumerate() {
                    column[row] = value.sqrt() * vectors[(i, k)];
                }
                parts.push(column);
            }
            found.push(self.whiten_own(DMatrix::from_columns(&parts)));
        }
        found
    }

    fn slopes(&self, effects: &[usize], t: &DVector<f64>) -> DMatrix<f64> {
        const STEP: f64 = 1e-4;
        let columns: Vec<DVector<f64>> = (0..t.len())
            .map(|k| {
                let at = |step: f64| {
                    let mut moved = t.clone();
                    moved[k] += step;
                    self.change(effects, moved.as_slice())
                };
                (at(STEP) - at(-STEP)) / (2.0 * STEP)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }
}
