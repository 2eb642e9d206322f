//! One task of the array: its runs, through the same store as everywhere.

use super::super::local::{run, told};
use super::submitted::{store, sweep};
use crate::failure::{ExitCode, Failure};
use crate::progress::OutputStyle;
use crate::terminal::note;
use crate::{interrupt, loading};
use sphcut_sweep::slurm::{Submission, TaskRun};
use sphcut_sweep::{Execution, Retry, SweepPlan, plan_only};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Computes what is missing of task `number` of the submission in `folder`.
pub fn task(folder: &Path, number: usize) -> Result<ExitCode, Failure> {
    // A cluster may end the task at any time.
    interrupt::install_patient();
    let submission = Submission::read(folder)?;
    let mut shares = submission.shares()?;
    shares.retain(|share| share.task == number);
    if shares.is_empty() {
        let (shown, tasks) = (folder.display(), submission.tasks);
        return Err(Failure::input(format!(
            "`{shown}` has no task {number}; its tasks are 1 to {tasks}"
        )));
    }
    let place = |name: &str| std::env::var(name).unwrap_or_else(|_| "?".to_owned());
    let again = std::env::var("SLURM_RESTART_COUNT").unwrap_or_else(|_| "0".to_owned());
    note(&format!(
        "task {number} of {}, {} runs, on {}, restarted {again} times",
        submission.tasks,
        shares.len(),
        place("SLURMD_NODENAME")
    ));
    let sweep = sweep(&submission)?;
    let numbers = shares.iter().map(|share| share.run).collect();
    let plan = loading::pool(submission.threads)?.install(|| plan_only(&sweep, &numbers))?;
    check_unchanged(&plan, &shares)?;
    let store = store(&submission)?;
    // What failed is known to the next submission, and to this task when it is queued again.
    let execution = Execution { threads: submission.threads, retry: Retry::Never };
    let start = Instant::now();
    let states = run((&sweep, None), &plan, &store, execution, OutputStyle::Human)?;
    Ok(told(&states, start, OutputStyle::Human))
}

/// Whether the files still say what was submitted.
pub fn check_unchanged(plan: &SweepPlan, shares: &[TaskRun]) -> Result<(), Failure> {
    let planned: BTreeMap<usize, _> =
        plan.runs.iter().map(|run| (run.number, run.address)).collect();
    let changed = shares.iter().find(|share| planned.get(&share.run) != Some(&share.address));
    changed.map_or(Ok(()), |share| {
        Err(Failure::input(format!(
            "run {} is not what was submitted: the sweep, a file that it names, or sphcut has changed since",
            share.run
        ))
        .advise("submit the sweep again; runs that did not change are not computed again"))
    })
}
