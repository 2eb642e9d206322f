//! `sphcut sweep --executor slurm`, and what looks after a submitted sweep.

mod collect;
mod status;
mod submit;
mod task;

pub use submit::{announced, check_options, submit};

use super::arguments::JobCommand;
use super::broken;
use crate::arguments::{PatchableArguments, ScenarioArguments};
use crate::failure::{ExitCode, Failure};
use crate::{loading, terminal};
use sphcut_sweep::Sweep;
use sphcut_sweep::slurm::{Queued, SlurmError, Submission};
use sphcut_sweep::{State, Store};
use std::path::Path;

/// Does what `job` asks.
pub fn look_after(job: &JobCommand) -> Result<ExitCode, Failure> {
    match job {
        JobCommand::Status { folder, json } => status::status(&last(folder)?, *json),
        JobCommand::Collect { folder } => collect::collect(last(folder)?),
        JobCommand::Cancel { folder } => cancel(last(folder)?),
        JobCommand::Task { folder, task } => task::task(folder, *task),
    }
}

/// What was submitted last for the sweep in `folder`.
fn last(folder: &Path) -> Result<Submission, Failure> {
    let shown = folder.display();
    Submission::last(folder).map_err(|error| broken(&error))?.ok_or_else(|| {
        Failure::new(
            ExitCode::InputOutput,
            format!("`{shown}` has no sweep on a cluster: nothing was submitted from there"),
        )
        .advise(format!("`sphcut sweep SWEEP.toml --out {shown} --executor slurm` submits one"))
    })
}

/// Why a cluster does not do what was asked.
fn refused(error: &SlurmError) -> Failure {
    let failure = Failure::new(ExitCode::NoCluster, error.to_string());
    match error {
        SlurmError::Absent(_) => {
            failure.advise("without --executor the sweep runs on this machine")
        }
        _ => failure,
    }
}

/// The sweep as it was submitted.
fn sweep(submission: &Submission) -> Result<Sweep, Failure> {
    let scenario = submission.sweep.clone();
    let file = ScenarioArguments { scenario, allow_outside: submission.allow_outside };
    loading::sweep(&PatchableArguments { file, patch: submission.patch.clone() })
}

fn store(submission: &Submission) -> Result<Store, Failure> {
    Store::create(&submission.store).map_err(|error| broken(&error))
}

/// The tasks of the array, those that have ended included while the cluster remembers them.
fn tasks(submission: &Submission) -> Result<Vec<Queued>, SlurmError> {
    submission.array.map_or_else(|| Ok(Vec::new()), sphcut_sweep::slurm::queue)
}

/// What the store says of a run that nobody computes now.
fn state(store: &Store, address: &sphcut_sweep::Address) -> Result<State, Failure> {
    if store.has(address) {
        return Ok(State::Reused);
    }
    let failure = store.failure(address).map_err(|error| broken(&error))?;
    Ok(failure.map_or(State::Stopped, |failure| State::Failed(failure.reason)))
}

fn cancel(mut submission: Submission) -> Result<ExitCode, Failure> {
    let living = tasks(&submission).map_err(|error| refused(&error))?;
    let living = living.iter().filter(|task| task.is_alive()).count();
    let name = submission.array.map_or_else(String::new, |array| array.to_string());
    if living == 0 {
        terminal::line(&format!("nothing to cancel: array {name} has no task in the queue"));
        return Ok(ExitCode::Done);
    }
    // The collecting job first: it waits for the end of the array.
    let jobs: Vec<u64> = submission.collecting.into_iter().chain(submission.array).collect();
    sphcut_sweep::slurm::cancel(&jobs).map_err(|error| refused(&error))?;
    submission.cancelled = true;
    submission.write().map_err(|error| broken(&error))?;
    let plural = if living == 1 { "" } else { "s" };
    terminal::line(&format!(
        "array {name} cancelled: {living} task{plural} ended; those that ran write checkpoints. The same sweep command goes on"
    ));
    Ok(ExitCode::Done)
}
