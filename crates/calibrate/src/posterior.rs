//! The constants given the measured cuts and what the runs say of them.

use crate::cuts::MeasuredCut;
use crate::emulator::Emulator;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;
use sphcut_physics::Channel;

/// A discrepancy of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    /// Standard deviation of ln F_c at the middle of the cuts.
    pub amplitude: f64,
    /// That of ln F_f and ln F_p over it.
    pub thrust: f64,
    /// Share of its variance that is each cut's own; the rest is common to neighbours.
    pub own: f64,
    /// How probable it is before a cut was made.
    pub prior: f64,
}

/// Amplitudes, and how probable each is: half of all laws follow to 1 %, one in ten misses by 16 % or more.
const AMPLITUDES: [(f64, f64); 7] =
    [(0.0, 0.3), (0.01, 0.2), (0.02, 0.15), (0.04, 0.15), (0.08, 0.1), (0.16, 0.06), (0.32, 0.04)];
/// Of F_f over F_c, and shares of the variance that are a cut's own: each as probable.
const THRUSTS: [f64; 2] = [1.0, 4.0];
const OWN: [f64; 2] = [0.25, 0.01];

/// Discrepancies that are weighed against each other.
pub const DISCREPANCIES: [Discrepancy; 25] = {
    let none = Discrepancy { amplitude: 0.0, thrust: 1.0, own: 0.0, prior: AMPLITUDES[0].1 };
    let mut all = [none; 25];
    let mut k = 1;
    while k < all.len() {
        let (amplitude, prior) = AMPLITUDES[k.div_ceil(4)];
        let (thrust, own) = (THRUSTS[(k / 2) % 2], OWN[k % 2]);
        all[k] = Discrepancy { amplitude, thrust, own, prior: 0.25 * prior };
        k += 1;
    }
    all
};

impl Discrepancy {
    /// Standard deviation of the logarithm of a channel: what models of cutting miss of them.
    const fn deviation(&self, channel: Channel) -> f64 {
        let times = match channel {
            Channel::FeedForce | Channel::PassiveForce => self.thrust,
            Channel::ChipThickness => 1.5,
            Channel::ContactLength | Channel::Springback => 3.0,
            _ => 1.0,
        };
        self.amplitude * times
    }
}

/// Shares of what is common to neighbours: the same at all cuts, straight over their places, smooth.
const CONSTANT: f64 = 1.0 / 3.0;
const STRAIGHT: f64 = 1.0 / 3.0;
const SMOOTH: f64 = 1.0 / 3.0;
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
    /// Channel of each value.
    pub channels: Vec<Channel>,
    /// Covariance of a discrepancy of deviation 1 in every channel that is common to neighbours.
    pub common: DMatrix<f64>,
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
            values.par_iter().map(|v| emulator.slopes(v.channel, of(v), t)).collect();
        let mut known = DMatrix::from_fn(values.len(), values.len(), |i, j| {
            if i == j { values[i].variance } else { 0.0 }
        });
        let mut common = DMatrix::zeros(values.len(), values.len());
        for channel in Channel::RECORDED {
            let own: Vec<usize> =
                (0..values.len()).filter(|&k| values[k].channel == channel).collect();
            if own.is_empty() {
                continue;
            }
            let conditions: Vec<_> = own.iter().map(|&k| of(&values[k])).collect();
            let mut open = DMatrix::zeros(own.len(), own.len());
            let at =
                |place: &DVector<f64>| emulator.covariance(channel, &conditions, place.as_slice());
            let all: Vec<DMatrix<f64>> = around.par_iter().map(at).collect();
            for there in all {
                open += there / around.len() as f64;
            }
            let places: Vec<[f64; 4]> =
                conditions.iter().map(|c| emulator.places().at(c)).collect();
            for (a, &i) in own.iter().enumerate() {
                for (b, &j) in own.iter().enumerate() {
                    known[(i, j)] += open[(a, b)];
                    let apart: f64 = (0..4).map(|k| (places[a][k] - places[b][k]).powi(2)).sum();
                    let along: f64 = (0..4).map(|k| places[a][k] * places[b][k]).sum();
                    let smooth = (-0.5 * apart / (LENGTH * LENGTH)).exp();
                    common[(i, j)] = CONSTANT + STRAIGHT * along + SMOOTH * smooth;
                }
            }
        }
        Self {
            at: DVector::from_column_slice(t),
            logs: DVector::from_iterator(values.len(), logs),
            slopes: DMatrix::from_fn(values.len(), t.len(), |i, k| slopes[i][k]),
            known,
            channels: values.iter().map(|v| v.channel).collect(),
            common,
        }
    }

    /// Covariance given t with a discrepancy.
    #[must_use]
    pub fn covariance(&self, discrepancy: Discrepancy) -> DMatrix<f64> {
        let deviations: Vec<f64> =
            self.channels.iter().map(|channel| discrepancy.deviation(*channel)).collect();
        let shared = 1.0 - discrepancy.own;
        DMatrix::from_fn(deviations.len(), deviations.len(), |i, j| {
            let own = if i == j { discrepancy.own } else { 0.0 };
            let share = shared * self.common[(i, j)] + own;
            self.known[(i, j)] + deviations[i] * deviations[j] * share
        })
    }

    /// The law of the values before anything was measured: mean and covariance over t ~ N(0, 1) and all errors.
    #[must_use]
    pub fn marginal(&self, discrepancy: Discrepancy) -> (DVector<f64>, DMatrix<f64>) {
        let mean = &self.logs - &self.slopes * &self.at;
        (mean, self.covariance(discrepancy) + &self.slopes * self.slopes.transpose())
    }
}

/// A normal law of the constants with its weight.
#[derive(Debug, Clone)]
struct Component {
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
    /// Probability of each of [`DISCREPANCIES`].
    pub weights: Vec<f64>,
    /// ln of the evidence, the mean over the discrepancies (Laplace); only differences on the same values say something.
    pub evidence: f64,
}

impl Posterior {
    /// Root mean square of the standard deviation by which the model misses ln y of a channel.
    #[must_use]
    pub fn discrepancy(&self, channel: Channel) -> f64 {
        let all = self.weights.iter().zip(DISCREPANCIES);
        all.map(|(w, d)| w * d.deviation(channel).powi(2)).sum::<f64>().sqrt()
    }

    /// Probability that the model misses a channel by so much or more beside all other errors.
    #[must_use]
    pub fn misses(&self, channel: Channel, share: f64) -> f64 {
        let all = self.weights.iter().zip(DISCREPANCIES);
        all.filter(|(_, d)| d.deviation(channel) >= share).map(|(w, _)| w).sum()
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
/// discrepancy; each of [`DISCREPANCIES`] is weighed by its evidence (Laplace), so that a law that cannot follow the cuts has wide
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
    let mut components: Vec<Component> = Vec::new();
    for one in DISCREPANCIES {
        // The last optimum is near this one.
        let near = components.last().map_or(start, |last| last.mean.as_slice());
        let found = component(one, (near, held), cuts, (values, &measured), emulator)?;
        components.push(found);
    }
    let best = components.iter().map(|c| c.evidence).fold(f64::NEG_INFINITY, f64::max);
    let all = components.iter().zip(DISCREPANCIES);
    let raw: Vec<f64> = all.map(|(c, d)| d.prior * (c.evidence - best).exp()).collect();
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
    Some(Posterior { mean, covariance, weights, evidence })
}

/// Gauss and Newton with halved steps; the covariance is that of the last place. A constant that is held does not move.
fn component(
    discrepancy: Discrepancy,
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
    let mut known: Cholesky<f64, Dyn> = law.covariance(discrepancy).cholesky()?;
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
        known = law.covariance(discrepancy).cholesky()?;
        if moved < MOVED {
            break;
        }
    }
    let normal = law.slopes.transpose() * known.solve(&law.slopes) + &prior;
    let (mean, covariance) = law.marginal(discrepancy);
    let marginal = covariance.cholesky()?;
    let rest = measured - mean;
    let spread: f64 = marginal.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
    let evidence = -0.5 * (rest.dot(&marginal.solve(&rest)) + spread);
    Some(Component { evidence, mean: t, covariance: normal.try_inverse()? })
}
