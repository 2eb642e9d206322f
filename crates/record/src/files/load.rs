//! Reading a result back: the run at once, its particles when they are asked for.

use super::run_h5;
use crate::snapshots::{Place, Snapshots};
use crate::{Run, RunError};
use sphcut_sph::{CheckpointState, Snapshot};
use std::path::Path;
use std::sync::Arc;

impl Run {
    /// Reads a run from `run.h5`.
    ///
    /// # Errors
    /// A file that cannot be read, is no record of a run, is cut short, or comes from another version
    /// of the layout.
    pub fn load(path: &Path) -> Result<Self, RunError> {
        run_h5::read(path)
    }

    /// Reads the state of the solver at the end of the record in `run.h5`, if it has one.
    ///
    /// # Errors
    /// As [`Run::load`].
    pub fn load_state(path: &Path) -> Result<Option<CheckpointState>, RunError> {
        run_h5::read_state(path)
    }
}

impl Snapshots {
    /// The particles of one snapshot.
    ///
    /// # Errors
    /// A `run.h5` that has been moved, changed or damaged since it was opened.
    ///
    /// # Panics
    /// If `number` is not below [`Snapshots::len`].
    pub fn get(&self, number: usize) -> Result<Arc<Snapshot>, RunError> {
        assert!(number < self.len(), "snapshot {number} of {}", self.len());
        match &self.place {
            Place::Memory(snapshots) => Ok(Arc::clone(&snapshots[number])),
            Place::File(path) => run_h5::read_snapshot(path, number).map(Arc::new),
        }
    }

    /// The latest snapshot, if there is one.
    ///
    /// # Errors
    /// As [`Snapshots::get`].
    pub fn last(&self) -> Result<Option<Arc<Snapshot>>, RunError> {
        self.len().checked_sub(1).map(|number| self.get(number)).transpose()
    }
}
