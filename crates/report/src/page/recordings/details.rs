//! One cut of the page: the force over time and its spectrum.

use super::{colour, symbol};
use crate::chart::{Band, Chart, Line, Mark};
use crate::text::{percent, plain, three_digits, with_interval};
use maud::{Markup, html};
use sphcut_physics::Channel;
use sphcut_recordings::{ComponentResult, CutResult};

/// Columns of a force over time: of each the smallest and the largest value is drawn.
const COLUMNS: usize = 350;
const INK: &str = "#5b6470";

/// Force, spectrum and figures of a cut; what was noticed if it has none.
pub(super) fn details(cut: &CutResult) -> Markup {
    if cut.components.is_empty() {
        return html! {
            section {
                h2 { (cut.conditions.name) }
                ul { @for fault in &cut.faults { li { (fault) "." } } }
            }
        };
    }
    html! {
        section {
            h2 { (cut.conditions.name) ", " (plain(cut.conditions.cutting_speed * 60.0)) " m/min, h = "
                (plain(cut.conditions.uncut_chip_thickness * 1e3)) " mm" }
            @if !cut.faults.is_empty() { ul { @for fault in &cut.faults { li { (fault) "." } } } }
            (super::super::charts::figure(forces(cut).svg(), "Force over time with the zero taken out and \
                after the low-pass: smallest and largest value of each column. Shaded: steady window; bands: mean and its \
                95 % interval."))
            (super::super::charts::figure(spectrum(cut).svg(), "Power density of the force in the window \
                (Welch, Hann windows), in decibels above 1 N\u{b2}/Hz. Dashed: the revolution, and resonances that stand \
                out of their neighbourhood."))
            (figures(cut))
        }
    }
}

/// Smallest and largest value of each column, with their times.
fn outline(values: &[f64], column: usize) -> Vec<f64> {
    values
        .chunks(column)
        .flat_map(|part| {
            let low = part.iter().copied().fold(f64::INFINITY, f64::min);
            let high = part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // In the order in which they come, as far as two points can tell.
            if part.first() < part.last() { [low, high] } else { [high, low] }
        })
        .collect()
}

fn forces(cut: &CutResult) -> Chart<'static> {
    let samples = cut.components.first().map_or(0, |c| c.force.len());
    let column = samples.div_ceil(COLUMNS).max(1);
    let time = |index: usize| index as f64 / cut.rate;
    let window = cut.window.map(|w| (time(w.entry), time(w.exit), "steady window"));
    let points = 2 * samples.div_ceil(column);
    Chart {
        description: "Force over time.".to_owned(),
        x_title: "Time in s",
        y_title: "Force in N",
        height: 330.0,
        x: (0..points).map(|k| time((k * column) / 2)).collect(),
        lines: cut
            .components
            .iter()
            .map(|c| Line {
                name: c.component.symbol(),
                colour: colour(c.component),
                width: 1.0,
                values: outline(&c.force, column),
            })
            .collect(),
        window,
        bands: window
            .map(|(from, to, _)| {
                cut.components
                    .iter()
                    .map(|c| Band {
                        from,
                        to,
                        mean: c.mean,
                        half_width: c.ci95,
                        colour: "#22262b",
                        label: format!(
                            "{} = {} N",
                            c.component.symbol(),
                            with_interval(c.mean, c.ci95)
                        ),
                    })
                    .collect()
            })
            .unwrap_or_default(),
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

fn spectrum(cut: &CutResult) -> Chart<'static> {
    let decibels = |density: &f64| 10.0 * density.max(1e-12).log10();
    let lines = cut
        .components
        .iter()
        .filter(|c| c.spectrum.density.len() > 2)
        .map(|c| Line {
            name: c.component.symbol(),
            colour: colour(c.component),
            width: 1.0,
            // The mean is taken out: the first line is no density.
            values: c.spectrum.density[1..].iter().map(decibels).collect(),
        })
        .collect();
    let x = cut.components.first().map(|c| c.spectrum.frequency[..].iter().skip(1).copied());
    Chart {
        description: "Power density of the force.".to_owned(),
        x_title: "Frequency in Hz",
        y_title: "Density in dB re 1 N\u{b2}/Hz",
        height: 300.0,
        x: x.map(Iterator::collect).unwrap_or_default(),
        lines,
        marks: marks(cut),
        ..Chart::default()
    }
}

/// The revolution, and the resonances of the cutting force or of the others where it has none.
fn marks(cut: &CutResult) -> Vec<Mark<'static>> {
    let mut marks: Vec<Mark<'static>> = Vec::new();
    if let Some(revolution) = cut.conditions.revolution {
        let label = format!("revolution {} Hz", three_digits(revolution));
        marks.push(Mark { at: revolution, colour: INK, label });
    }
    for found in &cut.components {
        for peak in &found.resonances {
            let near = |mark: &Mark<'_>| {
                (mark.at - peak.frequency).abs() <= 3.0 * found.spectrum.resolution()
            };
            if !marks.iter().any(near) {
                let at = peak.frequency;
                let label = format!("{} {} Hz", found.component.symbol(), three_digits(at));
                marks.push(Mark { at, colour: colour(found.component), label });
            }
        }
    }
    marks
}

fn figures(cut: &CutResult) -> Markup {
    let newtons = |value: Option<f64>| {
        value.map_or_else(|| "\u{2013}".to_owned(), |v| format!("{} N", three_digits(v)))
    };
    let peaks = |found: &ComponentResult| {
        let list: Vec<String> = found
            .resonances
            .iter()
            .take(3)
            .map(|peak| format!("{} Hz ({})", three_digits(peak.frequency), percent(peak.share)))
            .collect();
        if list.is_empty() { "none stands out".to_owned() } else { list.join(", ") }
    };
    let revolution = |found: &ComponentResult| match &found.revolution {
        None => "\u{2013}".to_owned(),
        Some(line) if line.stands_out() => format!("{} N", three_digits(line.amplitudes[0])),
        Some(line) => format!("below {} N", three_digits(line.noise)),
    };
    let parts: Vec<(Channel, &ComponentResult)> =
        cut.components.iter().map(|c| (c.component, c)).collect();
    html! {
        div.scroll { table {
            thead { tr {
                th scope="col" { "Force" } th.n scope="col" { "Mean in N" }
                th.n scope="col" { "Standard deviation" } th.n scope="col" { "Correlation time" }
                th.n scope="col" { "Zero before" } th.n scope="col" { "Zero after" }
                th.n scope="col" { "Once per revolution" }
                th scope="col" { "Resonances (share of the variance)" }
            } }
            tbody { @for (component, found) in parts { tr {
                th scope="row" { (symbol(component)) }
                td.n { (with_interval(found.mean, found.ci95)) }
                td.n { (newtons(Some(found.deviation))) }
                td.n { (three_digits(found.correlation_time * 1e3)) " ms" }
                td.n { (newtons(found.zero.before.map(|level| level.mean))) }
                td.n { (newtons(found.zero.after.map(|level| level.mean))) }
                td.n { (revolution(found)) }
                td { (peaks(found)) }
            } } }
        } }
    }
}
