//! The files of a result.

use crate::{Run, RunError};
use sphcut_sph::Snapshot;
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
}

pub(crate) fn load_run(_path: &Path) -> Result<Run, RunError> {
    todo!()
}

pub(crate) fn load_snapshot(_path: &Path, _number: usize) -> Result<Snapshot, RunError> {
    todo!()
}
