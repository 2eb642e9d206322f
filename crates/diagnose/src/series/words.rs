//! What the series say, in words.

use super::combs::{Comb, CombBase};
use super::laws::{Explanation, LineLaw};
use super::tracks::{Named, Track};
use super::{CutChange, SeriesDiagnosis};

/// What a law means for the cut.
#[must_use]
pub const fn law_title(law: LineLaw) -> &'static str {
    match law {
        LineLaw::Mains => "the mains, through the instruments",
        LineLaw::Constant => {
            "one frequency whatever the cut: a structure (workpiece, tool holder, dynamometer)"
        }
        LineLaw::Rotation => "a multiple of the rotation: run-out or form of the workpiece",
        LineLaw::Ratio => "a fixed ratio to the rotation: a bearing, gear or belt",
        LineLaw::Chip => "the chip comes in segments",
        LineLaw::Chatter => "regenerative chatter",
        LineLaw::Other => "none of these laws",
    }
}

/// What the particle solver has for it, and what it has not.
#[must_use]
pub const fn hint(law: LineLaw) -> &'static str {
    match law {
        LineLaw::Chip => {
            "A simulation without segments lacks what makes the hot shear zone lose its strength: try `[effects.tanh_softening]` or `[effects.damage]` \
             (docs/catalogue.md), with particles much smaller than the pitch"
        }
        LineLaw::Rotation => {
            "No law of the material makes it: it belongs to machine and workpiece. `[tool.run_out]` moves the tool like this if the force over time is \
             to be compared; no patch is written"
        }
        LineLaw::Chatter => {
            "A rigid tool cannot chatter: it belongs to the machine. `[tool.compliance]` lets the tool give way, but the solver cuts one pass over a flat surface, \
             so that the waves of the pass before are not there; no patch is written"
        }
        LineLaw::Constant => {
            "It belongs to structure or instrument, not to the law of the material: correct the recordings by the frequency response of the dynamometer (`response`), \
             or low-pass below it; no patch is written"
        }
        LineLaw::Mains | LineLaw::Ratio => {
            "It belongs to instruments or machine; no patch is written"
        }
        LineLaw::Other => "Nothing in the catalogue is known to make it",
    }
}

/// Hz with as many digits as count.
fn hertz(frequency: f64) -> String {
    if frequency >= 10_000.0 {
        format!("{:.2} kHz", frequency * 1e-3)
    } else if frequency >= 100.0 {
        format!("{frequency:.0} Hz")
    } else {
        format!("{frequency:.1} Hz")
    }
}

fn percent(share: f64) -> String {
    if share > 0.995 { "over 99 %".to_owned() } else { format!("{:.0} %", share * 100.0) }
}

fn counted(count: usize, name: &str) -> String {
    if count == 1 { format!("One {name}") } else { format!("{count} {name}s") }
}

/// Lowest and highest frequency of a track.
fn range(found: &SeriesDiagnosis, track: &Track) -> String {
    let all = || track.lines.iter().map(|&k| found.lines[k].frequency);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    if high < 1.01 * low {
        hertz(0.5 * (low + high))
    } else {
        format!("{} to {}", hertz(low), hertz(high))
    }
}

fn constant(explanation: &Explanation) -> String {
    let Some([value, low, high]) = explanation.constant else { return String::new() };
    match explanation.law {
        LineLaw::Chip => {
            format!(": the pitch is {value:.2} ({low:.2} to {high:.2}) of the uncut chip thickness")
        }
        LineLaw::Rotation if value < 1.5 => ": once per revolution".to_owned(),
        LineLaw::Rotation => format!(": {value:.0} times per revolution"),
        LineLaw::Ratio => format!(": {value:.3} ({low:.3} to {high:.3}) times per revolution"),
        LineLaw::Mains => format!(": {value:.0} Hz"),
        _ => String::new(),
    }
}

fn names(laws: &[LineLaw]) -> String {
    let all: Vec<&str> = laws.iter().map(|law| law_title(*law)).collect();
    match all.as_slice() {
        [head @ .., last] if !head.is_empty() => format!("{}, or {last}", head.join(", ")),
        _ => all.join(""),
    }
}

/// 1, 2, 3 and 5.
fn listed(values: &[String]) -> String {
    match values {
        [head @ .., last] if !head.is_empty() => format!("{} and {last}", head.join(", ")),
        _ => values.join(""),
    }
}

fn base_words(base: CombBase) -> String {
    match base {
        CombBase::Rotation => "the stated rotation".to_owned(),
        CombBase::Mains(f) => format!("the mains of {f:.0} Hz"),
        CombBase::Natural(f) => format!("the stated natural frequency of {}", hertz(f)),
        CombBase::Track(_) => "its frequency".to_owned(),
    }
}

/// What lines at multiples of a stated frequency say.
#[must_use]
pub fn comb_words(found: &SeriesDiagnosis, comb: &Comb) -> Vec<String> {
    let mut multiples: Vec<u32> = comb.members.iter().map(|(_, multiple)| *multiple).collect();
    multiples.dedup();
    let lines = || {
        let tracks = comb.members.iter().map(|(track, _)| &found.tracks[*track]);
        tracks.flat_map(|track| &track.lines).map(|&line| &found.lines[line])
    };
    let mut cuts: Vec<usize> = lines().map(|line| line.cut).collect();
    cuts.sort_unstable();
    cuts.dedup();
    let places: Vec<String> = multiples.iter().map(u32::to_string).collect();
    let base = base_words(comb.base);
    let place = match comb.base {
        CombBase::Natural(_) => format!("A line at {base}"),
        _ if multiples == [1] => format!("A line at {base}"),
        _ => format!("Lines at {} times {base}", listed(&places)),
    };
    let law = comb.base.law().map_or("", law_title);
    let chance = comb.chance.filter(|chance| *chance < 0.02).map_or_else(String::new, |chance| {
        let chance = if chance < 1e-3 { "less than 0.1 %".to_owned() } else { percent(chance) };
        format!(" (by chance they would lie so close with {chance})")
    });
    let seen = match (cuts.len(), found.cuts.len()) {
        (1, 1) => "in the only cut".to_owned(),
        (own, all) => format!("in {own} of {all} cuts"),
    };
    let mut words = vec![format!("{place} {seen}: {law}{chance}.")];
    if let Some(rival) = comb.rival {
        words.push(format!(
            "They lie at multiples of {} as well: these cuts cannot tell; a cut at another rotation would.",
            base_words(rival)
        ));
    }
    if let Some(law) = comb.base.law() {
        words.push(format!("{}.", hint(law)));
    }
    if !found.air.is_empty() {
        let both = lines().filter(|line| line.in_air).count();
        words.push(match (both, lines().count()) {
            (0, 1) => {
                "The free-running machine does not have it: the cut makes or excites it.".to_owned()
            }
            (0, _) => "The free-running machine does not have them: the cut makes or excites them."
                .to_owned(),
            (both, all) => {
                format!("The free-running machine has {both} of these {all} lines, too.")
            }
        });
    }
    words
}

/// Why a track is what it is said to be.
#[must_use]
pub fn track_words(found: &SeriesDiagnosis, track: &Track) -> Vec<String> {
    let cuts = track.lines.len();
    let place = format!("{} in {cuts} of {} cuts", range(found, track), found.cuts.len());
    let first = &track.explanations[0];
    let mut words = match &track.named {
        Named::Law(law) => {
            let mut words = vec![format!(
                "{place}: {}{} (probability {}).",
                law_title(*law),
                constant(first),
                percent(first.probability)
            )];
            words.push(format!("{}.", hint(*law)));
            words
        }
        Named::NotToldApart(laws) => {
            let mut words = vec![format!(
                "{place}: {}. These cuts cannot tell: over them the laws predict the same frequencies.",
                names(laws)
            )];
            words.push(advice(track));
            words
        }
        Named::Unsure => vec![format!(
            "{place}: no law has more than 90 %; the most probable is {} ({}).",
            law_title(first.law),
            percent(first.probability)
        )],
        Named::TooFewCuts => vec![format!(
            "{place}: a line in fewer than three cuts follows no law that could be named."
        )],
    };
    match track.in_air {
        Some(0) => words.push(
            "The free-running machine does not have it: the cut makes or excites it.".to_owned(),
        ),
        Some(count) if count == cuts => {
            words.push(
                "The free-running machine has it too: machine or instrument, not the cut."
                    .to_owned(),
            );
        }
        Some(count) => words.push(format!(
            "The free-running machine has it as strongly as {count} of the {cuts} cuts."
        )),
        None => {}
    }
    let same = |comb: &&Comb| matches!(comb.base, CombBase::Track(k) if std::ptr::eq(&raw const found.tracks[k], track));
    if let Some(comb) = found.combs.iter().find(same) {
        let places: Vec<String> = comb.members.iter().map(|(_, m)| m.to_string()).collect();
        words.push(format!(
            "Lines at {} times its frequency stand out, too: the wave is no sine.",
            listed(&places)
        ));
    }
    if let Some(jump) = track.jump {
        let chatter =
            matches!(track.named, Named::Law(LineLaw::Constant | LineLaw::Chatter) | Named::Unsure);
        words.push(format!(
            "Its amplitude jumps: the largest is {jump:.0} times that of the weaker cuts{}.",
            if chatter { ", as when a cut begins to chatter" } else { "" }
        ));
    }
    words
}

fn advice(track: &Track) -> String {
    let Some(advice) = &track.advice else {
        return "Cuts at two thicknesses and two speeds, with two diameters at one speed, would tell.".to_owned();
    };
    let change = match advice.change {
        CutChange::Thickness => "at the same speed",
        CutChange::Diameter => "with another diameter at the same speed",
        CutChange::Speed => "at the same diameter and thickness",
        CutChange::ThicknessAndSpeed => "at another thickness and speed",
    };
    let expected: Vec<String> = advice
        .expected
        .iter()
        .map(|(law, f)| format!("{} if {}", hertz(*f), law_title(*law)))
        .collect();
    let rotation =
        advice.revolution.map_or_else(String::new, |n| format!(", {:.0} 1/min", n * 60.0));
    format!(
        "A cut {change} would tell: at {:.0} m/min and {:.3} mm{rotation} the line would be at {}.",
        advice.cutting_speed * 60.0,
        advice.uncut_chip_thickness * 1e3,
        expected.join(", ")
    )
}

/// The verdict on frequency, in words: first what was found, then how it was tested.
#[must_use]
pub fn series_words(found: &SeriesDiagnosis) -> Vec<String> {
    let mut words = Vec::new();
    let analysed = found.cuts.len() - found.too_short.len();
    if found.lines.is_empty() {
        words.push(format!(
            "No line stands out of the broadband force in {analysed} cuts: what is in the forces over time is noise without a period."
        ));
    } else {
        let followed = found.single_tracks().filter(|(_, t)| t.named != Named::TooFewCuts).count();
        words.push(format!(
            "{} of {} stand out of the broadband force; {} over three cuts or more.",
            counted(found.lines.len(), "line"),
            if analysed == 1 { "the only cut".to_owned() } else { format!("{analysed} cuts") },
            match followed {
                0 => "none can be followed".to_owned(),
                1 => "one can be followed".to_owned(),
                more => format!("{more} can be followed"),
            }
        ));
    }
    let freedom = found.spectra.iter().flatten().map(|s| s.freedom);
    let (low, high) = (freedom.clone().fold(f64::INFINITY, f64::min), freedom.fold(0.0, f64::max));
    words.push(format!(
        "Tested: {} bins of {} at a false discovery rate of 5 %; averaged periodograms with {low:.0} to {high:.0} effective degrees of freedom.",
        found.tests,
        hertz(found.resolution),
    ));
    if let Some(rate) = found.false_alarms {
        let [low, high] = rate.interval();
        words.push(format!(
            "The same steps on white and red noise with nothing in it: a line in {} of {} sets, {:.1} % ({:.1} to {:.1} %); 5 % are allowed.",
            rate.hits,
            rate.trials,
            rate.share() * 100.0,
            low * 100.0,
            high * 100.0
        ));
    }
    words.extend(limits(found));
    words
}

/// What these recordings cannot show.
fn limits(found: &SeriesDiagnosis) -> Vec<String> {
    let mut words = Vec::new();
    let [every, any] = found.visible_pitch;
    if any > 3.0 {
        words.push(format!(
            "Segmented chips cannot be excluded: the sampling is too slow for v_c/h. Segments shorter than {any:.1} uncut chip thicknesses have frequencies beyond half \
             the sampling rate in every cut and would show at wrong places, if at all. Sample at least {:.0} times faster.",
            (any / 0.5).ceil()
        ));
    } else if every > 0.5 {
        words.push(format!(
            "Segments of chips shorter than {every:.1} uncut chip thicknesses lie beyond half the sampling rate in at least one cut."
        ));
    }
    if !found.knows_rotation {
        words.push(
            "The rotation of some cut is not stated (`workpiece_diameter` or `rotational_speed`): run-out cannot be told there, and chatter not be told from it.".to_owned(),
        );
    } else if found.cuts.iter().any(|c| c.revolution.is_some_and(|n| n < 4.0 * found.resolution)) {
        words.push(format!(
            "Revolutions follow each other more slowly than four bins in some cuts: multiples of the rotation cannot be separated there; record longer or state a `resolution` below {}.",
            hertz(found.cuts.iter().filter_map(|c| c.revolution).fold(f64::INFINITY, f64::min) / 4.0)
        ));
    }
    for (name, length) in &found.too_short {
        words.push(format!(
            "Left out: {name}, whose steady window of {length:.2} s is too short for these bins."
        ));
    }
    words
}
