//! The paired runs of a diagnosis, through a store like any sweep.

use super::DiagnoseArguments;
use crate::commands::sweep::listed::{self, ListedRuns, RunPlace};
use crate::commands::sweep::{dry_run, local};
use crate::failure::{ExitCode, Failure};
use crate::{files, loading, terminal};
use sphcut_diagnose::{
    Change, DiagnoseError, Diagnosis, DiagnosisCase, Fit, PairedRun, PairedRuns, PairedScenario,
    Predictor, STATES, changes, rerun_changes, rerun_conditions, scenario_patch, support,
    unseen_fits,
};
use sphcut_physics::CuttingCondition;
use sphcut_report::SimulatedPair;
use sphcut_sweep::Sweep;
use std::path::PathBuf;

/// Pairs of pictures on the page.
const MOST_PAIRS: usize = 3;
/// Folder of the runs in the output folder.
const FOLDER: &str = "runs";

/// Runs at conditions, each with its change.
pub struct Paired {
    sweep: Sweep,
    runs: Vec<(CuttingCondition, Change)>,
    /// The patch that makes the last of the runs of the scenario; empty for a library.
    patch: String,
}

/// A result, and where its record lies.
#[derive(Debug, Clone)]
pub struct FinishedRun {
    /// What was changed and what it gave.
    pub run: PairedRun,
    /// Folder of its record in the store.
    pub folder: PathBuf,
}

/// How paired runs ended.
pub enum Ended {
    /// With so many results.
    Finished(Vec<FinishedRun>),
    /// The user stopped them, or computes them elsewhere; the same command goes on.
    Interrupted,
}

impl Paired {
    /// `changes` at every condition.
    pub fn new(
        case: &DiagnosisCase,
        arguments: &DiagnoseArguments,
        (title, name): (&str, &str),
        runs: Vec<(CuttingCondition, Change)>,
    ) -> Result<Self, Failure> {
        let base = PairedScenario::of(&case.base, case.runs.travel).map_err(refused)?;
        let worn = runs.iter().any(|(_, change)| change.wear_land.is_some());
        let values = runs
            .iter()
            .map(|(condition, change)| base.values(condition, change, worn).map_err(refused));
        let values: Vec<Vec<String>> = values.collect::<Result<_, _>>()?;
        let sweep = Sweep::listed(
            (title, name),
            (&case.base, &case.base_path),
            &loading::options(&arguments.scene),
            (&base.keys(worn), &values),
        )
        .map_err(Failure::input)?;
        Ok(Self { sweep, runs, patch: String::new() })
    }

    /// The library of a case: every effect at three speeds and thicknesses.
    pub fn library(case: &DiagnosisCase, arguments: &DiagnoseArguments) -> Result<Self, Failure> {
        let rows = case.measured.iter().chain(case.reference.iter().flat_map(|cuts| &cuts.rows));
        let conditions: Vec<CuttingCondition> = rows.map(|row| row.condition()).collect();
        PairedScenario::check_tools(&case.base, &conditions).map_err(refused)?;
        let [speeds, sizes] = support(&conditions, case.runs.range);
        let wears = conditions.iter().any(|condition| condition.cut_length > 0.0);
        let base = PairedScenario::of(&case.base, case.runs.travel).map_err(refused)?;
        let can_be = |key: &str| (wears || key != "flank_wear") && base.can_have(key);
        let runs: Vec<(CuttingCondition, Change)> = changes(&case.scatter(), can_be)
            .into_iter()
            .flat_map(|change| {
                let at = speeds.iter().flat_map(|v| sizes.iter().map(move |h| (*v, *h)));
                let at: Vec<(f64, f64)> = at.collect();
                at.into_iter().map(move |(v, h)| (CuttingCondition::new(v, h), change.clone()))
            })
            .collect();
        if runs.len() > case.runs.most {
            let message = format!(
                "{} runs are needed to tell what each effect changes, and `most` of [runs] allows {}",
                runs.len(),
                case.runs.most
            );
            return Err(Failure::input(message).advise("raise `most`, or use --closed-form"));
        }
        Self::new(case, arguments, ("What each effect changes", "library"), runs)
    }

    /// What it would take.
    pub fn dry_run(&self, arguments: &DiagnoseArguments) -> Result<ExitCode, Failure> {
        let threads = loading::threads(arguments.threads);
        let plan = local::planned(&self.sweep, threads)?;
        let speed = local::speed(&self.sweep, &plan)?;
        let total = dry_run::total(&plan, Some(speed), threads);
        let warnings = dry_run::warnings(&plan);
        terminal::answer(&format!("{}\n{total}{warnings}", self.sweep.title))
    }

    /// The scenario as it is, fitted again and repaired, at some of the recorded conditions, and the two fits, which have not seen these;
    /// `None` if there is no repair, or none that the scenario has keys for.
    pub fn repaired(
        case: &DiagnosisCase,
        arguments: &DiagnoseArguments,
        (found, predictor): (&Diagnosis, &dyn Predictor),
    ) -> Result<Option<(Self, Fit, Fit)>, Failure> {
        let problem = &found.problem;
        let Some(repair) = found.repair.map(|repair| &found.fits[repair]) else { return Ok(None) };
        let conditions = rerun_conditions(problem, case.runs.repaired);
        let Some((null, repair)) = unseen_fits(problem, predictor, repair, &conditions) else {
            return Ok(None);
        };
        let mut runs = Vec::new();
        for condition in conditions {
            let Some(changes) = rerun_changes(problem, predictor, (&null, &repair), &condition)
            else {
                return Ok(None);
            };
            runs.extend(changes.map(|change| (condition, change)));
        }
        let Some((_, change)) = runs.last() else { return Ok(None) };
        let patch = scenario_patch(&case.base, change).map_err(refused)?;
        let mut paired = Self::new(case, arguments, ("The corrected scenario", "repaired"), runs)?;
        paired.patch = patch;
        Ok(Some((paired, null, repair)))
    }

    /// The results in the order of the runs, of each condition the three states.
    pub fn in_order(&self, results: &[FinishedRun]) -> Vec<[Option<FinishedRun>; STATES]> {
        let of = |(condition, change): &(CuttingCondition, Change)| {
            let is_it = |run: &PairedRun| run.condition == *condition && run.change == *change;
            results.iter().find(|one| is_it(&one.run)).cloned()
        };
        self.runs
            .chunks(STATES)
            .map(|own| std::array::from_fn(|k| own.get(k).and_then(of)))
            .collect()
    }

    /// Computes what the store does not have.
    pub fn run(&self, arguments: &DiagnoseArguments) -> Result<Ended, Failure> {
        let folder = arguments.folder().join(FOLDER).join(&self.sweep.name);
        files::create_folder(&folder)?;
        if !self.patch.is_empty() {
            files::save(&folder.join(super::PATCH), self.patch.as_bytes())?;
        }
        let place = RunPlace {
            folder,
            store: arguments
                .store
                .clone()
                .unwrap_or_else(|| arguments.folder().join(FOLDER).join("store")),
            threads: loading::threads(arguments.threads),
            only_list: arguments.list_runs,
            patch: None,
        };
        let ListedRuns::Finished(rows) = listed::compute(&self.sweep, &place)? else {
            return Ok(Ended::Interrupted);
        };
        let results = rows.iter().map(|row| {
            let (condition, change) = &self.runs[row.number - 1];
            let means = listed::means(row);
            let run = PairedRun { condition: *condition, change: change.clone(), means };
            FinishedRun { run, folder: row.folder.clone() }
        });
        Ok(Ended::Finished(results.collect()))
    }
}

/// Why a scenario has no paired runs, with advice.
pub fn refused(error: DiagnoseError) -> Failure {
    let failure = Failure::input(error.to_string());
    match error {
        DiagnoseError::NoPairedRuns { help, .. } if !help.is_empty() => failure.advise(help),
        _ => failure,
    }
}

/// The library as a model.
pub fn model(case: &DiagnosisCase, results: &[FinishedRun]) -> Result<PairedRuns, Failure> {
    let runs: Vec<PairedRun> = results.iter().map(|one| one.run.clone()).collect();
    PairedRuns::new(&runs, &case.scatter()).ok_or_else(|| {
        Failure::input(
            "too few of the runs without an effect have a result: there is nothing to compare with",
        )
    })
}

/// The results alone.
pub fn without_folders(
    states: &[[Option<FinishedRun>; STATES]],
) -> Vec<[Option<PairedRun>; STATES]> {
    let alone = |run: &Option<FinishedRun>| run.as_ref().map(|run| run.run.clone());
    states.iter().map(|own| own.each_ref().map(alone)).collect()
}

/// Pictures of the first conditions, which lie farthest apart: as the scenario is beside the corrected one.
pub fn pairs(states: &[[Option<FinishedRun>; STATES]]) -> Result<Vec<SimulatedPair>, Failure> {
    let mut pairs = Vec::new();
    for [as_it_is, _, corrected] in states {
        let (Some(first), Some(second)) = (as_it_is, corrected) else { continue };
        let drawn = [first, second].map(|one| (&one.run, one.folder.as_path()));
        let pair = SimulatedPair::draw(drawn)
            .map_err(|error| Failure::new(ExitCode::InputOutput, error.to_string()))?;
        pairs.extend(pair);
        if pairs.len() == MOST_PAIRS {
            break;
        }
    }
    Ok(pairs)
}
