//! Which runs are made, one round after the other, and what they come to.

use crate::constants::FreeConstant;
use crate::cuts::MeasuredCut;
use crate::emulator::{Emulator, Places, PriorModel};
use crate::evaluator::{CutEvaluator, QuickEvaluator};
use crate::left_out::{Foreseen, foresee, grouped, left_out, mean_error, regression};
use crate::posterior::{
    DISCREPANCIES, Discrepancy, LinearLaw, MeasuredValue, Posterior, infer, infer_without, values,
};
use crate::{CutValues, NORMAL_95, RunPoint};
use nalgebra::DVector;
use sphcut_diagnose::Change;
use sphcut_physics::{Channel, ToolGeometry};
use std::convert::Infallible;

/// How far the runs that find the changes with the constants go to either side, in standard deviations of the prior.
const REACH: f64 = 0.7;
/// And how far their middle may lie from the mean of the prior.
const CENTRE: f64 = 1.5;
/// A change of every predicted value below this ends the rounds.
const SETTLED: f64 = 0.01;
/// Standard deviation of the logarithm of a value that is wrong.
const WRONG: f64 = 0.5;
/// Logarithm of the evidence from which on a value is wrong: odds of 400, as many values are tried.
const CONVINCING: f64 = 6.0;
/// Cuts below which no value can be called wrong.
const FEWEST: usize = 4;
/// The row of the twelve-run design of Plackett and Burman (Biometrika 33 (1946) 305), turned for the other rows; one of all -1 ends it.
const DESIGN: [f64; 11] = [1.0, 1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, -1.0];

/// What is asked.
#[derive(Clone, Copy)]
pub struct CalibrationRequest<'a> {
    /// The constants with their priors.
    pub constants: &'a [FreeConstant],
    /// What was measured.
    pub cuts: &'a [MeasuredCut],
    /// Cuts that are predicted and not fitted; their measured values, if there are some, are for comparison only.
    pub held_out: &'a [MeasuredCut],
    /// The quick model.
    pub model: &'a dyn PriorModel,
    /// Most rounds of runs at the optimum.
    pub refreshes: usize,
}

/// How well values were predicted that were left out: mean absolute relative errors.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutErrors {
    /// What was left out together: `cut`, `speed`, `thickness`, `rake`, or `held out`.
    pub by: &'static str,
    /// The channel.
    pub channel: Channel,
    /// Of the constants fitted to the others.
    pub calibrated: f64,
    /// Of a regression of the others alone; `None` with too few of them.
    pub regression: Option<f64>,
    /// Of the scenario as it was with a regression of its errors.
    pub corrected: Option<f64>,
    /// Share of the values in their 95 % intervals.
    pub covered: f64,
}

/// A tool whose cuts miss those of the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContradictingTool {
    /// The tool.
    pub tool: ToolGeometry,
    /// In which channel.
    pub channel: Channel,
    /// ln of what it measures over what the constants of all cuts give.
    pub log_shift: f64,
    /// ln of the evidence with that shift over that without it.
    pub evidence: f64,
}

/// A value before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedValue {
    /// What was measured.
    pub value: MeasuredValue,
    /// ln y with the constants of the scenario.
    pub before: f64,
    /// ln y with those fitted, and its standard deviation by the constants and the runs.
    pub after: (f64, f64),
    /// Whether it was left out of the fit as wrong.
    pub wrong: bool,
    /// Predicted from the other cuts.
    pub left_out: Option<Foreseen>,
}

/// A calibration.
#[derive(Debug, Clone)]
pub struct CutCalibration {
    /// The constants with their priors.
    pub constants: Vec<FreeConstant>,
    /// What was measured.
    pub cuts: Vec<MeasuredCut>,
    /// Cuts that were held out.
    pub held_out: Vec<MeasuredCut>,
    /// The constants.
    pub posterior: Posterior,
    /// Every value.
    pub values: Vec<ComparedValue>,
    /// Errors of values that were left out.
    pub errors: Vec<LeftOutErrors>,
    /// Effects that were fitted: place of the constant, and ln of the evidence with it over that without it.
    pub effects: Vec<(usize, f64)>,
    /// Tools that contradict the others, the clearest first.
    pub contradicting: Vec<ContradictingTool>,
    /// Cuts held out: simulated with the constants, and predicted with what the other cuts say of the discrepancy. Their `cut` counts on after
    /// those that were measured.
    pub foreseen: Vec<(f64, Foreseen)>,
    /// Every run.
    pub runs: Vec<(RunPoint, CutValues)>,
}

impl CutCalibration {
    /// The cut of a value.
    #[must_use]
    pub fn cut(&self, value: &MeasuredValue) -> &MeasuredCut {
        self.cuts.get(value.cut).unwrap_or_else(|| &self.held_out[value.cut - self.cuts.len()])
    }

    /// The change of the scenario to the constants found.
    #[must_use]
    pub fn change(&self) -> Change {
        FreeConstant::change(&self.constants, self.posterior.mean.as_slice())
    }
}

/// Fits the constants with the runs of `evaluator`:
///
/// 1. every cut with the constants of the scenario;
/// 2. runs about the optimum that these and the changes of the quick model give, all constants moved at once after Plackett and Burman, one at each cut or
///    more, so that every run tells of every constant;
/// 3. half of the cuts at the new optimum, where the runs leave most open, until the predictions stay.
///
/// `None` where nothing that was measured was simulated.
///
/// # Errors
/// Those of the evaluator.
pub fn calibrate<E: CutEvaluator>(
    request: &CalibrationRequest<'_>,
    evaluator: &mut E,
) -> Result<Option<CutCalibration>, E::Error> {
    let CalibrationRequest { constants, cuts, held_out, model, .. } = *request;
    let places = Places::of(cuts.iter().map(|cut| &cut.condition));
    let stated: Vec<f64> = constants.iter().map(|c| c.coordinate(c.stated)).collect();
    let mut runs: Vec<(RunPoint, CutValues)> = Vec::new();
    let at = |t: &[f64], which: &[usize]| -> Vec<RunPoint> {
        let point = |&cut: &usize| RunPoint { condition: cuts[cut].condition, t: t.to_vec() };
        which.iter().map(point).collect()
    };
    let all: Vec<usize> = (0..cuts.len()).collect();
    make(&mut runs, evaluator, "as stated", at(&stated, &all))?;
    let Some(found) = fitted(request, &places, &runs, &stated) else { return Ok(None) };
    let centre: Vec<f64> = found.posterior.mean.iter().map(|t| t.clamp(-CENTRE, CENTRE)).collect();
    make(&mut runs, evaluator, "changes", changes(&centre, cuts))?;
    let Some(mut found) = fitted(request, &places, &runs, &centre) else { return Ok(None) };
    for refresh in 1..=request.refreshes {
        let t: Vec<f64> = found.posterior.mean.iter().copied().collect();
        let which = most_open(cuts, &found, &Emulator::new(model, &places, &runs), &t);
        make(&mut runs, evaluator, &format!("optimum {refresh}"), at(&t, &which))?;
        let Some(next) = fitted(request, &places, &runs, &t) else { return Ok(None) };
        let emulator = Emulator::new(model, &places, &runs);
        let moved = next.values.iter().map(|v| {
            let of = |at: &[f64]| emulator.log(v.channel, &cuts[v.cut].condition, at);
            (of(next.posterior.mean.as_slice()) - of(&t)).abs()
        });
        let settled = moved.fold(0.0, f64::max) < SETTLED;
        found = next;
        if settled {
            break;
        }
    }
    if !held_out.is_empty() {
        let t = found.posterior.mean.as_slice();
        let point = |cut: &MeasuredCut| RunPoint { condition: cut.condition, t: t.to_vec() };
        make(&mut runs, evaluator, "held out", held_out.iter().map(point).collect())?;
    }
    Ok(finished(request, &places, runs, found, &stated))
}

/// What a calibration would come to if the cuts were those of the quick model with the constants of the scenario: its runs, and the intervals to be
/// expected. `None` where the quick model has no answer.
#[must_use]
pub fn expected(request: &CalibrationRequest<'_>) -> Option<CutCalibration> {
    let stated: Vec<f64> = request.constants.iter().map(|c| c.coordinate(c.stated)).collect();
    let mut cuts = request.cuts.to_vec();
    for cut in &mut cuts {
        let logs = request.model.logs(&cut.condition, &stated);
        for (value, log) in cut.values.iter_mut().zip(logs) {
            *value = value.filter(|_| log.is_finite()).map(|(_, variance)| (log, variance));
        }
    }
    let request = CalibrationRequest { cuts: &cuts, ..*request };
    let Ok(found): Result<_, Infallible> = calibrate(&request, &mut QuickEvaluator(request.model));
    found
}

fn make<E: CutEvaluator>(
    runs: &mut Vec<(RunPoint, CutValues)>,
    evaluator: &mut E,
    round: &str,
    points: Vec<RunPoint>,
) -> Result<(), E::Error> {
    let values = evaluator.evaluate(round, &points)?;
    runs.extend(points.into_iter().zip(values));
    Ok(())
}

/// All constants moved at once; a run at each cut, and more than there are constants.
fn changes(centre: &[f64], cuts: &[MeasuredCut]) -> Vec<RunPoint> {
    let count = cuts.len().max(centre.len() + 2);
    let sign = |run: usize, k: usize| match run % 12 {
        11 => -1.0,
        row => DESIGN[(k + row) % 11],
    };
    let point = |run: usize| RunPoint {
        condition: cuts[run % cuts.len()].condition,
        t: centre.iter().enumerate().map(|(k, t)| t + REACH * sign(run, k)).collect(),
    };
    (0..count).map(point).collect()
}

/// Half of the cuts: those whose F_c, or whatever is known first, the runs leave most open at `t`.
fn most_open(
    cuts: &[MeasuredCut],
    found: &Fitted,
    emulator: &Emulator<'_>,
    t: &[f64],
) -> Vec<usize> {
    let open = |cut: usize| -> f64 {
        let own = found.values.iter().filter(|v| v.cut == cut);
        let of = |v: &MeasuredValue| {
            emulator.covariance(v.channel, &[&cuts[cut].condition], t)[(0, 0)] / v.variance
        };
        own.map(of).sum()
    };
    let mut order: Vec<(usize, f64)> = (0..cuts.len()).map(|cut| (cut, open(cut))).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    order.truncate(cuts.len().div_ceil(2).max(cuts.len().min(3)));
    let mut which: Vec<usize> = order.into_iter().map(|(cut, _)| cut).collect();
    which.sort_unstable();
    which
}

/// A fit to the runs so far.
struct Fitted {
    posterior: Posterior,
    /// Values that were fitted.
    values: Vec<MeasuredValue>,
    wrong: Vec<MeasuredValue>,
}

/// Fits and takes out, one after the other, values that are wrong: the evidence rises by [`CONVINCING`] when one may be wrong by
/// [`WRONG`]. At most a quarter of them.
fn fitted(
    request: &CalibrationRequest<'_>,
    places: &Places,
    runs: &[(RunPoint, CutValues)],
    start: &[f64],
) -> Option<Fitted> {
    let emulator = Emulator::new(request.model, places, runs);
    let cuts = request.cuts;
    let mut values = values(cuts, &emulator);
    let mut wrong = Vec::new();
    let most = if cuts.len() < FEWEST { 0 } else { values.len() / 4 };
    loop {
        let posterior = (!values.is_empty()).then(|| infer(start, cuts, &values, &emulator))??;
        let around = posterior.around();
        let about = (posterior.mean.as_slice(), around.as_slice());
        let law = LinearLaw::about(about, cuts, &values, &emulator);
        let plain = evidence(&law, &values, &[])?;
        let gain = |k: usize| evidence(&law, &values, &[k]).map(|e| (k, e - plain));
        let best = (0..values.len()).filter_map(gain).max_by(|a, b| a.1.total_cmp(&b.1));
        match best.filter(|(_, gain)| *gain > CONVINCING && wrong.len() < most) {
            Some((k, _)) => wrong.push(values.remove(k)),
            None => return Some(Fitted { posterior, values, wrong }),
        }
    }
}

/// ln of the mean over the discrepancies of the evidence of all values, those that are `doubted` with one error of their own in common.
fn evidence(law: &LinearLaw, values: &[MeasuredValue], doubted: &[usize]) -> Option<f64> {
    let measured = DVector::from_iterator(values.len(), values.iter().map(|v| v.log));
    let of = |discrepancy: Discrepancy| {
        let (mean, mut covariance) = law.marginal(discrepancy);
        for &i in doubted {
            for &j in doubted {
                covariance[(i, j)] += WRONG * WRONG;
            }
        }
        let known = covariance.cholesky()?;
        let rest = &measured - mean;
        let spread: f64 = known.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
        Some(-0.5 * (rest.dot(&known.solve(&rest)) + spread))
    };
    let logs: Option<Vec<f64>> = DISCREPANCIES.into_iter().map(of).collect();
    let logs = logs?;
    let best = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let all = logs.iter().zip(DISCREPANCIES);
    Some(best + all.map(|(log, d)| d.prior * (log - best).exp()).sum::<f64>().ln())
}

/// Tools whose values of a channel all miss those of the other tools by the same: as a value that is wrong is found.
fn contradictions(
    cuts: &[MeasuredCut],
    values: &[MeasuredValue],
    law: &LinearLaw,
) -> Option<Vec<ContradictingTool>> {
    let mut tools: Vec<ToolGeometry> = Vec::new();
    for value in values {
        let tool = cuts[value.cut].condition.tool;
        if !tools.contains(&tool) {
            tools.push(tool);
        }
    }
    let mut found = Vec::new();
    // Of two that contradict each other either may be the wrong one.
    if tools.len() < 2 {
        return Some(found);
    }
    let plain = evidence(law, values, &[])?;
    let measured = DVector::from_iterator(values.len(), values.iter().map(|v| v.log));
    for tool in tools {
        for channel in Channel::RECORDED {
            let is_own =
                |v: &MeasuredValue| v.channel == channel && cuts[v.cut].condition.tool == tool;
            let own: Vec<usize> = (0..values.len()).filter(|&k| is_own(&values[k])).collect();
            if own.len() < 2 {
                continue;
            }
            let gain = evidence(law, values, &own)? - plain;
            if gain > CONVINCING {
                let (mean, covariance) = law.marginal(DISCREPANCIES[0]);
                let pull = covariance.cholesky()?;
                let shift =
                    DVector::from_fn(values.len(), |k, _| if own.contains(&k) { 1.0 } else { 0.0 });
                let weighed = pull.solve(&shift);
                let precision = shift.dot(&weighed) + 1.0 / (WRONG * WRONG);
                let log_shift = weighed.dot(&(&measured - mean)) / precision;
                found.push(ContradictingTool { tool, channel, log_shift, evidence: gain });
            }
        }
    }
    found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    Some(found)
}

/// Errors of each channel, beside those of regression alone and of the scenario with its errors regressed.
fn compared_errors(
    by: &'static str,
    seen: &[Foreseen],
    rivals: [&[(MeasuredValue, f64)]; 2],
) -> Vec<LeftOutErrors> {
    let of = |channel: Channel| {
        let own: Vec<&Foreseen> = seen.iter().filter(|f| f.value.channel == channel).collect();
        let calibrated = mean_error(own.iter().map(|f| (channel, f.error())), channel)?;
        let [regression, corrected] =
            rivals.map(|rows| mean_error(rows.iter().map(|(v, e)| (v.channel, *e)), channel));
        let inside = own.iter().filter(|f| f.score().abs() < NORMAL_95).count();
        let covered = inside as f64 / own.len() as f64;
        Some(LeftOutErrors { by, channel, calibrated, regression, corrected, covered })
    };
    Channel::RECORDED.into_iter().filter_map(of).collect()
}

fn finished(
    request: &CalibrationRequest<'_>,
    places: &Places,
    runs: Vec<(RunPoint, CutValues)>,
    found: Fitted,
    stated: &[f64],
) -> Option<CutCalibration> {
    let CalibrationRequest { constants, cuts, held_out, model, .. } = *request;
    let emulator = Emulator::new(model, places, &runs);
    let Fitted { posterior, values, wrong } = found;
    let t = posterior.mean.as_slice();
    let law = LinearLaw::about((t, &posterior.around()), cuts, &values, &emulator);
    let groups: Vec<Vec<usize>> = (0..cuts.len())
        .map(|cut| (0..values.len()).filter(|&k| values[k].cut == cut).collect())
        .filter(|group: &Vec<usize>| !group.is_empty())
        .collect();
    let apart = (groups.len() > 2).then(|| left_out(&law, &values, &posterior, &groups));
    let apart = apart.flatten().unwrap_or_default();
    let compared = |value: &MeasuredValue, is_wrong: bool| {
        let condition = &cuts[value.cut].condition;
        let slopes = DVector::from_vec(emulator.slopes(value.channel, condition, t));
        let open = emulator.covariance(value.channel, &[condition], t)[(0, 0)];
        let variance = open + slopes.dot(&(&posterior.covariance * &slopes));
        ComparedValue {
            value: *value,
            before: emulator.log(value.channel, condition, stated),
            after: (emulator.log(value.channel, condition, t), variance.max(0.0).sqrt()),
            wrong: is_wrong,
            left_out: apart.iter().find(|f| f.value == *value).copied(),
        }
    };
    let mut all: Vec<ComparedValue> = values.iter().map(|v| compared(v, false)).collect();
    all.extend(wrong.iter().map(|v| compared(v, true)));
    all.sort_by_key(|c| (c.value.cut, c.value.channel));
    let base: Vec<f64> =
        values.iter().map(|v| emulator.log(v.channel, &cuts[v.cut].condition, stated)).collect();
    let mut errors = Vec::new();
    let cuts_apart = groups.len();
    let of = |get: fn(&MeasuredCut) -> f64| grouped(&values, |cut| get(&cuts[cut]));
    for (by, groups) in [
        ("cut", Some(groups.clone()).filter(|groups| groups.len() > 2)),
        ("speed", of(|cut| cut.condition.cutting_speed)),
        ("thickness", of(|cut| cut.condition.uncut_chip_thickness)),
        ("rake", of(|cut| cut.condition.tool.rake_angle.unwrap_or(0.0))),
    ] {
        let Some(groups) = groups else { continue };
        // Where every cut has a speed of its own, leaving that out leaves out the cut.
        if by != "cut" && groups.len() == cuts_apart {
            continue;
        }
        let Some(seen) = left_out(&law, &values, &posterior, &groups) else { continue };
        let rival = regression(&values, cuts, places, &groups, None);
        let corrected = regression(&values, cuts, places, &groups, Some(&base));
        errors.extend(compared_errors(by, &seen, [&rival, &corrected]));
    }
    let effects = (0..constants.len())
        .filter(|&k| constants[k].effect.is_some())
        .filter_map(|k| {
            let without = infer_without(k, stated[k], t, cuts, &values, &emulator)?;
            Some((k, posterior.evidence - without.evidence))
        })
        .collect();
    let contradicting = contradictions(cuts, &values, &law)?;
    let together: Vec<MeasuredCut> = cuts
        .iter()
        .enumerate()
        .map(|(k, cut)| {
            let mut cut = cut.clone();
            for value in wrong.iter().filter(|v| v.cut == k) {
                cut.values[value.channel.index()] = None;
            }
            cut
        })
        .chain(held_out.iter().cloned())
        .collect();
    let seen = foresee(&together, cuts.len(), &posterior, &emulator)?;
    let measured = seen.iter().filter(|f| f.value.log.is_finite());
    let held: Vec<MeasuredValue> = measured.map(|f| f.value).collect();
    if !held.is_empty() {
        let fitted = values.len();
        let all: Vec<MeasuredValue> = values.into_iter().chain(held).collect();
        let as_stated =
            |v: &MeasuredValue| emulator.log(v.channel, &together[v.cut].condition, stated);
        let base: Vec<f64> = all.iter().map(as_stated).collect();
        let group = [(fitted..all.len()).collect::<Vec<usize>>()];
        let of = |base| regression(&all, &together, places, &group, base);
        errors.extend(compared_errors("held out", &seen, [&of(None), &of(Some(&base))]));
    }
    let simulated =
        |f: &Foreseen| emulator.log(f.value.channel, &together[f.value.cut].condition, t);
    let foreseen = seen.iter().map(|f| (simulated(f), *f)).collect();
    Some(CutCalibration {
        constants: constants.to_vec(),
        cuts: cuts.to_vec(),
        held_out: held_out.to_vec(),
        posterior,
        values: all,
        errors,
        effects,
        contradicting,
        foreseen,
        runs,
    })
}
