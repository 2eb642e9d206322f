//! What changes within the cuts, in words.

use super::SeriesDiagnosis;
use super::time::{OverTime, RunInLaw};

/// A share with its sign.
fn share(value: f64) -> String {
    format!("{:+.1} %", value * 100.0).replace('-', "\u{2212}")
}

fn of_cuts(hits: usize, all: usize) -> String {
    match (hits, all) {
        (1, 1) => "the only cut".to_owned(),
        _ if hits == all => format!("all {all} cuts"),
        _ => format!("{hits} of {all} cuts"),
    }
}

/// The verdict on time, in words.
#[must_use]
pub fn time_words(found: &SeriesDiagnosis) -> Vec<String> {
    let mut words: Vec<String> = found.time.iter().flat_map(|of| force_words(found, of)).collect();
    if found.time.is_empty() {
        words.push("No cut is long enough to tell whether the force changes within it: a hundred correlation times and ten revolutions are needed.".to_owned());
    }
    words.extend(found.growth.iter().map(|growth| {
        let [value, low, high] = growth.per_cut;
        let verdict = if growth.chance < 0.05 {
            "the edge wears, or the gain drifts: what stays between cuts is no heat of the cut"
        } else {
            "no growth from cut to cut beyond chance"
        };
        format!(
            "{} changes by {} ({} to {}) from each cut to the next under the same conditions: {verdict}.",
            growth.component.symbol(), share(value), share(low), share(high)
        )
    }));
    if let Some(rate) = found.time_false_alarms {
        let [low, high] = rate.interval();
        words.push(format!(
            "The same steps on noise without a trend: a trend or run-in in {} of {} sets, {:.1} % ({:.1} to {:.1} %); 10 % are allowed, 5 % for each.",
            rate.hits,
            rate.trials,
            rate.share() * 100.0,
            low * 100.0,
            high * 100.0
        ));
    }
    words
}

fn force_words(found: &SeriesDiagnosis, of: &OverTime) -> Vec<String> {
    let name = of.component.symbol();
    let all = of.trends.len();
    let mut words = vec![trend(of, name, all)];
    let zeros: Vec<f64> = of
        .trends
        .iter()
        .zip(&of.drifting)
        .filter(|(_, drifting)| **drifting)
        .filter_map(|(t, _)| Some(t.zero?[0] / t.scale))
        .collect();
    if !zeros.is_empty() {
        let largest =
            zeros.iter().copied().fold(0.0, |a: f64, z| if z.abs() > a.abs() { z } else { a });
        words.push(format!(
            "The zero of {name} moves from the air before to the air after {}, by {} of the force at most: the instrument. A straight line of it is taken out.",
            if zeros.len() == 1 { "one cut".to_owned() } else { of_cuts(zeros.len(), all) },
            share(largest)
        ));
    }
    let count = of.running_in.iter().filter(|r| **r).count();
    if count > 0 {
        words.push(run_in(found, of, name, count));
    }
    words
}

fn trend(of: &OverTime, name: &str, all: usize) -> String {
    let hits: Vec<usize> = (0..all).filter(|&k| of.trending[k]).collect();
    let possible = (0..all).map(|k| {
        let [_, low, high] = of.change(k);
        low.abs().max(high.abs())
    });
    if hits.is_empty() {
        return format!(
            "{name} has no trend within the cuts beyond chance; a change over the cut of more than {:.1} % is excluded in all of them.",
            possible.fold(0.0, f64::max) * 100.0
        );
    }
    let rising = hits.iter().filter(|&&k| of.change(k)[0] > 0.0).count();
    let changes = || hits.iter().map(|&k| of.change(k)[0]);
    let (low, high) =
        (changes().fold(f64::INFINITY, f64::min), changes().fold(f64::NEG_INFINITY, f64::max));
    let span =
        if hits.len() == 1 { share(low) } else { format!("{} to {}", share(low), share(high)) };
    let one_sided = hits.iter().any(|&k| of.trends[k].zero.is_none());
    let drifts = hits.iter().filter(|&&k| {
        of.drifting[k]
            && of.trends[k]
                .zero
                .is_some_and(|z| z[0].abs() > of.trends[k].scale * of.change(k)[0].abs())
    });
    let reason = if hits.len() == 1 && all > 2 {
        "One cut alone says little: one in twenty discoveries is expected to be false. Repeat it"
    } else if one_sided {
        "There is air on one side only: a drifting zero cannot be told from wear or heat. Record the air before and after the cut"
    } else if 2 * drifts.count() > hits.len() {
        "The zero moved further than that from the air before to the air after: an instrument that does not drift evenly explains it"
    } else if rising == hits.len() {
        "The zero does not explain it: it grows with the time in cut, as with wear or built-up material; a tool that only becomes warm makes forces fall"
    } else if rising == 0 {
        "The zero does not explain it: it falls with the time in cut, as where tool and workpiece become warm"
    } else {
        "It rises in some cuts and falls in others: no single cause"
    };
    format!(
        "{name} changes over the cut by {span} of itself in {}. {reason}.",
        of_cuts(hits.len(), all)
    )
}

fn run_in(found: &SeriesDiagnosis, of: &OverTime, name: &str, count: usize) -> String {
    let own = || of.trends.iter().zip(&of.running_in).filter(|(_, r)| **r).map(|(t, _)| t);
    let amplitude = |t: &super::Trend| t.run_in.map_or(0.0, |r| r.amplitude / t.scale);
    let low = own().map(amplitude).fold(f64::INFINITY, f64::min);
    let high = own().map(amplitude).fold(f64::NEG_INFINITY, f64::max);
    let lengths =
        || own().filter_map(|t| Some(t.run_in?.time[0] * found.cuts[t.cut].cutting_speed));
    let (short, long) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max));
    let law = match (of.law, of.constant) {
        (Some(RunInLaw::Time), Some(constant)) => format!(
            "In all of them it takes the same time, {:.0} ms: an instrument that follows slowly, or a machine that gives way ([tool.compliance])",
            constant * 1e3
        ),
        (Some(RunInLaw::Length), Some(constant)) => format!(
            "In all of them it takes the same length of cut, {:.0} mm: the edge beds in or warms; no dynamics of the machine and no instrument",
            constant * 1e3
        ),
        (Some(RunInLaw::Thicknesses), Some(constant)) => format!(
            "In all of them it takes the same number of uncut chip thicknesses, {constant:.0}: the chip and its contact build up, which a simulation of that length shows"
        ),
        _ if of.laws.is_empty() => "In fewer than three cuts it follows no law that could be named".to_owned(),
        _ => "Whether it takes a time, a length or a number of thicknesses these cuts cannot tell: vary speed and thickness by more, independently".to_owned(),
    };
    format!(
        "{name} runs in at the beginning of {}: it starts {} to {} beyond its level and comes within 1/e after {:.0} to {:.0} mm of cut. {law}.",
        of_cuts(count, of.trends.len()),
        share(low),
        share(high),
        short * 1e3,
        long * 1e3
    )
}
