//! How a run begins: afresh, from a checkpoint, or not at all because it is done.

use super::session::{Meter, Session};
use super::{RunOptions, Source, Start};
use crate::files::partial::{self, Checkpoint, Partial};
use crate::files::{self, RunFiles};
use crate::{Outcome, Performance, Provenance, Run, RunError, Samples, SnapshotInfo};

/// What there is to do.
pub(super) enum Begin<'a, S: Source> {
    /// Steps to compute.
    Session(Box<Session<'a, S>>),
    /// Nothing: the result is complete.
    Complete(Box<Run>),
}

/// A simulation with what was saved of its run.
struct Begun<S: Source> {
    stepper: S::Stepper,
    partial: Partial,
    samples: Samples,
    snapshots: Vec<SnapshotInfo>,
    lost: Vec<usize>,
    performance: Performance,
}

pub(super) fn begin<'a, S: Source>(
    source: &'a S,
    provenance: &'a Provenance,
    options: &'a RunOptions,
) -> Result<Begin<'a, S>, RunError> {
    let files = RunFiles::in_dir(&options.out_dir);
    let begun = match options.start {
        Start::Resume if partial::exists(&files) => {
            resume(source, provenance, &files).map_err(RunError::advising_force)?
        }
        Start::Resume if files.record().exists() => return complete(provenance, &files),
        Start::New | Start::Resume => {
            refuse_existing(&files)?;
            fresh(source, provenance, &files)?
        }
        Start::Replace => {
            files::refuse_foreign(&files)?;
            fresh(source, provenance, &files)?
        }
    };
    let Begun { stepper, partial, samples, snapshots, lost, performance } = begun;
    Ok(Begin::Session(Box::new(Session {
        source,
        provenance,
        facts: source.facts(),
        options,
        files,
        partial,
        meter: Meter::start(&stepper, performance),
        stepper,
        samples,
        snapshots,
        lost,
    })))
}

fn refuse_existing(files: &RunFiles) -> Result<(), RunError> {
    if partial::exists(files) {
        return Err(RunError::Exists { path: files.partial(), resumable: true });
    }
    for path in [files.record(), files.vtkhdf(), files.tool(), files.forces()] {
        if path.exists() {
            return Err(RunError::Exists { path, resumable: false });
        }
    }
    Ok(())
}

/// Everything that can fail without touching a file comes first.
fn fresh<S: Source>(
    source: &S,
    provenance: &Provenance,
    files: &RunFiles,
) -> Result<Begun<S>, RunError> {
    let stepper = source.start()?;
    files.prepare()?;
    partial::remove(files)?;
    let partial = Partial::create(files, provenance, &source.facts())?;
    Ok(Begun::at_start(stepper, partial))
}

fn resume<S: Source>(
    source: &S,
    provenance: &Provenance,
    files: &RunFiles,
) -> Result<Begun<S>, RunError> {
    let mut partial = Partial::open(files)?;
    let (stored, _) = partial.origin()?;
    if let Some(reason) = provenance.difference(&stored) {
        return Err(RunError::Mismatch { path: files.partial(), reason });
    }
    files.prepare()?;
    let facts = source.facts();
    let Some(saved) = partial.checkpoint(provenance)? else {
        let stepper = source.start()?;
        partial.take_up((provenance, &facts), &Samples::default())?;
        return Ok(Begun::at_start(stepper, partial));
    };
    let stepper = source.restore(&saved.state)?;
    partial.take_up((provenance, &facts), &saved.samples)?;
    let lost = partial.read_snapshots(saved.snapshots.len())?.lost;
    let Checkpoint { samples, snapshots, performance, .. } = saved;
    Ok(Begun { stepper, partial, samples, snapshots, lost, performance })
}

impl<S: Source> Begun<S> {
    fn at_start(stepper: S::Stepper, partial: Partial) -> Self {
        let (samples, performance) = (Samples::default(), Performance::default());
        let (snapshots, lost) = (Vec::new(), Vec::new());
        Self { stepper, partial, samples, snapshots, lost, performance }
    }
}

/// A result that needs no more steps.
fn complete<'a, S: Source>(
    provenance: &Provenance,
    files: &RunFiles,
) -> Result<Begin<'a, S>, RunError> {
    let record = files.record();
    let run = Run::load(&record)?;
    if let Some(reason) = provenance.difference(&run.provenance) {
        return Err(RunError::Mismatch { path: record, reason });
    }
    match run.outcome {
        Outcome::Finished | Outcome::Steady => {
            // A crash while it was cleared away may have left a part of the unfinished run.
            partial::remove(files)?;
            Ok(Begin::Complete(Box::new(run)))
        }
        Outcome::Diverged(divergence) => Err(RunError::Diverged { divergence, record }),
        Outcome::Interrupted => Err(RunError::Damaged {
            path: files.partial(),
            reason: format!("`{}` was interrupted, but its checkpoint is gone", record.display()),
        }
        .advising_force()),
    }
}
