//! Runs the scenarios of a case: files to values to judgements.

use super::judge::{RunValues, judge};
use super::{RunSpecification, ScenarioRuns, overrides};
use crate::error::CaseError;
use crate::evidence::{Evaluated, Evidence};
use crate::head::{CaseHead, text_of};
use crate::options::{CaseOptions, CaseProgress, ProgressWatch};
use crate::store::{CaseStore, StoredRun};
use crate::verdict::Judgement;
use sphcut_record::Run;
use sphcut_scenario::{LoadOptions, Scenario};
use sphcut_sph::RESULTS_VERSION;
use std::path::Path;

/// What came of the expectations of a case.
type Judged = Result<Vec<Judgement>, CaseError>;

impl ScenarioRuns {
    /// Runs everything and judges it.
    pub(crate) fn run(
        &self,
        head: &CaseHead,
        options: &CaseOptions,
        progress: &ProgressWatch<'_>,
    ) -> Judged {
        let all = self.runs.iter().enumerate();
        let values = all.map(|(index, run)| self.run_values(head, (index, run), options, progress));
        judge(self, head, &values.collect::<Result<Vec<_>, _>>()?)
    }

    /// Judges the values kept in `store`, with the names of the runs whose values an earlier version gave; `None` if a
    /// run is missing there or was one of another scenario.
    pub(crate) fn judge_stored(
        &self,
        head: &CaseHead,
        store: &CaseStore,
    ) -> Result<Option<(Judged, Vec<String>)>, CaseError> {
        let (mut values, mut earlier) = (Vec::new(), Vec::new());
        for (index, run) in self.runs.iter().enumerate() {
            let Some(stored) = store.read(&head.name, &run.name)? else { return Ok(None) };
            let Some(run_values) = self.values_kept(index, &stored) else { return Ok(None) };
            if stored.scenario != scenario_text(run)? {
                return Ok(None);
            }
            if stored.results_version != RESULTS_VERSION {
                earlier.push(run.name.clone());
            }
            values.push(run_values);
        }
        Ok(Some((judge(self, head, &values), earlier)))
    }

    /// Reads the scenarios of all runs without running them.
    pub(crate) fn check(&self, head: &CaseHead, options: &CaseOptions) -> Result<(), CaseError> {
        for run in &self.runs {
            parse(head, run, &scenario_text(run)?, &options.load)
                .map_err(|reason| CaseError::failed(&run.name, reason))?;
        }
        Ok(())
    }

    /// Keeps the values of a run that `sphcut run` has finished in `folder`, as those of run `name` of the case.
    ///
    /// # Errors
    /// No such run; a folder that holds no finished run; one whose scenario resolves to other values than that of the
    /// case; an observable without a value.
    pub fn adopt(
        &self,
        head: &CaseHead,
        (name, folder): (&str, &Path),
        options: &CaseOptions,
        store: &CaseStore,
    ) -> Result<(), CaseError> {
        let failed = |reason| CaseError::failed(name, reason);
        let index = self.runs.iter().position(|run| run.name == name);
        let index = index.ok_or_else(|| failed(format!("no such run in `{}`", head.name)))?;
        let run = &self.runs[index];
        let text = scenario_text(run)?;
        let scenario = parse(head, run, &text, &options.load).map_err(failed)?;
        let finished =
            Run::load(&folder.join("run.h5")).map_err(|error| failed(error.to_string()))?;
        if finished.outcome != sphcut_record::Outcome::Finished {
            return Err(failed(format!("{} did not run to its end", folder.display())));
        }
        let settings =
            |(section, key, value): (&str, &str, &str)| format!("{section}.{key} = {value}");
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
        let differs =
            |(a, b): (&Vec<String>, &Vec<String>)| a.iter().find(|x| !b.contains(x)).cloned();
        if let Some(other) = differs((&wanted, &found)).or_else(|| differs((&found, &wanted))) {
            return Err(failed(format!("{}: another scenario, `{other}`", folder.display())));
        }
        let snapshots = (0..finished.snapshots.len())
            .map(|number| finished.snapshots.get(number))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| failed(error.to_string()))?;
        let evidence = Evidence {
            setup: scenario.setup,
            samples: (0..finished.samples.len()).filter_map(|k| finished.samples.row(k)).collect(),
            snapshots,
            steps: finished.performance.steps,
            reference: self.reference.clone(),
            evaluated: Evaluated::default(),
        };
        let values = self.evaluate(index, &evidence)?;
        let values = RunValues { spacing: evidence.setup.particle_spacing, values };
        store.write(&head.name, &self.to_store(run, text, &values))
    }

    fn run_values(
        &self,
        head: &CaseHead,
        (index, run): (usize, &RunSpecification),
        options: &CaseOptions,
        progress: &ProgressWatch<'_>,
    ) -> Result<RunValues, CaseError> {
        let text = scenario_text(run)?;
        let failed = |reason| CaseError::failed(&run.name, reason);
        let scenario = parse(head, run, &text, &options.load).map_err(failed)?;
        let spacing = scenario.setup.particle_spacing;
        if let Some(store) = &options.store
            && let Some(stored) = store.read(&head.name, &run.name)?
            && stored.scenario == text
            // The same text is another scenario where a preset has changed.
            && (stored.spacing - spacing).abs() <= 1e-9 * spacing
            && stored.results_version == RESULTS_VERSION
            && let Some(values) = self.values_kept(index, &stored)
        {
            return Ok(values);
        }
        let (snapshots, setup) = (scenario.output.snapshots, scenario.setup);
        let tell =
            |fraction| progress(&CaseProgress { case: &head.name, run: &run.name, fraction });
        let reference = self.reference.clone();
        let collect = || Evidence::collect(setup, run.mode, snapshots, reference, &tell);
        let evidence = match run.threads {
            None => collect(),
            Some(threads) => rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(|error| failed(error.to_string()))?
                .install(collect),
        };
        let values = self.evaluate(index, &evidence.map_err(failed)?)?;
        let values = RunValues { spacing, values };
        if let Some(store) = &options.store {
            store.write(&head.name, &self.to_store(run, text, &values))?;
        }
        Ok(values)
    }

    fn evaluate(&self, run: usize, evidence: &Evidence) -> Result<Vec<Option<f64>>, CaseError> {
        self.expectations
            .iter()
            .map(|expectation| {
                if !expectation.runs.contains(&run) {
                    return Ok(None);
                }
                let observable = expectation.observable;
                (observable.evaluate)(evidence, &expectation.arguments)
                    .map(Some)
                    .map_err(|reason| CaseError::unobservable(observable.name, reason))
            })
            .collect()
    }

    fn to_store(&self, run: &RunSpecification, text: String, values: &RunValues) -> StoredRun {
        let labelled = self.expectations.iter().zip(&values.values);
        let labelled =
            labelled.filter_map(|(expectation, value)| Some((expectation.label(), (*value)?)));
        StoredRun {
            run: run.name.clone(),
            results_version: RESULTS_VERSION,
            spacing: values.spacing,
            scenario: text,
            values: labelled.collect(),
        }
    }

    /// The values of one run as kept; `None` if an expectation asks for one that is not there.
    fn values_kept(&self, run: usize, stored: &StoredRun) -> Option<RunValues> {
        let mut values = Vec::new();
        for expectation in &self.expectations {
            let is_meant = expectation.runs.contains(&run);
            values.push(if is_meant {
                Some(*stored.values.get(&expectation.label())?)
            } else {
                None
            });
        }
        Some(RunValues { spacing: stored.spacing, values })
    }
}

/// The scenario of a run with its changes applied.
fn scenario_text(run: &RunSpecification) -> Result<String, CaseError> {
    let path = &run.scenario;
    overrides::apply(&text_of(path)?, &run.changes)
        .map_err(|reason| CaseError::invalid(path, reason))
}

fn parse(
    head: &CaseHead,
    run: &RunSpecification,
    text: &str,
    options: &LoadOptions,
) -> Result<Scenario, String> {
    let base = run.scenario.parent().unwrap_or(&head.folder);
    let name = format!("{}-{}", head.name, run.name);
    sphcut_scenario::parse(text, &name, Some(base), options)
        .map_err(|problems| problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}
