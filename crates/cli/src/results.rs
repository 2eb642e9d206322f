//! What is written after a run: `summary.json` and the report.

use crate::failure::Failure;
use crate::outcome;
use sphcut_postprocess::{ProcessResult, evaluate, summary_json};
use sphcut_record::Run;
use std::path::{Path, PathBuf};

/// Name of the numbers for programs.
const SUMMARY: &str = "summary.json";

/// Evaluates the runand writes its summary into `folder`.
pub fn write(run: &Run, folder: &Path) -> Result<ProcessResult, Failure> {
    let result = evaluate(run).map_err(|error| outcome::failed(&error, folder))?;
    save(&folder.join(SUMMARY), summary_json(&result).as_bytes())?;
    Ok(result)
}

/// Writes beside the target and renames: a full disk leaves the old file whole.
fn save(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    std::fs::write(&beside, content)
        .and_then(|()| std::fs::rename(&beside, path))
        .map_err(|error| Failure::output(format!("cannot write `{}`", path.display()), &error))
}
