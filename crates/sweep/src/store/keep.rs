//! Looking after a store: what is in it, whether it is whole, what nobody needs.

use super::entry::StoredFile;
use super::{
    Durability, MARK, ResultEntry, RunFailure, Store, StoreError, at, read_json, sync_folder,
    write_json,
};
use crate::Address;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of the notes of what a sweep needs: the note and its backup.
const NEEDS: [&str; 2] = ["json", "backup"];
/// Ending of a folder that is being removed.
const REMOVED: &str = "removed";

/// What a store holds.
#[derive(Debug, Default)]
pub struct StoreContents {
    /// Finished runs, by address; those whose record cannot be read have their reason.
    pub results: Vec<Result<ResultEntry, StoreError>>,
    /// Runs that cannot finish.
    pub failures: Vec<Result<RunFailure, StoreError>>,
    /// Unfinished runs, and whether a process computes them now.
    pub unfinished: Vec<(PathBuf, bool)>,
}

/// Whether a result is whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Integrity {
    /// All files are as they were written.
    Whole,
    /// What is wrong.
    Damaged(String),
}

/// What a sweep needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Needs {
    /// Output folder of the sweep.
    pub folder: PathBuf,
    /// Its addresses.
    pub addresses: BTreeSet<Address>,
}

/// What nobody needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Leftover {
    /// The folder or file.
    pub path: PathBuf,
    /// Why it is not needed.
    pub reason: &'static str,
    /// Its size in bytes.
    pub bytes: u64,
}

impl Store {
    /// Everything in the store.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn list(&self) -> Result<StoreContents, StoreError> {
        Ok(StoreContents {
            results: self
                .folders("results")?
                .iter()
                .map(|folder| ResultEntry::read(folder))
                .collect(),
            failures: self
                .folders("failed")?
                .iter()
                .map(|folder| RunFailure::read(folder))
                .collect(),
            unfinished: self.unfinished()?,
        })
    }

    /// Reads every file of a result and compares it with its record.
    ///
    /// # Errors
    /// None so far: what cannot be read is damaged.
    pub fn verify(&self, entry: &ResultEntry) -> Integrity {
        let folder = self.result(&entry.address);
        for file in &entry.files {
            match StoredFile::of(&folder, &file.name) {
                Err(error) => return Integrity::Damaged(error.to_string()),
                Ok(found) if found.bytes != file.bytes => {
                    let message =
                        format!("`{}` has {} bytes, not {}", file.name, found.bytes, file.bytes);
                    return Integrity::Damaged(message);
                }
                Ok(found) if found.sha256 != file.sha256 => {
                    return Integrity::Damaged(format!(
                        "the content of `{}` has changed",
                        file.name
                    ));
                }
                Ok(_) => {}
            }
        }
        Integrity::Whole
    }

    /// Folders of all results, those with an unreadable record included.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn result_folders(&self) -> Result<Vec<PathBuf>, StoreError> {
        self.folders("results")
    }

    /// Takes a result out of the store: away from its place first, so that no half of one is left there.
    ///
    /// # Errors
    /// A folder that cannot be removed.
    pub fn remove(&self, folder: &Path) -> Result<(), StoreError> {
        if !folder.is_dir() {
            return at(folder, "remove", fs::remove_file(folder));
        }
        let away = match folder.extension().is_some_and(|ending| ending == REMOVED) {
            true => folder.to_owned(),
            false => {
                let name = folder.file_name().unwrap_or_default().to_string_lossy();
                let away = self.root.join(format!("{name}.{REMOVED}"));
                if away.exists() {
                    at(&away, "remove", fs::remove_dir_all(&away))?;
                }
                at(folder, "remove", fs::rename(folder, &away))?;
                sync_folder(&self.root)?;
                sync_folder(folder.parent().unwrap_or(&self.root))?;
                away
            }
        };
        at(&away, "remove", fs::remove_dir_all(&away))
    }

    /// Notes what the sweep in `folder` needs.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn note_needs(&self, needs: &Needs) -> Result<(), StoreError> {
        let shown = needs.folder.display().to_string();
        let name: String = Sha256::digest(shown.as_bytes())
            .iter()
            .take(8)
            .map(|byte| format!("{byte:02x}"))
            .collect();
        NEEDS.iter().try_for_each(|ending| {
            let path = self.root.join("sweeps").join(format!("{name}.{ending}"));
            write_json(&path, needs, Durability::Synced)
        })
    }

    /// Files with notes of what sweeps need, backups included.
    fn needs_files(&self) -> Result<Vec<PathBuf>, StoreError> {
        let folder = self.root.join("sweeps");
        let entries = at(&folder, "read", fs::read_dir(&folder))?;
        let paths = entries.map(|entry| at(&folder, "read", entry).map(|entry| entry.path()));
        let mut paths: Vec<PathBuf> = paths.collect::<Result<_, _>>()?;
        paths.retain(|path| path.extension().is_some_and(|e| NEEDS.iter().any(|n| e == *n)));
        paths.sort();
        Ok(paths)
    }

    /// What is wrong with the store's notes about itself, its sweeps and its failures.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn damaged_notes(&self) -> Result<Vec<StoreError>, StoreError> {
        let mut paths = self.needs_files()?;
        paths.push(self.root.join(MARK));
        let failures = self.folders("failed")?;
        let notes = paths.iter().map(|path| read_json::<Value>(path).map(|_| ()));
        let failures = failures.iter().map(|folder| RunFailure::read(folder).map(|_| ()));
        Ok(notes.chain(failures).filter_map(Result::err).collect())
    }

    /// Folders of results that are not what was written, each with what is wrong.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn damaged_results(&self) -> Result<Vec<(PathBuf, String)>, StoreError> {
        let mut damaged = Vec::new();
        for folder in self.result_folders()? {
            let verdict = match ResultEntry::read(&folder) {
                Ok(entry) if !folder.ends_with(entry.address.to_string()) => {
                    Integrity::Damaged(format!("the folder of {} has another name", entry.address))
                }
                Ok(entry) => self.verify(&entry),
                Err(error) => Integrity::Damaged(error.to_string()),
            };
            if let Integrity::Damaged(reason) = verdict {
                damaged.push((folder, reason));
            }
        }
        Ok(damaged)
    }

    /// What all sweeps need whose folders are still there.
    ///
    /// # Errors
    /// A record that cannot be read: then nothing may be thrown away.
    pub fn needs(&self) -> Result<Vec<Needs>, StoreError> {
        let mut all: Vec<Needs> = Vec::new();
        for path in self.needs_files()? {
            let needs: Needs = read_json(&path)?;
            match all.iter_mut().find(|known| known.folder == needs.folder) {
                Some(known) => known.addresses.extend(needs.addresses),
                None if needs.folder.exists() => all.push(needs),
                None => {}
            }
        }
        Ok(all)
    }

    /// What no sweep needs: results and failures that none names, unfinished runs of the same kind that no
    /// process computes, and halves of files.
    ///
    /// # Errors
    /// A folder or record that cannot be read.
    pub fn leftovers(&self) -> Result<Vec<Leftover>, StoreError> {
        let needed: BTreeSet<String> = self
            .needs()?
            .iter()
            .flat_map(|needs| needs.addresses.iter().map(ToString::to_string))
            .collect();
        let is_needed = |path: &Path| {
            path.file_name().is_some_and(|name| needed.contains(name.to_string_lossy().as_ref()))
        };
        let mut found = Vec::new();
        let mut add = |path: PathBuf, reason| {
            let bytes = size(&path);
            found.push(Leftover { path, reason, bytes });
        };
        for (kind, reason) in
            [("results", "no sweep needs it"), ("failed", "no sweep has this failure")]
        {
            self.folders(kind)?
                .into_iter()
                .filter(|path| !is_needed(path))
                .for_each(|path| add(path, reason));
        }
        for (path, busy) in self.unfinished()? {
            if !busy && !is_needed(&path) {
                add(path, "unfinished, and no sweep needs it");
            }
        }
        for path in self.halves()? {
            add(path, "half of a file or folder that a crash left");
        }
        Ok(found)
    }

    /// Temporary files of writers that are gone, and folders whose removal did not end. Those of living ones are younger than a minute.
    fn halves(&self) -> Result<Vec<PathBuf>, StoreError> {
        let mut found = Vec::new();
        for folder in [self.root.clone(), self.root.join("sweeps")] {
            for entry in at(&folder, "read", fs::read_dir(&folder))?.flatten() {
                let old = entry
                    .metadata()
                    .and_then(|metadata| metadata.modified())
                    .is_ok_and(|time| time.elapsed().is_ok_and(|age| age.as_secs() > 60));
                let is_half = |ending: &OsStr| ending == REMOVED || old && ending == "tmp";
                if entry.path().extension().is_some_and(is_half) {
                    found.push(entry.path());
                }
            }
        }
        Ok(found)
    }

    /// Folders two levels below `kind`.
    fn folders(&self, kind: &str) -> Result<Vec<PathBuf>, StoreError> {
        let root = self.root.join(kind);
        let mut found = Vec::new();
        for shard in at(&root, "read", fs::read_dir(&root))?.flatten() {
            let shard = shard.path();
            let entries = at(&shard, "read", fs::read_dir(&shard))?;
            found.extend(entries.flatten().map(|entry| entry.path()));
        }
        found.sort();
        Ok(found)
    }
}

fn size(path: &Path) -> u64 {
    if !path.is_dir() {
        return fs::metadata(path).map_or(0, |metadata| metadata.len());
    }
    let entries = fs::read_dir(path).into_iter().flatten().flatten();
    entries.map(|entry| size(&entry.path())).sum()
}
