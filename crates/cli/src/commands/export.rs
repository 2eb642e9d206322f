//! `sphcut export`: the particles of a run for ParaView.

use crate::failure::{ExitCode, Failure};
use crate::outcome;
use crate::terminal::note;
use sphcut_record::{Run, RunFiles, export_vtkhdf};
use std::path::Path;

/// Writes the snapshots of the run in `folder` to `to`, or beside the record.
pub fn export(folder: &Path, to: Option<&Path>, force: bool) -> Result<ExitCode, Failure> {
    let files = RunFiles::in_dir(folder);
    let target = to.map_or_else(|| files.vtkhdf(), Path::to_owned);
    if target.exists() && !force {
        let message = format!("`{}` exists: use --force to replace it", target.display());
        return Err(Failure::input(message));
    }
    let explain = |error| outcome::failed(&error, folder);
    let run = Run::load(&files.record()).map_err(explain)?;
    export_vtkhdf(&run, &target).map_err(explain)?;
    note(&format!("{} snapshots in {}", run.snapshots.len(), target.display()));
    Ok(ExitCode::Done)
}
