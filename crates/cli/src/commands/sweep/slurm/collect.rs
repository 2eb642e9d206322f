//! Table and page of a submitted sweep, from what the store has.

use super::super::local::planned;
use super::super::tables;
use super::submitted::{state, store, sweep, tasks};
use super::task::check_unchanged;
use crate::failure::{ExitCode, Failure};
use crate::{loading, terminal, text};
use sphcut_sweep::Sweep;
use sphcut_sweep::slurm::Submission;
use sphcut_sweep::{State, Store, SweepPlan};
use std::collections::BTreeMap;

/// Writes them, and notes how the tasks ended.
pub fn collect(mut submission: Submission) -> Result<ExitCode, Failure> {
    note_ends(&mut submission)?;
    let sweep = sweep(&submission)?;
    let plan = planned(&sweep, loading::threads(None))?;
    check_unchanged(&plan, &submission.shares()?)?;
    let store = store(&submission)?;
    write(&submission, (&sweep, &plan, &store))
}

/// The queue forgets tasks some minutes after their end; it is not asked for what it has forgotten.
fn note_ends(submission: &mut Submission) -> Result<(), Failure> {
    let Ok(tasks) = tasks(submission) else { return Ok(()) };
    if tasks.is_empty() || tasks.iter().any(|task| task.is_alive()) {
        return Ok(());
    }
    submission.ended = BTreeMap::new();
    for task in tasks {
        *submission.ended.entry(task.state).or_insert(0) += 1;
    }
    Ok(submission.write()?)
}

/// Writes table and page of everything that is there.
pub fn write(
    submission: &Submission,
    (sweep, plan, store): (&Sweep, &SweepPlan, &Store),
) -> Result<ExitCode, Failure> {
    let measured = tables::measured(submission.measured.as_deref())?;
    let states: Vec<State> =
        plan.runs.iter().map(|run| state(store, &run.address)).collect::<Result<_, _>>()?;
    let page = tables::write(&submission.out, sweep, plan, store, (&states, &measured))?;
    let count = |wanted: fn(&State) -> bool| states.iter().filter(|state| wanted(state)).count();
    let finished = count(|state| *state == State::Reused);
    let failed = count(|state| matches!(state, State::Failed(_)));
    let missing = states.len() - finished - failed;
    terminal::line(&format!(
        "{} of {} runs finished, {failed} failed, {missing} without a result",
        text::grouped(finished as u64),
        text::grouped(states.len() as u64),
    ));
    terminal::report(&page, &tables::next(&submission.out));
    Ok(match (missing, failed) {
        (0, 0) => ExitCode::Done,
        (0, _) => ExitCode::Diverged,
        _ => ExitCode::Interrupted,
    })
}
