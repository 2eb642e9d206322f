//! One cut of the page: the force over time and its spectrum.

use crate::kit::chart::{Band, Chart, ChartLine, Mark};
use crate::kit::colours::{BLUE, GREEN, INK, RED, SLATE};
use crate::kit::numbers::{M_PER_MIN, MM, percent, plain, three_digits, with_interval};
use crate::kit::shell::figure;
use crate::kit::table::{ColumnHead, NONE, or_dash, table};
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_physics::Channel;
use sphcut_recordings::{ComponentResult, CutResult};

/// Columns of a force over time: of each the smallest and the largest value is drawn.
const COLUMNS: usize = 350;

/// The colour of a force.
pub(super) fn colour(component: Channel) -> &'static str {
    match component {
        Channel::CuttingForce => BLUE,
        Channel::FeedForce => RED,
        _ => GREEN,
    }
}

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
            h2 { (cut.conditions.name) ", " (plain(cut.conditions.cutting_speed * M_PER_MIN)) " m/min, h = "
                (plain(cut.conditions.uncut_chip_thickness * MM)) " mm" }
            @if !cut.faults.is_empty() { ul { @for fault in &cut.faults { li { (fault) "." } } } }
            (figure(forces(cut).svg(), "Force over time with the zero taken out and \
                after the low-pass: smallest and largest value of each column. Shaded: steady window; bands: mean and its \
                95 % interval."))
            (figure(spectrum(cut).svg(), "Power density of the force in the window \
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
            .map(|c| {
                ChartLine::new(
                    c.component.symbol(),
                    colour(c.component),
                    1.0,
                    outline(&c.force, column),
                )
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
                        colour: INK,
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
        .map(|c| ChartLine {
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
        marks.push(Mark { at: revolution, colour: SLATE, label });
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
    use ColumnHead::{Number, Text};
    let columns = [
        Text("Force"),
        Number("Mean in N"),
        Number("Standard deviation"),
        Number("Correlation time"),
        Number("Zero before"),
        Number("Zero after"),
        Number("Once per revolution"),
        Text("Resonances (share of the variance)"),
    ];
    let newtons = |value: f64| format!("{} N", three_digits(value));
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
        None => NONE.to_owned(),
        Some(line) if line.stands_out() => newtons(line.amplitudes[0]),
        Some(line) => format!("below {}", newtons(line.noise)),
    };
    let rows = html! { @for found in &cut.components { tr {
        th scope="row" { (indexed(found.component.symbol())) }
        td.n { (with_interval(found.mean, found.ci95)) }
        td.n { (newtons(found.deviation)) }
        td.n { (three_digits(found.correlation_time * 1e3)) " ms" }
        td.n { (or_dash(found.zero.before, |level| newtons(level.mean))) }
        td.n { (or_dash(found.zero.after, |level| newtons(level.mean))) }
        td.n { (revolution(found)) }
        td { (peaks(found)) }
    } } };
    table("", columns, &rows)
}
