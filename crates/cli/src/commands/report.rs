//! `sphcut report`: summary and page of a run, written again.

use crate::failure::{ExitCode, Failure};
use crate::progress::Style;
use crate::{outcome, results};
use sphcut_record::{Run, RunFiles, recover};
use std::path::Path;

/// Evaluates the run in `folder` and writes its summary and report. Of a run that died without
/// a record, what it had saved is put together first; it can still be resumed.
pub fn report(folder: &Path) -> Result<ExitCode, Failure> {
    let files = RunFiles::in_dir(folder);
    let run = if !files.record().exists() && files.partial().exists() {
        recover(folder)
    } else {
        Run::load(&files.record())
    };
    let run = run.map_err(|error| outcome::failed(&error, folder))?;
    let results = results::write(&run, folder)?;
    outcome::finished(&run, &results, Style::Human);
    Ok(ExitCode::Done)
}
