//! A sweep on this machine: planned, measured, computed and told.

use super::display::SweepDisplay;
use super::worker::Apart;
use crate::commands::check;
use crate::failure::{ExitCode, Failure};
use crate::progress::{OutputStyle, emit};
use crate::{files, loading, terminal, text};
use serde_json::json;
use sphcut_sph::Simulation;
use sphcut_sweep::{
    Execution, Needs, News, PlannedRun, State, Store, Sweep, SweepPlan, execute, plan,
};
use std::path::Path;
use std::time::{Duration, Instant};

/// Every run, checked.
pub fn planned(sweep: &Sweep, threads: usize) -> Result<SweepPlan, Failure> {
    Ok(loading::pool(threads)?.install(|| plan(sweep))?)
}

/// Particle updates per second of one thread, in the run of middling cost.
pub fn speed(sweep: &Sweep, plan: &SweepPlan) -> Result<f64, Failure> {
    let mut order: Vec<&PlannedRun> = plan.runs.iter().collect();
    order.sort_by(|a, b| a.cost.updates().total_cmp(&b.cost.updates()));
    let middle = order[order.len() / 2];
    let values: Vec<&str> = middle.values.iter().map(String::as_str).collect();
    // It was read and built when the sweep was planned.
    let scenario = sweep.scenario(&values).map_err(|unfit| Failure::input(unfit.settings))?;
    loading::pool(1)?.install(|| {
        let mut simulation =
            Simulation::new(scenario.setup).map_err(|error| Failure::input(error.to_string()))?;
        check::speed(&mut simulation)
    })
}

/// Notes what the sweep with its output in `out` needs, for `sphcut store gc`.
pub fn note_needs(store: &Store, out: &Path, plan: &SweepPlan) -> Result<(), Failure> {
    let addresses = plan.runs.iter().map(|run| run.address).collect();
    Ok(store.note_needs(&Needs { folder: files::absolute(out)?, addresses })?)
}

/// Says what starts.
pub fn announce(
    sweep: &Sweep,
    plan: &SweepPlan,
    store: &Store,
    threads: usize,
    style: OutputStyle,
) {
    let (runs, folder) = (plan.runs.len(), store.root().display());
    match style {
        OutputStyle::Json => emit(&json!({
            "event": "start",
            "title": sweep.title,
            "runs": runs,
            "left_out": plan.left_out.len(),
            "threads": threads,
            "store": folder.to_string(),
        })),
        OutputStyle::Human => {
            let plural = if threads == 1 { "" } else { "s" };
            terminal::note(&format!(
                "{}: {} runs on {threads} thread{plural}, results in {folder}",
                sweep.title,
                text::grouped(runs as u64)
            ));
        }
        OutputStyle::Quiet => {}
    }
}

/// Computes what the store does not have, and shows how far it is.
pub fn run(
    (sweep, time_limit): (&Sweep, Option<Duration>),
    plan: &SweepPlan,
    store: &Store,
    execution: Execution,
    style: OutputStyle,
) -> Result<Vec<State>, Failure> {
    let display = SweepDisplay::new(sweep, plan, style);
    let news = |news| display.take(&news);
    let states = run_watched((sweep, time_limit), plan, store, execution, &news);
    display.finish();
    states
}

/// Computes what the store does not have, and tells the news.
pub fn run_watched(
    (sweep, time_limit): (&Sweep, Option<Duration>),
    plan: &SweepPlan,
    store: &Store,
    execution: Execution,
    news: &(dyn Fn(News) + Sync),
) -> Result<Vec<State>, Failure> {
    let worker = Apart { sweep, time_limit };
    Ok(execute(sweep, plan, store, execution, &worker, news)?)
}

/// Says how it ended.
pub fn told(states: &[State], start: Instant, style: OutputStyle) -> ExitCode {
    let count = |wanted: fn(&State) -> bool| states.iter().filter(|state| wanted(state)).count();
    let failed = count(|state| matches!(state, State::Failed(_)));
    let stopped = count(|state| matches!(state, State::Stopped));
    let reused = count(|state| matches!(state, State::Reused));
    let finished = count(|state| matches!(state, State::Finished));
    match style {
        OutputStyle::Json => emit(&json!({
            "event": if stopped > 0 { "interrupted" } else { "done" },
            "finished": finished,
            "reused": reused,
            "failed": failed,
            "stopped": stopped,
            "wall_s": start.elapsed().as_secs_f64(),
        })),
        OutputStyle::Human => {
            let duration = text::seconds(start.elapsed().as_secs_f64());
            terminal::line(&format!(
                "{finished} runs computed in {duration}, {reused} there already, {failed} failed"
            ));
        }
        OutputStyle::Quiet => {}
    }
    if stopped > 0 {
        if style != OutputStyle::Json {
            terminal::note(&format!(
                "interrupted, {stopped} runs are left: checkpoints are written; the same command goes on"
            ));
        }
        return ExitCode::Interrupted;
    }
    if failed > 0 { ExitCode::Diverged } else { ExitCode::Done }
}
