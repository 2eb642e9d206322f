//! What is said before and after a run.

use crate::digest::digest;
use crate::failure::Failure;
use crate::progress::{OutputStyle, emit};
use crate::results::Results;
use crate::terminal::note;
use crate::{terminal, text};
use serde_json::{Value, json};
use sphcut_postprocess::{ProcessResult, summary_json};
use sphcut_record::Run;
use sphcut_record::driver::RunOptions;
use sphcut_scenario::Scenario;

/// Says what starts, and what the user should know before trusting it.
pub fn announce(scenario: &Scenario, options: &RunOptions, style: OutputStyle) {
    let folder = options.out_dir.display();
    match style {
        OutputStyle::Json => emit(&json!({
            "event": "start",
            "scenario": scenario.name,
            "title": scenario.title,
            "out": folder.to_string(),
            "threads": options.threads,
            "warnings": scenario.warnings,
        })),
        OutputStyle::Human => {
            let plural = if options.threads == 1 { "" } else { "s" };
            note(&format!("{}: {} thread{plural}, into {folder}", scenario.title, options.threads));
        }
        OutputStyle::Quiet => {}
    }
    if style != OutputStyle::Json {
        for warning in &scenario.warnings {
            note(&format!("warning: {warning}"));
        }
    }
}

/// The failure as a JSON line.
pub fn emit_error(failure: &Failure) {
    emit(&json!({
        "event": "error",
        "exit_code": failure.exit_code().number(),
        "message": failure.message(),
    }));
}

/// Says how to go on.
pub fn interrupted(run: &Run, style: OutputStyle) {
    let steps = run.performance.steps;
    match style {
        OutputStyle::Json => emit(&json!({ "event": "interrupted", "step": steps })),
        _ => note(&format!(
            "interrupted after step {}: a checkpoint is written; the same command with --resume \
             goes on",
            text::grouped(steps)
        )),
    }
}

/// What can be done with a run.
fn next(run: &Run, results: &Results) -> String {
    let folder = results.page.parent().unwrap_or(&results.page).display();
    match ProcessResult::is_cut(run) {
        true if !results.result.steady.reached => {
            "open the page; a longer `travel` in [stop] makes the means steady".to_owned()
        }
        true if run.facts.dimension == 2 => {
            format!("open the page; `sphcut springback {folder}` measures the machined surface")
        }
        _ => "open the page in a browser".to_owned(),
    }
}

/// Says what came out and where it is.
pub fn finished(run: &Run, results: &Results, style: OutputStyle) {
    let result = &results.result;
    let summary = summary_json(result);
    if style == OutputStyle::Human {
        terminal::line(digest(run, result).trim_end());
    }
    if style != OutputStyle::Json {
        // Those of the scenario were told at the start.
        let told = |warning: &String| run.provenance.warnings.contains(warning);
        for warning in result.warnings.iter().map(ToString::to_string).filter(|w| !told(w)) {
            note(&format!("warning: {warning}"));
        }
    }
    match style {
        OutputStyle::Json => emit(&json!({
            "event": "done",
            "out": results.page.parent().map(|folder| folder.display().to_string()),
            "report": results.page.display().to_string(),
            // The text comes from a serialiser: it is JSON.
            "summary": serde_json::from_str::<Value>(&summary).unwrap_or_default(),
        })),
        OutputStyle::Human => {
            terminal::report(&results.page, &next(run, results));
        }
        OutputStyle::Quiet => {}
    }
}
