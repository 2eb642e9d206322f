//! Which further cuts would tell most.

use crate::constants::FreeConstant;
use crate::cuts::{MeasuredCut, noise_of, same};
use crate::emulator::{Emulator, Places, PriorModel};
use crate::posterior::{DISCREPANCIES, LinearLaw, MeasuredValue};
use crate::session::CutCalibration;
use nalgebra::{DMatrix, DVector};
use sphcut_physics::{Channel, CuttingCondition};

/// Speeds and thicknesses of the grid that stands for cuts that nobody named.
const GRID: usize = 6;

/// What is asked.
#[derive(Clone, Copy)]
pub struct NextRequest<'a> {
    /// The constants with their priors.
    pub constants: &'a [FreeConstant],
    /// The calibration so far; `None` before a cut is made.
    pub known: Option<&'a CutCalibration>,
    /// Cuts that could be made, and that the simulation is wanted for.
    pub candidates: &'a [CuttingCondition],
    /// The quick model.
    pub model: &'a dyn PriorModel,
    /// Noise of a value as a share, where it is stated.
    pub noise: Option<f64>,
    /// How many are wanted.
    pub count: usize,
}

/// A further cut.
#[derive(Debug, Clone, PartialEq)]
pub struct NextCut {
    /// Its condition.
    pub condition: CuttingCondition,
    /// What is open once it and those before it are made: as [`NextCuts::open`].
    pub open: Vec<f64>,
}

/// Further cuts, the most telling first.
#[derive(Debug, Clone, PartialEq)]
pub struct NextCuts {
    /// Channels that would be measured.
    pub channels: Vec<Channel>,
    /// Root mean square over all candidates of the standard deviation of ln y, by channel: what the cuts so far leave open.
    pub open: Vec<f64>,
    /// Whether cuts were measured before.
    pub known: bool,
    /// Number of candidates.
    pub candidates: usize,
    /// The cuts.
    pub cuts: Vec<NextCut>,
}

/// A grid over the speeds and thicknesses of `cuts` in equal ratios, with each of their tools.
#[must_use]
pub fn grid(cuts: &[MeasuredCut]) -> Vec<CuttingCondition> {
    // Three digits in the units that machines are set in.
    let along = |of: fn(&CuttingCondition) -> f64, scale: f64| -> Vec<f64> {
        let all = || cuts.iter().map(|cut| of(&cut.condition) * scale);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        let count = if high > low { GRID } else { 1 };
        let last = (count - 1).max(1) as f64;
        let at = |k: usize| three_digits(low * (high / low).powf(k as f64 / last)) / scale;
        (0..count).map(at).collect()
    };
    let mut tools: Vec<_> = Vec::new();
    for cut in cuts {
        if !tools.contains(&cut.condition.tool) {
            tools.push(cut.condition.tool);
        }
    }
    let speeds = along(|c| c.cutting_speed, 60.0);
    let thicknesses = along(|c| c.uncut_chip_thickness, 1e3);
    let mut all = Vec::new();
    for tool in tools {
        for &speed in &speeds {
            let at = |&h: &f64| CuttingCondition { tool, ..CuttingCondition::new(speed, h) };
            all.extend(thicknesses.iter().map(at));
        }
    }
    all
}

/// The decimal number of three digits nearest to `value`.
fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// The `count` candidates that leave least open, one after the other.
///
/// ```text
/// K_a = J J' + S + a^2 D   over the values of all candidates, given the values measured
/// cut c lowers it by K_a[:, c] (K_a[c, c] + N)^-1 K_a[c, :]
/// wanted: least   sum_a p_a sum_channels ln tr K_a,channel
/// ```
///
/// J: changes with the constants, which have the unit law of their prior; S: what the runs so far leave open; D_a: a discrepancy of the model
/// with the probability p_a; N: noise. So a cut tells by the constants, and by what it says of the
/// discrepancy in its neighbourhood. Candidates like a measured cut are left out. `None` if a covariance cannot be inverted.
///
/// Source: greedy minimisation of the mean prediction variance (V-optimality: Atkinson, Donev, Tobias, Optimum Experimental Designs (2007), chapter 10).
#[must_use]
pub fn next_cuts(request: &NextRequest<'_>) -> Option<NextCuts> {
    let NextRequest { constants, known, candidates, model, noise, count } = *request;
    let measured: &[MeasuredCut] = known.map_or(&[], |found| &found.cuts);
    let channels: Vec<Channel> = match known {
        None => vec![Channel::CuttingForce, Channel::FeedForce],
        Some(_) => Channel::RECORDED
            .into_iter()
            .filter(|c| measured.iter().any(|cut| cut.values[c.index()].is_some()))
            .collect(),
    };
    let is_new = |c: &&CuttingCondition| !measured.iter().any(|cut| same(&cut.condition, c));
    let candidates: Vec<CuttingCondition> = candidates.iter().filter(is_new).copied().collect();
    let mut cuts = measured.to_vec();
    for condition in &candidates {
        let values = std::array::from_fn(|k| {
            let own = channels.iter().any(|c| c.index() == k);
            own.then(|| (0.0, noise_of(measured, k, noise)))
        });
        cuts.push(MeasuredCut { condition: *condition, lines: Vec::new(), values });
    }
    let wrong = |cut: usize, channel: Channel| {
        let of = |v: &&crate::ComparedValue| v.value.cut == cut && v.value.channel == channel;
        known.is_some_and(|found| found.values.iter().find(of).is_none_or(|v| v.wrong))
    };
    let mut values: Vec<MeasuredValue> = Vec::new();
    for (cut, own) in cuts.iter().enumerate() {
        for &channel in &channels {
            let Some((log, variance)) = own.values[channel.index()] else { continue };
            if cut >= measured.len() || !wrong(cut, channel) {
                values.push(MeasuredValue { cut, channel, log, variance });
            }
        }
    }
    let stated: Vec<f64> = constants.iter().map(|c| c.coordinate(c.stated)).collect();
    let t = known.map_or(stated, |found| found.posterior.mean.iter().copied().collect());
    let around =
        known.map_or_else(|| vec![DVector::from_vec(t.clone())], |found| found.posterior.around());
    let of_places = if measured.is_empty() { &cuts } else { measured };
    let places = Places::of(of_places.iter().map(|cut| &cut.condition));
    let runs = known.map_or(&[][..], |found| &found.runs);
    let emulator = Emulator::new(model, &places, runs);
    let law = LinearLaw::about((&t, &around), &cuts, &values, &emulator);
    let weights: Vec<f64> = known.map_or_else(
        || DISCREPANCIES.iter().map(|d| d.prior).collect(),
        |found| found.posterior.weights.clone(),
    );
    let first = values.iter().filter(|v| v.cut < measured.len()).count();
    let mut left = Vec::new();
    for discrepancy in DISCREPANCIES {
        let mut covariance = law.marginal(discrepancy).1;
        for (k, value) in values.iter().enumerate() {
            covariance[(k, k)] -= value.variance;
        }
        let told: Vec<usize> = (0..first).collect();
        lower(&mut covariance, &told, &values)?;
        left.push(covariance);
    }
    let of_channel: Vec<Vec<usize>> = channels
        .iter()
        .map(|c| (first..values.len()).filter(|&k| values[k].channel == *c).collect())
        .collect();
    let open = |left: &[DMatrix<f64>]| -> Vec<f64> {
        let mean = |own: &Vec<usize>| {
            let of = |k: &DMatrix<f64>| own.iter().map(|&i| k[(i, i)]).sum::<f64>();
            let sum: f64 = left.iter().zip(&weights).map(|(k, weight)| weight * of(k)).sum();
            (sum / own.len().max(1) as f64).max(0.0).sqrt()
        };
        of_channel.iter().map(mean).collect()
    };
    let mut found = NextCuts {
        channels,
        open: open(&left),
        known: known.is_some(),
        candidates: candidates.len(),
        cuts: Vec::new(),
    };
    let mut rest: Vec<usize> = (measured.len()..cuts.len()).collect();
    while found.cuts.len() < count && !rest.is_empty() {
        let score = |cut: usize| -> Option<f64> {
            let own: Vec<usize> = (first..values.len()).filter(|&k| values[k].cut == cut).collect();
            let mut sum = 0.0;
            for (covariance, weight) in left.iter().zip(&weights) {
                let told = gains(covariance, &own, &values)?;
                for of in &of_channel {
                    let trace: f64 = of.iter().map(|&k| covariance[(k, k)] - told[k]).sum();
                    sum += weight * trace.max(f64::MIN_POSITIVE).ln();
                }
            }
            Some(sum)
        };
        let scores: Option<Vec<f64>> = rest.iter().map(|&cut| score(cut)).collect();
        let scores = scores?;
        // The first of equals: the order of the candidates decides.
        let best = (0..rest.len()).min_by(|&a, &b| scores[a].total_cmp(&scores[b]))?;
        let cut = rest.remove(best);
        let own: Vec<usize> = (first..values.len()).filter(|&k| values[k].cut == cut).collect();
        for covariance in &mut left {
            lower(covariance, &own, &values)?;
        }
        found.cuts.push(NextCut { condition: cuts[cut].condition, open: open(&left) });
    }
    Some(found)
}

/// By how much each variance falls when the values `told` are measured.
fn gains(covariance: &DMatrix<f64>, told: &[usize], values: &[MeasuredValue]) -> Option<Vec<f64>> {
    let (toward, inner) = parts(covariance, told, values);
    let solved = inner.cholesky()?.solve(&toward);
    Some((0..values.len()).map(|k| toward.column(k).dot(&solved.column(k))).collect())
}

/// The covariance once the values `told` are measured.
fn lower(covariance: &mut DMatrix<f64>, told: &[usize], values: &[MeasuredValue]) -> Option<()> {
    if told.is_empty() {
        return Some(());
    }
    let (toward, inner) = parts(covariance, told, values);
    *covariance -= toward.tr_mul(&inner.cholesky()?.solve(&toward));
    Some(())
}

/// Rows of the values `told`, and their own covariance with noise.
fn parts(
    covariance: &DMatrix<f64>,
    told: &[usize],
    values: &[MeasuredValue],
) -> (DMatrix<f64>, DMatrix<f64>) {
    let inner = DMatrix::from_fn(told.len(), told.len(), |i, j| {
        let noise = if i == j { values[told[i]].variance } else { 0.0 };
        covariance[(told[i], told[j])] + noise
    });
    (covariance.select_rows(told), inner)
}
