//! What is written after a run: `summary.json` and the report.

use crate::failure::{ExitCode, Failure};
use crate::files::save;
use sphcut_postprocess::{ProcessResult, evaluate, summary_json};
use sphcut_record::Run;
use std::path::{Path, PathBuf};

/// Name of the numbers for programs.
pub const SUMMARY: &str = "summary.json";

/// What a run means, and the page that shows it.
#[derive(Debug)]
pub struct Results {
    /// Forces, chip, balances.
    pub result: ProcessResult,
    /// Path of the report.
    pub page: PathBuf,
}

/// Evaluates the run and writes its summary and its report into `folder`.
pub fn write(run: &Run, folder: &Path) -> Result<Results, Failure> {
    let result = evaluate(run).map_err(|error| Failure::of_run(&error, folder))?;
    save(&folder.join(SUMMARY), summary_json(&result).as_bytes())?;
    let page = sphcut_report::write_report(run, &result, folder)
        .map_err(|error| Failure::new(ExitCode::InputOutput, error.to_string()))?;
    Ok(Results { result, page })
}
