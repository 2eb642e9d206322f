//! `sphcut report`: summary and page of a run, written again.

use crate::failure::{ExitCode, Failure};
use crate::progress::OutputStyle;
use crate::{loading, outcome, results};
use clap::Args;
use sphcut_record::{RunFiles, recover};
use std::path::PathBuf;

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Folder of the run, with `run.h5` inside.
    run: PathBuf,
}

/// Evaluates the run in `folder` and writes its summary and report. Of a run that died without
/// a record, what it had saved is put together first; it can still be resumed.
pub fn report(arguments: &ReportArguments) -> Result<ExitCode, Failure> {
    let folder = arguments.run.as_path();
    let files = RunFiles::in_dir(folder);
    let run = if !files.record().exists() && files.partial().exists() {
        recover(folder).map_err(|error| Failure::of_run(&error, folder))?
    } else {
        loading::run(folder)?
    };
    let results = results::write(&run, folder)?;
    outcome::finished(&run, &results, OutputStyle::Human);
    Ok(ExitCode::Done)
}
