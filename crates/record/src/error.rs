//! What can go wrong while a run is computed, recorded or read.

use sphcut_sph::{Diverged, SetupError};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Where and with which value a run blew up, as stored in its record.
#[derive(Debug, Clone, PartialEq)]
pub struct Divergence {
    /// Step in which it happened.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// Identifier of the particle.
    pub particle: u64,
    /// Its last position in m.
    pub position: [f64; 3],
    /// Name of the quantity.
    pub quantity: String,
    /// Its value.
    pub value: f64,
}

impl From<Diverged> for Divergence {
    fn from(diverged: Diverged) -> Self {
        Self {
            step: diverged.step,
            time: diverged.time,
            particle: diverged.particle,
            position: diverged.position,
            quantity: diverged.quantity.to_owned(),
            value: diverged.value,
        }
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "diverged in step {} at {:.6e} s: {} of particle {} is {:e} at x = {:.4} mm, y = {:.4} mm",
            self.step,
            self.time,
            self.quantity,
            self.particle,
            self.value,
            self.position[0] * 1e3,
            self.position[1] * 1e3
        )
    }
}

/// A run that could not be computed, recorded or read.
#[derive(Debug)]
pub enum RunError {
    /// A file or folder could not be read or written.
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
    Diverged {
        /// Where and how.
        divergence: Divergence,
        /// The record.
        record: PathBuf,
    },
    /// There is a result, or the beginning of one, and nobody allowed to replace it.
    Exists {
        /// The file or folder that is there.
        path: PathBuf,
        /// Whether it is an unfinished run that can be resumed.
        resumable: bool,
    },
    /// Another process is writing this run.
    InUse {
        /// The folder it works in.
        path: PathBuf,
    },
    /// A file is not what its name says.
    Foreign {
        /// The file.
        path: PathBuf,
        /// What was expected, e.g. `a record of a run`.
        expected: &'static str,
        /// What does not fit.
        reason: String,
    },
    /// A file is cut short or changed after it was written.
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A stored state belongs to another run.
    Mismatch {
        /// The file it is stored in.
        path: PathBuf,
        /// What differs.
        reason: String,
    },
    /// The setup cannot be built.
    Setup(SetupError),
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

impl From<SetupError> for RunError {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, action, source, kept } => {
                write!(f, "cannot {action} `{}`: {}", path.display(), io_reason(source))?;
                if kept.is_empty() { Ok(()) } else { write!(f, "; {kept}") }
            }
            Self::Diverged { divergence, record } => {
                write!(f, "{divergence}; saved until then: `{}`", record.display())
            }
            Self::Exists { path, resumable: true } => write!(
                f,
                "`{}` is an unfinished run: use --resume to go on with it or --force to start again",
                path.display()
            ),
            Self::Exists { path, resumable: false } => write!(
                f,
                "`{}` exists: use --force to replace it or --out for another folder",
                path.display()
            ),
            Self::InUse { path } => {
                write!(f, "another sphcut is writing in `{}`", path.display())
            }
            Self::Foreign { path, expected, reason } => {
                write!(f, "`{}` is not {expected}: {reason}", path.display())
            }
            Self::Damaged { path, reason } => {
                write!(f, "`{}` is damaged: {reason}", path.display())
            }
            Self::Mismatch { path, reason } => {
                write!(f, "`{}` belongs to another run: {reason}", path.display())
            }
            Self::Setup(error) => error.fmt(f),
        }
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

impl std::error::Error for RunError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Setup(error) => Some(error),
            _ => None,
        }
    }
}
