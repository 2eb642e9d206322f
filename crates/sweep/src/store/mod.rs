//! Results by their address.
//!
//! ```text
//! store.json                 what this folder is
//! results/ab/ADDRESS/        a finished run: run.h5, summary.json, forces.csv, scenario.toml, entry.json
//! failed/ab/ADDRESS/         a run that cannot finish: failure.json beside what it left
//! work/ADDRESS/              a run that is not finished, with the lock of the process that computes it
//! sweeps/NAME.json           which addresses a sweep needs; NAME.backup the same once more
//! ADDRESS.removed/           what `gc` is removing
//! ```
//!
//! A result appears by one rename of its complete, synced folder: it is there whole or not at all. `ab` are
//! the first two digits of the address, so that no folder has more than a 256th of the results. A process that
//! is killed loses its locks, and its runs are gone on with from their last checkpoint by whoever comes next.

mod claim;
mod entry;
mod keep;
mod self_digest;

pub use claim::{Claim, Work};
pub use entry::{ResultEntry, RunFailure, StoredFile};
pub use keep::{Integrity, Leftover, Needs, StoreContents};

use crate::Address;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

const LAYOUT: u64 = 1;
const MARK: &str = "store.json";

/// A folder of results.
#[derive(Debug, Clone)]
pub struct Store {
    root: PathBuf,
}

/// Why a store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file that cannot be read or written.
    #[error("cannot {what} `{}`: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried.
        what: &'static str,
        /// What the system says.
        error: io::Error,
    },
    /// A folder that holds something else.
    #[error("`{}` is no store of results: it has files but no {MARK}", .0.display())]
    Foreign(PathBuf),
    /// A store of another layout.
    #[error("the store `{}` has layout {}; this version of sphcut knows {LAYOUT}", .0.display(), .1)]
    Layout(PathBuf, u64),
    /// A record that is not what it should be.
    #[error("`{}` is damaged: {}", .0.display(), .1)]
    Damaged(PathBuf, String),
}

pub(crate) fn at<T>(
    path: &Path,
    what: &'static str,
    result: io::Result<T>,
) -> Result<T, StoreError> {
    result.map_err(|error| StoreError::Io { path: path.to_owned(), what, error })
}

impl Store {
    /// Opens the store in `root`, which is made if it is not there.
    ///
    /// # Errors
    /// A folder with other things in it, a store of another layout, a folder that cannot be written.
    pub fn create(root: &Path) -> Result<Self, StoreError> {
        if !root.join(MARK).exists() {
            at(root, "create", fs::create_dir_all(root))?;
            let mut entries = at(root, "read", fs::read_dir(root))?;
            // Another process may be making the same store.
            if entries.any(|entry| {
                entry.is_ok_and(|e| !e.file_name().to_string_lossy().starts_with(MARK))
            }) {
                if !root.join(MARK).exists() {
                    return Err(StoreError::Foreign(root.to_owned()));
                }
            } else {
                let mark = json!({ "what": "results of sphcut by address", "layout": LAYOUT });
                write_json(&root.join(MARK), &mark, Durability::Synced)?;
            }
        }
        Self::open(root)
    }

    /// Opens the store in `root`.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        let mark = root.join(MARK);
        if root.exists() && !mark.exists() {
            return Err(StoreError::Foreign(root.to_owned()));
        }
        let layout = read_json::<Value>(&mark)?["layout"].as_u64().unwrap_or(0);
        if layout != LAYOUT {
            return Err(StoreError::Layout(root.to_owned(), layout));
        }
        // Absolute, so that what is noted in it can be found from anywhere.
        let root = at(root, "find", fs::canonicalize(root))?;
        for name in ["results", "failed", "work", "sweeps"] {
            let folder = root.join(name);
            at(&folder, "create", fs::create_dir_all(&folder))?;
        }
        Ok(Self { root })
    }

    /// Its folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Folder of the finished run with this address.
    #[must_use]
    pub fn result(&self, address: &Address) -> PathBuf {
        self.sharded("results", address)
    }

    fn failure_folder(&self, address: &Address) -> PathBuf {
        self.sharded("failed", address)
    }

    fn work_folder(&self, address: &Address) -> PathBuf {
        self.root.join("work").join(address.to_string())
    }

    fn sharded(&self, kind: &str, address: &Address) -> PathBuf {
        let name = address.to_string();
        self.root.join(kind).join(&name[..2]).join(name)
    }

    /// Whether the run with this address is finished: its record can be read, all its files have their size, and those
    /// that tables are made of their content.
    #[must_use]
    pub fn has(&self, address: &Address) -> bool {
        let folder = self.result(address);
        folder.join(entry::ENTRY).exists()
            && ResultEntry::read(&folder)
                .is_ok_and(|entry| entry.address == *address && entry.fits(&folder))
    }

    /// Whether somebody has begun the run with this address and not ended it.
    #[must_use]
    pub fn is_begun(&self, address: &Address) -> bool {
        self.work_folder(address).exists()
    }

    /// Forgets that the run with this address cannot finish.
    ///
    /// # Errors
    /// A folder that cannot be removed.
    pub fn forget_failure(&self, address: &Address) -> Result<(), StoreError> {
        let folder = self.failure_folder(address);
        match fs::remove_dir_all(&folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                at(&folder, "remove", Err(error))
            }
            _ => Ok(()),
        }
    }

    /// What is noted of the finished run with this address.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn entry(&self, address: &Address) -> Result<Option<ResultEntry>, StoreError> {
        if !self.has(address) {
            return Ok(None);
        }
        ResultEntry::read(&self.result(address)).map(Some)
    }

    /// Why the run with this address cannot finish, if that is known.
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn failure(&self, address: &Address) -> Result<Option<RunFailure>, StoreError> {
        let folder = self.failure_folder(address);
        if !folder.join(entry::FAILURE).exists() {
            return Ok(None);
        }
        RunFailure::read(&folder).map(Some)
    }
}

/// Whether what is written survives a loss of power at once. It survives the end of the process in any case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Durability {
    /// Yes, for some milliseconds of waiting for the disk.
    Synced,
    /// When the system gets round to it: for what takes less time to compute than to sync.
    Later,
}

/// Distinguishes the writers of this process.
static TURN: AtomicU64 = AtomicU64::new(0);

/// Writes beside the target and renames.
pub(crate) fn write_json(
    path: &Path,
    value: &impl Serialize,
    durability: Durability,
) -> Result<(), StoreError> {
    // By way of a value: its keys are sorted.
    let text = serde_json::to_value(value).map_err(|error| damaged(path, &error))?;
    // Threads and processes that write the same file each have their own half.
    let turn = TURN.fetch_add(1, Ordering::Relaxed);
    let beside = path.with_extension(format!("json.{}.{turn}.tmp", std::process::id()));
    let text = self_digest::sign(&format!("{text:#}\n"));
    let write = || {
        let mut file = sphcut_record::create_anew(&beside)?;
        file.write_all(text.as_bytes())?;
        if durability == Durability::Synced {
            file.sync_all()?;
        }
        fs::rename(&beside, path)
    };
    at(path, "write", write())?;
    // Without it a loss of power may leave later changes, and not this one.
    match path.parent() {
        Some(folder) if durability == Durability::Synced => sync_folder(folder),
        _ => Ok(()),
    }
}

pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, StoreError> {
    let text = at(path, "read", fs::read_to_string(path))?;
    let value =
        self_digest::check(&text).map_err(|reason| StoreError::Damaged(path.to_owned(), reason))?;
    serde_json::from_value(value).map_err(|error| damaged(path, &error))
}

fn damaged(path: &Path, error: &serde_json::Error) -> StoreError {
    StoreError::Damaged(path.to_owned(), error.to_string())
}

/// Makes renames in `folder` survive a loss of power, where the platform can.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), StoreError> {
    if cfg!(unix) {
        return at(folder, "sync", File::open(folder).and_then(|file| file.sync_all()));
    }
    Ok(())
}
