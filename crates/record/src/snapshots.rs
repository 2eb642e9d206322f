//! The snapshots of a run: an index in memory, the particles on demand.

use crate::RunError;
use sphcut_sph::Snapshot;
use std::path::PathBuf;
use std::sync::Arc;

/// When a snapshot was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapshotInfo {
    /// Simulated time in s.
    pub time: f64,
    /// Steps since the start.
    pub step: u64,
    /// Number of particles.
    pub particles: usize,
}

/// The snapshots of a run, in the order of time. Particles are read when asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshots {
    index: Vec<SnapshotInfo>,
    place: Place,
}

#[derive(Debug, Clone, PartialEq)]
enum Place {
    Memory(Vec<Arc<Snapshot>>),
    File(PathBuf),
}

impl Default for Place {
    fn default() -> Self {
        Self::Memory(Vec::new())
    }
}

impl SnapshotInfo {
    /// The entry of `snapshot` in an index.
    #[must_use]
    pub fn of(snapshot: &Snapshot) -> Self {
        Self { time: snapshot.time, step: snapshot.step, particles: snapshot.id.len() }
    }
}

impl Snapshots {
    /// Snapshots held in memory.
    #[must_use]
    pub fn in_memory(snapshots: Vec<Snapshot>) -> Self {
        Self {
            index: snapshots.iter().map(SnapshotInfo::of).collect(),
            place: Place::Memory(snapshots.into_iter().map(Arc::new).collect()),
        }
    }

    /// Snapshots of the `run.h5` at `path`.
    pub(crate) fn in_file(path: PathBuf, index: Vec<SnapshotInfo>) -> Self {
        Self { index, place: Place::File(path) }
    }

    /// Number of snapshots.
    #[must_use]
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// When each was taken.
    #[must_use]
    pub fn index(&self) -> &[SnapshotInfo] {
        &self.index
    }

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
            Place::File(path) => crate::files::load_snapshot(path, number).map(Arc::new),
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
