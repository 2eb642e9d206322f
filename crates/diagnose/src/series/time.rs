//! What the changes within cuts say together: instrument, wear or heat, or a run-in and what its length goes with.
//!
//! Discoveries over all cuts and channels: Benjamini and Hochberg at q = 0.05, for run-ins, for trends and for zeros by themselves. The time
//! constants T of run-ins are weighed between
//!
//! ```text
//! T = const (an instrument, or something that gives way)     T = L / v_c (a length of cut)     T = k h / v_c (so many thicknesses)
//! ```
//!
//! or none of these, with the evidence of a normal scatter of 5 to 40 % (of 100 % for none) and the constant integrated out; where two of
//! them differ by a constant over the cuts, they are not told apart.

use super::SeriesCut;
use super::lines::FALSE_SHARE;
use super::trend::{Trend, trends, two_sided};
use crate::inference::locate::benjamini_hochberg;
use sphcut_physics::Channel;

/// Probability above which a law is named.
const CLAIM: f64 = 0.9;
/// Fewest run-ins for a law.
const FEWEST: usize = 3;
/// Laws whose logarithms scatter less than this against each other are not told apart.
const TOLD_APART: f64 = 3.0;

/// A law of run-ins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunInLaw {
    /// The same time in all cuts.
    Time,
    /// The same length of cut.
    Length,
    /// The same multiple of the uncut chip thickness.
    Thicknesses,
    /// None of these.
    Other,
}

impl RunInLaw {
    const ALL: [Self; 4] = [Self::Time, Self::Length, Self::Thicknesses, Self::Other];

    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Time => "constant_time",
            Self::Length => "constant_length",
            Self::Thicknesses => "multiple_of_thickness",
            Self::Other => "none_of_these",
        }
    }

    fn place(self, cut: &SeriesCut) -> f64 {
        match self {
            Self::Time | Self::Other => 0.0,
            Self::Length => -cut.cutting_speed.ln(),
            Self::Thicknesses => (cut.uncut_chip_thickness / cut.cutting_speed).ln(),
        }
    }
}

/// What one force does within the cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct OverTime {
    /// Which force.
    pub component: Channel,
    /// Each cut that is long enough.
    pub trends: Vec<Trend>,
    /// Which of them have a trend beyond chance.
    pub trending: Vec<bool>,
    /// Which of them have a run-in beyond chance.
    pub running_in: Vec<bool>,
    /// Of which of them the zero has moved beyond chance.
    pub drifting: Vec<bool>,
    /// Laws of the run-ins with their probabilities, the most probable first; empty for fewer than three.
    pub laws: Vec<(RunInLaw, f64)>,
    /// The law that may be named.
    pub law: Option<RunInLaw>,
    /// The constant of the most probable law: s, m or multiples of h.
    pub constant: Option<f64>,
}

impl OverTime {
    /// Change of a cut as a share of the force with its 95 % interval, run-in apart where there is one.
    #[must_use]
    pub fn change(&self, k: usize) -> [f64; 3] {
        let own = &self.trends[k];
        let change = if self.running_in[k] { own.change } else { own.line.0 };
        change.map(|c| c / own.scale)
    }
}

/// The forces over all cuts, in the order of the first cut's channels.
#[must_use]
pub fn over_time(cuts: &[SeriesCut]) -> Vec<OverTime> {
    let all: Vec<Trend> = cuts.iter().enumerate().flat_map(|(k, cut)| trends(k, cut)).collect();
    let running_in = found(all.iter().map(|t| t.run_in.map_or(1.0, |r| r.chance)));
    let trending = found(
        all.iter().zip(&running_in).map(|(t, run_in)| if *run_in { t.chance } else { t.line.1 }),
    );
    let drifting = found(
        all.iter()
            .map(|t| t.zero.map_or(1.0, |[drift, error, left]| two_sided(drift / error, left))),
    );
    let mut components: Vec<Channel> = all.iter().map(|t| t.component).collect();
    components.sort_by_key(|c| Channel::FORCES.iter().position(|other| other == c));
    components.dedup();
    components
        .into_iter()
        .map(|component| {
            let own: Vec<usize> =
                (0..all.len()).filter(|&k| all[k].component == component).collect();
            let pick = |flags: &[bool]| own.iter().map(|&k| flags[k]).collect::<Vec<bool>>();
            let mut of = OverTime {
                component,
                trends: own.iter().map(|&k| all[k].clone()).collect(),
                trending: pick(&trending),
                running_in: pick(&running_in),
                drifting: pick(&drifting),
                laws: Vec::new(),
                law: None,
                constant: None,
            };
            weigh(&mut of, cuts);
            of
        })
        .collect()
}

/// Whether anything changes within any of the cuts.
pub(super) fn is_any(cuts: &[SeriesCut]) -> bool {
    let found = over_time(cuts);
    found.iter().any(|of| of.trending.contains(&true) || of.running_in.contains(&true))
}

fn found(chances: impl Iterator<Item = f64>) -> Vec<bool> {
    benjamini_hochberg(&chances.collect::<Vec<f64>>(), FALSE_SHARE)
}

fn weigh(of: &mut OverTime, cuts: &[SeriesCut]) {
    let seen: Vec<(&SeriesCut, f64, f64)> = of
        .trends
        .iter()
        .zip(&of.running_in)
        .filter(|(_, run_in)| **run_in)
        .filter_map(|(trend, _)| {
            let [time, low, high] = trend.run_in?.time;
            // The interval is four standard deviations wide.
            Some((&cuts[trend.cut], time.ln(), ((high / low).ln() / 4.0).max(0.05)))
        })
        .collect();
    if seen.len() < FEWEST {
        return;
    }
    let constants = RunInLaw::ALL.map(|law| centre(law, &seen));
    let evidence = RunInLaw::ALL.map(|law| evidence(law, &seen));
    let most = evidence.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = evidence.iter().map(|z| (z - most).exp()).sum();
    let mut laws: Vec<(RunInLaw, f64)> = RunInLaw::ALL
        .into_iter()
        .zip(evidence)
        .map(|(law, z)| (law, (z - most).exp() / total))
        .collect();
    laws.sort_by(|a, b| b.1.total_cmp(&a.1));
    let first = laws[0];
    let apart = |other: RunInLaw| {
        let difference: Vec<f64> =
            seen.iter().map(|(cut, _, _)| first.0.place(cut) - other.place(cut)).collect();
        let mean = difference.iter().sum::<f64>() / difference.len() as f64;
        let squares: f64 =
            difference.iter().zip(&seen).map(|(d, s)| ((d - mean) / s.2.max(0.1)).powi(2)).sum();
        squares.sqrt() > TOLD_APART
    };
    let rivals = [RunInLaw::Time, RunInLaw::Length, RunInLaw::Thicknesses];
    let told = rivals.into_iter().filter(|other| *other != first.0).all(apart);
    of.law = (first.1 > CLAIM && first.0 != RunInLaw::Other && told).then_some(first.0);
    of.constant =
        RunInLaw::ALL.into_iter().position(|law| law == first.0).map(|k| constants[k].exp());
    of.laws = laws;
}

fn centre(law: RunInLaw, seen: &[(&SeriesCut, f64, f64)]) -> f64 {
    let weights = seen.iter().map(|s| s.2.powi(-2));
    let total: f64 = weights.clone().sum();
    seen.iter().zip(weights).map(|((cut, y, _), w)| w * (y - law.place(cut))).sum::<f64>() / total
}

/// The width of the prior of the constant is the same for all laws and left out.
fn evidence(law: RunInLaw, seen: &[(&SeriesCut, f64, f64)]) -> f64 {
    let scatter: &[f64] = if law == RunInLaw::Other { &[1.0] } else { &[0.05, 0.1, 0.2, 0.4] };
    let terms = scatter.iter().map(|tau| {
        let variances: Vec<f64> = seen.iter().map(|s| s.2 * s.2 + tau * tau).collect();
        let total: f64 = variances.iter().map(|v| 1.0 / v).sum();
        let values: Vec<f64> = seen.iter().map(|(cut, y, _)| y - law.place(cut)).collect();
        let mean = values.iter().zip(&variances).map(|(y, v)| y / v).sum::<f64>() / total;
        let likelihood: f64 = values
            .iter()
            .zip(&variances)
            .map(|(y, v)| -0.5 * ((y - mean).powi(2) / v + (std::f64::consts::TAU * v).ln()))
            .sum();
        likelihood + 0.5 * (std::f64::consts::TAU / total).ln()
    });
    let terms: Vec<f64> = terms.collect();
    let most = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + (terms.iter().map(|t| (t - most).exp()).sum::<f64>() / terms.len() as f64).ln()
}
