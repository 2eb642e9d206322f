//! Why a report could not be written.

use sphcut_record::RunError;
use std::fmt;
use std::path::PathBuf;

/// Why a report could not be written.
#[derive(Debug)]
pub enum ReportError {
    /// A snapshot of the record could not be read.
    Record(RunError),
    /// The page could not be written.
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Record(error) => write!(f, "the report needs the record of the run: {error}"),
            Self::Write { path, source } => {
                write!(f, "cannot write the report to {}: {source}", path.display())
            }
        }
    }
}

impl std::error::Error for ReportError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Record(error) => Some(error),
            Self::Write { source, .. } => Some(source),
        }
    }
}

impl From<RunError> for ReportError {
    fn from(error: RunError) -> Self {
        Self::Record(error)
    }
}
