//! How a run begins: afresh, from a checkpoint, or not at all because it is done.

use super::session::{Meter, Session};
use super::{RunOptions, Source, Start};
use crate::files::partial::{self, Partial};
use crate::files::{self, RunFiles};
use crate::{Outcome, Performance, Provenance, Run, RunError, Samples};

/// What there is to do.
pub(super) enum Begin<'a, S: Source> {
    /// Steps to compute.
    Session(Box<Session<'a, S>>),
    /// Nothing: the result is complete.
    Complete(Box<Run>),
}

pub(super) fn begin<'a, S: Source>(
    source: &'a S,
    provenance: &'a Provenance,
    options: &'a RunOptions,
) -> Result<Begin<'a, S>, RunError> {
    let files = RunFiles::in_dir(&options.out_dir);
    match options.start {
        Start::New => {
            refuse_existing(&files)?;
            fresh(source, provenance, options, files)
        }
        Start::Replace => {
            files::refuse_foreign(&files)?;
            fresh(source, provenance, options, files)
        }
        Start::Resume if partial::exists(&files) => {
            resume(source, provenance, options, files).map_err(RunError::advising_force)
        }
        Start::Resume if files.record().exists() => complete(provenance, &files),
        Start::Resume => {
            refuse_existing(&files)?;
            fresh(source, provenance, options, files)
        }
    }
}

fn refuse_existing(files: &RunFiles) -> Result<(), RunError> {
    if partial::exists(files) {
        return Err(RunError::Exists { path: files.partial(), resumable: true });
    }
    for path in [files.record(), files.vtkhdf(), files.forces()] {
        if path.exists() {
            return Err(RunError::Exists { path, resumable: false });
        }
    }
    Ok(())
}

/// Everything that can fail without touching a file comes first.
fn fresh<'a, S: Source>(
    source: &'a S,
    provenance: &'a Provenance,
    options: &'a RunOptions,
    files: RunFiles,
) -> Result<Begin<'a, S>, RunError> {
    let stepper = source.start()?;
    files.prepare()?;
    partial::remove(&files)?;
    let facts = source.facts();
    let partial = Partial::create(&files, provenance, &facts)?;
    let meter = Meter::start(&stepper, Performance::default());
    Ok(Begin::Session(Box::new(Session {
        source,
        provenance,
        facts,
        options,
        files,
        partial,
        stepper,
        samples: Samples::default(),
        snapshots: Vec::new(),
        meter,
    })))
}

fn resume<'a, S: Source>(
    source: &'a S,
    provenance: &'a Provenance,
    options: &'a RunOptions,
    files: RunFiles,
) -> Result<Begin<'a, S>, RunError> {
    let partial = Partial::open(&files)?;
    let (stored, _) = partial.origin()?;
    if let Some(reason) = provenance.difference(&stored) {
        return Err(RunError::Mismatch { path: files.partial(), reason });
    }
    files.prepare()?;
    let checkpoint = partial.checkpoint(provenance)?;
    let (stepper, samples, snapshots, earlier) = match checkpoint {
        Some(saved) => {
            partial.check_snapshots(saved.snapshots.len())?;
            (source.restore(&saved.state)?, saved.samples, saved.snapshots, saved.performance)
        }
        None => (source.start()?, Samples::default(), Vec::new(), Performance::default()),
    };
    let meter = Meter::start(&stepper, earlier);
    Ok(Begin::Session(Box::new(Session {
        source,
        provenance,
        facts: source.facts(),
        options,
        files,
        partial,
        stepper,
        samples,
        snapshots,
        meter,
    })))
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
