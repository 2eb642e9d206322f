//! Values of finished runs on disk: a long case goes on where it stopped, and the ledger is
//! written without running everything again. They are our own output, kept with the scenario that
//! gave them; no case is ever judged against them.

use crate::error::CaseError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder with one file per run: `<case>/results/<run>.toml`.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseStore {
    folder: PathBuf,
}

/// What is kept of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredRun {
    /// Name of the run.
    pub run: String,
    /// Version of the solver's numbers, [`sphcut_sph::RESULTS_VERSION`], that gave the values.
    pub results_version: u32,
    /// Particle spacing in m.
    pub spacing: f64,
    /// The scenario as it was run: the values belong to this text and no other.
    pub scenario: String,
    /// Value of every observable, by its label.
    pub values: BTreeMap<String, f64>,
}

impl CaseStore {
    /// The store in `folder`, which need not exist yet.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    /// The kept values of a run, if there are any.
    ///
    /// # Errors
    /// A file that cannot be read or understood.
    pub fn read(&self, case: &str, run: &str) -> Result<Option<StoredRun>, CaseError> {
        self.read_as(case, run)
    }

    /// What is kept under the name of a run, if anything is.
    pub(crate) fn read_as<T: DeserializeOwned>(
        &self,
        case: &str,
        run: &str,
    ) -> Result<Option<T>, CaseError> {
        let path = self.path(case, run);
        if !path.is_file() {
            return Ok(None);
        }
        let text =
            fs::read_to_string(&path).map_err(|error| CaseError::unreadable(&path, &error))?;
        toml::from_str(&text)
            .map(Some)
            .map_err(|error| CaseError::invalid(&path, error.to_string()))
    }

    /// Keeps the values of a run; the file appears whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, case: &str, stored: &StoredRun) -> Result<(), CaseError> {
        self.write_as(case, &stored.run, stored)
    }

    /// Keeps something under the name of a run.
    pub(crate) fn write_as<T: Serialize>(
        &self,
        case: &str,
        run: &str,
        kept: &T,
    ) -> Result<(), CaseError> {
        let path = self.path(case, run);
        let failed = |error: std::io::Error| CaseError::unreadable(&path, &error);
        let text =
            toml::to_string(kept).map_err(|error| CaseError::invalid(&path, error.to_string()))?;
        fs::create_dir_all(self.results(case)).map_err(failed)?;
        let partial = path.with_extension("partial");
        fs::write(&partial, text).map_err(failed)?;
        fs::rename(&partial, &path).map_err(failed)
    }

    /// Forgets the kept values of a case.
    ///
    /// # Errors
    /// Files that cannot be removed.
    pub fn forget(&self, case: &str) -> Result<(), CaseError> {
        let folder = self.results(case);
        if !folder.is_dir() {
            return Ok(());
        }
        fs::remove_dir_all(&folder).map_err(|error| CaseError::unreadable(&folder, &error))
    }

    fn path(&self, case: &str, run: &str) -> PathBuf {
        self.results(case).join(format!("{run}.toml"))
    }

    fn results(&self, case: &str) -> PathBuf {
        self.folder.join(case).join("results")
    }
}
