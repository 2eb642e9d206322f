//! What a calibration says, in sentences.

use crate::NORMAL_95;
use crate::cuts::{cut_name, tool_name};
use crate::next::NextCuts;
use crate::session::{CutCalibration, LeftOutErrors};
use sphcut_physics::Channel;

/// Standard deviation over that of the prior below which a constant is determined, and above which it keeps its prior.
const DETERMINED: f64 = 0.5;
const OPEN: f64 = 0.85;
/// A share of a direction below which a constant is not named in it.
const NAMED: f64 = 0.35;
/// Correlation from which on two constants are known only together.
const TOGETHER: f64 = 0.7;
/// A probability that is said.
const PROBABLE: f64 = 0.9;
/// Discrepancies of F_c that are asked for; of F_f twice as much.
const MISSES: [f64; 3] = [0.16, 0.08, 0.04];
/// ln of the evidence from which on it tells (20 to 1: Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773-795), and the largest that is said.
const TELLING: f64 = 3.0;
const LARGEST: f64 = 9.21;

/// What the cuts say of a constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConstantStanding {
    /// Half of the prior's interval or less.
    Determined,
    /// Narrower than the prior.
    Narrowed,
    /// The prior's interval.
    Prior,
}

impl ConstantStanding {
    /// For people and files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Determined => "determined",
            Self::Narrowed => "narrowed",
            Self::Prior => "keeps its prior",
        }
    }
}

/// That of every constant.
#[must_use]
pub fn standings(found: &CutCalibration) -> Vec<ConstantStanding> {
    let of = |k: usize| match found.posterior.deviation(k) {
        deviation if deviation < DETERMINED => ConstantStanding::Determined,
        deviation if deviation < OPEN => ConstantStanding::Narrowed,
        _ => ConstantStanding::Prior,
    };
    (0..found.constants.len()).map(of).collect()
}

/// A number to three digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// What can be said, the answer first.
#[must_use]
pub fn cut_calibration_words(found: &CutCalibration) -> Vec<String> {
    let mut words = vec![fit_words(found)];
    words.extend(left_out_words(found));
    words.extend(wrong_words(found));
    words.extend(tool_words(found));
    words.extend(constant_words(found));
    words.extend(together_words(found));
    words.extend(effect_words(found));
    words.extend(discrepancy_words(found));
    words
}

/// Tools that no constants bring together, once for each channel.
fn tool_words(found: &CutCalibration) -> Vec<String> {
    let mut told: Vec<Channel> = Vec::new();
    let mut words = Vec::new();
    for one in &found.contradicting {
        if told.contains(&one.channel) {
            continue;
        }
        told.push(one.channel);
        let name = tool_name(&one.tool);
        words.push(format!(
            "The tool with {name} contradicts the others: its {} is {} what constants of all cuts give. Is its geometry right, is it worn, is it of another grade?",
            one.channel.short_name(),
            match one.log_shift.exp_m1() {
                x if x > 0.0 => format!("{:.0} % above", 100.0 * x),
                x => format!("{:.0} % below", -100.0 * x),
            }
        ));
    }
    words
}

/// Whether the cuts want the effects that were fitted.
fn effect_words(found: &CutCalibration) -> Vec<String> {
    let of = |&(k, evidence): &(usize, f64)| {
        let (key, title) = found.constants[k].effect?;
        let odds =
            |x: f64| if x > LARGEST { "more than 10 000".to_owned() } else { short(x.exp()) };
        Some(match evidence {
            x if x > TELLING => {
                format!("The cuts want {key} ({title}): evidence {} to 1.", odds(x))
            }
            x if x < -TELLING => {
                format!("The cuts speak against {key} ({title}): evidence 1 to {}.", odds(-x))
            }
            x => format!(
                "The cuts do not tell whether {key} acts ({title}): evidence {}, from 20 to 1 on it would count.",
                if x < 0.0 {
                    format!("1 to {}", short((-x).exp()))
                } else {
                    format!("{} to 1", short(x.exp()))
                }
            ),
        })
    };
    found.effects.iter().filter_map(of).collect()
}

/// What is to be expected before anything is computed.
#[must_use]
pub fn expected_words(found: &CutCalibration) -> Vec<String> {
    let mut words =
        vec!["Intervals to be expected (95 %), if the solver follows the cuts:".to_owned()];
    let width = found.constants.iter().map(|c| c.rule.symbol.len()).max().unwrap_or(0).max(5);
    for (k, constant) in found.constants.iter().enumerate() {
        let (scale, unit) = constant.rule.shown;
        let range = |t: f64, half: f64| {
            let [low, high] = constant.interval(t, half).map(|x| short(x * scale));
            format!("{low} to {high}")
        };
        let half = NORMAL_95 * found.posterior.deviation(k);
        words.push(format!(
            "  {:<width$} before {:<18} after {:<18} {unit}",
            constant.rule.symbol,
            range(0.0, NORMAL_95),
            range(found.posterior.mean[k], half)
        ));
    }
    words.extend(constant_words(found));
    words
}

/// The further cuts: a sentence and a line for each.
#[must_use]
pub fn next_words(next: &NextCuts) -> Vec<String> {
    let open = |open: &[f64]| -> String {
        let all = next.channels.iter().zip(open);
        let parts: Vec<String> = all
            .map(|(channel, s)| format!("{} ± {}", channel.short_name(), percent(NORMAL_95 * s)))
            .collect();
        parts.join(", ")
    };
    let mut words = vec![format!(
        "Most telling cuts of {} that could be made, one after the other, and how well all of them are then predicted (95 %):",
        next.candidates
    )];
    let first = if next.known { "as it is" } else { "without a cut" };
    words.push(format!("      {first:<32} {}", open(&next.open)));
    for (k, cut) in next.cuts.iter().enumerate() {
        words.push(format!("  {:>2}. {:<32} {}", k + 1, cut_name(&cut.condition), open(&cut.open)));
    }
    words
}

/// Root mean square of the relative errors of a channel before and after.
#[must_use]
pub(crate) fn deviations(found: &CutCalibration, channel: Channel) -> Option<[f64; 2]> {
    let own = || found.values.iter().filter(|v| v.value.channel == channel && !v.wrong);
    let count = own().count() as f64;
    (count > 0.0).then(|| {
        let of = |log: fn(&crate::ComparedValue) -> f64| {
            (own().map(|v| (log(v) - v.value.log).exp_m1().powi(2)).sum::<f64>() / count).sqrt()
        };
        [of(|v| v.before), of(|v| v.after.0)]
    })
}

fn fit_words(found: &CutCalibration) -> String {
    let parts: Vec<String> = Channel::RECORDED
        .into_iter()
        .filter_map(|channel| {
            let [before, after] = deviations(found, channel)?;
            Some(format!("{} from {} to {}", channel.short_name(), percent(before), percent(after)))
        })
        .collect();
    format!(
        "Calibrated to {} with {} runs; errors of the simulation (root mean square): {}.",
        match found.cuts.len() {
            1 => "one cut".to_owned(),
            cuts => format!("{cuts} cuts"),
        },
        found.runs.len(),
        parts.join(", ")
    )
}

fn left_out_words(found: &CutCalibration) -> Vec<String> {
    let said = |e: &LeftOutErrors| {
        let rival =
            e.regression.map_or_else(String::new, |r| format!(" (regression {})", percent(r)));
        format!("{} {}{rival}", e.channel.short_name(), percent(e.calibrated))
    };
    let by = |by: &str| -> Vec<String> {
        found.errors.iter().filter(|e| e.by == by).map(said).collect()
    };
    let mut words = Vec::new();
    for (key, what) in [
        ("cut", "Each cut predicted from the others"),
        ("speed", "All cuts of a speed predicted from the other speeds"),
        ("thickness", "All cuts of a thickness predicted from the other thicknesses"),
        ("rake", "All cuts of a rake predicted from the other rakes"),
    ] {
        let parts = by(key);
        if !parts.is_empty() {
            words.push(format!("{what}, mean absolute error: {}.", parts.join(", ")));
        }
    }
    for channel in Channel::RECORDED {
        let own: Vec<_> =
            found.foreseen.iter().filter(|(_, f)| f.value.channel == channel).collect();
        if own.is_empty() {
            continue;
        }
        let count = own.len() as f64;
        let mean = |error: &dyn Fn(&(f64, crate::Foreseen)) -> f64| {
            own.iter().map(|one| error(one).abs()).sum::<f64>() / count
        };
        let inside = own.iter().filter(|(_, f)| f.score().abs() < NORMAL_95).count();
        let rivals = found.errors.iter().find(|e| e.by == "held out" && e.channel == channel);
        let rival = |name: &str, error: Option<f64>| {
            error.map_or_else(String::new, |error| format!(", {name} {}", percent(error)))
        };
        words.push(format!(
            "{} cuts held out, {}: simulated to {}, predicted to {}{}{} (mean absolute), {inside} of {} within 95 % intervals.",
            found.held_out.len(),
            channel.short_name(),
            percent(mean(&|(log, f)| (log - f.value.log).exp_m1())),
            percent(mean(&|(_, f)| f.error())),
            rival("by regression of the fitted cuts", rivals.and_then(|e| e.regression)),
            rival("by the scenario with its errors regressed", rivals.and_then(|e| e.corrected)),
            own.len()
        ));
    }
    words
}

fn wrong_words(found: &CutCalibration) -> Vec<String> {
    let all = found.values.iter().filter(|v| v.wrong);
    all.map(|v| {
        let cut = found.cut(&v.value);
        let lines: Vec<String> = cut.lines.iter().map(ToString::to_string).collect();
        format!(
            "{} of line {} ({}) is {:+.0} % of what the other cuts lead to expect: left out of the fit. Check it.",
            v.value.channel.short_name(),
            lines.join(", "),
            cut.name(),
            100.0 * (v.value.log - v.after.0).exp_m1()
        )
    })
    .collect()
}

fn constant_words(found: &CutCalibration) -> Vec<String> {
    let standing = standings(found);
    let named = |wanted: ConstantStanding| {
        let all = found.constants.iter().zip(&standing).filter(|(_, s)| **s == wanted);
        all.map(|(c, _)| c.rule.symbol).collect::<Vec<&str>>().join(", ")
    };
    let mut words = Vec::new();
    let determined = named(ConstantStanding::Determined);
    if determined.is_empty() {
        words.push("No constant is determined alone: its interval is more than half of what it was before.".to_owned());
    } else if !missed(found).is_empty() {
        words.push(format!(
            "{determined}: narrowed to half of the prior or less, but these cuts follow no constants: what the model lacks is in them."
        ));
    } else {
        words.push(format!("These cuts determine {determined}."));
    }
    let open = named(ConstantStanding::Prior);
    if !open.is_empty() {
        words.push(format!(
            "{open}: not identifiable from these cuts; the interval is about that of the prior."
        ));
    }
    words
}

/// Constants that are known together and not alone, from the directions of the posterior: those whose variance fell most.
fn together_words(found: &CutCalibration) -> Vec<String> {
    let covariance = &found.posterior.covariance;
    let count = found.constants.len();
    let mut words = Vec::new();
    for i in 0..count {
        for j in 0..i {
            let correlation = covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
            if correlation.abs() > TOGETHER {
                let [a, b] = [j, i].map(|k| found.constants[k].rule.symbol);
                let how = if correlation < 0.0 { "less" } else { "more" };
                words.push(format!(
                    "{a} and {b} only together: with more {a} the cuts want {how} {b}."
                ));
            }
        }
    }
    let eigen = covariance.clone().symmetric_eigen();
    let Some(best) =
        (0..count).min_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]))
    else {
        return words;
    };
    let direction = eigen.eigenvectors.column(best);
    let mut parts: Vec<(usize, f64)> =
        (0..count).map(|k| (k, direction[k])).filter(|(_, x)| x.abs() > NAMED).collect();
    parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    if parts.len() > 1 {
        let lead = parts[0].1.signum();
        let names: Vec<String> = parts
            .iter()
            .map(|(k, x)| {
                let word = if x * lead > 0.0 { "more" } else { "less" };
                format!("{word} {}", found.constants[*k].rule.symbol)
            })
            .collect();
        words.push(format!(
            "Best known is a combination, {} together: its interval is {:.0} % of what it was before.",
            names.join(", "),
            100.0 * eigen.eigenvalues[best].max(0.0).sqrt()
        ));
    }
    words
}

/// The forces that the model probably misses, whatever the constants, with the probability.
fn missed(found: &CutCalibration) -> Vec<(Channel, f64)> {
    let of = |(channel, times): (Channel, f64)| {
        let probability = |share: f64| found.posterior.misses(channel, times * share);
        let is_fitted = found.values.iter().any(|v| v.value.channel == channel);
        let most = MISSES.into_iter().map(probability).find(|p| *p > PROBABLE);
        most.filter(|_| is_fitted).map(|p| (channel, p))
    };
    [(Channel::CuttingForce, 1.0), (Channel::FeedForce, 2.0)].into_iter().filter_map(of).collect()
}

fn discrepancy_words(found: &CutCalibration) -> Vec<String> {
    let by = |channel: Channel| {
        let share = percent(found.posterior.discrepancy(channel));
        format!("{share} of {}", channel.symbol())
    };
    let missed = missed(found);
    if let Some(probability) = missed.iter().map(|(_, p)| *p).reduce(f64::max) {
        let all: Vec<String> = missed.iter().map(|(channel, _)| by(*channel)).collect();
        return vec![format!(
            "No constants follow these cuts: the model misses about {} beside all noise (probability {:.0} %). The intervals hold that; \
             `sphcut diagnose` looks for the missing physics.",
            all.join(" and "),
            100.0 * probability
        )];
    }
    let has = |channel: Channel| found.values.iter().any(|v| v.value.channel == channel);
    let forces = [Channel::CuttingForce, Channel::FeedForce].into_iter().filter(|c| has(*c));
    let all: Vec<String> = forces.map(by).collect();
    if all.is_empty() {
        return Vec::new();
    }
    vec![format!(
        "A discrepancy of the model of {} is in the intervals (root mean square over its probabilities).",
        all.join(" and ")
    )]
}
