//! The tables of the page.

use super::drawing::drawings;
use crate::kit::colours::INK;
use crate::kit::numbers::{UM, grouped, percent, three_digits, with_interval};
use crate::kit::table::{ResultRow, results as results_table, row};
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_postprocess::{
    EnergyBalance, Force, MomentumBalance, ProcessResult, TermKind, ToolHeatBalance,
};
use sphcut_record::{Run, Setting, TemperatureUnit};
use sphcut_sph::{ChannelId, Snapshot};

/// The five numbers one looks for first.
pub(super) fn key_figures(run: &Run, result: &ProcessResult) -> Markup {
    let in_space = run.facts.dimension == 3;
    let force = |force: &Force| match in_space {
        true => with_interval(force.mean, force.ci95),
        false => with_interval(force.mean_per_width * 1e-3, force.ci95_per_width * 1e-3),
    };
    let unit = if in_space { "N" } else { "N/mm" };
    let geometry = &result.geometry;
    // Forces are those of the last of several passes, chip and contact those of the first.
    let of = |pass: &str, name: &str| match result.passes.len() {
        0 | 1 => name.to_owned(),
        _ => format!("{name} ({pass} pass)"),
    };
    let (last, first) = (|name: &str| of("last", name), |name: &str| of("first", name));
    html! {
        dl.figures {
            @if ProcessResult::is_cut(run) {
                (figure(&last("Cutting force F_c"), &force(&result.forces.cutting), unit))
                (figure(&last("Feed force F_f"), &force(&result.forces.feed), unit))
                @if in_space {
                    (figure(&last("Passive force F_p"), &force(&result.forces.passive), unit))
                }
                @if let Ok(chip) = &geometry.chip {
                    (figure(&first("Chip thickness"), &three_digits(chip.thickness * UM), "\u{b5}m"))
                    (figure(&first("Chip compression ratio"), &three_digits(chip.compression_ratio), ""))
                }
                @if let Ok(interface) = &geometry.interface {
                    (figure(&first("Contact length"), &three_digits(interface.contact_length * UM), "\u{b5}m"))
                }
            }
            @match result.temperature.interface.as_ref().filter(|_| ProcessResult::is_cut(run)) {
                Some(interface) => { (temperature(run, &last("Contact temperature"), interface.mean)) },
                None => { (temperature(run, "Highest temperature", result.temperature.max)) },
            }
            @if let Some(energy) = &result.energy {
                (figure("Numerical share of the work", &percent(energy.numerical_dissipation), ""))
            }
        }
    }
}

fn temperature(run: &Run, name: &str, kelvin: f64) -> Markup {
    let unit = run.provenance.temperature_unit();
    let beside = match unit {
        TemperatureUnit::Celsius => format!("{} ({kelvin:.0} K)", unit.symbol()),
        TemperatureUnit::Kelvin => unit.symbol().to_owned(),
    };
    figure(name, &format!("{:.0}", unit.of(kelvin)), &beside)
}

fn figure(name: &str, value: &str, unit: &str) -> Markup {
    html! { div { dt { (indexed(name)) } dd { (value) @if !unit.is_empty() { " " small { (unit) } } } } }
}

/// Colour of a term of the energy balance; physical ones in calm colours, numerical ones warm.
pub(super) fn term_colour(channel: ChannelId) -> &'static str {
    match channel {
        ChannelId::PlasticWork => "#4c78a8",
        ChannelId::FrictionWork => "#72b7b2",
        ChannelId::ElasticEnergy => "#9ecae9",
        ChannelId::KineticEnergy => "#b8b0d8",
        ChannelId::ThermoelasticWork => "#d6cfe6",
        ChannelId::HourglassWork => "#e45756",
        ChannelId::ViscosityWork => "#f58518",
        ChannelId::DensityDiffusionWork => "#eeca3b",
        ChannelId::ArtificialStressWork => "#b279a2",
        ChannelId::UpdateResidue => "#ff9da6",
        ChannelId::ContactEnergy => "#9d755d",
        _ => INK,
    }
}

/// What the intervals of a cut are, and what they leave out (`docs/numerics.md`, *What F_c owes to the damping*).
const CUT_INTERVALS: &str = "Intervals are 95 % and take the correlation of the force along the travel into account. \
                             They hold for this spacing: a shear zone whose load is known takes 3 to 5 % too much force \
                             with 7 to 40 particles across, so expect the cutting force that much too high, and more \
                             where the material softens in the shear zone (8 % in drafts of Ti6Al4V).";

/// Forces, temperatures, extremes.
pub(super) fn results(run: &Run, result: &ProcessResult) -> Markup {
    let mut rows = Vec::new();
    if ProcessResult::is_cut(run) {
        rows.extend(force_rows(run, result));
    }
    rows.extend(state_rows(run, result));
    html! {
        section id="results" {
            h2 { "Results" }
            (results_table(if ProcessResult::is_cut(run) { CUT_INTERVALS } else { "Extremes." }, &rows))
            (passes(result))
        }
    }
}

/// The forces of each pass, where there are several.
fn passes(result: &ProcessResult) -> Markup {
    if result.passes.is_empty() {
        return html! {};
    }
    let force = |force: &Force| with_interval(force.mean, force.ci95);
    html! {
        div.scroll {
            table.results {
                caption { "Mean forces of each pass in N; above are those of the last one." }
                thead { tr {
                    th scope="col" { "Pass" }
                    th.n scope="col" { (indexed("F_c")) }
                    th.n scope="col" { (indexed("F_f")) }
                    th.n scope="col" { (indexed("F_p")) }
                    th scope="col" { "Means over" }
                } }
                tbody {
                    @for pass in &result.passes {
                        tr {
                            th scope="row" { (pass.number) }
                            td.n { (force(&pass.forces.cutting)) }
                            td.n { (force(&pass.forces.feed)) }
                            td.n { (force(&pass.forces.passive)) }
                            td {
                                (three_digits(pass.window.start * 1e3)) " to "
                                (three_digits(pass.window.end * 1e3)) " mm"
                                @if !pass.steady.reached { ", not steady" }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn force_rows(run: &Run, result: &ProcessResult) -> Vec<ResultRow> {
    let forces = &result.forces;
    let mut rows = Vec::new();
    for (name, per_width, force) in [
        ("Cutting force F_c", "Cutting force per width", &forces.cutting),
        ("Feed force F_f", "Feed force per width", &forces.feed),
        ("Passive force F_p", "Passive force per width", &forces.passive),
    ] {
        if force.mean == 0.0 {
            continue;
        }
        let (mean, half_width) = (force.mean_per_width * 1e-3, force.ci95_per_width * 1e-3);
        // In space the width of cut is that of a later pass, and only a measure.
        let in_space = run.facts.dimension == 3;
        let note = if in_space { "" } else { "for the width of cut" };
        rows.push(row(name, with_interval(force.mean, force.ci95), "N", note));
        if !in_space {
            rows.push(row(per_width, with_interval(mean, half_width), "N/mm", ""));
        }
    }
    rows
}

fn state_rows(run: &Run, result: &ProcessResult) -> Vec<ResultRow> {
    let (temperature, extremes) = (&result.temperature, &result.extremes);
    let mut rows = Vec::new();
    let unit = run.provenance.temperature_unit();
    // Without a cut the window of the means has no travel.
    if let Some(interface) = temperature.interface.as_ref().filter(|_| ProcessResult::is_cut(run)) {
        let value = with_interval(unit.of(interface.mean), interface.half_width);
        let tool = result.heat.and_then(|heat| heat.tool);
        let warming_up = match tool.is_some_and(|tool| tool.is_warming_up()) {
            true => {
                "; of a tool that is still warming up: `capacity_scaling` in [tool.heat] gives that of a tool in use"
            }
            false => "",
        };
        let note = format!(
            "{:.0} K; from {} to {} mm of travel; highest of any interval: {}{warming_up}",
            interface.mean,
            three_digits(interface.start * 1e3),
            three_digits(interface.end * 1e3),
            unit.shown(temperature.interface_max)
        );
        rows.push(row("Contact temperature", value, unit.symbol(), note));
        let state = if interface.steady.reached { "steady" } else { "not steady" };
        let drift = with_interval(interface.drift.change, interface.drift.half_width);
        let note = format!("over this window; {state}: {}", interface.steady.reason);
        rows.push(row("Drift of the contact temperature", drift, "K", note));
    }
    rows.push(row(
        "Temperature",
        format!("{:.0} to {:.0}", unit.of(temperature.min), unit.of(temperature.max)),
        unit.symbol(),
        format!("of any particle over the run; highest {:.0} K", temperature.max),
    ));
    let strain = three_digits(extremes.max_plastic_strain);
    rows.push(row("Largest plastic strain", strain, "", "of any particle over the run"));
    rows.push(row(
        "Density ratio",
        format!("{:.4} to {:.4}", extremes.min_density_ratio, extremes.max_density_ratio),
        "",
        "of any particle over the run",
    ));
    rows
}

/// Energy, momentum and heat.
pub(super) fn balances(run: &Run, result: &ProcessResult) -> Markup {
    html! {
        @if let Some(energy) = &result.energy { (energy_table(run, energy)) }
        @if let Some(momentum) = &result.momentum {
            h3 { "Momentum over the window" }
            div.scroll { table {
                caption {
                    "Impulse of the tool plus impulse of the supports has to equal the change \
                     of momentum"
                    @if let Some(closure) = momentum.closure() {
                        "; what is missing, over the impulse of the tool: " (percent(closure))
                    }
                    "."
                }
                thead { tr {
                    th { "N s" @if run.facts.dimension == 2 { " per m of width" } }
                    th.n { "Tool" } th.n { "Supports" } th.n { "Change" } th.n { "Missing" }
                } }
                tbody {
                    (momentum_row("Cutting direction", &momentum.cutting))
                    (momentum_row("Feed direction", &momentum.feed))
                }
            } }
        }
        @if let Some(heat) = result.heat {
            h3 { "Heat" }
            p {
                "Supplied: " (three_digits(heat.supplied)) " J, found in the particles: "
                (three_digits(heat.content)) " J"
                @if run.facts.dimension == 2 { " (per m of width)" }
                @if let Some(closure) = heat.closure() { "; difference " (percent(closure)) }
                "."
                @if let Some(share) = heat.friction_share {
                    " Of the heat of friction " (percent(share)) " go into the workpiece at once."
                }
            }
            @if let Some(tool) = heat.tool { (tool_heat(run, &tool)) }
        }
    }
}

/// Where the heat of the tool comes from.
fn tool_heat(run: &Run, tool: &ToolHeatBalance) -> Markup {
    let heat = three_digits;
    html! {
        p {
            "Tool: " (heat(tool.contact)) " J through the contact, " (heat(tool.friction))
            " J of friction, " (heat(tool.boundary)) " J through its outer sides; found in it: "
            (heat(tool.content)) " J"
            @if run.facts.dimension == 2 { " (per m of width)" }
            @if let Some(closure) = tool.closure() { "; difference " (percent(closure)) }
            ". Highest temperature of the tool: " (run.provenance.temperature_unit().shown(tool.max_temperature)) "."
        }
    }
}

fn energy_table(run: &Run, energy: &EnergyBalance) -> Markup {
    let (factor, unit) = match run.facts.dimension {
        3 => (1e3, "mJ"),
        _ => (run.facts.force_factor() / run.facts.width_of_cut, "mJ/mm"),
    };
    let value = |energy: f64| three_digits(energy * factor);
    let kind = |kind: TermKind| match kind {
        TermKind::Physical => "physical",
        TermKind::Numerical => "numerical",
        TermKind::Closure => "closure",
    };
    html! {
        h3 { "Energy at the end of the run" }
        div.scroll { table {
            caption { "Shares of the work supplied. The numerical share adds absolute values." }
            thead { tr { th { "Term" } th { "Kind" } th.n { (unit) } th.n { "Share" } } }
            tbody {
                tr {
                    th scope="row" { "Work supplied" } td {} td.n { (value(energy.supplied)) } td.n { (percent(1.0)) }
                }
                @for term in energy.terms.iter().filter(|term| term.kind != TermKind::Closure) {
                    tr {
                        th scope="row" {
                            span.swatch style={ "background:" (term_colour(term.channel)) } {}
                            (term.title)
                        }
                        td { (kind(term.kind)) }
                        td.n { (value(term.energy)) }
                        td.n { (percent(term.share)) }
                    }
                }
                tr.sum {
                    th scope="row" { "Numerical terms together" } td { "gross" } td {}
                    td.n { (percent(energy.numerical_dissipation)) }
                }
                tr.sum {
                    th scope="row" { "Not accounted for" } td { "closure" } td {}
                    td.n { (percent(energy.closure)) }
                }
            }
        } }
    }
}

fn momentum_row(name: &str, balance: &MomentumBalance) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            td.n { (three_digits(balance.contact_impulse)) }
            td.n { (three_digits(balance.reaction_impulse)) }
            td.n { (three_digits(balance.momentum_change)) }
            td.n { (percent(balance.residual().abs() / balance.contact_impulse.abs().max(f64::MIN_POSITIVE))) }
        }
    }
}

/// Resolution, resolved scenario, effects, cost.
pub(super) fn setup(run: &Run, result: &ProcessResult, first: Option<&Snapshot>) -> Markup {
    html! {
        @if let Some(first) = first { (drawings(&run.facts, &run.provenance, first)) }
        (results_table("Resolution and cost.", &cost_rows(result)))
        @if !run.provenance.effects.is_empty() {
            h3 { "Laws and effects" }
            table { tbody {
                @for (name, description) in &run.provenance.effects {
                    tr { th scope="row" { (name) } td { (description) } }
                }
            } }
        }
        @if !run.provenance.settings.is_empty() {
            h3 { "Every setting" }
            (settings_table(&run.provenance.settings))
        }
    }
}

fn cost_rows(result: &ProcessResult) -> Vec<ResultRow> {
    let (resolution, performance) = (&result.resolution, &result.performance);
    let mut rows = vec![row(
        "Particle spacing",
        three_digits(resolution.particle_spacing * UM),
        "\u{b5}m",
        "",
    )];
    for (name, particles) in [
        ("Particles across the uncut chip thickness", resolution.across_chip_thickness),
        ("Particles across the edge radius", resolution.across_edge_radius),
    ] {
        rows.extend(particles.map(|n| row(name, three_digits(n), "", "at least 5")));
    }
    rows.push(row("Particles", grouped(performance.particles as u64), "", ""));
    rows.push(row("Time steps", grouped(performance.steps), "", ""));
    let threads = format!("on {} threads", performance.threads);
    rows.push(row("Wall-clock time", three_digits(performance.wall_seconds), "s", threads));
    let speed = grouped(performance.updates_per_second() as u64);
    rows.push(row("Particle updates", speed, "1/s", "wall clock"));
    if let Some(speed) = performance.updates_per_cpu_second() {
        rows.push(row("Particle updates", grouped(speed as u64), "1/s", "processor time"));
    }
    if let Some(bytes) = performance.peak_memory_bytes {
        rows.push(row("Peak memory", three_digits(bytes as f64 / 1048576.0), "MiB", ""));
    }
    rows
}

fn settings_table(settings: &[Setting]) -> Markup {
    html! {
        details {
            summary { (settings.len()) " keys as resolved, defaults included" }
            div.scroll { table {
                thead { tr { th { "Section" } th { "Key" } th { "As written" } th { "SI" } } }
                tbody {
                    @for setting in settings {
                        tr {
                            td { (setting.section) }
                            th scope="row" { (setting.key) }
                            td { (setting.text) }
                            td { (setting.value) " " (setting.unit) }
                        }
                    }
                }
            } }
        }
    }
}
