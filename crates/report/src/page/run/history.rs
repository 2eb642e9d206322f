//! Forces, energy, momentum and temperature over the run.

use super::tables::term_colour;
use crate::kit::chart::{Area, Band, Chart, ChartLine};
use crate::kit::colours::{BLUE, BLUE_LIGHT, GREEN, GREEN_LIGHT, INK, RED, RED_LIGHT};
use crate::kit::numbers::{UM, percent, three_digits, with_interval};
use crate::kit::shell::figure;
use crate::kit::table::{results, row};
use maud::{Markup, html};
use sphcut_postprocess::{ENERGY_TERMS, Force, ProcessResult, TermKind};
use sphcut_record::{Facts, Run, TemperatureUnit};
use sphcut_sph::ChannelId;

/// Share of the record averaged for the smooth line of a force.
const SMOOTHING: f64 = 0.02;

/// Temperature, energy, momentum over the travel, and how steady the forces are.
pub(super) fn section(run: &Run, result: &ProcessResult) -> Markup {
    let axis = Axis::of(run, result);
    html! {
        (figure(temperature(run, &axis).svg(), "Highest temperature of any particle, and mean \
            temperature in contact weighted with the contact force."))
        (figure(energy(run, &axis).svg(), "Where the work went, stacked: physical terms in \
            calm colours, numerical ones in warm colours. The line is the work supplied."))
        (figure(momentum(run, result, &axis).svg(), "Force of the tool, and what it has to \
            equal: support reaction with opposite sign plus rate of change of momentum, along \
            the cutting direction; running means."))
        @if ProcessResult::is_cut(run) { (steadiness(run, result)) }
    }
}

/// Forces over the travel.
pub(super) fn forces_figure(run: &Run, result: &ProcessResult) -> Markup {
    figure(
        forces(run, result, &Axis::of(run, result)).svg(),
        if ProcessResult::is_cut(run) {
            "Forces of the tool on the workpiece (in the plane per width of cut): impulse averages over each sampling \
             interval (pale) and running mean over 2 % of the record. The level and its band are the mean over the window \
             and its 95 % interval. A click shows the picture of that place."
        } else {
            "Forces on the material (in the plane per width): impulse averages over each sampling interval (pale) and \
             running mean over 2 % of the record. A click shows the picture of that time."
        },
    )
}

/// Place of a time on the axis of the charts, and the travel of a cut in words.
pub(super) fn moment(run: &Run, result: &ProcessResult, time: f64) -> (f64, Option<String>) {
    let axis = Axis::of(run, result);
    let times = run.samples.channel(ChannelId::Time);
    let after = times.partition_point(|sampled| *sampled < time);
    // The first sample ends an interval after the start.
    let before = |values: &[f64]| if after > 0 { values[after - 1] } else { 0.0 };
    let between = |values: &[f64]| match values.get(after) {
        Some(value) => {
            let share = (time - before(times)) / (times[after] - before(times));
            before(values) + share * (value - before(values))
        }
        None => before(values),
    };
    let place = between(&axis.values);
    let travel = between(run.samples.channel(ChannelId::Travel)) * 1e3;
    (place, ProcessResult::is_cut(run).then(|| format!("{travel:.2} mm of travel")))
}

/// Forces over the travel alone, for the page of springback.
pub(in crate::page) fn force_figure(run: &Run, result: &ProcessResult) -> Markup {
    let chart = forces(run, result, &Axis::of(run, result));
    figure(
        chart.svg(),
        "Forces of the tool on the workpiece per width of cut, as in the run's report.",
    )
}

/// Travel in mm where a tool cuts once, else time in ms.
struct Axis {
    title: &'static str,
    values: Vec<f64>,
    /// Start and end of the window of the means.
    window: Option<(f64, f64)>,
}

impl Axis {
    fn of(run: &Run, result: &ProcessResult) -> Self {
        let scaled = |id: ChannelId| -> Vec<f64> {
            run.samples.channel(id).iter().map(|x| x * 1e3).collect()
        };
        let window = &result.window;
        if !run.facts.passes.is_empty() {
            // The tool comes by several times: only time tells the passes apart.
            let values = scaled(ChannelId::Time);
            let end = window.last_sample.checked_sub(1).and_then(|last| values.get(last).copied());
            let window = end.map(|end| (window.start_time * 1e3, end));
            return Self { title: "Time in ms", values, window };
        }
        let travel = run.samples.channel(ChannelId::Travel);
        if travel.last().is_some_and(|travel| *travel > 0.0) {
            let window = Some((window.start * 1e3, window.end * 1e3));
            Self { title: "Travel in mm", values: scaled(ChannelId::Travel), window }
        } else {
            Self { title: "Time in ms", values: scaled(ChannelId::Time), window: None }
        }
    }

    fn window(&self, result: &ProcessResult) -> Option<(f64, f64, &'static str)> {
        let name = if result.steady.reached {
            "steady window"
        } else {
            "window of the means (not steady)"
        };
        let (from, to) = self.window?;
        (to > from).then_some((from, to, name))
    }
}

/// How forces and energies are shown: per mm of width in the plane, as they are in space.
struct Scale {
    /// From the channels to the unit.
    factor: f64,
    force: &'static str,
    force_title: &'static str,
    energy_title: &'static str,
}

impl Scale {
    fn of(facts: &Facts) -> Self {
        if facts.dimension == 2 {
            let factor = facts.force_factor() / facts.width_of_cut * 1e-3;
            let (force_title, energy_title) = ("Force in N/mm", "Energy in J/mm");
            Self { factor, force: "N/mm", force_title, energy_title }
        } else {
            let (force_title, energy_title) = ("Force in N", "Energy in J");
            Self { factor: 1.0, force: "N", force_title, energy_title }
        }
    }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| value * factor).collect()
}

/// Running mean over the samples around each.
fn smooth(values: &[f64]) -> Vec<f64> {
    let half = (0.5 * SMOOTHING * values.len() as f64).ceil() as usize;
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    (0..values.len())
        .map(|k| {
            let from = k.saturating_sub(half);
            let to = (k + half + 1).min(values.len());
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}

fn forces<'a>(run: &Run, result: &ProcessResult, axis: &Axis) -> Chart<'a> {
    let scale = Scale::of(&run.facts);
    let factor = scale.factor;
    let cutting = scaled(run.samples.channel(ChannelId::CuttingForce), factor);
    let feed = scaled(run.samples.channel(ChannelId::FeedForce), factor);
    let line = ChartLine::new;
    // Without a cut they are those of the coordinates.
    let names = if ProcessResult::is_cut(run) {
        ["Cutting force F_c", "Feed force F_f", "Passive force F_p"]
    } else {
        ["Along x", "Along \u{2212}y", "Along z"]
    };
    let mut chart = Chart {
        x_title: axis.title,
        y_title: scale.force_title,
        height: 400.0,
        x: axis.values.clone(),
        window: axis.window(result),
        y_includes: vec![0.0],
        follows_animation: true,
        ..Chart::default()
    };
    let band = |force: &Force, colour, symbol: &str| {
        let (mean, half_width) = match run.facts.dimension {
            2 => (force.mean_per_width * 1e-3, force.ci95_per_width * 1e-3),
            _ => (force.mean, force.ci95),
        };
        let label = format!("{symbol} = {} {}", with_interval(mean, half_width), scale.force);
        let (from, to) = axis.window.unwrap_or_default();
        Band { from, to, mean, half_width, colour, label }
    };
    let in_space = run.facts.dimension == 3;
    if chart.window.is_some() {
        chart.bands =
            vec![band(&result.forces.cutting, BLUE, "F_c"), band(&result.forces.feed, RED, "F_f")];
        chart.bands.extend(in_space.then(|| band(&result.forces.passive, GREEN, "F_p")));
    }
    chart.description = format!(
        "{}. {}",
        if ProcessResult::is_cut(run) {
            "Cutting force and feed force over the travel"
        } else {
            "Forces over time"
        },
        chart.bands.iter().map(|band| band.label.clone() + ". ").collect::<String>()
    );
    chart.lines = vec![
        line("", BLUE_LIGHT, 1.0, cutting.clone()),
        line("", RED_LIGHT, 1.0, feed.clone()),
        line(names[0], BLUE, 2.0, smooth(&cutting)),
        line(names[1], RED, 2.0, smooth(&feed)),
    ];
    if in_space {
        let passive = scaled(run.samples.channel(ChannelId::PassiveForce), factor);
        chart.lines.push(line("", GREEN_LIGHT, 1.0, passive.clone()));
        chart.lines.push(line(names[2], GREEN, 2.0, smooth(&passive)));
    }
    chart
}

fn temperature<'a>(run: &Run, axis: &Axis) -> Chart<'a> {
    let interface = run.samples.channel(ChannelId::InterfaceTemperature);
    let unit = run.provenance.temperature_unit();
    let in_celsius = unit == TemperatureUnit::Celsius;
    let highest = run.samples.channel(ChannelId::MaxTemperature);
    Chart {
        description: "Highest temperature and contact temperature over the travel.".to_owned(),
        x_title: axis.title,
        y_title: if in_celsius { "Temperature in \u{b0}C" } else { "Temperature in K" },
        height: 300.0,
        x: axis.values.clone(),
        follows_animation: true,
        lines: vec![
            ChartLine::new(
                "Highest",
                RED,
                1.5,
                highest.iter().map(|kelvin| unit.of(*kelvin)).collect(),
            ),
            ChartLine {
                name: "In contact",
                colour: BLUE,
                width: 1.5,
                // The channel is 0 without contact.
                values: interface
                    .iter()
                    .map(|t| if *t > 0.0 { unit.of(*t) } else { f64::NAN })
                    .collect(),
            },
        ],
        ..Chart::default()
    }
}

fn energy<'a>(run: &Run, axis: &Axis) -> Chart<'a> {
    let scale = Scale::of(&run.facts);
    let factor = scale.factor;
    let areas = ENERGY_TERMS
        .iter()
        .filter(|(channel, kind, _)| {
            // Terms that do not exist in this run need no entry in the legend.
            *kind != TermKind::Closure
                && run.samples.channel(*channel).iter().any(|energy| *energy != 0.0)
        })
        .map(|(channel, _, title)| Area {
            name: title,
            colour: term_colour(*channel),
            values: scaled(run.samples.channel(*channel), factor),
        })
        .collect();
    let supports = run.samples.channel(ChannelId::SupportWork);
    let work = run.samples.channel(ChannelId::ToolWork).iter().zip(supports);
    Chart {
        description: "Terms of the energy balance over the travel, stacked, against the work \
                      supplied; the shares at the end are in the table of balances."
            .to_owned(),
        x_title: axis.title,
        y_title: scale.energy_title,
        height: 420.0,
        x: axis.values.clone(),
        follows_animation: true,
        areas,
        lines: vec![ChartLine::new(
            "Work",
            INK,
            2.0,
            work.map(|(tool, support)| (tool + support) * factor).collect(),
        )],
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

fn momentum<'a>(run: &Run, result: &ProcessResult, axis: &Axis) -> Chart<'a> {
    let scale = Scale::of(&run.facts);
    let factor = scale.factor;
    let channel = |id: ChannelId| run.samples.channel(id);
    let (time, momentum) = (channel(ChannelId::Time), channel(ChannelId::MomentumCutting));
    let rate = |k: usize| {
        let before = k.saturating_sub(1);
        let span = time[k] - time[before];
        if span > 0.0 { (momentum[k] - momentum[before]) / span } else { 0.0 }
    };
    let reaction = channel(ChannelId::ReactionCutting);
    let equal: Vec<f64> = (0..time.len()).map(|k| (rate(k) - reaction[k]) * factor).collect();
    let force = scaled(channel(ChannelId::CuttingForce), factor);
    let difference: Vec<f64> = force.iter().zip(&equal).map(|(a, b)| a - b).collect();
    let line =
        |name, colour, width, values: &[f64]| ChartLine::new(name, colour, width, smooth(values));
    Chart {
        description: "Contact force and the force from supports and momentum over the travel: the \
                      two lines should lie on each other."
            .to_owned(),
        x_title: axis.title,
        y_title: scale.force_title,
        height: 300.0,
        x: axis.values.clone(),
        follows_animation: true,
        window: axis.window(result).map(|(from, to, _)| (from, to, "")),
        lines: vec![
            line("Contact", BLUE_LIGHT, 5.0, &force),
            line("Supports and momentum", INK, 1.2, &equal),
            line("Difference", GREEN, 1.5, &difference),
        ],
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

/// How the verdict on the cutting force came about.
fn steadiness(run: &Run, result: &ProcessResult) -> Markup {
    let (drift, unit) = match run.facts.dimension {
        3 => (result.window.drift_per_width * run.facts.width_of_cut, "N"),
        _ => (result.window.drift_per_width * 1e-3, "N/mm"),
    };
    let state = &result.steady;
    let bound = result.feed_known.drift.bound();
    let possible = if bound.is_finite() {
        three_digits(if unit == "N" { bound } else { bound * 1e-3 })
    } else {
        "not known".to_owned()
    };
    let window = format!(
        "{} to {} mm",
        three_digits(result.window.start * 1e3),
        three_digits(result.window.end * 1e3)
    );
    let wanted = format!(
        "\u{b1} {} after {} mm",
        percent(result.criterion.relative_half_width),
        three_digits(result.criterion.minimum_travel * 1e3)
    );
    let rows = [
        row(
            "Steady",
            if state.reached { "yes" } else { "no" }.to_owned(),
            "",
            state.reason.to_string(),
        ),
        row("Asked for", wanted, "", "half width of the interval and least travel"),
        row("Window of the means", window, "", ""),
        row(
            "Correlation length",
            three_digits(state.correlation_length * UM),
            "\u{b5}m",
            "of the cutting force along the travel",
        ),
        row(
            "Drift over the window",
            three_digits(drift),
            unit,
            "linear regression of ten batch means",
        ),
        row("Possible drift of the feed force", possible, unit, result.feed_known.to_string()),
    ];
    html! { h3 { "Steadiness" } (results("Judged by the cutting force.", &rows)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_keeps_a_straight_line_and_its_length() {
        let values: Vec<f64> = (0..600).map(f64::from).collect();
        let smoothed = smooth(&values);
        assert_eq!(smoothed.len(), 600);
        assert!((6..594).all(|k| (smoothed[k] - values[k]).abs() < 1e-9));
        // The mean of 0 to 6.
        assert_eq!(smoothed[0], 3.0);
        assert!(smooth(&[]).is_empty());
    }
}
