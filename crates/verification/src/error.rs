//! What can be wrong with a case folder.

use std::path::PathBuf;

/// A case that cannot be read or run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CaseError {
    /// A file or folder cannot be read.
    #[error("{}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A file says something that makes no sense.
    #[error("{}: {reason}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A run of the case did not come to its end.
    #[error("run `{run}`: {reason}")]
    RunFailed {
        /// Name of the run.
        run: String,
        /// What happened.
        reason: String,
    },
    /// An observable cannot be computed from what the run produced.
    #[error("`{observable}`: {reason}")]
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

    /// `error` of the run, fit or diagnosis `run`.
    pub(crate) fn failed(run: &str, error: impl ToString) -> Self {
        Self::RunFailed { run: run.to_owned(), reason: error.to_string() }
    }

    pub(crate) fn unobservable(observable: &str, reason: impl Into<String>) -> Self {
        Self::Unobservable { observable: observable.to_owned(), reason: reason.into() }
    }
}
