//! `sphcut run`: a scenario from its file to its report.

use crate::common_arguments::{PatchableArguments, ToldArguments, minutes};
use crate::failure::{ExitCode, Failure};
use crate::progress::{OutputStyle, RunDisplay, ShownForces, Status, Travel};
use crate::{interrupt, loading, outcome, results, terminal};
use clap::Args;
use sphcut_postprocess::steady::{Series, SteadyOptions, detect};
use sphcut_record::driver::{self, Control, Export, Moment, Progress, RunOptions, Start};
use sphcut_record::{Outcome, Run};
use sphcut_scenario::{Scenario, Steady};
use sphcut_sph::ChannelId;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const HELP: &str = "\
What appears in the output folder (out/<scenario> unless --out says otherwise):
  report.html    one page: setup, pictures, forces, balances, warnings
  summary.json   the results as numbers
  forces.csv     forces, energies and temperatures over time, units in the header
  run.h5         everything: channels, particles, scenario text, checkpoint

Ctrl-C stops after the current step and writes a checkpoint; run the same command with --resume
to go on. The results are the same, bit for bit, as without the interruption and for any number
of threads.

--patch scenario.patch.toml runs the scenario with what `sphcut diagnose` found to be missing.";

/// Arguments of `run`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct RunArguments {
    /// The scenario.
    #[command(flatten)]
    pub scenario: PatchableArguments,
    /// Output folder [default: out/<name of the scenario>].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Go on from the last checkpoint in the output folder.
    #[arg(long, conflicts_with = "force")]
    pub resume: bool,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
    /// Stop with a checkpoint after so many minutes, as Ctrl-C does.
    #[arg(long, value_name = "MINUTES", value_parser = minutes)]
    pub time_limit: Option<Duration>,
    /// What is told.
    #[command(flatten)]
    pub told: ToldArguments,
}

/// The test for a steady state looks at the whole record: once in this many samples is enough.
const SAMPLES_BETWEEN_STEADY_TESTS: usize = 10;

/// Runs the scenario.
pub fn run(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let style = arguments.told.style();
    let result = follow(arguments, style);
    if let (Err(failure), OutputStyle::Json) = (&result, style) {
        outcome::emit_error(failure);
    }
    result
}

/// From the file to the report.
fn follow(arguments: &RunArguments, style: OutputStyle) -> Result<ExitCode, Failure> {
    let scenario = loading::scenario(&arguments.scenario)?;
    let start = match (arguments.resume, arguments.force) {
        (true, _) => Start::Resume,
        (false, true) => Start::Replace,
        (false, false) => Start::New,
    };
    let out = output_folder(arguments.out.as_deref(), &scenario);
    let options = options(&scenario, out, start, arguments.threads);
    interrupt::install();
    outcome::announce(&scenario, &options, style);
    let run = compute(&scenario, &options, arguments.time_limit, style)?;
    if run.outcome == Outcome::Interrupted {
        outcome::interrupted(&run, style);
        return Ok(ExitCode::Interrupted);
    }
    let results = results::write(&run, &options.out_dir)?;
    let new = |warning: &&String| !scenario.warnings.contains(warning);
    for warning in run.provenance.warnings.iter().filter(new) {
        terminal::note(&format!("warning: {warning}"));
    }
    outcome::finished(&run, &results, style);
    Ok(ExitCode::Done)
}

/// How `scenario` is run into the folder `out_dir`.
pub fn options(
    scenario: &Scenario,
    out_dir: PathBuf,
    start: Start,
    threads: Option<NonZeroUsize>,
) -> RunOptions {
    RunOptions {
        out_dir,
        start,
        snapshots: scenario.output.snapshots,
        checkpoint_interval: Duration::from_secs_f64(scenario.output.checkpoint_seconds),
        threads: loading::threads(threads),
        export: Export::Vtkhdf,
    }
}

/// The folder of the result: the one asked for, or `out/<scenario>`.
fn output_folder(wanted: Option<&Path>, scenario: &Scenario) -> PathBuf {
    wanted.map_or_else(|| Path::new("out").join(&scenario.name), Path::to_owned)
}

/// Steps the simulation on its own threads and shows its progress.
pub fn compute(
    scenario: &Scenario,
    options: &RunOptions,
    time_limit: Option<Duration>,
    style: OutputStyle,
) -> Result<Run, Failure> {
    let mut display = RunDisplay::new(style);
    let run = compute_watched(scenario, options, time_limit, &mut |status| display.update(status));
    display.finish();
    run
}

/// Steps the simulation on its own threads and tells `watch` where it is.
pub fn compute_watched(
    scenario: &Scenario,
    options: &RunOptions,
    time_limit: Option<Duration>,
    watch: &mut (dyn FnMut(&Status) + Send),
) -> Result<Run, Failure> {
    let pool = loading::pool(options.threads)?;
    let provenance = loading::provenance(scenario);
    let stop = StopRule { steady: scenario.stop.steady, start: Instant::now(), time_limit };
    let run = pool.install(|| {
        driver::run(&scenario.setup, &provenance, options, &mut |progress| {
            watch(&status(progress));
            stop.decide(progress)
        })
    });
    run.map_err(|error| Failure::of_run(&error, &options.out_dir))
}

/// What ends a run before its end time.
pub struct StopRule {
    /// Mean forces that are known well enough.
    pub steady: Option<Steady>,
    /// When this process took the run up.
    pub start: Instant,
    /// Most wall-clock time since then.
    pub time_limit: Option<Duration>,
}

impl StopRule {
    /// Whether the run goes on.
    pub fn decide(&self, progress: &Progress) -> Control {
        if interrupt::requested() || self.is_late() {
            return Control::Interrupt;
        }
        match self.steady {
            Some(steady) if is_steady(progress, steady) => Control::Stop,
            _ => Control::Continue,
        }
    }

    fn is_late(&self) -> bool {
        self.time_limit.is_some_and(|limit| self.start.elapsed() >= limit)
    }
}

/// Whether the mean forces are known well enough. Only asked at samples, so that the answer
/// does not depend on the clock.
fn is_steady(progress: &Progress, steady: Steady) -> bool {
    let samples = progress.samples;
    let due = progress.moment == Moment::Sample
        && samples.len().is_multiple_of(SAMPLES_BETWEEN_STEADY_TESTS)
        && progress.travel >= steady.minimum_travel;
    let known = |force: ChannelId, relative_half_width: f64| {
        let options = SteadyOptions { relative_half_width, minimum_travel: steady.minimum_travel };
        let series =
            Series { travel: samples.channel(ChannelId::Travel), force: samples.channel(force) };
        detect(series, &options).reached
    };
    due && known(ChannelId::CuttingForce, steady.relative_half_width)
        && steady.feed_relative_half_width.is_none_or(|wanted| known(ChannelId::FeedForce, wanted))
}

/// The progress as it is shown.
fn status(progress: &Progress) -> Status {
    let cuts = progress.end_travel > 0.0;
    let in_space = progress.facts.dimension == 3;
    // Channels of a plane run are in N/m; those of a spatial one in N.
    let factor = if in_space { 1.0 } else { 1e-3 };
    let forces = progress.samples.last().filter(|_| cuts).map(|sample| ShownForces {
        cutting: sample.get(ChannelId::CuttingForce) * factor,
        feed: sample.get(ChannelId::FeedForce) * factor,
        passive: in_space.then(|| sample.get(ChannelId::PassiveForce)),
    });
    Status {
        step: progress.step,
        time: progress.time,
        end_time: progress.end_time,
        travel: cuts.then_some(Travel { now: progress.travel, end: progress.end_travel }),
        updates_per_second: progress.updates_per_second,
        wall_seconds: progress.wall_seconds,
        remaining_seconds: progress.remaining_seconds,
        forces,
    }
}
