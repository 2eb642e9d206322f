//! What a program that holds sphcut calls, without a command line: checks, runs and sweeps. How far they are
//! is told as a share between 0 and 1 and a line for people. [`crate::interrupt`] stops them with a checkpoint.

use crate::commands::sweep::{SweepTally, local, tables};
use crate::commands::{check, run as run_command};
use crate::failure::Failure;
use crate::results::{self, Results};
use crate::{files, loading};
use serde_json::Value;
use sphcut_postprocess::ProcessResult;
use sphcut_record::driver::Start;
use sphcut_record::{Outcome, Run};
use sphcut_scenario::Scenario;
use sphcut_sweep::{Execution, News, State, Store, Sweep, SweepTable};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Hears a share between 0 and 1 and a line for people.
pub type Tell<'t> = dyn FnMut(f64, &str) + Send + 't;

/// Most often a sweep tells how far it is.
const BETWEEN: Duration = Duration::from_millis(200);

/// Particles, steps, memory, resolution, warnings and every key of `scenario` as `sphcut check --json` has them; if `measured`, the
/// speed of this machine and the expected duration, too.
///
/// # Errors
/// A setup that cannot be built.
pub fn checked(scenario: &Scenario, measured: bool) -> Result<Value, Failure> {
    check::as_json_of(scenario, loading::threads(None), measured)
}

/// Runs `scenario` into the folder `out` and writes summary and report, as `sphcut run` does. The results are `None` where the run
/// was interrupted.
///
/// # Errors
/// What `sphcut run` refuses, and a run that diverges.
pub fn run(
    scenario: &Scenario,
    (out, start): (&Path, Start),
    threads: Option<NonZeroUsize>,
    told: &mut Tell<'_>,
) -> Result<(Run, Option<ProcessResult>), Failure> {
    let options = run_command::options(scenario, out.to_owned(), start, threads);
    let mut watch = |status: &crate::progress::Status| told(status.share(), &status.line());
    let run = run_command::compute_watched(scenario, &options, None, &mut watch)?;
    if run.outcome == Outcome::Interrupted {
        return Ok((run, None));
    }
    let Results { result, .. } = results::write(&run, out)?;
    Ok((run, Some(result)))
}

/// Where the results of a sweep go.
#[derive(Debug, Clone)]
pub struct SweepPlace {
    /// Folder of table and page.
    pub out: PathBuf,
    /// Folder of the store of results.
    pub store: PathBuf,
    /// Threads of all runs together.
    pub threads: Option<NonZeroUsize>,
}

/// Computes what the store does not have of `sweep`, and writes table and page, as `sphcut sweep` does. Each run has a process of its
/// own: see [`crate::started_by`].
///
/// # Errors
/// Combinations that make no scenario; a store that cannot be used. Runs that fail are no error: see the table.
pub fn sweep(
    sweep: &Sweep,
    place: &SweepPlace,
    told: &mut Tell<'_>,
) -> Result<SweepTable, Failure> {
    let threads = loading::threads(place.threads);
    let plan = local::planned(sweep, threads)?;
    files::create_folder(&place.out)?;
    let store = Store::create(&place.store)?;
    local::note_needs(&store, &place.out, &plan)?;
    let start = Instant::now();
    let state = Mutex::new((SweepTally::new(&plan), None::<Instant>, told));
    let news = |news: News| {
        let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
        let (tally, last, told) = &mut *state;
        tally.note(&news);
        if matches!(news, News::State { .. }) || last.is_none_or(|last| last.elapsed() >= BETWEEN) {
            *last = Some(Instant::now());
            told(tally.share(), &tally.line(start.elapsed().as_secs_f64()));
        }
    };
    let execution = Execution { threads, retry: sphcut_sweep::Retry::Never };
    let states: Vec<State> = local::run_watched((sweep, None), &plan, &store, execution, &news)?;
    tables::write(&place.out, sweep, &plan, &store, (&states, &[]))?;
    Ok(SweepTable::new(sweep, &plan, &store, &states, &tables::summary))
}
