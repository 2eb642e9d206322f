//! Computes one run of a sweep in this process.

use crate::commands::run;
use crate::{files, interrupt, loading, results};
use sphcut_postprocess::{evaluate, summary_json};
use sphcut_record::driver::{self, Export, Process, RunOptions, Start};
use sphcut_record::{Outcome, Run, RunError};
use sphcut_scenario::Scenario;
use sphcut_sweep::{Computed, Trouble, Watch, Worker};
use std::path::Path;
use std::time::Duration;

/// Computes runs until the user stops it.
#[derive(Debug)]
pub struct Here;

impl Worker for Here {
    fn compute(
        &self,
        scenario: &Scenario,
        folder: &Path,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Computed, Trouble> {
        let run = match stepped(scenario, folder, (threads, Start::Resume), watch) {
            // Left by a scenario with other comments, or by a crash that hurt the disk: begun anew.
            Err(Stop::Run(RunError::Mismatch { .. } | RunError::Damaged { .. })) => {
                stepped(scenario, folder, (threads, Start::Replace), watch)
            }
            run => run,
        }
        .map_err(trouble)?;
        if run.outcome == Outcome::Interrupted {
            return Ok(Computed::Interrupted);
        }
        let passing = |reason: String| Trouble::Passing(reason);
        let result = evaluate(&run).map_err(|error| passing(error.to_string()))?;
        files::save(&folder.join(results::SUMMARY), summary_json(&result).as_bytes())
            .map_err(|failure| passing(failure.message().to_owned()))?;
        Ok(Computed::Finished {
            particles: run.performance.particles,
            steps: run.performance.steps,
            wall_seconds: run.performance.wall_seconds,
        })
    }

    fn stopping(&self) -> bool {
        interrupt::requested()
    }
}

/// Why there is no run.
enum Stop {
    Run(RunError),
    Pool(String),
}

fn stepped(
    scenario: &Scenario,
    folder: &Path,
    (threads, start): (usize, Start),
    watch: &mut Watch<'_>,
) -> Result<Run, Stop> {
    let options = RunOptions {
        out_dir: folder.to_owned(),
        start,
        snapshots: scenario.output.snapshots,
        checkpoint_interval: Duration::from_secs_f64(scenario.output.checkpoint_seconds),
        threads,
        process: Process::Shared,
        export: Export::Nothing,
    };
    let pool =
        loading::pool(threads).map_err(|failure| Stop::Pool(failure.message().to_owned()))?;
    let provenance = loading::provenance(scenario);
    let mut control = |progress: &driver::Progress<'_>| {
        let share = if progress.end_time > 0.0 { progress.time / progress.end_time } else { 0.0 };
        watch(share, progress.remaining_seconds);
        run::decide(progress, scenario.stop.steady)
    };
    pool.install(|| driver::run(&scenario.setup, &provenance, &options, &mut control))
        .map_err(Stop::Run)
}

/// Whether the run would stop again at the same place.
fn trouble(stop: Stop) -> Trouble {
    match stop {
        Stop::Run(error @ (RunError::Diverged { .. } | RunError::Setup(_))) => {
            Trouble::Lasting(error.to_string())
        }
        Stop::Run(error) => Trouble::Passing(error.to_string()),
        Stop::Pool(reason) => Trouble::Passing(reason),
    }
}
