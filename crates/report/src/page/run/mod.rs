//! `report.html`: one run.

mod animation;
mod drawing;
mod history;
mod measures;
mod tables;

pub(super) use drawing::drawings;
pub(super) use history::force_figure;

use crate::ReportError;
use crate::kit::numbers::{UM, grouped, three_digits};
use crate::kit::shell::{Shell, contents, data_uri, folded, next, note, tab};
use crate::picture::{Picture, Pictures, draw_all};
use maud::{Markup, html};
use sphcut_postprocess::ProcessResult;
use sphcut_record::{Outcome, Run};
use sphcut_sph::Snapshot;
use std::path::{Path, PathBuf};

/// Writes `report.html` into `folder` and returns its path.
///
/// # Errors
/// A snapshot that cannot be read, a folder that cannot be written to.
pub fn write_report(
    run: &Run,
    result: &ProcessResult,
    folder: &Path,
) -> Result<PathBuf, ReportError> {
    let page = render_report(run, result)?;
    let path = folder.join("report.html");
    // Beside the target and renamed: a full disk leaves an older page whole.
    let beside = folder.join("report.html.new");
    std::fs::write(&beside, page)
        .and_then(|()| std::fs::rename(&beside, &path))
        .map_err(|source| ReportError::Write { path: path.clone(), source })?;
    Ok(path)
}

/// The text of `report.html`: pictures and charts are part of it, nothing is loaded.
///
/// # Errors
/// A snapshot that cannot be read.
pub fn render_report(run: &Run, result: &ProcessResult) -> Result<String, ReportError> {
    let provenance = &run.provenance;
    let title =
        if provenance.title.is_empty() { &provenance.scenario_name } else { &provenance.title };
    let along_edge = result.geometry.along_edge.as_ref();
    let pictures = draw_all(run, along_edge.and_then(|along| along.deepest.as_ref()))?;
    let first = if run.snapshots.is_empty() { None } else { Some(run.snapshots.get(0)?) };
    let is_cut = ProcessResult::is_cut(run);
    let body = html! {
        (contents(&sections(is_cut, &pictures)))
        (warnings(result, is_cut))
        (tables::key_figures(run, result))
        section id="cut" {
            h2 { (heading(is_cut)) }
            @if let Some(found) = &pictures.animation {
                (animation::figure(found, &pictures, is_cut, |time| history::moment(run, result, time)))
            } @else if let Some(whole) = &pictures.whole {
                (figure(whole))
            }
            (history::forces_figure(run, result))
        }
        (tables::results(run, result))
        (measures::section(run, result))
        @if is_cut { (folded("charts", CHARTS, &measures::figures(run, result))) }
        (folded("history", HISTORY, &history::section(run, result)))
        @if !pictures.fields.is_empty() { (folded("pictures", PICTURES, &last_pictures(&pictures))) }
        (folded("balances", BALANCES, &tables::balances(run, result)))
        (folded("setup", SETUP, &tables::setup(run, result, first.as_deref())))
        (next_steps(run))
        (reproduce(run))
    };
    let lead = html! { (lead(run, first.as_deref())) };
    Ok(Shell { tab: tab(title), title, lead, version: &provenance.version, body }.render())
}

/// One line on what was run and how it ended.
fn lead(run: &Run, first: Option<&Snapshot>) -> String {
    let outcome = match &run.outcome {
        Outcome::Finished => "ran to its end",
        Outcome::Steady => "stopped when the cutting force was steady",
        Outcome::Interrupted => "was interrupted",
        Outcome::Diverged(_) => "diverged",
    };
    let dimension = if run.facts.dimension == 2 { "plane strain" } else { "three dimensions" };
    let finest = run.facts.particle_spacing * UM;
    let coarsest =
        first.map_or(1.0, |first| first.relative_spacing.iter().copied().fold(1.0, f64::max));
    let spacing = if coarsest > 1.0 {
        format!("{} to {}", three_digits(finest), three_digits(finest * coarsest))
    } else {
        three_digits(finest)
    };
    let time = run.samples.last().map_or(0.0, |s| s.get(sphcut_sph::ChannelId::Time));
    format!(
        "Scenario {}, {dimension}, {} particles of {spacing} \u{b5}m; {outcome} after {} ms of simulated \
         time.",
        run.provenance.scenario_name,
        grouped(run.performance.particles as u64),
        three_digits(time * 1e3),
    )
}

fn warnings(result: &ProcessResult, is_cut: bool) -> Markup {
    if result.warnings.is_empty() {
        return html! {
            p.clean {
                "No warnings: " @if is_cut { "the cutting force is steady, " }
                "the balances close and the numerical terms are within their limits."
            }
        };
    }
    note("Before you use these numbers", result.warnings.iter().map(|warning| html! { (warning) }))
}

/// Of what moves.
const fn heading(is_cut: bool) -> &'static str {
    if is_cut { "The cut" } else { "The run" }
}

const CHARTS: &str = "Charts of contact, shear zone, chip and surface";
const HISTORY: &str = "History and steadiness";
const PICTURES: &str = "Pictures of the end of the run";
const BALANCES: &str = "Balances";
const SETUP: &str = "Setup";

/// Names and headings of the sections.
fn sections(is_cut: bool, pictures: &Pictures) -> Vec<(&'static str, &'static str)> {
    let mut sections = vec![("cut", heading(is_cut)), ("results", "Results")];
    if is_cut {
        sections.extend([("chip", "Chip and surface"), ("charts", "Charts")]);
    }
    sections.push(("history", "History"));
    if !pictures.fields.is_empty() {
        sections.push(("pictures", "Pictures"));
    }
    sections.extend([("balances", BALANCES), ("setup", SETUP), ("reproduce", "How to reproduce")]);
    sections
}

/// Every field at the end of the run.
fn last_pictures(pictures: &Pictures) -> Markup {
    html! {
        @if let Some(cut_off) = &pictures.cut_off { p { (cut_off) } }
        div.pair {
            @for picture in pictures.fields.iter().chain(&pictures.layers) { (figure(picture)) }
            // Without an animation it stands above.
            @if let Some(whole) = pictures.whole.as_ref().filter(|_| pictures.animation.is_some()) {
                (figure(whole))
            }
        }
    }
}

fn figure(picture: &Picture) -> Markup {
    html! { figure { img src=(uri(picture)) alt=(picture.description); figcaption { (picture.title) } } }
}

fn uri(picture: &Picture) -> String {
    data_uri(picture.media_type, &picture.bytes)
}

/// FOLDER is that of this page.
fn next_steps(run: &Run) -> Markup {
    if !ProcessResult::is_cut(run) {
        return html! {};
    }
    next(&[
        (
            "sphcut springback FOLDER",
            "springback and residual stress of the machined surface; FOLDER is that of this page",
        ),
        (
            "sphcut sweep SWEEP.toml",
            "forces over speed and thickness, and their coefficients (docs/howto/sweep.md)",
        ),
        (
            "sphcut calibrate-friction SCENARIO --measured FILE",
            "the friction coefficient that fits measured forces",
        ),
        (
            "sphcut diagnose CASE.toml",
            "which physics is missing, told from measured forces (docs/howto/diagnose.md)",
        ),
    ])
}

fn reproduce(run: &Run) -> Markup {
    let provenance = &run.provenance;
    html! {
        section id="reproduce" {
            h2 { "How to reproduce" }
            p {
                "With sphcut " (provenance.version) " and the text below as "
                code { (provenance.scenario_name) ".toml" } ":"
            }
            pre { code { "sphcut run " (provenance.scenario_name) ".toml" } }
            p {
                "The same scenario gives the same bits, whatever the number of threads. Seed: "
                (provenance.seed) "."
            }
            details {
                summary { "Scenario, word for word" }
                pre { (provenance.scenario_text) }
            }
        }
    }
}
