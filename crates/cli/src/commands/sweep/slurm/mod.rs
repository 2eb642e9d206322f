//! `sphcut sweep --executor slurm`, and what looks after a submitted sweep.

mod collect;
mod status;
mod submit;
mod submitted;
mod task;

pub use submit::{announced, check_options, submit};

use super::arguments::JobCommand;
use super::one::one;
use crate::failure::{ExitCode, Failure};
use crate::terminal;
use sphcut_sweep::slurm::Submission;
use submitted::{last, tasks};

/// Does what `job` asks.
pub fn look_after(job: &JobCommand) -> Result<ExitCode, Failure> {
    match job {
        JobCommand::Status { folder, json } => status::status(&last(folder)?, *json),
        JobCommand::Collect { folder } => collect::collect(last(folder)?),
        JobCommand::Cancel { folder } => cancel(last(folder)?),
        JobCommand::Task { folder, task } => task::task(folder, *task),
        JobCommand::One(arguments) => one(arguments),
    }
}

fn cancel(mut submission: Submission) -> Result<ExitCode, Failure> {
    let living = tasks(&submission)?;
    let living = living.iter().filter(|task| task.is_alive()).count();
    let name = submission.array.map_or_else(String::new, |array| array.to_string());
    if living == 0 {
        terminal::line(&format!("nothing to cancel: array {name} has no task in the queue"));
        return Ok(ExitCode::Done);
    }
    // The collecting job first: it waits for the end of the array.
    let jobs: Vec<u64> = submission.collecting.into_iter().chain(submission.array).collect();
    sphcut_sweep::slurm::cancel(&jobs)?;
    submission.cancelled = true;
    submission.write()?;
    let plural = if living == 1 { "" } else { "s" };
    terminal::line(&format!(
        "array {name} cancelled: {living} task{plural} ended; those that ran write checkpoints. The same sweep command goes on"
    ));
    Ok(ExitCode::Done)
}
