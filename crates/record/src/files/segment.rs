//! One snapshot as an archive.

use super::archive::{Archive, ArchiveFile};
use super::atomic;
use super::fields::{Column, SnapshotField, all_fields};
use crate::RunError;
use sphcut_sph::Snapshot;
use std::path::Path;

const KIND: &str = "a saved snapshot";

pub(crate) fn write(path: &Path, snapshot: &Snapshot) -> Result<(), RunError> {
    let mut archive = Archive::new(KIND);
    archive.reals("time_and_spacing", vec![snapshot.time, snapshot.particle_spacing]);
    archive.integers("step_and_dimension", vec![snapshot.step, snapshot.dimension as u64]);
    for field in all_fields() {
        match field.column(snapshot) {
            Column::Reals(values) => archive.reals(field.name, values),
            Column::Longs(values) => archive.integers(field.name, values),
            Column::Shorts(values) => {
                archive
                    .integers(field.name, values.iter().map(|v| u64::from(*v)).collect::<Vec<_>>());
            }
        }
    }
    atomic::replace(path, |writer| archive.write(writer))
}

/// A snapshot on disk, read column by column.
#[derive(Debug)]
pub(crate) struct Segment {
    archive: ArchiveFile,
}

impl Segment {
    pub(crate) fn open(path: &Path) -> Result<Self, RunError> {
        Ok(Self { archive: ArchiveFile::open(path, KIND)? })
    }

    /// A snapshot without particles: time, step, dimension and spacing only.
    pub(crate) fn head(&self) -> Result<Snapshot, RunError> {
        let reals = self.archive.reals("time_and_spacing")?;
        let integers = self.archive.integers("step_and_dimension")?;
        let (&[time, particle_spacing], &[step, dimension]) =
            (reals.as_slice(), integers.as_slice())
        else {
            return Err(self.archive.damaged("its head has the wrong length".to_owned()));
        };
        let dimension = dimension as usize;
        Ok(Snapshot { time, step, dimension, particle_spacing, ..Snapshot::default() })
    }

    /// Adds the column `field` to `snapshot`.
    pub(crate) fn fill(
        &self,
        field: &SnapshotField,
        snapshot: &mut Snapshot,
    ) -> Result<(), RunError> {
        let filled = if field.is_integer() {
            field.set_integers(snapshot, self.archive.integers(field.name)?)
        } else {
            field.set_reals(snapshot, self.archive.reals(field.name)?)
        };
        filled.ok_or_else(|| self.archive.damaged(format!("`{}` has the wrong form", field.name)))
    }

    /// The whole snapshot.
    pub(crate) fn read(&self) -> Result<Snapshot, RunError> {
        let mut snapshot = self.head()?;
        all_fields().try_for_each(|field| self.fill(field, &mut snapshot))?;
        Ok(snapshot)
    }
}
