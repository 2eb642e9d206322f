//! The files of a result.
//!
//! While a run goes on, everything is in the folder `run.partial` ([`partial`]);
//! when it ends, in order or interrupted, `run.h5` and its companions are put
//! together from there.

mod archive;
mod atomic;
mod checksums;
mod columns_h5;
mod fields;
mod forces_csv;
mod hdf;
mod journal;
mod load;
mod origin;
pub(crate) mod partial;
mod run_files;
mod run_h5;
mod run_h5_attributes;
mod segment;
mod verify;
mod vtkhdf;

use crate::{Outcome, Run, RunError, Samples};
pub use atomic::{create_anew, open_lock};
pub use columns_h5::{
    ColumnH5, FactH5, GroupH5, MOST_VALUES, Wanted, read_columns_h5, read_named_columns_h5,
    write_columns_h5,
};
pub use fields::{Column, PARTICLE_FIELDS, SnapshotField, TOOL_FIELDS};
use partial::{Checkpoint, Partial, SavedSnapshots};
pub use run_files::RunFiles;
pub(crate) use run_h5::RunBody;
pub use run_h5::stored_unit;
use segment::Segment;
use sphcut_sph::Snapshot;
use std::path::{Path, PathBuf};
pub use verify::{Verified, has_checksums, verify_h5, verify_run};

/// What is written beside `run.h5` and `forces.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Export {
    /// `snapshots.vtkhdf` and `tool.vtkhdf` for ParaView.
    Vtkhdf,
    /// Nothing: [`crate::export_vtkhdf`] writes it from the record when it is wanted.
    Nothing,
}

/// Puts `run.h5`, `forces.csv` and, if wanted, `snapshots.vtkhdf` together from what `partial` has saved.
/// `run.h5` comes last: where it is, the others are too.
pub(crate) fn assemble(
    files: &RunFiles,
    partial: &Partial,
    body: &RunBody,
    saved: &SavedSnapshots,
    export: Export,
) -> Result<(), RunError> {
    forces_csv::write(&files.forces(), body.facts, body.samples)?;
    if export == Export::Vtkhdf {
        let columns = |place: usize, field: &SnapshotField| {
            let segment = Segment::open(&partial.snapshot_path(saved.whole[place].0))?;
            let mut snapshot = segment.head()?;
            segment.fill(field, &mut snapshot)?;
            Ok(snapshot)
        };
        vtkhdf::write(&files.vtkhdf(), &saved.index(), &columns)?;
        vtkhdf::write_tool(&files.tool(), &saved.index(), &columns)?;
    }
    let snapshots = saved.whole.iter().map(|(number, _)| -> Result<Snapshot, RunError> {
        Segment::open(&partial.snapshot_path(*number))?.read()
    });
    run_h5::write(&files.record(), body, snapshots)
}

/// Puts the record of an unfinished run together from what it has saved so far: samples and
/// snapshots up to the moment it died, those after its last checkpoint included. The unfinished run
/// stays as it is and can still be resumed. What is damaged is left out, with a warning in the record.
///
/// # Errors
/// No unfinished run in `dir`, one that another process is writing, a file that cannot be read or
/// written.
pub fn recover(dir: &Path) -> Result<Run, RunError> {
    let files = RunFiles::in_dir(dir);
    let partial = Partial::open(&files)?;
    let (mut provenance, facts) = partial.origin()?;
    let mut loss = Vec::new();
    let checkpoint = partial.checkpoint(&provenance).or_else(|error| match error {
        RunError::Damaged { .. } | RunError::Foreign { .. } => {
            loss.push(error.to_string());
            Ok(None)
        }
        error => Err(error),
    })?;
    let samples = saved_samples(&partial, checkpoint.as_ref(), &mut loss)?;
    let saved = partial.read_snapshots(partial.saved_snapshots())?;
    loss.extend(saved.loss());
    provenance.warnings.extend(loss);
    let body = RunBody {
        provenance: &provenance,
        facts: &facts,
        samples: &samples,
        performance: &checkpoint.as_ref().map(|saved| saved.performance).unwrap_or_default(),
        outcome: &Outcome::Interrupted,
        state: checkpoint.as_ref().map(|saved| &saved.state),
    };
    assemble(&files, &partial, &body, &saved, Export::Vtkhdf)?;
    Run::load(&files.record())
}

/// The samples of the journal, or those of the checkpoint if it has more.
fn saved_samples(
    partial: &Partial,
    checkpoint: Option<&Checkpoint>,
    loss: &mut Vec<String>,
) -> Result<Samples, RunError> {
    let samples = match (partial.samples(), checkpoint) {
        (Ok((samples, 0)), _) => samples,
        (Ok((samples, hidden)), _) => {
            loss.push(format!("lost after a damaged sample: up to {hidden} samples"));
            samples
        }
        (Err(error), Some(_)) => {
            loss.push(error.to_string());
            Samples::default()
        }
        (Err(error), None) => return Err(error),
    };
    let more = checkpoint.map(|saved| &saved.samples).filter(|more| more.len() > samples.len());
    Ok(more.cloned().unwrap_or(samples))
}

/// Refuses to replace files that only have the names of ours.
pub(crate) fn refuse_foreign(files: &RunFiles) -> Result<(), RunError> {
    let refuse = |path: PathBuf, expected| {
        let reason = "sphcut did not write it and will not replace it".to_owned();
        Err(RunError::Foreign { path, expected, reason })
    };
    if files.record().exists() && !run_h5::is_ours(&files.record()) {
        return refuse(files.record(), "a record of a run");
    }
    for path in [files.vtkhdf(), files.tool()] {
        if path.exists() && !hdf::looks_like_hdf5(&path) {
            return refuse(path, "a VTKHDF file");
        }
    }
    if files.forces().exists() && !forces_csv::is_ours(&files.forces()) {
        return refuse(files.forces(), "a force history");
    }
    Ok(())
}

/// Writes the snapshots of `run` for ParaView, and its tool to the file `tool`: whether there is one.
///
/// # Errors
/// A `run.h5` that cannot be read any more, a file that cannot be written.
pub fn export_vtkhdf(run: &Run, path: &Path, tool: &Path) -> Result<bool, RunError> {
    let columns = |number: usize, _: &SnapshotField| {
        run.snapshots.get(number).map(|snapshot| snapshot.as_ref().clone())
    };
    vtkhdf::write(path, run.snapshots.index(), &columns)?;
    vtkhdf::write_tool(tool, run.snapshots.index(), &columns)
}
