//! What each effect would change, tabulated at the null fit; with it everything else is linear algebra.

use crate::error::DiagnoseError;
use crate::fit::{Fit, active};
use crate::gaussian::log_determinant;
use crate::law::{Factor, Law, principal};
use crate::predictor::Predictor;
use crate::problem::Problem;
use nalgebra::{DMatrix, DVector};
use sphcut_greybox::Random;

/// Nodes for an effect with one, two, and more parameters: their number and their distance in standard deviations.
const NODES: [(usize, f64); 3] = [(7, 0.8), (5, 1.0), (3, 1.5)];
/// Draws of the prior of which the expected change is the median.
const DRAWS: usize = 33;
/// Amplitudes of the smooth discrepancy of "none of these", as shares of the value.
pub(crate) const AMPLITUDES: [f64; 4] = [0.01, 0.02, 0.04, 0.08];
/// Length over which it changes, in shares of the range of log v_c, log h and cut length.
const LENGTH: f64 = 0.5;
/// Share of the largest eigenvalue below which a direction of a smooth process does not count.
pub(crate) const SMOOTH: f64 = 1e-8;
/// Steps after which the search for the parameters ends.
const MOST_STEPS: usize = 40;

/// The change of each row by an effect, on a grid of its coordinates; whitened.
#[derive(Debug, Clone)]
struct Table {
    parameters: usize,
    /// One column per node, the first parameter changing fastest.
    nodes: DMatrix<f64>,
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
/// nuisances do not change what an effect does, and whose effects add up.
#[derive(Debug, Clone)]
pub struct Templates {
    tables: Vec<Table>,
    pub(crate) whitener: Law,
    log_determinant: f64,
    /// Derivative of the prediction by the nuisances.
    gradient: DMatrix<f64>,
    discrepancy: Discrepancy,
}

/// The covariance of the discrepancy with amplitude 1, whitened: its eigenvalues and vectors.
#[derive(Debug, Clone)]
struct Discrepancy {
    values: Vec<f64>,
    vectors: DMatrix<f64>,
}

/// Where the parameters of some effects explain the data best.
#[derive(Debug, Clone)]
pub(crate) struct Peak {
    pub coordinates: Vec<f64>,
    pub log_evidence: f64,
}

impl Templates {
    /// Asks the model what every effect changes at the nuisances of the fit in which nothing is missing.
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub fn new(
        problem: &Problem,
        predictor: &dyn Predictor,
        null: &Fit,
    ) -> Result<Self, DiagnoseError> {
        let gradient = null.jacobian.clone();
        let whitener = problem.noise.with(&Factor::of_all(gradient.clone()))?;
        let base = problem.predict(predictor, &null.unknowns, &[]);
        let tables = (0..predictor.effects().len())
            .map(|effect| {
                let parameters = predictor.effects()[effect].parameters.len();
                let columns: Vec<DVector<f64>> = coordinates(parameters)
                    .iter()
                    .map(|t| {
                        let active = active(predictor, &[effect], t);
                        problem.predict(predictor, &null.unknowns, &active) - &base
                    })
                    .collect();
                Table { parameters, nodes: whitener.whiten(DMatrix::from_columns(&columns)) }
            })
            .collect();
        let discrepancy = whitened_discrepancy(problem, &whitener);
        let log_determinant = whitener.log_determinant();
        Ok(Self { tables, whitener, log_determinant, gradient, discrepancy })
    }

    /// The whitened deviation e of a null fit of data with the design of these templates.
    #[must_use]
    pub fn signal(&self, null: &Fit) -> DVector<f64> {
        let nuisances = null.unknowns.rows(0, self.gradient.ncols());
        self.whitener.whiten_vector(&null.residual + &self.gradient * nuisances)
    }

    /// Number of effects.
    #[must_use]
    pub fn effects(&self) -> usize {
        self.tables.len()
    }

    /// Whether the model could say what an effect does at all conditions.
    #[must_use]
    pub fn is_known(&self, effect: usize) -> bool {
        self.tables[effect].nodes.iter().all(|value| value.is_finite())
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
        let mut left = t;
        let mut sum = DVector::zeros(self.gradient.nrows());
        for &effect in effects {
            let table = &self.tables[effect];
            let (own, rest) = left.split_at(table.parameters);
            left = rest;
            sum += &table.nodes * DVector::from_vec(weights(own));
        }
        sum
    }

    /// log Z of "nothing missing".
    pub(crate) fn log_evidence_of_nothing(&self, signal: &DVector<f64>) -> f64 {
        -0.5 * (signal.norm_squared() + self.log_determinant)
    }

    /// log Z of "none of these": a normal process of the conditions, independent between channels, its amplitude one of
    /// [`AMPLITUDES`] with equal probabilities.
    pub(crate) fn log_evidence_of_none(&self, signal: &DVector<f64>) -> f64 {
        let turned = self.discrepancy.vectors.tr_mul(signal);
        let each = AMPLITUDES.map(|amplitude| {
            let mut sum = self.log_determinant + signal.norm_squared();
            for (part, value) in turned.iter().zip(&self.discrepancy.values) {
                let stretched = 1.0 + amplitude * amplitude * value;
                sum += stretched.ln() - part * part * (1.0 - 1.0 / stretched);
            }
            -0.5 * sum
        });
        let most = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = each.iter().map(|log| (log - most).exp()).sum();
        most + (total / AMPLITUDES.len() as f64).ln()
    }

    /// The most probable parameters of `effects` and the evidence there; `None` where the model had no answer.
    pub(crate) fn peak(&self, signal: &DVector<f64>, effects: &[usize]) -> Option<Peak> {
        if !effects.iter().all(|&effect| self.is_known(effect)) {
            return None;
        }
        self.starts(signal, effects)
            .into_iter()
            .filter_map(|start| self.climb(signal, effects, start))
            .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
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
            (signal - table.nodes.column(*k)).norm_squared() + t.iter().map(|t| t * t).sum::<f64>()
        };
        coordinates(table.parameters)
            .into_iter()
            .enumerate()
            .min_by(|a, b| cost(a).total_cmp(&cost(b)))
            .map_or_else(Vec::new, |(_, t)| t)
    }

    /// Damped Gauss-Newton steps as in [`fit`](crate::fit()).
    fn climb(&self, signal: &DVector<f64>, effects: &[usize], start: Vec<f64>) -> Option<Peak> {
        let mut t = DVector::from_vec(start);
        let residual = |t: &DVector<f64>| signal - self.change(effects, t.as_slice());
        let mut left = residual(&t);
        let mut target = left.norm_squared() + t.norm_squared();
        let mut damping = 1e-3;
        let mut slopes = self.slopes(effects, &t);
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
                slopes = self.slopes(effects, &t);
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
        log_evidence.is_finite().then(|| Peak { coordinates: t.as_slice().to_vec(), log_evidence })
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

fn nodes(parameters: usize) -> (usize, f64) {
    NODES[parameters.clamp(1, NODES.len()) - 1]
}

/// The coordinates of all nodes.
fn coordinates(parameters: usize) -> Vec<Vec<f64>> {
    let (count, distance) = nodes(parameters);
    let total = count.pow(u32::try_from(parameters).expect("a handful of parameters"));
    let middle = (count - 1) as f64 / 2.0;
    (0..total)
        .map(|node| {
            let place = |axis: u32| node / count.pow(axis) % count;
            (0..parameters as u32).map(|axis| (place(axis) as f64 - middle) * distance).collect()
        })
        .collect()
}

/// The weight of each node in the value at `t`: along each axis the cubic through four nodes with the slopes of their
/// neighbours (Catmull and Rom 1974), straight at the ends; beyond the last node half a distance more, then constant.
fn weights(t: &[f64]) -> Vec<f64> {
    let (count, distance) = nodes(t.len());
    let along: Vec<Vec<f64>> = t.iter().map(|&t| axis_weights(t, count, distance)).collect();
    let mut all = vec![1.0];
    for axis in along {
        all = axis.iter().flat_map(|a| all.iter().map(move |b| a * b)).collect();
    }
    all
}

fn axis_weights(t: f64, count: usize, distance: f64) -> Vec<f64> {
    let last = (count - 1) as f64;
    let x = (t / distance + last / 2.0).clamp(-0.5, last + 0.5);
    let cell = (x.floor().clamp(0.0, last - 1.0)) as usize;
    let s = x - cell as f64;
    let mut weights = vec![0.0; count];
    if (0.0..=1.0).contains(&s) {
        let (s2, s3) = (s * s, s * s * s);
        weights[cell] += 2.0 * s3 - 3.0 * s2 + 1.0;
        weights[cell + 1] += 3.0 * s2 - 2.0 * s3;
        let mut slope = |node: usize, share: f64| {
            let (a, b) = (node.saturating_sub(1), (node + 1).min(count - 1));
            weights[b] += share / (b - a) as f64;
            weights[a] -= share / (b - a) as f64;
        };
        slope(cell, s3 - 2.0 * s2 + s);
        slope(cell + 1, s3 - s2);
    } else {
        // Straight on with the slope of the outermost cell.
        weights[cell] += 1.0 - s;
        weights[cell + 1] += s;
    }
    weights
}

/// Of the diagnosed rows, each channel on its own.
fn whitened_discrepancy(problem: &Problem, whitener: &Law) -> Discrepancy {
    let places = scaled_places(problem);
    let mut parts: Vec<DMatrix<f64>> = Vec::new();
    for channel in problem.channels() {
        let rows: Vec<usize> = (0..problem.rows.len())
            .filter(|&row| problem.rows[row].channel == channel && problem.is_diagnosed(row))
            .collect();
        let kernel = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            let (a, b) = (places[rows[i]], places[rows[j]]);
            let square: f64 = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
            (-0.5 * square / (LENGTH * LENGTH)).exp()
        });
        let (values, vectors) = principal(kernel, SMOOTH);
        let mut columns = DMatrix::zeros(problem.rows.len(), values.len());
        for (k, value) in values.iter().enumerate() {
            for (i, &row) in rows.iter().enumerate() {
                columns[(row, k)] = value.sqrt() * vectors[(i, k)];
            }
        }
        parts.push(whitener.whiten(columns));
    }
    let columns: Vec<DVector<f64>> =
        parts.iter().flat_map(|part| part.column_iter().map(|c| c.into_owned())).collect();
    let white = DMatrix::from_columns(&columns);
    let (values, turned) = principal(white.tr_mul(&white), SMOOTH);
    let mut vectors = white * turned;
    for (mut vector, value) in vectors.column_iter_mut().zip(&values) {
        vector /= value.sqrt();
    }
    Discrepancy { values, vectors }
}

/// log v_c, log h and cut length of each row, from 0 to 1 over all rows.
pub(crate) fn scaled_places(problem: &Problem) -> Vec<[f64; 3]> {
    let raw: Vec<[f64; 3]> = (0..problem.rows.len())
        .map(|row| {
            let condition = problem.condition(row);
            [
                condition.cutting_speed.ln(),
                condition.uncut_chip_thickness.ln(),
                condition.cut_length,
            ]
        })
        .collect();
    let mut scaled = raw.clone();
    for axis in 0..3 {
        let low = raw.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
        let high = raw.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
        for (to, from) in scaled.iter_mut().zip(&raw) {
            to[axis] = if high > low { (from[axis] - low) / (high - low) } else { 0.0 };
        }
    }
    scaled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_interpolated_exactly_and_nodes_are_kept() {
        for parameters in 1..=3 {
            let plane = |t: &[f64]| {
                1.0 + t.iter().enumerate().map(|(k, t)| (k as f64 + 2.0) * t).sum::<f64>()
            };
            let values: Vec<f64> = coordinates(parameters).iter().map(|t| plane(t)).collect();
            let at = |t: &[f64]| weights(t).iter().zip(&values).map(|(w, v)| w * v).sum::<f64>();
            for share in [-1.4, -0.37, 0.0, 0.9, 1.3] {
                let t: Vec<f64> = (0..parameters).map(|k| share / (k as f64 + 1.0)).collect();
                assert!((at(&t) - plane(&t)).abs() < 1e-12, "{t:?}");
            }
        }
    }

    #[test]
    fn the_interpolation_of_a_share_of_the_prior_is_good_to_a_hundredth() {
        use crate::predictor::Prior;
        let prior = Prior::Uniform { low: 0.0, high: 1.0 };
        let values: Vec<f64> = coordinates(1).iter().map(|t| prior.value(t[0])).collect();
        for k in -24..=24 {
            let t = 0.1 * f64::from(k);
            let found: f64 = weights(&[t]).iter().zip(&values).map(|(w, v)| w * v).sum();
            assert!((found - prior.value(t)).abs() < 0.01, "{t}: {found}");
        }
    }
}
