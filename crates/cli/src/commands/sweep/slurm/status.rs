//! `sphcut sweep status`: what the store has, what the queue does.

use super::submitted::{state, store, tasks};
use crate::failure::{ExitCode, Failure};
use crate::{terminal, text};
use serde_json::json;
use sphcut_sweep::slurm::{Queued, Submission};
use sphcut_sweep::{State, Store};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// How far a submitted sweep is.
#[derive(Debug, Default)]
struct Standing {
    finished: usize,
    failed: usize,
    /// With a checkpoint, or computed now.
    begun: usize,
    waiting: usize,
    /// Particle updates that are left, at least.
    updates_left: f64,
    /// Updates per second of one thread in what is finished.
    speed: Option<f64>,
}

impl Standing {
    fn new(submission: &Submission, store: &Store) -> Result<Self, Failure> {
        let (finished, failed) = (submission.there, submission.failing);
        let mut standing = Self { finished, failed, ..Self::default() };
        let (mut updates, mut seconds) = (0.0, 0.0);
        for share in submission.shares()? {
            match state(store, &share.address)? {
                State::Failed(_) => standing.failed += 1,
                State::Reused => {
                    standing.finished += 1;
                    if let Some(entry) = store.entry(&share.address)? {
                        updates += share.updates;
                        seconds += entry.wall_seconds * entry.threads as f64;
                    }
                }
                _ => {
                    standing.updates_left += share.updates;
                    if store.is_begun(&share.address) {
                        standing.begun += 1;
                    } else {
                        standing.waiting += 1;
                    }
                }
            }
        }
        standing.speed = (seconds > 0.0).then(|| updates / seconds);
        Ok(standing)
    }

    fn missing(&self) -> usize {
        self.begun + self.waiting
    }

    /// Seconds left on `threads` threads.
    fn remaining(&self, threads: usize) -> Option<f64> {
        let speed = self.speed.filter(|_| threads > 0 && self.missing() > 0)?;
        Some(self.updates_left / (speed * threads as f64))
    }
}

/// Says how far it is.
pub fn status(submission: &Submission, as_json: bool) -> Result<ExitCode, Failure> {
    let standing = Standing::new(submission, &store(submission)?)?;
    let tasks = tasks(submission)?;
    let running = tasks.iter().filter(|task| task.state == "RUNNING").count();
    let living = tasks.iter().filter(|task| task.is_alive()).count();
    let remaining = standing.remaining(running * submission.threads);
    let code = match (living, standing.missing(), standing.failed) {
        (0, 0, 0) => ExitCode::Done,
        (0, 0, _) => ExitCode::Diverged,
        (0, _, _) => ExitCode::Interrupted,
        _ => ExitCode::Done,
    };
    let states = if tasks.is_empty() { submission.ended.clone() } else { counts(&tasks) };
    if as_json {
        let page = json!({
            "title": submission.title,
            "array": submission.array,
            "collecting": submission.collecting,
            "runs": submission.runs,
            "finished": standing.finished,
            "failed": standing.failed,
            "begun": standing.begun,
            "waiting": standing.waiting,
            "tasks": states,
            "tasks_in_queue": living,
            "cancelled": submission.cancelled,
            "remaining_s": remaining,
        });
        return terminal::answer(&format!("{page:#}\n")).map(|_| code);
    }
    let mut page =
        format!("{}: {} runs\n", submission.title, text::grouped(submission.runs as u64));
    let _ = writeln!(
        page,
        "{} finished, {} failed, {} begun, {} not begun",
        text::grouped(standing.finished as u64),
        standing.failed,
        standing.begun,
        text::grouped(standing.waiting as u64)
    );
    page.push_str(&array(submission, &tasks, &states, living));
    if let Some(seconds) = remaining {
        let plural = if running == 1 { "" } else { "s" };
        let left = text::seconds(seconds);
        let _ = writeln!(page, "about {left} left with {running} task{plural} running");
    }
    if living == 0 && standing.missing() > 0 {
        page.push_str(&unfinished(submission, &states, standing.missing()));
    }
    terminal::answer(&page).map(|_| code)
}

/// How many tasks are in which state.
fn counts(tasks: &[Queued]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for task in tasks {
        *counts.entry(task.state.clone()).or_insert(0) += 1;
    }
    counts
}

/// `array 12, 9 tasks: 7 pending (Resources), 2 running`.
fn array(
    submission: &Submission,
    tasks: &[Queued],
    states: &BTreeMap<String, usize>,
    living: usize,
) -> String {
    let shown = |(state, count): (&String, &usize)| {
        let waits = tasks.iter().find(|task| task.state == *state && task.is_alive());
        let reason = waits.map(|task| task.reason.as_str()).filter(|reason| *reason != "None");
        let reason = reason.map_or_else(String::new, |reason| format!(" ({reason})"));
        format!("{count} {}{reason}", state.to_lowercase().replace('_', " "))
    };
    let mut known: Vec<String> = states.iter().map(shown).collect();
    let listed: usize = states.values().sum();
    if listed > 0 && listed < submission.tasks {
        // The queue forgets a task some minutes after its end.
        known.push(format!("{} ended earlier", submission.tasks - listed));
    }
    let number = submission.array.map_or_else(|| "?".to_owned(), |number| number.to_string());
    let told = match (known.is_empty(), living) {
        (true, _) => "no longer in the queue".to_owned(),
        (false, 0) => format!("ended: {}", known.join(", ")),
        _ => known.join(", "),
    };
    let plural = if submission.tasks == 1 { "" } else { "s" };
    format!("array {number}, {} task{plural}: {told}\n", submission.tasks)
}

/// Why runs are missing although nothing computes them, and what to do.
fn unfinished(submission: &Submission, states: &BTreeMap<String, usize>, missing: usize) -> String {
    let has = |state: &str| states.contains_key(state);
    let reason = if submission.cancelled {
        "`sphcut sweep cancel` ended the array"
    } else if has("CANCELLED") {
        "tasks were cancelled in the queue"
    } else if has("OUT_OF_MEMORY") {
        "tasks needed more memory than they had; --slurm-option=--mem=4G asks for more"
    } else {
        "tasks ended before their time"
    };
    let log = submission.folder.join("log");
    format!(
        "{missing} runs have no result: {reason}\n  the same sweep command submits them again; what the tasks said is in `{}`\n",
        log.display()
    )
}
