//! Runs a case: scenario files to values to a verdict.

use crate::case::{Case, RunSpecification};
use crate::error::CaseError;
use crate::evidence::Evidence;
use crate::judge::{self, RunValues};
use crate::overrides;
use crate::store::{Store, StoredRun};
use crate::verdict::{Outcome, Verdict};
use sphcut_record::Run;
use sphcut_scenario::{LoadOptions, Scenario};
use sphcut_sph::RESULTS_VERSION;
use std::fs;
use std::path::Path;

/// How cases are run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Where values of finished runs are kept, so that a long case can go on after an
    /// interruption; nothing is kept without it.
    pub store: Option<Store>,
    /// Whether a scenario may read outside its own folder.
    pub load: LoadOptions,
}

/// Where a case is.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress<'case> {
    /// Name of the case.
    pub case: &'case str,
    /// Name of the run.
    pub run: &'case str,
    /// Share of the run that is done.
    pub fraction: f64,
}

/// Runs `case` and judges it. What goes wrong becomes [`Outcome::Broken`].
pub fn run_case(
    case: &Case,
    options: &RunOptions,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Verdict {
    let findings = case
        .runs
        .iter()
        .enumerate()
        .map(|(index, run)| run_values(case, index, run, options, progress))
        .collect::<Result<Vec<_>, _>>()
        .and_then(|values| judge::judge(case, &values));
    verdict(case, findings)
}

/// Judges `case` on the values kept in `store`, without running anything; `None` if a run is
/// missing there or was one of another scenario. Values of an earlier [`RESULTS_VERSION`] count, and are named in
/// [`Verdict::earlier`].
///
/// # Errors
/// A store that cannot be read.
pub fn judge_stored(case: &Case, store: &Store) -> Result<Option<Verdict>, CaseError> {
    let (mut values, mut earlier) = (Vec::new(), Vec::new());
    for (index, run) in case.runs.iter().enumerate() {
        let Some(stored) = store.read(&case.name, &run.name)? else { return Ok(None) };
        let Some(run_values) = from_store(case, index, &stored) else { return Ok(None) };
        if stored.scenario != scenario_text(run)? {
            return Ok(None);
        }
        if stored.results_version != RESULTS_VERSION {
            earlier.push(run.name.clone());
        }
        values.push(run_values);
    }
    let mut verdict = verdict(case, judge::judge(case, &values));
    verdict.earlier = earlier;
    Ok(Some(verdict))
}

/// Reads the scenarios of all runs of `case` without running them.
///
/// # Errors
/// The first scenario that cannot be read, with all its mistakes.
pub fn check_scenarios(case: &Case, options: &RunOptions) -> Result<(), CaseError> {
    for run in &case.runs {
        let text = scenario_text(run)?;
        parse(case, run, &text, &options.load)
            .map_err(|reason| CaseError::RunFailed { run: run.name.clone(), reason })?;
    }
    Ok(())
}

/// Keeps the values of a run that `sphcut run` has finished in `folder`, as those of run `name` of `case`.
///
/// # Errors
/// No such run; a folder that holds no finished run; one whose scenario resolves to other values than that of the
/// case; an observable without a value.
pub fn adopt(
    case: &Case,
    name: &str,
    folder: &Path,
    options: &RunOptions,
    store: &Store,
) -> Result<(), CaseError> {
    let failed = |reason| CaseError::RunFailed { run: name.to_owned(), reason };
    let index = case.runs.iter().position(|run| run.name == name);
    let index = index.ok_or_else(|| failed(format!("no such run in `{}`", case.name)))?;
    let run = &case.runs[index];
    let text = scenario_text(run)?;
    let scenario = parse(case, run, &text, &options.load).map_err(failed)?;
    let finished = Run::load(&folder.join("run.h5")).map_err(|error| failed(error.to_string()))?;
    if finished.outcome != sphcut_record::Outcome::Finished {
        return Err(failed(format!("{} did not run to its end", folder.display())));
    }
    let settings = |(section, key, value): (&str, &str, &str)| format!("{section}.{key} = {value}");
    let wanted: Vec<String> = scenario
        .description
        .iter()
        .map(|entry| settings((&entry.section, &entry.key, &entry.value)))
        .collect();
    let found: Vec<String> = finished
        .provenance
        .settings
        .iter()
        .map(|setting| settings((&setting.section, &setting.key, &setting.value)))
        .collect();
    let differs = |(a, b): (&Vec<String>, &Vec<String>)| a.iter().find(|x| !b.contains(x)).cloned();
    if let Some(other) = differs((&wanted, &found)).or_else(|| differs((&found, &wanted))) {
        return Err(failed(format!("{}: another scenario, `{other}`", folder.display())));
    }
    let snapshots = (0..finished.snapshots.len())
        .map(|number| finished.snapshots.get(number).map(|snapshot| (*snapshot).clone()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| failed(error.to_string()))?;
    let evidence = Evidence {
        setup: scenario.setup,
        samples: (0..finished.samples.len()).filter_map(|k| finished.samples.row(k)).collect(),
        snapshots,
        steps: finished.performance.steps,
        reference: case.reference.clone(),
    };
    let values = evaluate(case, index, &evidence)?;
    let values = RunValues { spacing: evidence.setup.particle_spacing, values };
    store.write(&case.name, &to_store(case, run, text, &values))
}

fn verdict(case: &Case, findings: Result<Vec<crate::Finding>, CaseError>) -> Verdict {
    let (findings, outcome) = match findings {
        Ok(findings) => {
            let outcome = Verdict::outcome_of(&findings);
            (findings, outcome)
        }
        Err(error) => (Vec::new(), Outcome::Broken { reason: error.to_string() }),
    };
    Verdict {
        case: case.name.clone(),
        title: case.title.clone(),
        kind: case.kind,
        tier: case.tier,
        claim: case.claim.clone(),
        findings,
        earlier: Vec::new(),
        outcome,
    }
}

fn run_values(
    case: &Case,
    index: usize,
    run: &RunSpecification,
    options: &RunOptions,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Result<RunValues, CaseError> {
    let text = scenario_text(run)?;
    if let Some(store) = &options.store
        && let Some(stored) = store.read(&case.name, &run.name)?
        && stored.scenario == text
        && stored.results_version == RESULTS_VERSION
        && let Some(values) = from_store(case, index, &stored)
    {
        return Ok(values);
    }
    let failed = |reason| CaseError::RunFailed { run: run.name.clone(), reason };
    let scenario = parse(case, run, &text, &options.load).map_err(failed)?;
    let spacing = scenario.setup.particle_spacing;
    let (snapshots, setup, mode) = (scenario.output.snapshots, scenario.setup, run.mode);
    let mut tell = |fraction| progress(&Progress { case: &case.name, run: &run.name, fraction });
    let reference = case.reference.clone();
    let evidence = match run.threads {
        None => Evidence::collect(setup, mode, snapshots, reference, &mut tell).map_err(failed)?,
        Some(threads) => {
            // The callback stays on this thread: a run in a pool of its own is silent.
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(|error| failed(error.to_string()))?;
            pool.install(|| Evidence::collect(setup, mode, snapshots, reference, &mut |_| ()))
                .map_err(failed)?
        }
    };
    let values = evaluate(case, index, &evidence)?;
    let values = RunValues { spacing, values };
    if let Some(store) = &options.store {
        store.write(&case.name, &to_store(case, run, text, &values))?;
    }
    Ok(values)
}

/// The scenario of a run with its changes applied.
fn scenario_text(run: &RunSpecification) -> Result<String, CaseError> {
    let path = &run.scenario;
    let text = fs::read_to_string(path).map_err(|error| CaseError::unreadable(path, &error))?;
    overrides::apply(&text, &run.changes).map_err(|reason| CaseError::invalid(path, reason))
}

fn parse(
    case: &Case,
    run: &RunSpecification,
    text: &str,
    options: &LoadOptions,
) -> Result<Scenario, String> {
    let base = run.scenario.parent().unwrap_or(&case.folder);
    let name = format!("{}-{}", case.name, run.name);
    sphcut_scenario::parse(text, &name, Some(base), options)
        .map_err(|problems| problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}

fn evaluate(case: &Case, run: usize, evidence: &Evidence) -> Result<Vec<Option<f64>>, CaseError> {
    case.expectations
        .iter()
        .map(|expectation| {
            if !expectation.runs.contains(&run) {
                return Ok(None);
            }
            let observable = expectation.observable;
            (observable.evaluate)(evidence, &expectation.arguments).map(Some).map_err(|reason| {
                CaseError::Unobservable { observable: observable.name.to_owned(), reason }
            })
        })
        .collect()
}

fn to_store(case: &Case, run: &RunSpecification, text: String, values: &RunValues) -> StoredRun {
    let labelled =
        case.expectations.iter().zip(&values.values).filter_map(|(expectation, value)| {
            value.map(|value| (expectation.arguments.label(expectation.observable), value))
        });
    StoredRun {
        run: run.name.clone(),
        results_version: RESULTS_VERSION,
        spacing: values.spacing,
        scenario: text,
        values: labelled.collect(),
    }
}

/// The values of one run as kept; `None` if an expectation asks for one that is not there.
fn from_store(case: &Case, run: usize, stored: &StoredRun) -> Option<RunValues> {
    let mut values = Vec::new();
    for expectation in &case.expectations {
        values.push(if expectation.runs.contains(&run) {
            let label = expectation.arguments.label(expectation.observable);
            Some(*stored.values.get(&label)?)
        } else {
            None
        });
    }
    Some(RunValues { spacing: stored.spacing, values })
}
