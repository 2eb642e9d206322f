//! `sphcut sweep`: many runs of one scenario.

mod arguments;
mod dry_run;

pub use arguments::SweepArguments;

use crate::failure::{ExitCode, Failure};
use crate::loading;
use sphcut_scenario::Sweep;
use sphcut_sweep::{Plan, PlanError, plan};

/// Plans the sweep and runs it.
pub fn sweep(arguments: &SweepArguments) -> Result<ExitCode, Failure> {
    let sweep = loading::sweep(&arguments.scene)?;
    let threads = loading::threads(arguments.threads);
    let plan = planned(&sweep, threads)?;
    dry_run::dry_run(arguments, &sweep, &plan, threads)
}

/// Every run, checked.
fn planned(sweep: &Sweep, threads: usize) -> Result<Plan, Failure> {
    loading::pool(threads)?.install(|| plan(sweep)).map_err(|error| match error {
        PlanError::Unfit(_) => Failure::rendered(ExitCode::BadInput, error.to_string()),
        _ => Failure::input(error.to_string()),
    })
}
