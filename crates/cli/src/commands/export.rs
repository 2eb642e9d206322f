//! `sphcut export`: the particles of a run for ParaView.

use crate::failure::{ExitCode, Failure};
use crate::terminal::note;
use crate::{files, loading};
use clap::Args;
use sphcut_record::{RunFiles, export_vtkhdf};
use std::path::PathBuf;

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Folder of the run, with `run.h5` inside.
    run: PathBuf,
    /// File to write [default: RUN/snapshots.vtkhdf]; the tool goes beside it into tool.vtkhdf.
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
    let tool = target.with_file_name("tool.vtkhdf");
    if tool == target {
        return Err(Failure::input("`tool.vtkhdf` is the file of the tool: choose another name"));
    }
    files::unless_there([target.clone(), tool.clone()], arguments.force)?;
    let run = loading::run(&arguments.run)?;
    let has_tool = export_vtkhdf(&run, &target, &tool)
        .map_err(|error| Failure::of_run(&error, &arguments.run))?;
    note(&format!("{} snapshots in {}", run.snapshots.len(), target.display()));
    if has_tool {
        note(&format!("tool               {}", tool.display()));
    }
    note("next               open them in ParaView, or with pyvista.read");
    Ok(ExitCode::Done)
}
