//! What is noted of a run beside its files.

use super::{Durability, StoreError, at, read_json, write_json};
use crate::Address;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fs;
use std::io;
use std::path::Path;

pub(super) const ENTRY: &str = "entry.json";
pub(super) const FAILURE: &str = "failure.json";

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
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
#[derive(Debug, Clone, PartialEq)]
pub struct StoredFile {
    /// Name in the folder.
    pub name: String,
    /// Size in bytes.
    pub bytes: u64,
    /// SHA-256 in hexadecimal digits.
    pub sha256: String,
}

/// Why a run cannot finish.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
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

impl Entry {
    /// Whether all its files are in `folder` with their sizes.
    pub(super) fn fits(&self, folder: &Path) -> bool {
        self.files.iter().all(|file| {
            fs::metadata(folder.join(&file.name)).is_ok_and(|found| found.len() == file.bytes)
        })
    }

    /// Size of all its files in bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.files.iter().map(|file| file.bytes).sum()
    }

    pub(super) fn write(&self, folder: &Path, durability: Durability) -> Result<(), StoreError> {
        let files: Vec<Value> = self
            .files
            .iter()
            .map(|file| json!({ "name": file.name, "bytes": file.bytes, "sha256": file.sha256 }))
            .collect();
        let entry = json!({
            "address": self.address.to_string(),
            "title": self.title,
            "version": self.version,
            "results_version": self.results_version,
            "particles": self.particles,
            "steps": self.steps,
            "wall_seconds": self.wall_seconds,
            "threads": self.threads,
            "files": files,
        });
        write_json(&folder.join(ENTRY), &entry, durability)
    }

    pub(super) fn read(folder: &Path) -> Result<Self, StoreError> {
        let path = folder.join(ENTRY);
        let value = read_json(&path)?;
        Self::from(&value).ok_or_else(|| StoreError::Damaged(path, "a key is missing".to_owned()))
    }

    fn from(value: &Value) -> Option<Self> {
        let text = |key: &str| value[key].as_str().map(ToOwned::to_owned);
        let file = |file: &Value| {
            Some(StoredFile {
                name: file["name"].as_str()?.to_owned(),
                bytes: file["bytes"].as_u64()?,
                sha256: file["sha256"].as_str()?.to_owned(),
            })
        };
        Some(Self {
            address: Address::parse(value["address"].as_str()?)?,
            title: text("title")?,
            version: text("version")?,
            results_version: value["results_version"].as_u64()?,
            particles: value["particles"].as_u64()?,
            steps: value["steps"].as_u64()?,
            wall_seconds: value["wall_seconds"].as_f64()?,
            threads: value["threads"].as_u64()?,
            files: value["files"].as_array()?.iter().map(file).collect::<Option<_>>()?,
        })
    }
}

impl Failure {
    pub(super) fn write(&self, folder: &Path) -> Result<(), StoreError> {
        let failure = json!({
            "address": self.address.to_string(),
            "reason": self.reason,
            "wall_seconds": self.wall_seconds,
        });
        write_json(&folder.join(FAILURE), &failure, Durability::Synced)
    }

    pub(super) fn read(folder: &Path) -> Result<Self, StoreError> {
        let path = folder.join(FAILURE);
        let value = read_json(&path)?;
        let failure = || {
            Some(Self {
                address: Address::parse(value["address"].as_str()?)?,
                reason: value["reason"].as_str()?.to_owned(),
                wall_seconds: value["wall_seconds"].as_f64()?,
            })
        };
        failure().ok_or_else(|| StoreError::Damaged(path, "a key is missing".to_owned()))
    }
}
