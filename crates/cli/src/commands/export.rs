//! `sphcut export`: the particles of a run for ParaView.

use crate::failure::{ExitCode, Failure};
use crate::files;
use crate::terminal::note;
use clap::Args;
use sphcut_record::{Run, RunFiles, export_vtkhdf};
use std::path::PathBuf;

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Folder of the run, with `run.h5` inside.
    run: PathBuf,
    /// File to write [default: RUN/snapshots.vtkhdf].
    #[arg(long, value_name = "FILE")]
    to: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Writes the snapshots of a run, to a file or beside the record.
pub fn export(arguments: &ExportArguments) -> Result<ExitCode, Failure> {
    let files = RunFiles::in_dir(&arguments.run);
    let target = arguments.to.clone().unwrap_or_else(|| files.vtkhdf());
    files::unless_there([target.clone()], arguments.force)?;
    let explain = |error| Failure::of_run(&error, &arguments.run);
    let run = Run::load(&files.record()).map_err(explain)?;
    export_vtkhdf(&run, &target).map_err(explain)?;
    note(&format!("{} snapshots in {}", run.snapshots.len(), target.display()));
    Ok(ExitCode::Done)
}
