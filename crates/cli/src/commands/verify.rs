//! `sphcut verify`: whether the files of runs still hold what was written.

use crate::failure::{ExitCode, Failure};
use crate::loading::not_verified;
use crate::terminal::{line, note};
use clap::Args;
use sphcut_record::{RunFiles, Verified, verify_h5, verify_run};
use std::path::PathBuf;

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyRunsArguments {
    /// Folders of runs, or single files: `run.h5`, `.vtkhdf`.
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
}

/// Checks every run; a folder with its companions, a file alone.
pub fn verify(arguments: &VerifyRunsArguments) -> Result<ExitCode, Failure> {
    let checks = arguments.runs.iter().flat_map(|path| match path.is_file() {
        true => vec![(path.clone(), verify_h5(path))],
        false => verify_run(&RunFiles::in_dir(path)),
    });
    let (mut files, mut damaged) = (0, 0);
    for (path, found) in checks {
        files += 1;
        match found {
            Ok(Verified::Whole) => line(&format!("whole: {}", path.display())),
            Ok(Verified::NoChecksums) => note(&not_verified(&path)),
            Err(error) => {
                damaged += 1;
                note(&format!("error: {error}"));
            }
        }
    }
    line(&format!("{files} files, {damaged} damaged"));
    if damaged == 0 {
        return Ok(ExitCode::Done);
    }
    Err(Failure::new(ExitCode::InputOutput, format!("{damaged} of {files} files are damaged"))
        .advise("compute the runs again, or take the files from a backup"))
}
