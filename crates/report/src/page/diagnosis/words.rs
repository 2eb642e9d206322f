//! The verdict in plain words.

use super::DiagnosisPage;
use super::set::{self, SET, ranked};
use crate::kit::numbers::{
    percent, percent_whole, plain, three_digits, with_ends, with_known_ends,
};
use crate::kit::text::listed;
use sphcut_diagnose::{
    BiasOrigin, ClaimVerdict, Competitor, Fit, HeldOutErrors, Nuisance, ParameterEstimate, Part,
    Rate, RelationError, Rerun, RerunChannel,
};
use sphcut_physics::{Channel, PUBLISHED_SPREAD};

/// A pattern in words.
pub(super) fn pattern(pattern: &str) -> &str {
    match pattern {
        "v" => "a slope over the cutting speed",
        "h" => "a slope over the uncut chip thickness",
        "v^2" => "a curvature over the cutting speed",
        "h^2" => "a curvature over the uncut chip thickness",
        "v h" => "an interaction of speed and thickness",
        "low v, low h" => "slow cuts of thin chips",
        "high v, low h" => "fast cuts of thin chips",
        "low v, high h" => "slow cuts of thick chips",
        "high v, high h" => "fast cuts of thick chips",
        "order" => "a slope over the order of the cuts",
        "cut length" => "a slope over the length that the edge has cut",
        "rake" => "a slope over the rake",
        "v rake" => "an interaction of speed and rake",
        "h rake" => "an interaction of thickness and rake",
        "edge radius" => "a slope over the edge radius",
        "v edge radius" => "an interaction of speed and edge radius",
        "h edge radius" => "an interaction of thickness and edge radius",
        other => other,
    }
}

pub(super) fn part(part: Part) -> &'static str {
    match part {
        Part::Blocks => "quarters of the range of speed and thickness, in turn",
        Part::HighestSpeed => "the highest speeds (beyond the rest)",
        Part::ThinnestChip => "the thinnest chips (beyond the rest)",
        Part::UnfittedChannel => "each channel in turn, which then nothing is fitted to",
        Part::Tools => "the tools of each rake and edge radius, one after the other",
    }
}

pub(super) fn competitor(competitor: Competitor) -> String {
    match competitor {
        Competitor::RunnerUp => "the runner-up explanation".to_owned(),
        Competitor::Regression(method) => format!("the best regression ({})", method.name()),
    }
}

/// What the particle solver says of the correction: channel by channel better, worse, or not decided.
fn in_the_solver(rerun: &Rerun) -> String {
    let standing = |one: &RerunChannel| {
        let [_, low, high] = one.ratio;
        if high < 1.0 { 0 } else { 1 + usize::from(low <= 1.0) }
    };
    let parts = ["better in", "worse in", "not decided in"].into_iter().enumerate();
    let parts: Vec<String> = parts
        .filter_map(|(k, what)| {
            let own = rerun.channels.iter().filter(|one| standing(one) == k);
            let own: Vec<String> = own
                .map(|one| {
                    let [_, recalibrated, corrected] = one.errors.map(error);
                    let ratio = with_ends(one.ratio);
                    let title = one.channel.title();
                    format!("{title} ({corrected} instead of {recalibrated}, ratio {ratio})")
                })
                .collect();
            (!own.is_empty()).then(|| format!("{what} {}", listed(&own)))
        })
        .collect();
    format!(
        "In the particle solver, at {} of the conditions, the corrected scenario against the one recalibrated without the effect is {}.",
        rerun.conditions,
        parts.join("; ")
    )
}

/// A mean error of the logarithm: where it is small it is a share, where it is large a factor.
pub(super) fn error(log: f64) -> String {
    if log < 0.3 { percent(log) } else { format!("a factor of {}", three_digits(log.exp())) }
}

pub(super) fn family(key: &str) -> &str {
    match key {
        "rate_size" => "rate and size",
        "instrument" => "machine and instrument",
        other => other,
    }
}

/// `2.5 % (0.8 % to 5.8 %)`.
pub(super) fn rate(rate: Rate) -> String {
    let [low, high] = rate.interval();
    format!(
        "{} of {}: {} (95 % interval {} to {})",
        rate.hits,
        rate.trials,
        percent(rate.share()),
        percent(low),
        percent(high)
    )
}

/// How many simulated recordings do not count; empty if all do.
pub(super) fn unanswered(asked: usize, counted: Rate) -> String {
    match asked - counted.trials {
        0 => String::new(),
        lost => format!(
            "; {lost} of the {asked} asked for do not count, because the model has no answer for them"
        ),
    }
}

/// Scale and unit for people.
pub(super) fn shown(unit: &str, value: f64) -> (f64, &str) {
    match unit {
        "m" if value.abs() < 1e-3 => (1e6, "\u{b5}m"),
        "m" => (1e3, "mm"),
        "Pa" => (1e-6, "MPa"),
        "rad" => (180.0 / std::f64::consts::PI, "\u{b0}"),
        other => (1.0, other),
    }
}

/// `r_n = 39.1 µm (35.2 to 42.9)`.
pub(super) fn estimate(page: &DiagnosisPage<'_>, estimate: &ParameterEstimate) -> String {
    let parameter = &page.predictor.effects()[estimate.effect].parameters[estimate.parameter];
    let (scale, unit) = shown(parameter.unit, estimate.interval[1]);
    let [low, high] = estimate.interval;
    let text = with_known_ends([estimate.value, low, high].map(|x| x * scale));
    let blank = if unit.is_empty() { "" } else { " " };
    format!("{} = {}", parameter.symbol, text.replacen(" (", &format!("{blank}{unit} ("), 1))
}

pub(super) fn parameters(page: &DiagnosisPage<'_>, fit: &Fit) -> Vec<String> {
    sizes(page, &page.diagnosis.estimates(page.predictor, fit))
}

pub(super) fn sizes(page: &DiagnosisPage<'_>, estimates: &[ParameterEstimate]) -> Vec<String> {
    estimates.iter().map(|e| estimate(page, e)).collect()
}

/// An effect of a set in words; `None`: one that is not among the candidates.
pub(super) fn title(page: &DiagnosisPage<'_>, effect: Option<usize>) -> String {
    effect.map_or("an unmodelled effect", |k| page.predictor.effects()[k].title).to_owned()
}

/// `0.12 rad (7°)`, `30 %`.
pub(super) fn relation_error(error: &RelationError) -> String {
    let (scale, unit) = shown(error.unit, error.deviation);
    if error.unit.is_empty() {
        return percent_whole(error.deviation);
    }
    format!("{} {} ({:.0}{unit})", plain(error.deviation), error.unit, scale * error.deviation)
}

/// What the terminal shows, a line per entry: the verdict, the ranking of its set where there is one, and all else that can be said.
#[must_use]
pub fn diagnosis_text(page: &DiagnosisPage<'_>) -> Vec<String> {
    let mut lines = sentences(page);
    let ranked = ranked(page);
    if !ranked.is_empty() {
        let rows = ranked.iter().enumerate().map(|(k, row)| {
            let size = if row.size.is_empty() { String::new() } else { format!(": {}", row.size) };
            format!("{:>4}  {:>6}  {}{size}", k + 1, row.probability, row.title)
        });
        lines.splice(1..1, [format!("  {SET}")].into_iter().chain(rows));
    }
    lines
}

/// What can be said, one entry per thought.
pub(super) fn sentences(page: &DiagnosisPage<'_>) -> Vec<String> {
    let mut words = vec![verdict(page)];
    words.extend(whereabouts(page));
    words.extend(page.diagnosis.help.first().map(|held| help(page, held)));
    words.extend(page.diagnosis.rerun.as_ref().map(in_the_solver));
    if let Some(found) = page.diagnosis.false_alarms {
        let alarm = if page.diagnosis.finding.is_alarm() { "this design" } else { "an alarm" };
        words.push(format!(
            "Of simulated recordings with this design and this noise, without a missing effect, {} raised an alarm: the false-alarm rate of {alarm}{}.",
            rate(found),
            unanswered(page.diagnosis.asked[0], found)
        ));
    }
    if let Some(bias) = page.diagnosis.bias {
        let why = match bias.origin {
            BiasOrigin::Stated => Some("as stated"),
            BiasOrigin::Compared if page.predictor.relations().is_empty() => {
                Some("as comparisons with measured cuts have it")
            }
            BiasOrigin::Compared => Some(
                "as its comparisons with measured cuts have it, and besides in its shear angle, contact length, edge force and \
                 temperatures, which change several channels together",
            ),
            BiasOrigin::Reference | BiasOrigin::Difference | BiasOrigin::AnotherBatch => None,
        };
        words.extend(why.map(|why| {
            format!(
                "The model is taken to be wrong by up to {} by itself, smoothly over speed and thickness, {why}: what is claimed lies beyond that.",
                percent(bias.amplitude)
            )
        }));
    }
    if !page.diagnosis.setups.is_empty() {
        let each = page.diagnosis.setups.iter();
        let each = each.map(|s| format!("{} ({})", percent(s.deviation), s.channel.title()));
        words.push(format!(
            "Neighbouring conditions differ by {} more than repeats of one condition do: repeats that are cut one after the other show too little. That \
             scatter counts as noise.",
            listed(&each.collect::<Vec<_>>())
        ));
    }
    let unknown = &page.diagnosis.attribution.unknown;
    if !unknown.is_empty() {
        let titles = unknown.iter().map(|&k| page.predictor.effects()[k].title.to_owned());
        words.push(format!(
            "At some of these conditions the model has no answer for {}: no explanation here. Without those cuts it could be one.",
            listed(&titles.map(|title| format!("\u{201c}{title}\u{201d}")).collect::<Vec<_>>())
        ));
    }
    let has_reference = page
        .diagnosis
        .bias
        .is_some_and(|bias| matches!(bias.origin, BiasOrigin::Reference | BiasOrigin::Difference));
    if !has_reference && page.diagnosis.finding.is_alarm() {
        words.push(
            "There are no reference cuts: what the model itself gets wrong looks like missing physics too. Cuts without a missing effect (fresh edge, \
             known radius) would distinguish the two."
                .to_owned(),
        );
    }
    if !has_reference && has_published_constants(page) {
        words.push(
            "The constants of material and friction count as published ones, which differ from set to set by 25 to 60 %. Sizes of effects hang on them: of blind cuts \
             of other constants, explained by paired runs, three of ten lay beside their intervals. Constants that sphcut calibrate has fitted to \
             this material, with what is left of the doubt in [priors], let weaker effects be seen."
                .to_owned(),
        );
    }
    let untestable = page.diagnosis.finding.untestable.len();
    if untestable > 0 {
        words.push(format!(
            "{untestable} of {} effects are not identifiable with these data: that none of them was found says nothing.",
            page.predictor.effects().len()
        ));
    }
    words
}

/// Whether no constant is known better than published sets agree.
fn has_published_constants(page: &DiagnosisPage<'_>) -> bool {
    let nuisances = page.predictor.nuisances();
    let is_wide = |own: &Nuisance| PUBLISHED_SPREAD.contains(&(own.key, own.deviation));
    !nuisances.is_empty() && nuisances.iter().all(is_wide)
}

fn verdict(page: &DiagnosisPage<'_>) -> String {
    let finding = &page.diagnosis.finding;
    let titles =
        |list: &[usize]| -> Vec<String> { list.iter().map(|&k| title(page, Some(k))).collect() };
    match &finding.verdict {
        ClaimVerdict::NoAlarm => format!(
            "No effect is shown to be missing: material, friction and instruments explain these data within what they may differ by (posterior probability of the null hypothesis: {}).",
            percent(finding.nothing)
        ),
        ClaimVerdict::Named(named) => {
            let fit = page.diagnosis.repair.map(|k| &page.diagnosis.fits[k]);
            let values = fit.map_or_else(Vec::new, |fit| parameters(page, fit));
            let probable = named.iter().map(|&k| finding.inclusion[k]).fold(1.0, f64::min);
            format!(
                "An effect is missing in the simulation: {} (posterior probability {}). Its size: {}.",
                listed(&titles(named)),
                percent(probable),
                listed(&values)
            )
        }
        ClaimVerdict::OneOf => {
            let family = finding.family().map_or_else(String::new, |name| {
                format!(" Its family is known: {}.", family(name))
            });
            let leading = finding
                .leading
                .as_ref()
                .filter(|leading| leading.asked.is_some() || leading.leaves_pattern());
            let stands_in = leading.map_or_else(String::new, |leading| {
                let quoted = |name: String| format!("\u{201c}{name}\u{201d}");
                let effects: Vec<String> = titles(&leading.effects).into_iter().map(quoted).collect();
                let effects = listed(&effects);
                let (is, explains, they) = if leading.effects.len() > 1 {
                    ("are", "explain", "they")
                } else {
                    ("is", "explains", "it")
                };
                let share = format!("{explains} {} of what {they} and a smooth residual explain together", percent(leading.explained));
                match leading.asked {
                    Some(asked) => format!(
                        " {effects} {is} not named: {they} {share} (at this probability {} are asked for), and may stand in for another effect.",
                        percent(asked)
                    ),
                    None => format!(" The most probable, {effects}, {share}: it may stand in for an effect that is no candidate."),
                }
            });
            let which = set::named(page);
            format!(
                "An effect is missing, but these data do not distinguish which: {which}.{family}{stands_in}"
            )
        }
        ClaimVerdict::NoneOfThese => {
            let failed: Vec<String> = finding
                .gates
                .iter()
                .filter(|gate| !gate.passed)
                .map(|gate| gate.channel.title().to_owned())
                .collect();
            let best = (0..finding.inclusion.len())
                .max_by(|&a, &b| finding.inclusion[a].total_cmp(&finding.inclusion[b]));
            if let (true, Some(best)) = (failed.is_empty() && finding.none_of_these <= 0.5, best) {
                return format!(
                    "Probably an unmodelled effect: a smooth difference without a candidate has a posterior probability of {}, the most probable candidate, \
                     \u{201c}{}\u{201d}, {}; of blind cases with such a probability eight of ten had an effect that is no candidate. No patch is \
                     written; the maps show where it acts.",
                    percent(finding.none_of_these),
                    page.predictor.effects()[best].title,
                    percent(finding.inclusion[best])
                );
            }
            let why = if failed.is_empty() {
                format!(
                    "a smooth difference without a candidate explains the data better (posterior probability {})",
                    percent(finding.none_of_these)
                )
            } else {
                format!("the best of them does not follow the {}", listed(&failed))
            };
            format!(
                "An unmodelled effect: none of the candidates explains the data: {why}. No patch is written; the maps show where it acts."
            )
        }
    }
}

fn whereabouts(page: &DiagnosisPage<'_>) -> Option<String> {
    let found: Vec<_> = page.diagnosis.location.contrasts.iter().filter(|c| c.discovered).collect();
    let first = found.first()?;
    let direction = if first.score > 0.0 { "above" } else { "below" };
    let channels: Vec<Channel> = page.diagnosis.problem.channels();
    let touched = channels.iter().filter(|c| found.iter().any(|f| f.channel == **c));
    let names: Vec<String> = touched.map(|c| c.title().to_owned()).collect();
    Some(format!(
        "Residual pattern: {} significant, in the {}. The strongest is {} of the {} ({} standard deviations {direction} the model).",
        found.len(),
        listed(&names),
        pattern(first.pattern),
        first.channel.title(),
        three_digits(first.score.abs())
    ))
}

fn help(page: &DiagnosisPage<'_>, held: &HeldOutErrors) -> String {
    let unbeaten;
    let how = if held.ratio[2] < 1.0 {
        match held.unbeaten() {
            None => {
                "the correction improves the prediction, beyond the runner-up explanation and the best regression, too"
            }
            Some(competitor) => {
                unbeaten = format!(
                    "better than recalibration, but not beyond {}, so that this is no evidence for the explanation",
                    self::competitor(competitor)
                );
                &unbeaten
            }
        }
    } else if held.ratio[1] > 1.0 {
        "the correction makes it worse"
    } else {
        "the improvement is not significant"
    };
    let state = match page.diagnosis.finding.verdict {
        ClaimVerdict::OneOf => "with the most probable of the set",
        _ => "with the correction",
    };
    format!(
        "On held-out conditions the mean error is {} as simulated, {} with material and friction recalibrated, {} {state}: {how} (ratio to the recalibrated baseline {}, 95 % interval {} to {}).",
        error(held.before),
        error(held.refitted),
        error(held.repaired),
        three_digits(held.ratio[0]),
        three_digits(held.ratio[1]),
        three_digits(held.ratio[2])
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_error_of_the_logarithm_is_a_factor() {
        assert_eq!(error(0.0416), "4.2 %");
        assert_eq!(error(1.66), "a factor of 5.26");
    }
}
