//! `calibration.html` of `sphcut calibrate`: constants of flow stress and friction from measured cuts.

use crate::kit::numbers::{percent, signed_percent, three_digits, with_ends};
use crate::kit::parity::{ComparedPoint, channel_unit, parity};
use crate::kit::shell::{Shell, note, plotted, tab};
use crate::kit::table::{ColumnHead, or_dash, table};
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_calibrate::{
    CalibrationSource, ComparedValue, CutCalibration, NextCuts, cut_calibration_words, cut_name,
    standings,
};
use sphcut_physics::Channel;

/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.96;

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct CutCalibrationPage<'a> {
    /// Where it comes from.
    pub source: CalibrationSource<'a>,
    /// What was found.
    pub found: &'a CutCalibration,
    /// Further cuts, if they were asked for.
    pub next: Option<&'a NextCuts>,
}

/// The text of `calibration.html`; nothing is loaded.
#[must_use]
pub fn render_cut_calibration(page: &CutCalibrationPage<'_>) -> String {
    let CutCalibrationPage { source, found, next } = page;
    let lead = html! { (source.title) ": " (found.constants.len()) " constants from " (found.cuts.len()) " cuts ("
    (source.measured) ") with " (found.runs.len()) " runs of " (source.model) "." };
    let body = html! {
        (note("What these figures say", cut_calibration_words(found).iter().map(|words| indexed(words))))
        (constants(page))
        (cuts(found))
        (left_out(found))
        (held_out(found))
        @if let Some(next) = next { (further(next)) }
        (limits())
    };
    let title = "Constants from measured cuts";
    Shell { tab: tab(title), title, lead, version: source.version, body }.render()
}

fn constants(page: &CutCalibrationPage<'_>) -> Markup {
    let found = page.found;
    let standing = standings(found);
    let columns = [
        ColumnHead::Text("Constant"),
        ColumnHead::Number("In the scenario"),
        ColumnHead::Number("Before (95 %)"),
        ColumnHead::Number("Found (95 %)"),
        ColumnHead::Number("Interval left"),
        ColumnHead::Text(""),
    ];
    let rows = html! { @for (k, constant) in found.constants.iter().enumerate() {
        @let (scale, unit) = constant.rule.shown;
        @let ends = |t: f64, half: f64| {
            let [low, high] = constant.interval(t, half);
            with_ends([constant.value(t), low, high].map(|x| x * scale))
        };
        @let deviation = found.posterior.deviation(k);
        tr {
            th scope="row" { (indexed(constant.rule.symbol)) @if !unit.is_empty() { " in " (unit) } }
            td.n { (three_digits(constant.stated * scale)) }
            td.n { (ends(0.0, NORMAL_95)) }
            td.n { (ends(found.posterior.mean[k], NORMAL_95 * deviation)) }
            td.n { (percent(deviation)) }
            td { (standing[k].word()) }
        }
    } };
    let sets = page.source.sets;
    html! {
        section {
            h2 { "The constants" }
            (table("Before: the spread of published sets. Found: with these cuts. Interval left: standard deviation of the logarithm over that before.", columns, &rows))
            @if sets.len() > 1 {
                p { "Sets of constants behind the intervals of the flow stress, each source once:" }
                ul { @for set in sets { li { (set.name) ": " (set.source) } } }
            } @else {
                p { "Fewer than two published sets of this material are in the library: the intervals before are the general spread of published \
                     constants about those of the scenario." }
            }
            @if found.constants.iter().any(|constant| constant.is_tested) {
                p { "Tests of the material count with their own intervals and half of the general spread: they end at strains and rates far below those of a cut." }
            }
            p { "Friction and edge have their general spread about the values of the scenario." }
        }
    }
}

fn cuts(found: &CutCalibration) -> Markup {
    let channels = Channel::RECORDED.into_iter().filter_map(|channel| {
        let own: Vec<&ComparedValue> =
            found.values.iter().filter(|v| v.value.channel == channel).collect();
        (!own.is_empty()).then_some((channel, own))
    });
    html! {
        section {
            h2 { "Before and after" }
            @for (channel, own) in channels {
                @let (scale, unit) = channel_unit(channel);
                @let title = format!("{} in {unit}", channel.short_name());
                (plotted(&plot(found, &own, &title, scale), &format!("Simulated over measured {}: grey before, blue after, with the 95 % interval of the simulation.", channel.title())))
                (values(found, &own, &title, scale))
            }
        }
    }
}

fn plot(found: &CutCalibration, own: &[&ComparedValue], title: &str, scale: f64) -> String {
    let point = |v: &&ComparedValue| {
        let (log, half) = (v.after.0, NORMAL_95 * v.after.1);
        let at = |log: f64| log.exp() * scale;
        ComparedPoint {
            measured: at(v.value.log),
            before: at(v.before),
            after: at(log),
            interval: [at(log - half), at(log + half)],
            name: found.cut(&v.value).name(),
        }
    };
    let points: Vec<ComparedPoint> = own.iter().map(point).collect();
    parity(title, &points, ["before", "after"])
}

fn values(found: &CutCalibration, own: &[&ComparedValue], title: &str, scale: f64) -> Markup {
    let columns = [
        ColumnHead::Text("Cut"),
        ColumnHead::Number("Measured"),
        ColumnHead::Number("Before"),
        ColumnHead::Number("After"),
        ColumnHead::Number("From the other cuts (95 %)"),
        ColumnHead::Text(""),
    ];
    let error = |log: f64, v: &ComparedValue| signed_percent((log - v.value.log).exp_m1(), 1);
    let rows = html! { @for v in own { tr.over[v.wrong] {
        th scope="row" { (found.cut(&v.value).name()) }
        td.n { (three_digits(v.value.log.exp() * scale)) }
        td.n { (three_digits(v.before.exp() * scale)) br; (error(v.before, v)) }
        td.n { (three_digits(v.after.0.exp() * scale)) br; (error(v.after.0, v)) }
        td.n { (or_dash(v.left_out, |f| {
            let half = NORMAL_95 * f.deviation;
            with_ends([f.log, f.log - half, f.log + half].map(|x| x.exp() * scale))
        })) }
        td { @if v.wrong { "left out of the fit" } @else if v.left_out.is_some_and(|f| f.score().abs() > NORMAL_95) { "outside" } }
    } } };
    table(indexed(title), columns, &rows)
}

fn left_out(found: &CutCalibration) -> Markup {
    if found.errors.is_empty() {
        return html! { section { h2 { "Cuts left out" } p { "Three cuts are needed to leave one out." } } };
    }
    let columns = [
        ColumnHead::Text("Left out together"),
        ColumnHead::Text("Channel"),
        ColumnHead::Number("Calibrated"),
        ColumnHead::Number("Regression alone"),
        ColumnHead::Number("Scenario, its errors regressed"),
        ColumnHead::Number("In 95 % intervals"),
    ];
    let rows = html! { @for e in &found.errors { tr {
        th scope="row" { (e.by) } td { (indexed(e.channel.short_name())) }
        td.n { (percent(e.calibrated)) } td.n { (or_dash(e.regression, percent)) }
        td.n { (or_dash(e.corrected, percent)) } td.n { (percent(e.covered)) }
    } } };
    html! {
        section {
            h2 { "Cuts left out" }
            p { "Mean absolute errors of cuts held out of the fit, on the emulator made linear at the optimum: nothing is run for it; \
                 held out are the cuts of the table of its own, as they are predicted below. Beside it, on the same rows, a power law of speed and thickness (and rake or edge, where they vary) fitted to the other cuts alone, and the same of the \
                 errors of the scenario as it was." }
            (table("Errors of values left out", columns, &rows))
        }
    }
}

fn held_out(found: &CutCalibration) -> Markup {
    if found.foreseen.is_empty() {
        return html! {};
    }
    let columns = [
        ColumnHead::Text("Cut"),
        ColumnHead::Text("Channel"),
        ColumnHead::Number("Measured"),
        ColumnHead::Number("Simulated"),
        ColumnHead::Number("Predicted (95 %)"),
    ];
    let rows = html! { @for (simulated, f) in &found.foreseen {
        @let (scale, unit) = channel_unit(f.value.channel);
        @let half = NORMAL_95 * f.deviation;
        @let inside = f.score().abs() < NORMAL_95;
        tr.over[!inside] {
            th scope="row" { (found.cut(&f.value).name()) } td { (indexed(f.value.channel.short_name())) " in " (unit) }
            td.n { (three_digits(f.value.log.exp() * scale)) }
            td.n { (three_digits(simulated.exp() * scale)) br; (signed_percent((simulated - f.value.log).exp_m1(), 1)) }
            td.n { (with_ends([f.log, f.log - half, f.log + half].map(|x| x.exp() * scale))) br; (signed_percent(f.error(), 1)) }
        }
    } };
    html! {
        section {
            h2 { "Cuts held out" }
            p { "Run with the constants found. Predicted: with what the other cuts say of the discrepancy of the model. The interval is that of a measured value." }
            (table("Cuts held out", columns, &rows))
        }
    }
}

fn further(next: &NextCuts) -> Markup {
    let heads: Vec<String> =
        next.channels.iter().map(|c| format!("{} open", c.short_name())).collect();
    let columns: Vec<ColumnHead<'_>> = std::iter::once(ColumnHead::Text("Cut"))
        .chain(heads.iter().map(|head| ColumnHead::Number(head)))
        .collect();
    let row = |name: &str, open: &[f64]| {
        html! { tr {
            th scope="row" { (name) }
            @for s in open { td.n { "± " (percent(NORMAL_95 * s)) } }
        } }
    };
    let rows = html! {
        (row("as it is", &next.open))
        @for cut in &next.cuts { (row(&cut_name(&cut.condition), &cut.open)) }
    };
    html! {
        section {
            h2 { "Further cuts" }
            p { "Of " (next.candidates) " cuts that could be made, the most telling, one after the other. Open: how well all of them are predicted then, \
                 root mean square of their 95 % intervals, by the constants and by what the cuts say of the discrepancy of the model." }
            (table("Further cuts", columns, &rows))
        }
    }
}

fn limits() -> Markup {
    html! {
        section {
            h2 { "What this rests on" }
            p { "The constants have a normal prior in their logarithms. Runs teach an emulator about the closed form; noise of the cuts, scatter of the runs, what they leave open, \
                 and a discrepancy of the model whose size is weighed by its evidence are in the covariance. The interval of a constant says which value this solver wants with this \
                 resolution, friction law and heat; it is not the interval of a material test." }
            p { "A value is called wrong where the evidence rises four-hundredfold when it alone may be wrong by half." }
        }
    }
}
