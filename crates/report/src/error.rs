//! Why a report could not be written.

use sphcut_record::RunError;
use std::path::PathBuf;

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A snapshot of the record could not be read.
    #[error("the report needs the record of the run: {0}")]
    Record(#[from] RunError),
    /// The page could not be written.
    #[error("cannot write the report to {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}
