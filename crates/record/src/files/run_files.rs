//! The names of the files of a result.

use super::atomic;
use crate::RunError;
use std::fs;
use std::path::{Path, PathBuf};

/// Paths of the files that sphcut writes into the folder of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFiles {
    /// The folder.
    pub dir: PathBuf,
}

impl RunFiles {
    /// The files in `dir`.
    #[must_use]
    pub fn in_dir(dir: &Path) -> Self {
        Self { dir: dir.to_owned() }
    }

    /// The record: channels, snapshots, provenance, final state.
    #[must_use]
    pub fn record(&self) -> PathBuf {
        self.dir.join("run.h5")
    }

    /// The snapshots for ParaView.
    #[must_use]
    pub fn vtkhdf(&self) -> PathBuf {
        self.dir.join("snapshots.vtkhdf")
    }

    /// The tool for ParaView.
    #[must_use]
    pub fn tool(&self) -> PathBuf {
        self.dir.join("tool.vtkhdf")
    }

    /// The force history as text.
    #[must_use]
    pub fn forces(&self) -> PathBuf {
        self.dir.join("forces.csv")
    }

    /// What an unfinished run has saved.
    #[must_use]
    pub fn partial(&self) -> PathBuf {
        self.dir.join("run.partial")
    }

    /// Creates the folder, checks that files can be written there, and clears away the halves of
    /// files that a crash has left.
    pub(crate) fn prepare(&self) -> Result<(), RunError> {
        fs::create_dir_all(&self.dir)
            .map_err(|error| RunError::io(&self.dir, "create the folder", error))?;
        let probe = self.dir.join("run.h5");
        atomic::stage(&probe, |_| Ok(()))?;
        for path in [self.record(), self.vtkhdf(), self.tool(), self.forces()] {
            atomic::remove_if_there(&atomic::temporary(&path))?;
        }
        Ok(())
    }
}
