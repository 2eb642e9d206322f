//! `sphcut sweep`: many runs of one scenario.

mod arguments;
mod display;
pub mod dry_run;
pub mod listed;
pub mod local;
mod one;
mod slurm;
pub mod tables;
mod tally;
mod worker;

pub use arguments::SweepCommand;
pub use tally::SweepTally;

use crate::failure::{ExitCode, Failure};
use crate::progress::OutputStyle;
use crate::{files, interrupt, loading, outcome, terminal};
use arguments::{Executor, SweepArguments};
use sphcut_sweep::{Execution, Retry, Store};
use std::time::Instant;

/// Runs a sweep, or looks after one on a cluster.
pub fn sweep(command: &SweepCommand) -> Result<ExitCode, Failure> {
    match command {
        SweepCommand::Job(job) => slurm::look_after(job),
        SweepCommand::Sweep(arguments) => planned_and_run(arguments),
    }
}

fn planned_and_run(arguments: &SweepArguments) -> Result<ExitCode, Failure> {
    let result = follow(arguments);
    if let (Err(failure), true) = (&result, arguments.told.json) {
        outcome::emit_error(failure);
    }
    result
}

fn follow(arguments: &SweepArguments) -> Result<ExitCode, Failure> {
    slurm::check_options(arguments)?;
    let sweep = loading::sweep(&arguments.scene)?;
    let threads = loading::threads(arguments.threads);
    // Those of a cluster's nodes may be more than this machine is good for.
    let slurm = arguments.executor == Executor::Slurm;
    let plan = local::planned(&sweep, if slurm { loading::threads(None) } else { threads })?;
    if arguments.dry_run {
        return dry_run::dry_run(arguments, &sweep, &plan, threads);
    }
    let style = arguments.told.style();
    let out = &arguments.folder();
    files::create_folder(out)?;
    let store = Store::create(&arguments.store_folder())?;
    local::note_needs(&store, out, &plan)?;
    if arguments.executor == Executor::Slurm {
        return slurm::submit(arguments, &sweep, &plan, &store, style);
    }
    interrupt::install();
    local::announce(&sweep, &plan, &store, threads, style);
    let start = Instant::now();
    let measured = tables::measured(arguments.measured.as_deref())?;
    let states = local::run(
        (&sweep, arguments.time_limit),
        &plan,
        &store,
        execution(arguments, threads),
        style,
    )?;
    let page = tables::write(out, &sweep, &plan, &store, (&states, &measured))?;
    let code = local::told(&states, start, style);
    if style == OutputStyle::Human {
        terminal::report(&page, &tables::next(out));
    }
    Ok(code)
}

fn execution(arguments: &SweepArguments, threads: usize) -> Execution {
    let retry = if arguments.retry_failed { Retry::Failed } else { Retry::Never };
    Execution { threads, retry }
}
