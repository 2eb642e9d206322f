//! What was submitted, and what became of it so far.

use crate::common_arguments::{PatchableArguments, ScenarioArguments};
use crate::failure::{ExitCode, Failure};
use crate::loading;
use sphcut_sweep::slurm::{Queued, SlurmError, Submission};
use sphcut_sweep::{Address, State, Store, Sweep};
use std::path::Path;

/// What was submitted last for the sweep in `folder`.
pub fn last(folder: &Path) -> Result<Submission, Failure> {
    let shown = folder.display();
    Submission::last(folder)?.ok_or_else(|| {
        Failure::new(
            ExitCode::InputOutput,
            format!("`{shown}` has no sweep on a cluster: nothing was submitted from there"),
        )
        .advise(format!("`sphcut sweep SWEEP.toml --out {shown} --executor slurm` submits one"))
    })
}

/// The sweep as it was submitted.
pub fn sweep(submission: &Submission) -> Result<Sweep, Failure> {
    let scenario = submission.sweep.clone();
    let file = ScenarioArguments { scenario, allow_outside: submission.allow_outside };
    loading::sweep(&PatchableArguments { file, patch: submission.patch.clone() })
}

/// Its store of results.
pub fn store(submission: &Submission) -> Result<Store, Failure> {
    Ok(Store::create(&submission.store)?)
}

/// The tasks of the array, those that have ended included while the cluster remembers them.
pub fn tasks(submission: &Submission) -> Result<Vec<Queued>, SlurmError> {
    submission.array.map_or_else(|| Ok(Vec::new()), sphcut_sweep::slurm::queue)
}

/// What the store says of a run that nobody computes now.
pub fn state(store: &Store, address: &Address) -> Result<State, Failure> {
    if store.has(address) {
        return Ok(State::Reused);
    }
    let failure = store.failure(address)?;
    Ok(failure.map_or(State::Stopped, |failure| State::Failed(failure.reason)))
}
