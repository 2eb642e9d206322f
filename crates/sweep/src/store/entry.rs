//! What is noted of a run beside its files.

use super::{Durability, StoreError, at, read_json, write_json};
use crate::Address;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs;
use std::io;
use std::path::Path;

pub(super) const ENTRY: &str = "entry.json";
pub(super) const FAILURE: &str = "failure.json";

/// Most bytes of a file that is read whole whenever somebody asks for a result: summary and scenario.
const SMALL: u64 = 1 << 18;

/// A finished run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResultEntry {
    /// Its address.
    pub address: Address,
    /// Title of the scenario it was computed from first.
    pub title: String,
    /// Version of sphcut that computed it.
    pub version: String,
    /// Version of the solver's results.
    pub results_version: u64,
    /// Particles.
    pub particles: u64,
    /// Steps.
    pub steps: u64,
    /// Wall-clock time in s, all parts of an interrupted run added.
    pub wall_seconds: f64,
    /// Threads of the last part.
    pub threads: u64,
    /// Its files.
    pub files: Vec<StoredFile>,
}

/// A file of a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredFile {
    /// Name in the folder.
    pub name: String,
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 in hexadecimal digits.
    pub sha256: String,
}

/// Why a run cannot finish.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunFailure {
    /// Its address.
    pub address: Address,
    /// The reason in words.
    pub reason: String,
    /// Wall-clock time until then in s.
    pub wall_seconds: f64,
}

impl StoredFile {
    pub(super) fn of(folder: &Path, name: &str) -> Result<Self, StoreError> {
        let path = folder.join(name);
        let mut hash = Sha256::new();
        let bytes = at(
            &path,
            "read",
            fs::File::open(&path).and_then(|mut file| io::copy(&mut file, &mut hash)),
        )?;
        let sha256 = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { name: name.to_owned(), bytes, sha256 })
    }
}

impl ResultEntry {
    /// Whether all its files are in `folder` with their sizes, small ones with their content; a record has checksums of
    /// its own.
    pub(super) fn fits(&self, folder: &Path) -> bool {
        self.files.iter().all(|file| {
            let found = fs::symlink_metadata(folder.join(&file.name));
            found.is_ok_and(|found| found.is_file() && found.len() == file.bytes)
                && (file.bytes > SMALL
                    || StoredFile::of(folder, &file.name).is_ok_and(|f| f == *file))
        })
    }

    /// Size of all its files in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.files.iter().map(|file| file.bytes).sum()
    }

    pub(super) fn write(&self, folder: &Path, durability: Durability) -> Result<(), StoreError> {
        write_json(&folder.join(ENTRY), self, durability)
    }

    pub(super) fn read(folder: &Path) -> Result<Self, StoreError> {
        read_json(&folder.join(ENTRY))
    }
}

impl RunFailure {
    pub(super) fn write(&self, folder: &Path) -> Result<(), StoreError> {
        write_json(&folder.join(FAILURE), self, Durability::Synced)
    }

    pub(super) fn read(folder: &Path) -> Result<Self, StoreError> {
        read_json(&folder.join(FAILURE))
    }
}
