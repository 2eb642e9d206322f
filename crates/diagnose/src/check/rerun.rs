//! The repaired scenario in the particle solver itself, at cutting conditions that the fits have not seen.

use crate::check::held_out::ratio_interval;
use crate::data::recordings::same_cut;
use crate::inference::fit::{Fit, fit};
use crate::inference::places::{AXES, scaled_places};
use crate::inference::problem::RegressionProblem;
use crate::model::paired::{Change, PairedRun, can_be_run};
use crate::model::predictor::Predictor;
use nalgebra::DVector;
use sphcut_physics::{Channel, CuttingCondition};

/// The scenario as it is, with its nuisances as fitted where nothing is missing, and with the effects and all fitted with them.
pub const STATES: usize = 3;

/// What the particle solver says of the recordings with and without the repair: mean of |log(simulated / measured)| of the same cuts
/// after gain, offset and drift of each fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Rerun {
    /// Cutting conditions that were run.
    pub conditions: usize,
    /// Each channel that was measured there.
    pub channels: Vec<RerunChannel>,
}

/// Errors of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct RerunChannel {
    /// The channel.
    pub channel: Channel,
    /// Recordings that were compared.
    pub values: usize,
    /// As it is, fitted again, repaired.
    pub errors: [f64; STATES],
    /// Repaired over fitted again, with its 95 % interval over the conditions.
    pub ratio: [f64; 3],
}

/// The share of the conditions that is left out of the fits at most: one of three.
const LEFT_OUT: usize = 3;

/// Conditions of the recordings at which to look: at most `most` and a third of all, spread over speed and thickness by always taking the one that is
/// farthest from those taken (Kennard and Stone 1969), from the fastest on.
#[must_use]
pub fn rerun_conditions(problem: &RegressionProblem, most: usize) -> Vec<CuttingCondition> {
    let places = scaled_places(problem);
    let mut left: Vec<usize> = Vec::new();
    for row in (0..problem.rows.len()).filter(|&row| problem.is_diagnosed(row)) {
        let same = |&other: &usize| same_cut(problem.condition(other), problem.condition(row));
        if !left.iter().any(same) {
            left.push(row);
        }
    }
    let apart = |a: usize, b: usize| -> f64 {
        (0..AXES).map(|k| (places[a][k] - places[b][k]).powi(2)).sum()
    };
    let most = most.min(left.len() / LEFT_OUT);
    let mut taken: Vec<usize> = Vec::new();
    while taken.len() < most {
        let worth = |row: usize| {
            let near = taken.iter().map(|&other| apart(row, other)).fold(f64::INFINITY, f64::min);
            if near.is_finite() { near } else { places[row][0] }
        };
        let place = (0..left.len())
            .max_by(|&a, &b| worth(left[a]).total_cmp(&worth(left[b])))
            .expect("some are left");
        taken.push(left.swap_remove(place));
    }
    taken.into_iter().map(|row| *problem.condition(row)).collect()
}

/// The fit in which nothing is missing and that of `repair`, without the recordings at `conditions`. `None` where a fit fails.
#[must_use]
pub fn unseen_fits(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    repair: &Fit,
    conditions: &[CuttingCondition],
) -> Option<(Fit, Fit)> {
    let is_seen = |&row: &usize| {
        let own = problem.condition(row);
        !problem.is_diagnosed(row) || !conditions.iter().any(|c| same_cut(c, own))
    };
    let kept: Vec<usize> = (0..problem.rows.len()).filter(is_seen).collect();
    let training = problem.select(&kept).ok()?;
    let start = repair.unknowns.rows(0, problem.unknowns()).into_owned();
    let null = fit(&training, predictor, &[], &start)?;
    Some((null, fit(&training, predictor, &repair.effects, &repair.unknowns)?))
}

/// What the three states change at a condition; the first goes only as far as the other two, which would else be compared with a hotter tool.
/// `None` if the scenario has no key for an effect of the repair.
#[must_use]
pub fn rerun_changes(
    problem: &RegressionProblem,
    predictor: &dyn Predictor,
    (null, repair): (&Fit, &Fit),
    condition: &CuttingCondition,
) -> Option<[Change; STATES]> {
    let changed = |fit: &Fit| fit.change(problem, predictor, condition.cut_length);
    let repaired = changed(repair);
    let runs = repaired.effects.iter().all(|(key, _)| can_be_run(key));
    runs.then(|| [Change { repeat: 1, ..Change::default() }, changed(null), repaired])
}

/// Compares what was run at each condition in the three states with the recordings there. `None` if too little was run.
#[must_use]
pub fn compare_rerun(
    problem: &RegressionProblem,
    (null, repair): (&Fit, &Fit),
    runs: &[[Option<PairedRun>; STATES]],
    seed: u64,
) -> Option<Rerun> {
    let instruments = |fit: &Fit| {
        let own = fit.unknowns.rows(problem.model_unknowns(), problem.instrument.ncols());
        &problem.instrument * own
    };
    let none = DVector::zeros(problem.rows.len());
    let shown = [none, instruments(null), instruments(repair)];
    let complete: Vec<&[Option<PairedRun>; STATES]> =
        runs.iter().filter(|own| own.iter().all(Option::is_some)).collect();
    let channels = Channel::RECORDED.into_iter().filter_map(|channel| {
        let mut errors: Vec<(usize, [f64; STATES])> = Vec::new();
        for (place, own) in complete.iter().enumerate() {
            let logs = own.each_ref().map(|run| {
                let mean = run.as_ref().and_then(|run| run.means[channel.index()]);
                mean.map_or(f64::NAN, |(mean, _)| mean.ln())
            });
            let condition = own[0].as_ref()?.condition;
            if logs.iter().any(|log| !log.is_finite()) {
                continue;
            }
            // A worn edge is that of one length cut.
            let is_worn = own.iter().flatten().any(|run| run.change.wear_land.is_some());
            for (k, row) in problem.rows.iter().enumerate() {
                let there = problem.condition(k);
                let is_there = row.channel == channel
                    && problem.is_diagnosed(k)
                    && same_cut(there, &condition)
                    && (!is_worn || there.cut_length == condition.cut_length);
                if is_there {
                    let of = |s: usize| (row.log_value - shown[s][k] - logs[s]).abs();
                    errors.push((place, [of(0), of(1), of(2)]));
                }
            }
        }
        if errors.is_empty() {
            return None;
        }
        let mean = |s: usize| errors.iter().map(|(_, e)| e[s]).sum::<f64>() / errors.len() as f64;
        let all = [mean(0), mean(1), mean(2)];
        let [low, high] = ratio_interval(errors.iter().map(|(c, e)| (*c, [e[1], e[2]])), seed);
        let ratio = [all[2] / all[1], low, high];
        Some(RerunChannel { channel, values: errors.len(), errors: all, ratio })
    });
    let channels: Vec<RerunChannel> = channels.collect();
    (!channels.is_empty()).then_some(Rerun { conditions: complete.len(), channels })
}
