//! `diagnosis.html`: which physics a simulation left out.

mod compared;
mod pictures;
mod series;
mod set;
mod size;
mod time;
mod words;

pub use pictures::SimulatedPair;
pub use series::{SeriesPage, render_series, series_summary};
pub use words::diagnosis_text;

use crate::kit::map::{ColourScale, Map, ValueAt};
use crate::kit::numbers::{
    M_PER_MIN, MM, UM, minus, percent, signed, signed_percent, three_digits, with_ends,
};
use crate::kit::shell::{self, Shell, plain, plotted, tab, verdict_above};
use crate::kit::table::ColumnHead::{Number, Text};
use crate::kit::table::{NONE, table};
use crate::kit::text::{indexed, listed};
use maud::{Markup, html};
use sphcut_diagnose::series::SeriesDiagnosis;
use sphcut_diagnose::{
    BiasOrigin, ChannelNoise, ClaimVerdict, Diagnosis, DiagnosisProvenance, Hypothesis, MapPoint,
    NoiseSource, Predictor, Recordings, Rerun, Scored,
};
use sphcut_greybox::{Hull, Input};
use words::{
    error, family, parameters, part, pattern, rate, relation_error, sentences, shown, unanswered,
};

/// Explanations that are shown.
const MOST_EXPLANATIONS: usize = 10;
/// Patterns that are shown.
const MOST_PATTERNS: usize = 12;

/// What the page shows.
#[derive(Clone, Copy)]
pub struct DiagnosisPage<'a> {
    /// Where it comes from.
    pub provenance: DiagnosisProvenance<'a>,
    /// What was found.
    pub diagnosis: &'a Diagnosis,
    /// What was measured.
    pub recordings: &'a Recordings,
    /// The model that explains.
    pub predictor: &'a dyn Predictor,
    /// Forces over time.
    pub series: Option<&'a SeriesDiagnosis>,
    /// Cuts as simulated and corrected, from the runs that confirm the correction.
    pub pairs: &'a [SimulatedPair],
}

/// The text of `diagnosis.html`; nothing is loaded.
#[must_use]
pub fn render_diagnosis(page: &DiagnosisPage<'_>) -> String {
    let provenance = &page.provenance;
    let lead = html! {
        (page.recordings.all().len()) " recordings, explained with " (provenance.model) "; " (provenance.source) "."
    };
    let sentences = sentences(page);
    let alarm = page.diagnosis.finding.is_alarm();
    let body = html! {
        (verdict_above(alarm, &sentences, plain, &set::ranking(page)))
        (compared::section(page))
        (where_it_is(page))
        (what_it_is(page))
        @if let Some(series) = page.series {
            section {
                h2 { "Forces over time" }
                (series::list(series))
            }
            (series::sections(series))
        }
        (repair(page))
        (does_it_help(page))
        (pictures::section(page))
        (trust(page))
        (next(page))
        (method(page))
        (next_steps(page))
    };
    let title = format!("What is missing: {}", provenance.title);
    Shell { tab: tab(&title), title: &title, lead, version: provenance.version, body }.render()
}

fn where_it_is(page: &DiagnosisPage<'_>) -> Markup {
    let location = &page.diagnosis.location;
    let size = location.maps.iter().flat_map(|(_, points)| points).map(|p| p.score.abs());
    let size = size.fold(4.0, f64::max);
    let sites = &page.diagnosis.problem.sites;
    let tools_differ = sites.iter().any(|site| site.condition.tool != sites[0].condition.tool);
    html! {
        section {
            h2 { "Residual pattern" }
            p { "The residual after material, friction and instruments have been fitted, in standard deviations: what noise does not \
                explain. Beyond \u{b1}3 is rare under the null hypothesis at a single place. A place is evidence, not an explanation: the fit moves an effect to where it \
                cannot follow it."
                @if tools_differ { " A place on the maps is the mean over the tools that cut there; what differs between them is among the patterns." } }
            div.pair { @for (channel, points) in &location.maps {
                (plotted(&score_map(page, points, size, channel.title()),
                    &format!("{}: measured above the model is red, below is blue. Dots: recordings.", channel.title())))
            } }
            p { "The same in size: measured less recalibrated, the mean of the recordings around each place (a window of 15 % of the range), as it is and in per cent of the \
                recalibrated value. It shows where the fit gives way, with or without evidence." }
            div.pair { @for (channel, _) in &location.maps { @for (around, unit) in size::sizes(page, *channel) {
                (plotted(&map(page, (channel.title(), unit), around.largest(), &|place| around.mean(place)),
                    &format!("{}: measured less recalibrated, in {unit}.", channel.title())))
            } } }
            (table("Patterns of the residual. A discovery survives Benjamini and Hochberg: of all discoveries one in twenty is expected to be false.",
                [Text("Channel"), Text("Pattern"), Number("Standard deviations"), Text("Discovery")],
                &html! { @for contrast in location.contrasts.iter().take(MOST_PATTERNS) { tr {
                    th scope="row" { (contrast.channel.title()) } td { (pattern(contrast.pattern)) }
                    td.n { (signed(contrast.score, 1)) }
                    td { @if contrast.discovered { "yes" } @else { "no" } }
                } } }))
        }
    }
}

/// A map of the scores, interpolated between its points.
fn score_map(page: &DiagnosisPage<'_>, points: &[MapPoint], size: f64, title: &str) -> String {
    let shape = page.diagnosis.location.shape;
    map(page, (title, "standard deviations"), size, &|input| interpolated(points, shape, input))
}

fn map(
    page: &DiagnosisPage<'_>,
    (title, quantity): (&str, &str),
    size: f64,
    surface: &dyn Fn(Input) -> f64,
) -> String {
    let problem = &page.diagnosis.problem;
    let inputs: Vec<Input> = problem
        .sites
        .iter()
        .filter(|site| site.diagnosed)
        .map(|site| [site.condition.cutting_speed, site.condition.uncut_chip_thickness])
        .collect();
    let hull = Hull::around(&inputs);
    Map {
        title: title.to_owned(),
        description: format!(
            "Residual of the {title} over cutting speed and uncut chip thickness in {quantity}"
        ),
        quantity: quantity.to_owned(),
        colours: ColourScale::around_zero([size].into_iter()),
        hull: &hull,
        inputs: &inputs,
        surface: Some(&surface),
        points: inputs.iter().map(|&at| ValueAt { at, value: surface(at), link: None }).collect(),
    }
    .svg()
}

/// Bilinear in the logarithms of v_c and h; the border goes on outside.
fn interpolated(points: &[MapPoint], [columns, rows]: [usize; 2], [v, h]: Input) -> f64 {
    let (first, last) = (points[0], points[points.len() - 1]);
    let place = |x: f64, low: f64, high: f64, count: usize| {
        let share = if high > low { (x / low).ln() / (high / low).ln() } else { 0.0 };
        (share * (count - 1) as f64).clamp(0.0, (count - 1) as f64)
    };
    let x = place(v, first.cutting_speed, last.cutting_speed, columns);
    let y = place(h, first.uncut_chip_thickness, last.uncut_chip_thickness, rows);
    let (i, j) = ((x as usize).min(columns - 2), (y as usize).min(rows - 2));
    let (s, t) = (x - i as f64, y - j as f64);
    let at = |i: usize, j: usize| points[j * columns + i].score;
    (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j))
        + t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1))
}

fn titles(page: &DiagnosisPage<'_>, scored: &Scored) -> String {
    match &scored.hypothesis {
        Hypothesis::Nothing => "null hypothesis: no effect is missing".to_owned(),
        Hypothesis::NoneOfThese => {
            "unmodelled effect: smooth, and not among the candidates".to_owned()
        }
        Hypothesis::Effects(list) => {
            let names: Vec<String> =
                list.iter().map(|&k| page.predictor.effects()[k].title.to_owned()).collect();
            names.join(" + ")
        }
    }
}

fn what_it_is(page: &DiagnosisPage<'_>) -> Markup {
    let found = page.diagnosis;
    let finding = &found.finding;
    let effects = page.predictor.effects();
    html! {
        section {
            h2 { "Candidate effects" }
            (table("The most probable explanations. Under each of them material, friction and instruments are fitted anew. An alarm needs \
                    a posterior probability of the null hypothesis below 5 %; a named effect one above 90 %, or 60 % where it explains nearly all (friction over temperature, which others look like, above 90 % alone).",
                [Text("Explanation"), Number("Posterior probability"), Text("Most probable size (95 % interval)")],
                &html! { @for scored in found.attribution.scored.iter().take(MOST_EXPLANATIONS) { tr {
                    th scope="row" { (titles(page, scored)) }
                    td.n { (percent(scored.probability)) }
                    td { @if let Some(fit) = found.fits.iter().find(|fit| fit.effects == scored.hypothesis.effects()) {
                        (indexed(&parameters(page, fit).join("; ")))
                    } }
                } } }))
            @if finding.is_alarm() && !finding.families.is_empty() {
                p { "By family: " (listed(&finding.families.iter().map(|(name, p)| format!("{} {}", family(name), percent(*p))).collect::<Vec<_>>())) "." }
            }
            (table("Every candidate: the posterior probability that it is missing in the simulation, and by how much \u{3c7}\u{b2} would fall on average if it were missing \
                    at a typical strength and were put in. Below 6 it is not identifiable with these data.",
                [Text("Effect"), Text("Family"), Number("Probability"), Number("Expected fall of \u{3c7}\u{b2}"), Text("Identifiable")],
                &html! { @for (k, effect) in effects.iter().enumerate() { tr {
                    th scope="row" { (effect.title) } td { (family(effect.family)) }
                    td.n { (percent(finding.inclusion[k])) }
                    td.n { (three_digits(found.attribution.expected_gains[k])) }
                    td { @if found.attribution.is_testable(k) { "yes" } @else { "not with these data" } }
                } } }))
        }
    }
}

fn repair(page: &DiagnosisPage<'_>) -> Markup {
    let found = page.diagnosis;
    let repaired = found.repair.map(|k| &found.fits[k]);
    let factors = |unknowns| found.problem.nuisances(unknowns, 0);
    let null = factors(&found.null.unknowns);
    let after = repaired.map(|fit| factors(&fit.unknowns));
    let factor = |log: f64| signed_percent(log.exp_m1(), 1);
    html! {
        section {
            h2 { "Correction" }
            @match &found.finding.verdict {
                ClaimVerdict::Named(_) => p { "The file scenario.patch.toml beside this page has the effect, its parameters with intervals, and the keys of the \
                    scenario that have it, with the properties fitted together with it: \"sphcut run SCENARIO --patch scenario.patch.toml\" runs them. "
                    @if found.rerun.is_some() { "What a patch from fits without the recordings compared gives in the particle solver stands below; it is in the folder of these runs." }
                    @else { "The patched scenario has not been run in the particle solver." } },
                sphcut_diagnose::ClaimVerdict::OneOf => p { "No patch is written: the effects of the set are not distinguishable with these data. Their sizes stand above; the cuts that would distinguish them stand below." },
                sphcut_diagnose::ClaimVerdict::NoneOfThese => p { "No patch is written: no candidate explains the data." },
                sphcut_diagnose::ClaimVerdict::NoAlarm => p { "No correction is needed." },
            }
            div.scroll { table {
                caption { "What the fit changes of material and friction. A value far beyond its scatter compensates for an effect that is missing." }
                thead { tr {
                    th scope="col" { "Quantity" } th.n scope="col" { "Scatter assumed" } th.n scope="col" { "Recalibrated baseline" }
                    @if after.is_some() { th.n scope="col" { "With the correction" } }
                } }
                tbody { @for (k, nuisance) in page.predictor.nuisances().iter().enumerate() { tr {
                    th scope="row" { code { (nuisance.key) } }
                    td.n { (percent(nuisance.deviation)) }
                    td.n { (factor(null[k])) }
                    @if let Some(after) = &after { td.n { (factor(after[k])) } }
                } } }
            } }
        }
    }
}

fn does_it_help(page: &DiagnosisPage<'_>) -> Markup {
    let help = &page.diagnosis.help;
    html! {
        section {
            h2 { "Held-out validation" }
            @if let [first, ..] = help.as_slice() {
                div.scroll { table {
                    caption { "Mean error (of the logarithm: a share, or a factor where it is large) on held-out recordings. Grey box: the scenario \
                        as it is, corrected by regression of its error over speed and thickness; its settings were searched with the left-out recordings in view, which favours it." }
                    thead { tr {
                        th scope="col" { "Left out" } th.n scope="col" { "Values" } th.n scope="col" { "As simulated" }
                        th.n scope="col" { "Recalibrated baseline" } th.n scope="col" { "Corrected" }
                        th.n scope="col" { "Corrected / recalibrated" }
                        @for (method, _) in &first.grey_box { th.n scope="col" { "Grey box: " (method.name()) } }
                    } }
                    tbody { @for held in help { tr {
                        th scope="row" { (part(held.part)) } td.n { (held.values) }
                        td.n { (error(held.before)) } td.n { (error(held.refitted)) } td.n { (error(held.repaired)) }
                        td.n { (with_ends(held.ratio)) }
                        @for (_, log) in &held.grey_box { td.n { (error(*log)) } }
                        @for _ in held.grey_box.len()..first.grey_box.len() { td.n { (NONE) } }
                    } } }
                } }
                (table("The correction improves the prediction only where the whole 95 % intervals of the ratios to the recalibrated baseline, to the \
                    runner-up explanation and to the best regression all lie below 1: most wrong explanations, too, predict better than recalibration.",
                    [Text("Left out"), Text("Corrected over"), Number("Ratio"), Text("Better")],
                    &html! { @for held in help { @for (competitor, ratio) in &held.competitors { tr {
                        th scope="row" { (part(held.part)) } td { (words::competitor(*competitor)) }
                        td.n { (with_ends(*ratio)) } td { @if ratio[2] < 1.0 { "yes" } @else { "no" } }
                    } } } }))
                (table("The same by channel. A channel to which nothing was fitted is predicted only if the others show the missing effect, too.",
                [Text("Left out"), Text("Channel"), Number("Recalibrated baseline"), Number("Corrected"), Number("Corrected / recalibrated")],
                &html! { @for held in help { @for (channel, [refitted, repaired]) in &held.channels { tr {
                        th scope="row" { (part(held.part)) } td { (channel.title()) }
                        td.n { (error(*refitted)) } td.n { (error(*repaired)) } td.n { (three_digits(repaired / refitted)) }
                    } } } }))
            } @else {
                p { "There is no correction to validate." }
            }
            @if let Some(rerun) = &page.diagnosis.rerun { (in_the_solver(rerun)) }
        }
    }
}

fn in_the_solver(rerun: &Rerun) -> Markup {
    html! {
        (table(html! { "The scenario itself, run again in the particle solver at " (rerun.conditions) " of the recorded conditions: as it is, with material and friction \
                recalibrated, and with the correction. Mean error over the recordings there, which were held out of both fits; the corners of speed and thickness are \
                among them: for those the fits look beyond the rest." },
                [Text("Channel"), Number("Values"), Number("As simulated"), Number("Recalibrated baseline"), Number("Corrected"), Number("Corrected / recalibrated")],
                &html! { @for one in &rerun.channels { tr {
                th scope="row" { (one.channel.title()) } td.n { (one.values) }
                @for log in one.errors { td.n { (error(log)) } }
                td.n { (with_ends(one.ratio)) }
            } } }))
    }
}

fn trust(page: &DiagnosisPage<'_>) -> Markup {
    let found = page.diagnosis;
    let names = |list: &[usize]| -> String {
        listed(
            &list.iter().map(|&k| page.predictor.effects()[k].title.to_owned()).collect::<Vec<_>>(),
        )
    };
    html! {
        section {
            h2 { "Limits" }
            table { tbody {
                @if let Some(alarms) = found.false_alarms { tr {
                    th scope="row" { "False alarms in simulated recordings without a missing effect" } td { (rate(alarms)) (unanswered(found.asked[0], alarms)) }
                } }
                @if let Some(control) = &found.control {
                    tr { th scope="row" { "Alarms where \u{201c}" (names(&control.effects)) "\u{201d} was put in at the size found" } td { (rate(control.alarms)) (unanswered(found.asked[1], control.alarms)) } }
                    tr { th scope="row" { "\u{2026} named, and nothing else" } td { (rate(control.named)) } }
                    tr { th scope="row" { "\u{2026} in the 95 % set" } td { (rate(control.in_set)) } }
                }
                @for noise in page.recordings.noise() { tr {
                    th scope="row" { "Noise of a single " (noise.channel.title()) }
                    td { (percent(noise.deviation)) ", " (origin(noise)) }
                } }
                @for setup in &found.setups { tr {
                    th scope="row" { "Scatter of the " (setup.channel.title()) " between conditions" }
                    td { (percent(setup.deviation)) " beyond that of repeats; counted as noise" }
                } }
                @for gate in &found.finding.gates { tr.over[!gate.passed] {
                    th scope="row" { "Best explanation and " (gate.channel.title()) }
                    td { "\u{3c7}\u{b2} = " (three_digits(gate.chi_square)) " for " (format!("{:.0}", gate.freedom)) " values (p-value " (percent(gate.chance)) ")"
                        @if !gate.passed { ": not followed" } }
                } }
                @if let Some(bias) = found.bias { tr {
                    th scope="row" { "Bias of the model, in the channel where it is largest" }
                    td { (self::bias(bias)) }
                } }
            } }
            @let relations = found.relation_errors(page.predictor);
            @if !relations.is_empty() {
                (table("Errors that relations of the model are allowed besides, each in all channels that it changes: standard deviations, a share being one of \
                        the logarithm. Half of the variance is the same at all conditions, the rest changes smoothly over them.",
                    [Text("Relation"), Number("Standard deviation"), Text("Why")],
                    &html! { @for error in &relations { tr {
                        th scope="row" { (error.title) } td.n { (relation_error(error)) } td { (error.reason) }
                    } } }))
            }
        }
    }
}

fn bias(bias: sphcut_diagnose::Bias) -> String {
    let size = || {
        format!("{}, changing over {} of the range", percent(bias.amplitude), percent(bias.length))
    };
    match bias.origin {
        BiasOrigin::AnotherBatch => format!("{}, from batch to batch", size()),
        BiasOrigin::Reference => format!("{}, by the reference cuts", size()),
        BiasOrigin::Stated => format!("{}, as stated", size()),
        BiasOrigin::Compared => {
            format!("{}, by comparisons of the model with measured cuts", size())
        }
        BiasOrigin::Difference => {
            "cancelled: only the difference of the two states counts".to_owned()
        }
    }
}

fn origin(noise: &ChannelNoise) -> String {
    match noise.source {
        NoiseSource::Stated => "as stated".to_owned(),
        NoiseSource::Repeats => {
            let [constant, share] = noise.parts;
            let (scale, unit) = shown(noise.channel.unit(), constant);
            let size = three_digits(scale * constant);
            let law = match (constant > 0.0, share > 0.0) {
                (false, _) => String::new(),
                (true, false) => format!("{size} {unit} whatever the value, "),
                (true, true) => {
                    format!("{size} {unit} whatever the value and {} of it, ", percent(share))
                }
            };
            format!("{law}from repeats ({:.0} degrees of freedom)", noise.freedom)
        }
    }
}

fn next(page: &DiagnosisPage<'_>) -> Markup {
    let proposal = &page.diagnosis.next;
    let cuts = proposal.iter().flat_map(|next| &next.conditions);
    let has_rake = cuts.clone().any(|cut| cut.tool.rake_angle.is_some());
    let has_edge = cuts.clone().any(|cut| cut.tool.edge_radius.is_some());
    html! {
        section {
            h2 { "Next experiment" }
            @if let Some(next) = proposal {
                p { "The cuts on which the explanations that are left differ most. The probability of the right one among them is "
                    (percent(next.expected[0])) " now and is expected to be " (percent(next.expected[1])) " after these cuts." }
                div.scroll { table {
                    thead { tr {
                        th scope="col" { "Cut" } th.n scope="col" { "v_c in m/min" } th.n scope="col" { "h in mm" }
                        @if has_rake { th.n scope="col" { "Rake in \u{b0}" } }
                        @if has_edge { th.n scope="col" { "Edge radius in \u{b5}m" } }
                    } }
                    tbody { @for (k, cut) in next.conditions.iter().enumerate() { tr {
                        th scope="row" { (k + 1) }
                        td.n { (three_digits(cut.cutting_speed * M_PER_MIN)) } td.n { (three_digits(cut.uncut_chip_thickness * MM)) }
                        @if let Some(rake) = cut.tool.rake_angle { td.n { (minus(&three_digits(rake.to_degrees()))) } }
                        @if let Some(radius) = cut.tool.edge_radius { td.n { (three_digits(radius * UM)) } }
                    } } }
                } }
                @if !next.with_channel.is_empty() {
                    p { "With one more channel measured on these cuts (to 3 %): "
                        (listed(&next.with_channel.iter().map(|(channel, p)| format!("{} {}", channel.title(), percent(*p))).collect::<Vec<_>>())) "." }
                }
            } @else {
                p { "One explanation is left; no cut would change that." }
            }
        }
    }
}

/// Commands, and the pages of the runs that explain.
fn next_steps(page: &DiagnosisPage<'_>) -> Markup {
    let named = matches!(page.diagnosis.finding.verdict, ClaimVerdict::Named(_));
    let patched = ("sphcut run SCENARIO --patch scenario.patch.toml", "cuts with what was missing");
    let measured = (
        "sphcut predict --diagnosis FOLDER --conditions FILE",
        "corrected forces with intervals at other cuts",
    );
    let steps = if named { vec![patched, measured] } else { vec![measured] };
    html! {
        (shell::next(&steps))
        @if page.diagnosis.rerun.is_some() {
            p { a href="runs/repaired/sweep.html" { "Runs of the corrected scenario" } }
        }
    }
}

fn method(page: &DiagnosisPage<'_>) -> Markup {
    html! {
        section {
            h2 { "Method" }
            p { "Every explanation is fitted together with the scatter of material, friction and instruments, and weighed by its evidence; \
                a pair of effects has to earn its second one. \u{201c}Unmodelled effect\u{201d} is a smooth difference of 1 to 8 % without a candidate. \
                docs/diagnosis_method.md has formulas, sources and limits; diagnosis.json has every number. Seed " (page.provenance.seed) "." }
        }
    }
}
