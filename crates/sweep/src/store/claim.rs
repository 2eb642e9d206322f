//! Who computes a run, and how its result gets into the store.

use super::entry::StoredFile;
use super::{Durability, ResultEntry, RunFailure, Store, StoreError, at, sync_folder};
use crate::Address;
use sphcut_record::{create_anew, open_lock};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

const LOCK: &str = "lock";
/// Wall-clock time in s of a run that is worth waiting for the disk; a shorter one is computed again after a loss
/// of power.
const WORTH_A_SYNC: f64 = 1.0;
/// Attempts to lock a folder that others move away at the same time.
const ATTEMPTS: usize = 100;

/// What the store says to somebody who wants a result.
#[derive(Debug)]
pub enum Claim {
    /// It is there.
    Done,
    /// It cannot be computed.
    Failed(RunFailure),
    /// Another process computes it.
    Busy,
    /// Compute it, or go on with it, in this folder.
    Mine(Work),
}

/// The right to compute a run; it ends with this value or with the process.
#[derive(Debug)]
pub struct Work {
    address: Address,
    folder: PathBuf,
    /// Dropping it unlocks.
    _lock: File,
}

impl Work {
    /// Where the run is computed; what an earlier attempt has saved is there.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

/// Whether a known failure counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Failures {
    Count,
    Forgotten,
}

impl Store {
    /// Asks for the run with this address.
    ///
    /// # Errors
    /// A folder that cannot be read or written.
    pub fn claim(&self, address: &Address) -> Result<Claim, StoreError> {
        self.claimed(address, Failures::Count)
    }

    /// As [`Self::claim`], but a run that has failed is tried again.
    ///
    /// # Errors
    /// As there.
    pub fn claim_again(&self, address: &Address) -> Result<Claim, StoreError> {
        self.claimed(address, Failures::Forgotten)
    }

    fn claimed(&self, address: &Address, failures: Failures) -> Result<Claim, StoreError> {
        let folder = self.work_folder(address);
        for _ in 0..ATTEMPTS {
            if let Some(known) = self.known(address, failures)? {
                return Ok(known);
            }
            match fs::create_dir_all(&folder) {
                // There, and moved away before the library has looked what it is: look again.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && !folder.is_file() => {
                    continue;
                }
                made => at(&folder, "create", made)?,
            }
            let path = folder.join(LOCK);
            let lock = match open_lock(&path) {
                // Moved away since: look again.
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                file => at(&path, "write", file)?,
            };
            match lock.try_lock() {
                Err(TryLockError::WouldBlock) => return Ok(Claim::Busy),
                Err(TryLockError::Error(error)) => return at(&path, "lock", Err(error)),
                Ok(()) => {}
            }
            if !is_at(&lock, &path) {
                continue;
            }
            // It may have been finished while we waited for the lock.
            if let Some(known) = self.known(address, failures)? {
                self.discard(&folder)?;
                return Ok(known);
            }
            if failures == Failures::Forgotten {
                let failed = self.failure_folder(address);
                if failed.exists() {
                    at(&failed, "remove", fs::remove_dir_all(&failed))?;
                }
            }
            return Ok(Claim::Mine(Work { address: *address, folder, _lock: lock }));
        }
        Ok(Claim::Busy)
    }

    fn known(&self, address: &Address, failures: Failures) -> Result<Option<Claim>, StoreError> {
        if self.has(address) {
            return Ok(Some(Claim::Done));
        }
        if failures == Failures::Forgotten {
            return Ok(None);
        }
        Ok(self.failure(address)?.map(Claim::Failed))
    }

    /// Puts the text of the scenario beside the results of `work`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep_scenario(&self, work: &Work, text: &str) -> Result<(), StoreError> {
        let path = work.folder.join("scenario.toml");
        let write = || create_anew(&path)?.write_all(text.as_bytes());
        at(&path, "write", write())
    }

    /// Publishes what lies in the folder of `work` as the result of its address.
    ///
    /// # Errors
    /// A file that cannot be read or written; nothing is published then.
    pub fn publish(&self, work: Work, mut entry: ResultEntry) -> Result<ResultEntry, StoreError> {
        entry.files = files(&work.folder)?;
        let durability =
            if entry.wall_seconds >= WORTH_A_SYNC { Durability::Synced } else { Durability::Later };
        entry.write(&work.folder, durability)?;
        self.move_to(&work, &self.result(&work.address), durability)?;
        Ok(entry)
    }

    /// Notes that the run of `work` cannot finish; what it left is kept beside the reason.
    ///
    /// # Errors
    /// As [`Self::publish`].
    pub fn refuse(
        &self,
        work: Work,
        reason: &str,
        wall_seconds: f64,
    ) -> Result<RunFailure, StoreError> {
        let failure = RunFailure { address: work.address, reason: reason.to_owned(), wall_seconds };
        failure.write(&work.folder)?;
        self.move_to(&work, &self.failure_folder(&work.address), Durability::Synced)?;
        Ok(failure)
    }

    fn move_to(&self, work: &Work, place: &Path, durability: Durability) -> Result<(), StoreError> {
        if durability == Durability::Synced {
            sync_folder(&work.folder)?;
        }
        let parent = place.parent().unwrap_or(&self.root);
        at(parent, "create", fs::create_dir_all(parent))?;
        if place.exists() {
            // Damaged by a person or a loss of power: the address says that ours is what it was.
            at(place, "remove", fs::remove_dir_all(place))?;
        }
        at(place, "write", fs::rename(&work.folder, place))?;
        if durability == Durability::Synced {
            sync_folder(parent)?;
        }
        // Only now: a lock that is removed before the move could be taken by somebody else.
        remove(&place.join(LOCK))
    }

    fn discard(&self, folder: &Path) -> Result<(), StoreError> {
        match fs::remove_dir_all(folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                at(folder, "remove", Err(error))
            }
            _ => Ok(()),
        }
    }

    /// Folders of runs that are not finished, with whether a process computes them now.
    pub(super) fn unfinished(&self) -> Result<Vec<(PathBuf, bool)>, StoreError> {
        let work = self.root.join("work");
        let mut found = Vec::new();
        for entry in at(&work, "read", fs::read_dir(&work))?.flatten() {
            let lock = File::open(entry.path().join(LOCK));
            let busy =
                lock.is_ok_and(|lock| matches!(lock.try_lock(), Err(TryLockError::WouldBlock)));
            found.push((entry.path(), busy));
        }
        found.sort();
        Ok(found)
    }
}

/// The files of a run, all but the notes about it.
fn files(folder: &Path) -> Result<Vec<StoredFile>, StoreError> {
    let mut names: Vec<String> = at(folder, "read", fs::read_dir(folder))?
        .flatten()
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()))
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name != LOCK && name != super::entry::ENTRY && !name.ends_with(".tmp"))
        .collect();
    names.sort();
    names.iter().map(|name| StoredFile::of(folder, name)).collect()
}

fn remove(path: &Path) -> Result<(), StoreError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => at(path, "remove", Err(error)),
        _ => Ok(()),
    }
}

/// Whether the open `file` is the one at `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: io::Result<fs::Metadata>| metadata.ok().map(|m| (m.dev(), m.ino()));
    identity(file.metadata()).is_some() && identity(file.metadata()) == identity(fs::metadata(path))
}

/// Whether the open `file` is the one at `path`: an open file cannot be moved here.
#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.exists()
}
