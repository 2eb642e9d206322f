//! The constants given the measured cuts and what the runs say of them.

use crate::Channels;
use crate::cuts::MeasuredCut;
use crate::emulator::Emulator;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use sphcut_physics::Channel;

/// Amplitudes of the model discrepancy that are weighed against each other, as a share of F_c.
pub const AMPLITUDES: [f64; 7] = [0.0, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32];
/// How probable each is before a cut was made: half of all laws follow to 1 %, one in ten misses by 16 % or more.
pub(crate) const PRIOR: [f64; 7] = [0.3, 0.2, 0.15, 0.15, 0.1, 0.06, 0.04];
/// The discrepancy of each channel over that of F_c, by [`Channel::RECORDED`]: what models of cutting miss of them.
const TIMES: Channels<f64> = [1.0, 2.0, 2.0, 1.0, 1.5, 3.0, 3.0];
/// Shares of its variance at the middle and the ends of the cuts: the same at all, straight over their places, smooth, of each cut its own.
const CONSTANT: f64 = 0.25;
const STRAIGHT: f64 = 0.25;
const SMOOTH: f64 = 0.25;
const OWN: f64 = 0.25;
/// Correlation length in half spreads of the cuts.
const LENGTH: f64 = 1.0;
/// Steps of the search, and the change of all coordinates that ends it.
const STEPS: usize = 30;
const MOVED: f64 = 1e-3;
/// Intervals of constants are wider than the covariance by this. Changes with constants that a few runs have told look surer than they are: of 240 constants
/// of twins of another physics (`examples/twins.rs`), whose fit lacked nothing, 88 % lay within 1.96 standard deviations, as if these were 1.25 times as large.
const WIDENED: f64 = 1.25;
/// Runs are made, and the emulator is trusted, so far from the prior's mean.
const FARTHEST: f64 = 3.0;

/// One measured value: the place of its cut in the list and its channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredValue {
    /// Place of the cut.
    pub cut: usize,
    /// Channel.
    pub channel: Channel,
    /// Its logarithm.
    pub log: f64,
    /// Variance of that.
    pub variance: f64,
}

/// All values of `cuts` that the emulator knows.
#[must_use]
pub fn values(cuts: &[MeasuredCut], emulator: &Emulator<'_>) -> Vec<MeasuredValue> {
    let mut all = Vec::new();
    for (cut, own) in cuts.iter().enumerate() {
        for channel in Channel::RECORDED.into_iter().filter(|c| emulator.knows(*c)) {
            if let Some((log, variance)) = own.values[channel.index()] {
                all.push(MeasuredValue { cut, channel, log, variance });
            }
        }
    }
    all
}

/// The law of the values, linear about a place of the constants.
#[derive(Debug, Clone)]
pub struct LinearLaw {
    /// Coordinates about which it is linear.
    pub at: DVector<f64>,
    /// ln y there.
    pub logs: DVector<f64>,
    /// d ln y / d t.
    pub slopes: DMatrix<f64>,
    /// Covariance of measured ln y given t, without discrepancy: noise and emulator.
    pub known: DMatrix<f64>,
    /// Covariance of a discrepancy of amplitude 1.
    pub unit: DMatrix<f64>,
}

impl LinearLaw {
    /// About `t`; what the runs leave open is the mean over `around`, where the constants may be.
    #[must_use]
    pub fn about(
        (t, around): (&[f64], &[DVector<f64>]),
        cuts: &[MeasuredCut],
        values: &[MeasuredValue],
        emulator: &Emulator<'_>,
    ) -> Self {
        let of = |v: &MeasuredValue| &cuts[v.cut].condition;
        let logs = values.iter().map(|v| emulator.log(v.channel, of(v), t));
        let slopes: Vec<Vec<f64>> =
            values.iter().map(|v| emulator.slopes(v.channel, of(v), t)).collect();
        let mut known = DMatrix::from_fn(values.len(), values.len(), |i, j| {
            if i == j { values[i].variance } else { 0.0 }
        });
        let mut unit = DMatrix::zeros(values.len(), values.len());
        for channel in Channel::RECORDED {
            let own: Vec<usize> =
                (0..values.len()).filter(|&k| values[k].channel == channel).collect();
            if own.is_empty() {
                continue;
            }
            let conditions: Vec<_> = own.iter().map(|&k| of(&values[k])).collect();
            let mut open = DMatrix::zeros(own.len(), own.len());
            for place in around {
                let there = emulator.covariance(channel, &conditions, place.as_slice());
                open += there / around.len() as f64;
            }
            let places: Vec<[f64; 4]> =
                conditions.iter().map(|c| emulator.places().at(c)).collect();
            for (a, &i) in own.iter().enumerate() {
                for (b, &j) in own.iter().enumerate() {
                    known[(i, j)] += open[(a, b)];
                    let apart: f64 = (0..4).map(|k| (places[a][k] - places[b][k]).powi(2)).sum();
                    let along: f64 = (0..4).map(|k| places[a][k] * places[b][k]).sum();
                    let same = if values[i].cut == values[j].cut { 1.0 } else { 0.0 };
                    let smooth = (-0.5 * apart / (LENGTH * LENGTH)).exp();
                    unit[(i, j)] = TIMES[channel.index()].powi(2)
                        * (CONSTANT + STRAIGHT * along + SMOOTH * smooth + OWN * same);
                }
            }
        }
        Self {
            at: DVector::from_column_slice(t),
            logs: DVector::from_iterator(values.len(), logs),
            slopes: DMatrix::from_fn(values.len(), t.len(), |i, k| slopes[i][k]),
            known,
            unit,
        }
    }

    /// Covariance given t with a discrepancy of `amplitude`.
    #[must_use]
    pub fn covariance(&self, amplitude: f64) -> DMatrix<f64> {
        &self.known + &self.unit * amplitude.powi(2)
    }

    /// The law of the values before anything was measured: mean and covariance over t ~ N(0, 1) and all errors.
    #[must_use]
    pub fn marginal(&self, amplitude: f64) -> (DVector<f64>, DMatrix<f64>) {
        let mean = &self.logs - &self.slopes * &self.at;
        (mean, self.covariance(amplitude) + &self.slopes * self.slopes.transpose())
    }
}

/// A normal law of the constants with its weight.
#[derive(Debug, Clone)]
struct Component {
    amplitude: f64,
    evidence: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

/// Places whose mean and covariance are these: the mean, more and less by the root of their number along each column of the covariance's factor.
fn around(mean: &DVector<f64>, covariance: &DMatrix<f64>) -> Vec<DVector<f64>> {
    let Some(factor) = covariance.clone().cholesky() else { return vec![mean.clone()] };
    let far = (mean.len() as f64).sqrt();
    let columns = (0..mean.len()).map(|k| far * factor.l_dirty().lower_triangle().column(k));
    columns.flat_map(|step| [mean + &step, mean - &step]).collect()
}

/// What is known of the constants, in standard deviations of their priors.
#[derive(Debug, Clone)]
pub struct Posterior {
    /// Mean.
    pub mean: DVector<f64>,
    /// Covariance; that of the prior is the identity.
    pub covariance: DMatrix<f64>,
    /// Probability of each of [`AMPLITUDES`].
    pub weights: Vec<f64>,
    /// ln of the evidence, the mean over the amplitudes (Laplace); only differences on the same values say something.
    pub evidence: f64,
}

impl Posterior {
    /// Root mean square of the amplitude of the model discrepancy.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        self.weights.iter().zip(AMPLITUDES).map(|(w, a)| w * a * a).sum::<f64>().sqrt()
    }

    /// Probability that the model misses F_c by so much or more beside all other errors.
    #[must_use]
    pub fn misses(&self, amplitude: f64) -> f64 {
        let all = self.weights.iter().zip(AMPLITUDES);
        all.filter(|(_, a)| *a >= amplitude).map(|(w, _)| w).sum()
    }

    /// Places with its mean and covariance.
    #[must_use]
    pub fn around(&self) -> Vec<DVector<f64>> {
        around(&self.mean, &self.covariance)
    }

    /// Standard deviation of a coordinate for its interval: wider than the covariance says, and never wider than the prior.
    #[must_use]
    pub fn deviation(&self, k: usize) -> f64 {
        (WIDENED * self.covariance[(k, k)].sqrt()).min(1.0)
    }
}

/// The constants: prior N(0, 1) in each coordinate, values normal about the emulator with the covariance of noise, emulator and
/// discrepancy; the amplitude of the discrepancy is weighed by its evidence (Laplace), so that a law that cannot follow the cuts has wide
/// intervals. `None` if a covariance cannot be inverted.
#[must_use]
pub fn infer(
    start: &[f64],
    cuts: &[MeasuredCut],
    values: &[MeasuredValue],
    emulator: &Emulator<'_>,
) -> Option<Posterior> {
    infer_with(None, start, cuts, values, emulator)
}

/// The same with the constant `k` held at `held`: what the others say without it.
#[must_use]
pub fn infer_without(
    k: usize,
    held: f64,
    start: &[f64],
    cuts: &[MeasuredCut],
    values: &[MeasuredValue],
    emulator: &Emulator<'_>,
) -> Option<Posterior> {
    let mut start = start.to_vec();
    start[k] = held;
    infer_with(Some(k), &start, cuts, values, emulator)
}

fn infer_with(
    held: Option<usize>,
    start: &[f64],
    cuts: &[MeasuredCut],
    values: &[MeasuredValue],
    emulator: &Emulator<'_>,
) -> Option<Posterior> {
    let measured = DVector::from_iterator(values.len(), values.iter().map(|v| v.log));
    let components: Option<Vec<Component>> = AMPLITUDES
        .into_iter()
        .map(|amplitude| component(amplitude, (start, held), cuts, (values, &measured), emulator))
        .collect();
    let components = components?;
    let best = components.iter().map(|c| c.evidence).fold(f64::NEG_INFINITY, f64::max);
    let raw: Vec<f64> =
        components.iter().zip(PRIOR).map(|(c, prior)| prior * (c.evidence - best).exp()).collect();
    let sum: f64 = raw.iter().sum();
    let evidence = best + sum.ln();
    let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
    let mut mean = DVector::zeros(start.len());
    for (weight, own) in weights.iter().zip(&components) {
        mean += *weight * &own.mean;
    }
    let mut covariance = DMatrix::zeros(start.len(), start.len());
    for (weight, own) in weights.iter().zip(&components) {
        let apart = &own.mean - &mean;
        covariance += *weight * (&own.covariance + &apart * apart.transpose());
    }
    debug_assert_eq!(components.len(), AMPLITUDES.len());
    debug_assert!(components.iter().zip(AMPLITUDES).all(|(c, a)| c.amplitude == a));
    Some(Posterior { mean, covariance, weights, evidence })
}

/// Gauss and Newton with halved steps; the covariance is that of the last place. A constant that is held does not move.
fn component(
    amplitude: f64,
    (start, held): (&[f64], Option<usize>),
    cuts: &[MeasuredCut],
    (values, measured): (&[MeasuredValue], &DVector<f64>),
    emulator: &Emulator<'_>,
) -> Option<Component> {
    let mut t = DVector::from_column_slice(start);
    let prior = DMatrix::identity(start.len(), start.len());
    let mut places = vec![t.clone()];
    let about = |t: &DVector<f64>, places: &[DVector<f64>]| {
        let mut law = LinearLaw::about((t.as_slice(), places), cuts, values, emulator);
        if let Some(k) = held {
            law.slopes.column_mut(k).fill(0.0);
        }
        law
    };
    let mut law = about(&t, &places);
    let mut known: Cholesky<f64, Dyn> = law.covariance(amplitude).cholesky()?;
    let cost = |t: &DVector<f64>, known: &Cholesky<f64, Dyn>| {
        let of = |v: &MeasuredValue| emulator.log(v.channel, &cuts[v.cut].condition, t.as_slice());
        let rest = measured - DVector::from_iterator(values.len(), values.iter().map(of));
        rest.dot(&known.solve(&rest)) + t.dot(t)
    };
    for _ in 0..STEPS {
        let rest = measured - &law.logs;
        let weighed = known.solve(&law.slopes);
        let normal = law.slopes.transpose() * &weighed + &prior;
        let mut gradient = weighed.transpose() * &rest - &t;
        if let Some(k) = held {
            gradient[k] = 0.0;
        }
        let step = normal.clone().cholesky()?.solve(&gradient);
        let before = cost(&t, &known);
        let mut share = 1.0;
        let next = loop {
            let next = (&t + share * &step).map(|x| x.clamp(-FARTHEST, FARTHEST));
            if cost(&next, &known) <= before || share < 1e-3 {
                break next;
            }
            share *= 0.5;
        };
        let moved = (&next - &t).amax();
        t = next;
        // Where the runs are, the emulator knows the cuts, but not how they change: that is open where the constants may be as well.
        places = around(&t, &normal.try_inverse()?);
        if let Some(k) = held {
            places.iter_mut().for_each(|place| place[k] = t[k]);
        }
        law = about(&t, &places);
        known = law.covariance(amplitude).cholesky()?;
        if moved < MOVED {
            break;
        }
    }
    let normal = law.slopes.transpose() * known.solve(&law.slopes) + &prior;
    let (mean, covariance) = law.marginal(amplitude);
    let marginal = covariance.cholesky()?;
    let rest = measured - mean;
    let spread: f64 = marginal.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
    let evidence = -0.5 * (rest.dot(&marginal.solve(&rest)) + spread);
    Some(Component { amplitude, evidence, mean: t, covariance: normal.try_inverse()? })
}
