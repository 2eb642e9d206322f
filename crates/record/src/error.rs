//! What can go wrong while a run is computed, recorded or read.

use sphcut_sph::{Diverged, SetupError};
use std::io;
use std::path::{Path, PathBuf};

/// A run that could not be computed, recorded or read.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A file or folder could not be read or written.
    #[error("cannot {action} `{}`: {}{}", .path.display(), io_reason(.source), after_semicolon(.kept))]
    Io {
        /// Which one.
        path: PathBuf,
        /// What was being done, e.g. `write`.
        action: &'static str,
        /// What the system says.
        source: io::Error,
        /// What is kept of the run and how to go on; empty if nothing was at stake.
        kept: String,
    },
    /// The run blew up. Its record up to the last good state is saved.
    #[error("{divergence}; saved until then: `{}`", .record.display())]
    Diverged {
        /// Where and how.
        divergence: Diverged,
        /// The record.
        record: PathBuf,
    },
    /// There is a result, or the beginning of one, and nobody allowed to replace it.
    #[error("`{}` {}", .path.display(), way_out(.resumable))]
    Exists {
        /// The file or folder that is there.
        path: PathBuf,
        /// Whether it is an unfinished run that can be resumed.
        resumable: bool,
    },
    /// Another process is writing this run.
    #[error("another sphcut is writing in `{}`", .path.display())]
    InUse {
        /// The folder it works in.
        path: PathBuf,
    },
    /// A file is not what its name says.
    #[error("`{}` is not {expected}: {reason}", .path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What was expected, e.g. `a record of a run`.
        expected: &'static str,
        /// What does not fit.
        reason: String,
    },
    /// A file is cut short or changed after it was written.
    #[error("`{}` is damaged: {reason}", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// An array has more values than are read.
    #[error("`{array}` has {values} values, more than {most}, in `{}`", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The array.
        array: String,
        /// Its values.
        values: u64,
        /// Most that are read.
        most: u64,
    },
    /// A stored state belongs to another run.
    #[error("`{}` belongs to another run: {reason}", .path.display())]
    Mismatch {
        /// The file it is stored in.
        path: PathBuf,
        /// What differs.
        reason: String,
    },
    /// The setup cannot be built.
    #[error("{0}")]
    Setup(#[from] SetupError),
}

impl RunError {
    /// An I/O error on `path` while doing `action`.
    pub(crate) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), action, source, kept: String::new() }
    }

    /// The same error; if a file is unusable, with the advice to start the run again.
    pub(crate) fn advising_force(mut self) -> Self {
        if let Self::Damaged { reason, .. } | Self::Foreign { reason, .. } = &mut self {
            reason.push_str("; start the run again with --force");
        }
        self
    }

    /// The same error, telling what is kept.
    pub(crate) fn keeping(mut self, what: &str) -> Self {
        if let Self::Io { kept, .. } = &mut self {
            what.clone_into(kept);
        }
        self
    }
}

fn io_reason(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "the disk is full".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::NotFound => "there is no such file or folder".to_owned(),
        _ => source.to_string(),
    }
}

/// What to do about a result that exists.
fn way_out(resumable: &bool) -> &'static str {
    match resumable {
        true => "is an unfinished run: use --resume to go on with it or --force to start again",
        false => "exists: use --force to replace it or --out for another folder",
    }
}

/// `text` as the rest of a sentence, if there is one.
fn after_semicolon(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("; {text}") }
}
