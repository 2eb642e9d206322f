//! `report.html`: one page that needs nothing but itself.

mod calibration;
mod charts;
mod diagnosis;
mod greybox;
mod identification;
mod measures;
mod recordings;
mod springback;
mod sweep;
mod tables;
mod wear;

pub use calibration::{calibration_words, render_calibration};
pub use diagnosis::{
    DiagnosisPage, SeriesPage, diagnosis_words, render_diagnosis, render_series, series_summary,
};
pub use greybox::{greybox_words, render_comparison, render_greybox};
pub use identification::{IdentificationPage, identification_words, render_identification};
pub use recordings::{RecordingsPage, recordings_words, render_recordings};
pub use springback::{SpringbackRun, render_springback};
pub use sweep::{SweepPage, render_sweep, sweep_words};
pub use wear::{WearPage, render_wear};

use crate::ReportError;
use crate::pictures::{Picture, Pictures, draw_all};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sphcut_postprocess::ProcessResult;
use sphcut_record::{Outcome, Run};
use std::path::{Path, PathBuf};

const STYLE: &str = include_str!("style.css");

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
    let pictures = draw_all(run)?;
    Ok(page(run, result, &pictures).into_string())
}

fn page(run: &Run, result: &ProcessResult, pictures: &Pictures) -> Markup {
    let provenance = &run.provenance;
    let title =
        if provenance.title.is_empty() { &provenance.scenario_name } else { &provenance.title };
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content={ "sphcut " (provenance.version) };
                // No request for an icon.
                link rel="icon" href="data:,";
                title { (title) " \u{2013} sphcut" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    header {
                        h1 { (title) }
                        p.lead { (lead(run)) }
                    }
                    (warnings(result))
                    (tables::key_figures(run, result))
                    (cut(pictures))
                    (tables::results(run, result))
                    (measures::section(run, result))
                    (charts::section(run, result))
                    (tables::balances(run, result))
                    (tables::setup(run, result))
                    (reproduce(run))
                    footer { "Written by sphcut " (provenance.version) "." }
                }
            }
        }
    }
}

/// One line on what was run and how it ended.
fn lead(run: &Run) -> String {
    let outcome = match &run.outcome {
        Outcome::Finished => "ran to its end",
        Outcome::Steady => "stopped when the cutting force was steady",
        Outcome::Interrupted => "was interrupted",
        Outcome::Diverged(_) => "diverged",
    };
    let dimension = if run.facts.dimension == 2 { "plane strain" } else { "three dimensions" };
    let time = run.samples.last().map_or(0.0, |s| s.get(sphcut_sph::ChannelId::Time));
    format!(
        "Scenario {}, {dimension}, {} particles of {} \u{b5}m; {outcome} after {} ms of simulated \
         time.",
        run.provenance.scenario_name,
        crate::text::grouped(run.performance.particles as u64),
        crate::text::three_digits(run.facts.particle_spacing * 1e6),
        crate::text::three_digits(time * 1e3),
    )
}

fn warnings(result: &ProcessResult) -> Markup {
    if result.warnings.is_empty() {
        return html! {
            p.clean {
                "No warnings: the cutting force is steady, the balances close and the numerical terms are \
                 within their limits."
            }
        };
    }
    html! {
        section.warnings role="note" {
            h2 { "Before you use these numbers" }
            ul {
                @for warning in &result.warnings { li { (warning) } }
            }
        }
    }
}

fn cut(pictures: &Pictures) -> Markup {
    if pictures.fields.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "The cut" }
            @if let Some(animation) = &pictures.animation {
                (figure(animation, pictures.whole.as_ref()))
            } @else if let Some(whole) = &pictures.whole {
                (figure(whole, None))
            }
            div.pair {
                @for picture in pictures.fields.iter().chain(&pictures.layers) {
                    (figure(picture, None))
                }
            }
        }
    }
}

/// A picture; on paper and for readers who want nothing to move, `still` takes its place.
fn figure(picture: &Picture, still: Option<&Picture>) -> Markup {
    html! {
        figure {
            @if let Some(still) = still {
                img.moving src=(uri(picture)) alt=(picture.description);
                img.still src=(uri(still)) alt=(still.description);
            } @else {
                img src=(uri(picture)) alt=(picture.description);
            }
            figcaption { (picture.title) }
        }
    }
}

fn uri(picture: &Picture) -> String {
    format!("data:{};base64,{}", picture.media_type, BASE64_STANDARD.encode(&picture.bytes))
}

fn reproduce(run: &Run) -> Markup {
    let provenance = &run.provenance;
    html! {
        section {
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
