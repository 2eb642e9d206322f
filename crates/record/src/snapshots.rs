//! The snapshots of a run: an index in memory, the particles on demand.

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
    pub(crate) place: Place,
}

/// Where the particles are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Place {
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
    pub fn in_memory<S: Into<Arc<Snapshot>>>(snapshots: Vec<S>) -> Self {
        let snapshots: Vec<Arc<Snapshot>> = snapshots.into_iter().map(Into::into).collect();
        Self {
            index: snapshots.iter().map(|snapshot| SnapshotInfo::of(snapshot)).collect(),
            place: Place::Memory(snapshots),
        }
    }

    /// Snapshots of the `run.h5` at `path`.
    pub(crate) fn in_file(path: PathBuf, index: Vec<SnapshotInfo>) -> Self {
        Self { index, place: Place::File(path) }
    }

    /// The first `count` snapshots.
    pub(crate) fn first(&self, count: usize) -> Self {
        Self { index: self.index[..count].to_vec(), place: self.place.clone() }
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
}
