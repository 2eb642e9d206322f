//! What changes within the cuts, on the page of a diagnosis.

use crate::kit::chart::{Chart, ChartLine};
use crate::kit::colours::DISTINCT;
use crate::kit::numbers::{percent_whole, signed, signed_percent, three_digits, with_interval};
use crate::kit::shell::figure;
use crate::kit::table::{ColumnHead, table};
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_diagnose::series::{OverTime, RunInLaw, SeriesDiagnosis};
use sphcut_physics::Channel;

/// Points of a drawn force.
const POINTS: usize = 160;
/// Cuts that are drawn in one chart.
const MOST_CUTS: usize = 6;
/// The section on time.
pub(super) fn section(found: &SeriesDiagnosis) -> Markup {
    html! {
        section {
            h2 { "Where in time" }
            p { "Blocks of the force, each longer than five correlation times and of whole revolutions, against a line and a run-in over the cut. The zero is taken out by a straight line "
                "through the air before and after the cut." }
            @for of in &found.time { (one_force(found, of)) }
        }
    }
}

fn one_force(found: &SeriesDiagnosis, of: &OverTime) -> Markup {
    let name = of.component.symbol();
    let columns = [
        ColumnHead::Text("Cut"),
        ColumnHead::Number("Mean in N"),
        ColumnHead::Number("Independent samples"),
        ColumnHead::Number("Change over the cut"),
        ColumnHead::Text("Trend"),
        ColumnHead::Number("Last third less first, N"),
        ColumnHead::Number("Zero moves, N"),
        ColumnHead::Text("Run-in (time to 1/e)"),
    ];
    let rows = html! { @for k in 0..of.trends.len() { (row(found, of, k)) } };
    let laws = html! { @for (law, probability) in &of.laws { tr {
        th scope="row" { (title(*law)) } td.n { (percent_whole(*probability)) }
    } } };
    html! {
        h3 { (indexed(name)) " over the cuts" }
        (figure(chart(found, of).svg(), "Moving mean of the force over its mean, from entry to exit."))
        (table("Change over the cut as a share of the force, run-in apart, with its 95 % interval. Discoveries survive Benjamini and Hochberg at 5 % over all cuts and forces.", columns, &rows))
        @if !of.laws.is_empty() {
            (table("What the time of the run-in goes with.", [ColumnHead::Text("It is"), ColumnHead::Number("Probability")], &laws))
        }
    }
}

fn row(found: &SeriesDiagnosis, of: &OverTime, k: usize) -> Markup {
    let trend = &of.trends[k];
    let [change, low, high] = of.change(k);
    let share = |value: f64| signed_percent(value, 2);
    html! { tr {
        th scope="row" { (found.cuts[trend.cut].name) }
        td.n { (three_digits(trend.mean)) }
        td.n { (three_digits(trend.independent)) }
        td.n { (share(change)) " (" (share(low)) " to " (share(high)) ")" }
        td { @if of.trending[k] { "yes" } @else { "no" } }
        td.n { (with_interval(trend.thirds[0], trend.thirds[1])) }
        td.n { @match trend.zero {
            Some(zero) => { (signed(zero[0], 1)) @if of.drifting[k] { " (drifts)" } },
            None => "air on one side",
        } }
        td { @match trend.run_in.filter(|_| of.running_in[k]) {
            Some(run_in) => { (signed(run_in.amplitude, 1)) " N, " (three_digits(run_in.time[0])) " s" },
            None => "no",
        } }
    } }
}

const fn title(law: RunInLaw) -> &'static str {
    match law {
        RunInLaw::Time => "the same time: instrument or machine",
        RunInLaw::Length => "the same length of cut: edge or heat",
        RunInLaw::Thicknesses => "the same number of uncut chip thicknesses: chip and contact",
        RunInLaw::Other => "another law",
    }
}

fn chart<'a>(found: &'a SeriesDiagnosis, of: &OverTime) -> Chart<'a> {
    let step = of.trends.len().div_ceil(MOST_CUTS).max(1);
    let drawn = of.trends.iter().step_by(step);
    let force = |cut: usize, component: Channel| {
        let channels = &found.cuts[cut].channels;
        channels.iter().find(|c| c.component == component).map(|c| c.force.as_slice())
    };
    let lines = drawn.zip(DISTINCT).filter_map(|(trend, colour)| {
        let values = smooth(force(trend.cut, of.component)?, trend.mean);
        Some(ChartLine::new(&found.cuts[trend.cut].name, colour, 1.2, values))
    });
    Chart {
        description: format!("{} over the cut as a share of its mean.", of.component.symbol()),
        x_title: "Share of the cut",
        y_title: "Force over its mean",
        height: 260.0,
        x: (0..POINTS).map(|k| (k as f64 + 0.5) / POINTS as f64).collect(),
        lines: lines.collect(),
        y_includes: vec![0.95, 1.05],
        ..Chart::default()
    }
}

/// Means over stretches that overlap by half, as shares of `mean`.
fn smooth(force: &[f64], mean: f64) -> Vec<f64> {
    let half = force.len().div_ceil(POINTS).max(1);
    (0..POINTS)
        .map(|k| {
            let centre = ((k as f64 + 0.5) / POINTS as f64 * force.len() as f64) as usize;
            let part = &force[centre.saturating_sub(half)..(centre + half).min(force.len())];
            part.iter().sum::<f64>() / part.len().max(1) as f64 / mean
        })
        .collect()
}
