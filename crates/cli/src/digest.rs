//! The result of a run in a few lines.

use crate::text;
use sphcut_postprocess::{Force, ProcessResult};
use sphcut_record::{Outcome, Performance, Run};
use std::fmt::Write as _;

/// What came out: forces, temperatures, chip, balances, cost. A run without a cut has only the
/// last two.
pub fn digest(run: &Run, result: &ProcessResult) -> String {
    let mut page = String::new();
    if ProcessResult::is_cut(run) {
        let _ = writeln!(page, "{}", window(run, result));
        let forces = &result.forces;
        let shown = if run.facts.dimension == 3 { whole } else { per_width };
        let _ = writeln!(page, "cutting force F_c  {}", shown(&forces.cutting));
        let _ = writeln!(page, "feed force F_f     {}", shown(&forces.feed));
        if run.facts.dimension == 3 {
            let _ = writeln!(page, "passive force F_p  {}", shown(&forces.passive));
        }
        let _ = writeln!(page, "                   {}", result.feed_known);
        page.push_str(&temperature(run, result));
        page.push_str(&shape(result));
    }
    page.push_str(&balances(result));
    let _ = writeln!(page, "{}", cost(&run.performance));
    page
}

/// Over which part of the run the means are taken, and whether the force is steady there; if not, a warning says why.
fn window(run: &Run, result: &ProcessResult) -> String {
    let (start, end) = (result.window.start * 1e3, result.window.end * 1e3);
    let verdict = match (result.steady.reached, &run.outcome) {
        (true, Outcome::Steady) => "steady, stopped early",
        (true, _) => "steady",
        (false, _) => "not steady",
    };
    format!("means from {start:.3} to {end:.3} mm of travel: {verdict}")
}

/// `63.0 ± 4.1 N`: in space the width differs from place to place.
fn whole(force: &Force) -> String {
    let interval =
        if force.ci95.is_finite() { format!(" ± {:.2}", force.ci95) } else { String::new() };
    format!("{:.2}{interval} N", force.mean)
}

/// `232.1 ± 8.0 N/mm (696 N)`.
fn per_width(force: &Force) -> String {
    let interval = if force.ci95_per_width.is_finite() {
        format!(" ± {:.1}", force.ci95_per_width * 1e-3)
    } else {
        String::new()
    };
    format!("{:.1}{interval} N/mm ({:.0} N)", force.mean_per_width * 1e-3, force.mean)
}

/// The mean of the contact comes first; what is hottest is one particle.
fn temperature(run: &Run, result: &ProcessResult) -> String {
    let unit = run.provenance.temperature_unit();
    let interface = result.temperature.interface.as_ref().map_or_else(String::new, |found| {
        let (start, end) = (found.start * 1e3, found.end * 1e3);
        let state = if found.steady.reached { "steady" } else { "not steady" };
        let mean = unit.shown(found.mean);
        let tool = result.heat.and_then(|heat| heat.tool);
        let warming_up =
            if tool.is_some_and(|tool| tool.is_warming_up()) { ", which is still warming up" } else { "" };
        format!("{mean} in contact with the tool{warming_up} ({state} from {start:.3} to {end:.3} mm)\n                   ")
    });
    let highest = unit.shown(result.temperature.max);
    format!("temperature        {interface}{highest} at most, of any particle\n")
}

fn shape(result: &ProcessResult) -> String {
    let mut parts = Vec::new();
    if let Ok(chip) = &result.geometry.chip {
        let ratio = chip.compression_ratio;
        parts.push(format!("{:.3} mm thick ({ratio:.2} h)", chip.thickness * 1e3));
    }
    if let Ok(interface) = &result.geometry.interface {
        parts.push(format!("contact length {:.3} mm", interface.contact_length * 1e3));
    }
    if parts.is_empty() {
        return String::new();
    }
    format!("chip               {}\n", parts.join(", "))
}

fn balances(result: &ProcessResult) -> String {
    let mut parts = Vec::new();
    if let Some(energy) = &result.energy {
        parts.push(format!("energy closes to {:.2} %", 100.0 * energy.closure));
        parts.push(format!("numerical terms {:.1} %", 100.0 * energy.numerical_dissipation));
    }
    if let Some(closure) = result.momentum.as_ref().and_then(|momentum| momentum.closure()) {
        parts.push(format!("momentum closes to {:.2} %", 100.0 * closure));
    }
    if parts.is_empty() {
        return String::new();
    }
    format!("balances           {}\n", parts.join(", "))
}

fn cost(performance: &Performance) -> String {
    format!(
        "cost               {} particles, {} steps in {} ({})",
        text::grouped(performance.particles as u64),
        text::grouped(performance.steps),
        text::seconds(performance.wall_seconds),
        text::updates(performance.updates_per_second()),
    )
}
