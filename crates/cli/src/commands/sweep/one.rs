//! One run of a sweep, in the process that `worker.rs` starts for it.

use crate::commands::run::StopRule;
use crate::common_arguments::{ScenarioArguments, minutes};
use crate::failure::{ExitCode, Failure};
use crate::progress::emit;
use crate::{files, interrupt, loading, results};
use clap::Args;
use serde_json::{Value, json};
use sphcut_postprocess::{evaluate, summary_json};
use sphcut_record::driver::{self, Export, Moment, RunOptions, Start};
use sphcut_record::{Outcome, Run, RunError};
use sphcut_scenario::Scenario;
use std::io::{BufRead, Read};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Key of the share that is done.
pub const PROGRESS: &str = "share";
/// How long the process of a sweep that has just ended may take to leave the folder.
const PATIENCE: Duration = Duration::from_secs(20);

/// Arguments of the process of one run.
#[derive(Debug, Args)]
pub struct OneArguments {
    /// The scenario that the sweep varies.
    #[command(flatten)]
    scene: ScenarioArguments,
    /// Where the run is computed.
    folder: PathBuf,
    /// On how many threads.
    threads: usize,
    /// Most wall-clock time.
    #[arg(long, value_parser = minutes)]
    time_limit: Option<Duration>,
}

/// Computes the run whose scenario is on standard input, going on with what is in its folder.
pub fn one(arguments: &OneArguments) -> Result<ExitCode, Failure> {
    interrupt::install_patient();
    let text =
        scenario_text().map_err(|error| Failure::output("cannot read the scenario", &error))?;
    let scenario = loading::varied(&arguments.scene, &text)?;
    std::thread::spawn(|| {
        let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
        interrupt::request();
    });
    emit(&computed(&scenario, arguments));
    Ok(ExitCode::Done)
}

fn scenario_text() -> std::io::Result<String> {
    let (mut input, mut length) = (std::io::stdin().lock(), String::new());
    input.read_line(&mut length)?;
    let mut text = vec![0; length.trim().parse().unwrap_or(0)];
    // Cut short if the sweep has ended.
    input.read_exact(&mut text)?;
    String::from_utf8(text).map_err(std::io::Error::other)
}

/// The run, and how it ended.
fn computed(scenario: &Scenario, arguments: &OneArguments) -> Value {
    let passing = |reason: &str| json!({ "ended": "not now", "reason": reason });
    let run = match stepped(scenario, arguments, Start::Resume) {
        // Left by a scenario with other comments, or by a crash that hurt the disk: begun anew.
        Ok(Err(RunError::Mismatch { .. } | RunError::Damaged { .. })) => {
            stepped(scenario, arguments, Start::Replace)
        }
        run => run,
    };
    let run = match run {
        Ok(Ok(run)) => run,
        // It would stop again at the same place.
        Ok(Err(error @ (RunError::Diverged { .. } | RunError::Setup(_)))) => {
            return json!({ "ended": "failed", "reason": error.to_string() });
        }
        Ok(Err(error)) => return passing(&error.to_string()),
        Err(failure) => return passing(failure.message()),
    };
    if run.outcome == Outcome::Interrupted {
        return match arguments.time_limit.filter(|_| !interrupt::requested()) {
            Some(limit) => passing(&format!(
                "not done within {} min; the same sweep goes on from its checkpoint",
                limit.as_secs_f64() / 60.0
            )),
            None => json!({ "ended": "interrupted" }),
        };
    }
    let saved = evaluate(&run).map_err(|error| error.to_string()).and_then(|result| {
        files::save(&arguments.folder.join(results::SUMMARY), summary_json(&result).as_bytes())
            .map_err(|failure| failure.message().to_owned())
    });
    if let Err(reason) = saved {
        return passing(&reason);
    }
    let done = run.performance;
    json!({
        "ended": "finished",
        "particles": done.particles,
        "steps": done.steps,
        "wall_s": done.wall_seconds,
    })
}

fn stepped(
    scenario: &Scenario,
    arguments: &OneArguments,
    start: Start,
) -> Result<Result<Run, RunError>, Failure> {
    let options = RunOptions {
        out_dir: arguments.folder.clone(),
        start,
        snapshots: scenario.output.snapshots,
        checkpoint_interval: Duration::from_secs_f64(scenario.output.checkpoint_seconds),
        threads: arguments.threads,
        export: Export::Nothing,
    };
    let pool = loading::pool(arguments.threads)?;
    let provenance = loading::provenance(scenario);
    let begun = Instant::now();
    let stop =
        StopRule { steady: scenario.stop.steady, start: begun, time_limit: arguments.time_limit };
    let mut control = |progress: &driver::Progress<'_>| {
        if progress.moment == Moment::Clock && progress.end_time > 0.0 {
            let share = progress.time / progress.end_time;
            emit(&json!({ PROGRESS: share, "remaining": progress.remaining_seconds }));
        }
        stop.decide(progress)
    };
    loop {
        match pool.install(|| driver::run(&scenario.setup, &provenance, &options, &mut control)) {
            Err(RunError::InUse { .. }) if begun.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(50));
            }
            run => return Ok(run),
        }
    }
}
