//! `sphcut sweep`: many runs of one scenario.

mod arguments;
mod display;
pub mod dry_run;
mod slurm;
pub mod tables;
mod tally;
mod worker;

pub use arguments::{SweepArguments, SweepCommand};

use crate::failure::{ExitCode, Failure};
use crate::progress::{Style, emit, seconds_to_duration};
use crate::{interrupt, loading, outcome, terminal, text};
use arguments::Executor;
use display::Display;
use serde_json::json;
use sphcut_sweep::{
    Execution, Needs, Plan, PlanError, Retry, State, Store, StoreError, Sweep, execute, plan,
};
use std::path::PathBuf;
use std::time::Instant;

/// Name of the store in the output folder.
const STORE: &str = "store";

/// Runs a sweep, or looks after one on a cluster.
pub fn sweep(command: &SweepCommand) -> Result<ExitCode, Failure> {
    match command {
        SweepCommand::Job(job) => slurm::look_after(job),
        SweepCommand::Sweep(arguments) => planned_and_run(arguments),
    }
}

fn planned_and_run(arguments: &SweepArguments) -> Result<ExitCode, Failure> {
    let result = follow(arguments);
    if let (Err(failure), true) = (&result, arguments.json) {
        outcome::emit_error(failure);
    }
    result
}

fn follow(arguments: &SweepArguments) -> Result<ExitCode, Failure> {
    slurm::check_options(arguments)?;
    let sweep = loading::sweep(&arguments.scene)?;
    let threads = loading::threads(arguments.threads);
    let plan = planned(&sweep, threads)?;
    if arguments.dry_run {
        return dry_run::dry_run(arguments, &sweep, &plan, threads);
    }
    let style = style(arguments);
    let out = &arguments.out;
    std::fs::create_dir_all(out)
        .map_err(|error| Failure::output(format!("cannot create `{}`", out.display()), &error))?;
    let store = store(arguments)?;
    store.note_needs(&needs(arguments, &plan)?).map_err(|error| broken(&error))?;
    if arguments.executor == Executor::Slurm {
        return slurm::submit(arguments, &sweep, &plan, &store, style);
    }
    interrupt::install();
    announce(&sweep, &plan, &store, threads, style);
    let start = Instant::now();
    let measured = tables::measured(arguments.measured.as_deref())?;
    let states = run(&sweep, &plan, &store, execution(arguments, threads), style)?;
    let page = tables::write(out, &sweep, &plan, &store, (&states, &measured))?;
    let code = told(&states, start, style);
    if style == Style::Human {
        terminal::line(&format!("report  {}", page.display()));
    }
    Ok(code)
}

fn style(arguments: &SweepArguments) -> Style {
    match (arguments.json, arguments.quiet) {
        (true, _) => Style::Json,
        (false, true) => Style::Quiet,
        (false, false) => Style::Human,
    }
}

fn execution(arguments: &SweepArguments, threads: usize) -> Execution {
    let retry = if arguments.retry_failed { Retry::Failed } else { Retry::Never };
    Execution { threads, retry }
}

/// Every run, checked.
pub fn planned(sweep: &Sweep, threads: usize) -> Result<Plan, Failure> {
    loading::pool(threads)?.install(|| plan(sweep)).map_err(|error| unplanned(&error))
}

/// A sweep that cannot run.
fn unplanned(error: &PlanError) -> Failure {
    match error {
        PlanError::Unfit(_) => Failure::rendered(ExitCode::BadInput, error.to_string()),
        _ => Failure::input(error.to_string()),
    }
}

fn store(arguments: &SweepArguments) -> Result<Store, Failure> {
    let root = arguments.store.clone().unwrap_or_else(|| arguments.out.join(STORE));
    Store::create(&root).map_err(|error| broken(&error))
}

/// A store that cannot be used.
pub fn broken(error: &StoreError) -> Failure {
    Failure::new(ExitCode::InputOutput, error.to_string())
}

/// What this sweep needs, for `sphcut store gc`.
fn needs(arguments: &SweepArguments, plan: &Plan) -> Result<Needs, Failure> {
    let out = &arguments.out;
    let folder: PathBuf = std::fs::canonicalize(out)
        .map_err(|error| Failure::output(format!("cannot find `{}`", out.display()), &error))?;
    Ok(Needs { folder, addresses: plan.runs.iter().map(|run| run.address).collect() })
}

fn announce(sweep: &Sweep, plan: &Plan, store: &Store, threads: usize, style: Style) {
    let (runs, folder) = (plan.runs.len(), store.root().display());
    match style {
        Style::Json => emit(&json!({
            "event": "start",
            "title": sweep.title,
            "runs": runs,
            "left_out": plan.left_out.len(),
            "threads": threads,
            "store": folder.to_string(),
        })),
        Style::Human => {
            let plural = if threads == 1 { "" } else { "s" };
            terminal::note(&format!(
                "{}: {} runs on {threads} thread{plural}, results in {folder}",
                sweep.title,
                text::grouped(runs as u64)
            ));
        }
        Style::Quiet => {}
    }
}

/// Computes what the store does not have, and shows how far it is.
pub fn run(
    sweep: &Sweep,
    plan: &Plan,
    store: &Store,
    execution: Execution,
    style: Style,
) -> Result<Vec<State>, Failure> {
    let display = Display::new(sweep, plan, style);
    let states = execute(sweep, plan, store, execution, &worker::Here, &|news| display.take(&news));
    display.finish();
    states.map_err(|error| broken(&error))
}

/// Says how it ended.
fn told(states: &[State], start: Instant, style: Style) -> ExitCode {
    let count = |wanted: fn(&State) -> bool| states.iter().filter(|state| wanted(state)).count();
    let failed = count(|state| matches!(state, State::Failed(_)));
    let stopped = count(|state| matches!(state, State::Stopped));
    let reused = count(|state| matches!(state, State::Reused));
    let finished = count(|state| matches!(state, State::Finished));
    match style {
        Style::Json => emit(&json!({
            "event": if stopped > 0 { "interrupted" } else { "done" },
            "finished": finished,
            "reused": reused,
            "failed": failed,
            "stopped": stopped,
            "wall_s": start.elapsed().as_secs_f64(),
        })),
        Style::Human => {
            let duration = text::duration(seconds_to_duration(start.elapsed().as_secs_f64()));
            terminal::line(&format!(
                "{finished} runs computed in {duration}, {reused} there already, {failed} failed"
            ));
        }
        Style::Quiet => {}
    }
    if stopped > 0 {
        if style != Style::Json {
            terminal::note(&format!(
                "interrupted, {stopped} runs are left: checkpoints are written; the same command goes on"
            ));
        }
        return ExitCode::Interrupted;
    }
    if failed > 0 { ExitCode::Diverged } else { ExitCode::Done }
}
