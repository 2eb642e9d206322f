//! What can be wrong with a case folder.

use std::fmt;
use std::path::PathBuf;

/// A case that cannot be read or run.
#[derive(Debug, Clone, PartialEq)]
pub enum CaseError {
    /// A file or folder cannot be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A file says something that makes no sense.
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A run of the case did not come to its end.
    RunFailed {
        /// Name of the run.
        run: String,
        /// What happened.
        reason: String,
    },
    /// An observable cannot be computed from what the run produced.
    Unobservable {
        /// Name of the observable.
        observable: String,
        /// What is missing.
        reason: String,
    },
}

impl CaseError {
    pub(crate) fn invalid(path: impl Into<PathBuf>, reason: impl Into<String>) -> Self {
        Self::Invalid { path: path.into(), reason: reason.into() }
    }

    pub(crate) fn unreadable(path: impl Into<PathBuf>, error: &std::io::Error) -> Self {
        Self::Unreadable { path: path.into(), reason: error.to_string() }
    }
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { path, reason } => write!(f, "{}: {reason}", path.display()),
            Self::Invalid { path, reason } => write!(f, "{}: {reason}", path.display()),
            Self::RunFailed { run, reason } => write!(f, "run `{run}`: {reason}"),
            Self::Unobservable { observable, reason } => write!(f, "`{observable}`: {reason}"),
        }
    }
}

impl std::error::Error for CaseError {}
