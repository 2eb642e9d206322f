//! What runs say of all cuts at all values of the constants: a Gaussian process about a closed form.

use crate::{Channels, CutValues, RunPoint};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use sphcut_physics::{Channel, CuttingCondition};

/// A quick model of a cut, right in its trends: the mean that runs correct.
pub trait PriorModel: Sync {
    /// Logarithms of the channels in SI units at coordinates of the constants; not a number where it has no answer.
    fn logs(&self, condition: &CuttingCondition, t: &[f64]) -> Channels<f64>;
}

/// Standard deviations of the logarithm by which the quick model may be wrong: at all cuts by the same, per unit of their place,
/// smoothly over that, at each cut by its own.
const LEVEL: f64 = 0.7;
const SLOPE: f64 = 0.25;
const SMOOTH: f64 = 0.08;
const OWN: f64 = 0.08;
/// Correlation length of what is smooth, in half spreads of the cuts.
const LENGTH: f64 = 1.5;
/// By which share of it, and by which amount, the change with a constant may be wrong.
const SHARE: f64 = 0.4;
const LEAST_CHANGE: f64 = 0.015;
/// How much of that differs with the place of the cut, smoothly over it, and from cut to cut.
const CHANGE_SLOPE: f64 = 0.5;
const CHANGE_SMOOTH: f64 = 0.3;
const CHANGE_OWN: f64 = 0.02;
/// The curvature that the quick model lacks.
const CURVATURE: f64 = 0.01;
/// Scatter of the logarithm of a run that its interval does not show, by [`Channel::RECORDED`].
const SCATTER: Channels<f64> = [0.008, 0.02, 0.05, 0.008, 0.03, 0.06, 0.2];
/// Factors on smooth errors, on own errors and on the scatter that are compared by their evidence.
const SMOOTHS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const OWNS: [f64; 5] = [0.125, 0.25, 0.5, 1.0, 2.0];
const SCATTERS: [f64; 3] = [0.5, 1.0, 2.0];
/// Step of differences in coordinates.
const STEP: f64 = 0.2;

/// Places of cuts: logarithms of speed and thickness, rake, logarithm of the edge radius, each about the middle and over half the
/// spread of the cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    middle: [f64; 4],
    half: [f64; 4],
}

/// A smaller half spread says nothing of what is twice as far: a factor of 2 in speed, thickness or edge radius, 11 deg of rake.
const LEAST_HALF: [f64; 4] = [0.35, 0.35, 0.1, 0.35];

/// `None`: what the scenario has.
fn raw(condition: &CuttingCondition) -> [Option<f64>; 4] {
    let [rake, radius] = condition.tool.parts();
    [
        Some(condition.cutting_speed.ln()),
        Some(condition.uncut_chip_thickness.ln()),
        rake,
        radius.map(|radius| radius.max(1e-6).ln()),
    ]
}

impl Places {
    /// Those of some cuts.
    pub fn of<'c>(conditions: impl Iterator<Item = &'c CuttingCondition>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
        for condition in conditions {
            for (k, x) in raw(condition).into_iter().enumerate() {
                let Some(x) = x else { continue };
                (low[k], high[k]) = (low[k].min(x), high[k].max(x));
            }
        }
        let middle = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
        Self { middle, half: std::array::from_fn(|k| 0.5 * (high[k] - low[k])) }
    }

    /// Whether a quantity varies.
    pub fn varies(&self, k: usize) -> bool {
        self.half[k] > 1e-3
    }

    /// -1 to 1 within the cuts; beyond them, too, where a quantity does not vary among them: nothing is known of another.
    pub fn at(&self, condition: &CuttingCondition) -> [f64; 4] {
        let own = raw(condition);
        std::array::from_fn(|k| {
            let known = own[k].filter(|_| self.middle[k].is_finite());
            known.map_or(0.0, |x| (x - self.middle[k]) / self.half[k].max(LEAST_HALF[k]))
        })
    }
}

/// How closely the last place is found at which the quick model has an answer: to a hundredth of a deviation of the prior.
const HALVINGS: usize = 8;

/// The emulator of one channel.
#[derive(Debug, Clone)]
struct ChannelEmulator {
    runs: Vec<([f64; 4], CuttingCondition, Vec<f64>)>,
    /// Standard deviation of the error of the change with each constant.
    changes: Vec<f64>,
    /// Standard deviations of smooth and own errors.
    errors: [f64; 2],
    known: Cholesky<f64, Dyn>,
    weights: DVector<f64>,
    evidence: f64,
}

fn kernel(
    (changes, [smooth, own]): (&[f64], [f64; 2]),
    (za, ca, ta): (&[f64; 4], &CuttingCondition, &[f64]),
    (zb, cb, tb): (&[f64; 4], &CuttingCondition, &[f64]),
) -> f64 {
    let dot: f64 = za.iter().zip(zb).map(|(a, b)| a * b).sum();
    let same = if ca == cb { 1.0 } else { 0.0 };
    let apart: f64 = za.iter().zip(zb).map(|(a, b)| (a - b).powi(2)).sum();
    let near = (-0.5 * apart / LENGTH.powi(2)).exp();
    let level = LEVEL.powi(2) + SLOPE.powi(2) * dot + smooth.powi(2) * near + own.powi(2) * same;
    let along: f64 = changes.iter().zip(ta.iter().zip(tb)).map(|(s, (a, b))| s * s * a * b).sum();
    let shape =
        1.0 + CHANGE_SLOPE.powi(2) * dot + CHANGE_SMOOTH.powi(2) * near + CHANGE_OWN.powi(2) * same;
    let product: f64 = ta.iter().zip(tb).map(|(a, b)| a * b).sum();
    level + along * shape + (CURVATURE * product).powi(2)
}

/// Logarithms of all channels over cuts and constants, learnt from runs.
///
/// ```text
/// ln y(c, t) = ln y_0(c, t) + d(c, t),   d ~ GP(0, K)
/// K = s_0^2 + s_z^2 z.z' + s_s^2 q + s_c^2 [c = c'] + sum_k s_k^2 t_k t_k' (1 + s_1^2 z.z' + s_2^2 q + s_3^2 [c = c']) + s_q^2 (t.t')^2
/// q = exp(-(z - z')^2 / (2 l^2))
/// ```
///
/// y_0 is the quick model, t the constants in standard deviations of their priors, z the place of the cut. The change with a constant may be
/// wrong by 40 % of what y_0 has on average over the cuts. A run has the variance of its own mean and a scatter beside it.
pub struct Emulator<'m> {
    model: &'m dyn PriorModel,
    places: Places,
    channels: Vec<Option<ChannelEmulator>>,
    /// Where y_0 has no answer even at the mean of the prior.
    fallback: Channels<f64>,
}

impl<'m> Emulator<'m> {
    /// Learns from `runs`.
    #[must_use]
    pub fn new(model: &'m dyn PriorModel, places: &Places, runs: &[(RunPoint, CutValues)]) -> Self {
        let fallback = Channel::RECORDED.map(|channel| {
            let known = runs.iter().filter_map(|(_, values)| values[channel.index()]);
            let logs: Vec<f64> = known.map(|(log, _)| log).collect();
            logs.iter().sum::<f64>() / logs.len().max(1) as f64
        });
        let mut found = Self { model, places: places.clone(), channels: Vec::new(), fallback };
        found.channels = Channel::RECORDED.iter().map(|c| found.learn(c.index(), runs)).collect();
        found
    }

    /// Whether runs have told anything of a channel.
    #[must_use]
    pub fn knows(&self, channel: Channel) -> bool {
        self.channels[channel.index()].is_some()
    }

    /// y_0, where it has no answer continued from the last place on the way there from the mean of the prior that has one: a jump would
    /// look like a change with a constant, and determine it.
    fn quick(&self, channel: usize, condition: &CuttingCondition, t: &[f64]) -> f64 {
        let at = |share: f64| {
            let t: Vec<f64> = t.iter().map(|t| share * t).collect();
            self.model.logs(condition, &t)[channel]
        };
        let log = self.model.logs(condition, t)[channel];
        if log.is_finite() {
            return log;
        }
        let (mut found, mut low, mut high) = (at(0.0), 0.0, 1.0);
        if !found.is_finite() {
            return self.fallback[channel];
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let there = at(middle);
            if there.is_finite() {
                (found, low) = (there, middle);
            } else {
                high = middle;
            }
        }
        found
    }

    fn learn(&self, channel: usize, runs: &[(RunPoint, CutValues)]) -> Option<ChannelEmulator> {
        let known: Vec<(&RunPoint, f64, f64)> = runs
            .iter()
            .filter_map(|(point, values)| {
                values[channel].map(|(log, variance)| (point, log, variance))
            })
            .collect();
        let first = known.first()?;
        let constants = first.0.t.len();
        let changes: Vec<f64> = (0..constants)
            .map(|k| {
                let slope = |point: &RunPoint| {
                    let mut moved = point.t.clone();
                    moved[k] += STEP;
                    let high = self.quick(channel, &point.condition, &moved);
                    (high - self.quick(channel, &point.condition, &point.t)) / STEP
                };
                let squares: f64 = known.iter().map(|(point, _, _)| slope(point).powi(2)).sum();
                SHARE * (squares / known.len() as f64).sqrt() + LEAST_CHANGE
            })
            .collect();
        let places: Vec<([f64; 4], CuttingCondition, Vec<f64>)> = known
            .iter()
            .map(|(point, _, _)| {
                (self.places.at(&point.condition), point.condition, point.t.clone())
            })
            .collect();
        let errors = DVector::from_iterator(
            known.len(),
            known.iter().map(|(p, log, _)| log - self.quick(channel, &p.condition, &p.t)),
        );
        let of = |own_errors: [f64; 2], scatter: f64| {
            let covariance = DMatrix::from_fn(known.len(), known.len(), |i, j| {
                let (a, b) = (&places[i], &places[j]);
                let noise = known[i].2 + (scatter * SCATTER[channel]).powi(2);
                kernel((&changes, own_errors), (&a.0, &a.1, &a.2), (&b.0, &b.1, &b.2))
                    + if i == j { noise } else { 0.0 }
            });
            let known = covariance.cholesky()?;
            let weights = known.solve(&errors);
            let spread: f64 = known.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
            let evidence = -0.5 * (errors.dot(&weights) + spread);
            let (runs, changes) = (places.clone(), changes.clone());
            Some(ChannelEmulator { runs, changes, errors: own_errors, known, weights, evidence })
        };
        let pairs = SMOOTHS.iter().flat_map(|&a| OWNS.iter().map(move |&b| [a * SMOOTH, b * OWN]));
        let all = pairs.flat_map(|errors| SCATTERS.iter().map(move |&s| (errors, s)));
        let all: Vec<([f64; 2], f64)> = all.collect();
        let found: Vec<_> = all.into_par_iter().map(|(e, s)| of(e, s)).collect();
        found.into_iter().flatten().max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }

    fn toward(
        &self,
        own: &ChannelEmulator,
        condition: &CuttingCondition,
        t: &[f64],
    ) -> DVector<f64> {
        let place = self.places.at(condition);
        let all = own
            .runs
            .iter()
            .map(|(z, c, s)| kernel((&own.changes, own.errors), (z, c, s), (&place, condition, t)));
        DVector::from_iterator(own.runs.len(), all)
    }

    /// ln y of a channel.
    #[must_use]
    pub fn log(&self, channel: Channel, condition: &CuttingCondition, t: &[f64]) -> f64 {
        let quick = self.quick(channel.index(), condition, t);
        let Some(own) = &self.channels[channel.index()] else { return quick };
        quick + self.toward(own, condition, t).dot(&own.weights)
    }

    /// Covariance of ln y of a channel at some cuts, all with the same constants: what the runs leave open.
    #[must_use]
    pub fn covariance(
        &self,
        channel: Channel,
        cuts: &[&CuttingCondition],
        t: &[f64],
    ) -> DMatrix<f64> {
        let Some(own) = &self.channels[channel.index()] else {
            return DMatrix::zeros(cuts.len(), cuts.len());
        };
        let columns: Vec<DVector<f64>> = cuts.iter().map(|cut| self.toward(own, cut, t)).collect();
        // toward' K^-1 toward = |L^-1 toward|^2.
        let mut whitened = DMatrix::from_columns(&columns);
        own.known.l_dirty().solve_lower_triangular_mut(&mut whitened);
        let told = whitened.tr_mul(&whitened);
        let places: Vec<[f64; 4]> = cuts.iter().map(|cut| self.places.at(cut)).collect();
        DMatrix::from_fn(cuts.len(), cuts.len(), |i, j| {
            let (a, b) = ((&places[i], cuts[i], t), (&places[j], cuts[j], t));
            kernel((&own.changes, own.errors), a, b) - told[(i, j)]
        })
    }

    /// d ln y / d t.
    #[must_use]
    pub fn slopes(&self, channel: Channel, condition: &CuttingCondition, t: &[f64]) -> Vec<f64> {
        let at = |k: usize, step: f64| {
            let mut moved = t.to_vec();
            moved[k] += step;
            self.log(channel, condition, &moved)
        };
        (0..t.len()).map(|k| (at(k, STEP) - at(k, -STEP)) / (2.0 * STEP)).collect()
    }

    /// Where the cuts lie.
    #[must_use]
    pub fn places(&self) -> &Places {
        &self.places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A model that has no answer beyond half a deviation.
    struct Cliff;
    impl PriorModel for Cliff {
        fn logs(&self, _: &CuttingCondition, t: &[f64]) -> Channels<f64> {
            let mut logs = [f64::NAN; Channel::RECORDED.len()];
            logs[0] = if t[0] > 0.5 { f64::NAN } else { 5.0 + 0.1 * t[0] };
            logs
        }
    }

    /// Where the quick model ends, nothing changes at once: no constant follows from that.
    #[test]
    fn the_end_of_the_quick_model_is_no_jump() {
        let condition = CuttingCondition::new(2.0, 1e-4);
        let run = |t: f64| {
            let mut values = CutValues::default();
            values[0] = Some((5.0 + 0.1 * t, 1e-4));
            (RunPoint { condition, t: vec![t] }, values)
        };
        let places = Places::of([condition].iter());
        let emulator = Emulator::new(&Cliff, &places, &[run(-1.0), run(0.0), run(1.0)]);
        let at = |t: f64| emulator.log(Channel::CuttingForce, &condition, &[t]);
        assert!((at(0.51) - at(0.49)).abs() < 0.005, "{} {}", at(0.49), at(0.51));
        let slope = emulator.slopes(Channel::CuttingForce, &condition, &[0.5])[0];
        assert!((0.0..0.2).contains(&slope), "{slope}");
    }
}
