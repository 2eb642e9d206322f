//! Cases of scenarios: what is run, what is expected of named observables and why.

mod judge;
mod overrides;
mod replicates;
mod run;
pub(crate) mod variants;

use crate::error::CaseError;
use crate::evidence::RunMode;
use crate::head::{CaseHead, CaseKind, Tier, toml_of};
use crate::metric::{Metric, ReferenceValue};
use crate::observable::{self, ObservableArguments};
use crate::table::ReferenceTable;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use variants::Variant;

/// One expectation of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// Name in [`crate::observable::ALL`].
    pub observable: &'static observable::Observable,
    /// Its arguments.
    pub arguments: ObservableArguments,
    /// The runs it is about, by index.
    pub runs: Vec<usize>,
    /// How it is compared.
    pub metric: Metric,
    /// With what.
    pub reference: ReferenceValue,
    /// The limit.
    pub tolerance: f64,
    /// Why this tolerance.
    pub because: String,
    /// Why it is known not to hold yet.
    pub known_gap: Option<String>,
}

impl Expectation {
    /// The observable with its arguments: identifies a value.
    pub(crate) fn label(&self) -> String {
        self.arguments.label(self.observable)
    }
}

/// One run of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSpecification {
    /// Name, unique in the case.
    pub name: String,
    /// Path of the scenario file.
    pub scenario: PathBuf,
    /// Changes of single keys.
    pub changes: toml::Table,
    /// Number of threads; the surrounding pool if absent.
    pub threads: Option<usize>,
    /// Whether it is stepped.
    pub mode: RunMode,
}

/// Runs of scenarios and what is expected of them.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioRuns {
    /// Its runs.
    pub runs: Vec<RunSpecification>,
    /// The same runs with other models.
    pub variants: Vec<Variant>,
    /// Its expectations.
    pub expectations: Vec<Expectation>,
    /// `reference.csv`; empty if there is none.
    pub reference: ReferenceTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: CaseKind,
    tier: Tier,
    claim: String,
    #[serde(default)]
    run: Vec<RawRun>,
    #[serde(default)]
    variant: Vec<Variant>,
    expect: Vec<RawExpectation>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRun {
    name: String,
    #[serde(default = "default_scenario")]
    scenario: String,
    #[serde(default, rename = "override")]
    changes: toml::Table,
    threads: Option<usize>,
    #[serde(default)]
    mode: RunMode,
    /// Runs it this often, with the seeds 1, 2, ... for `resolution.seed`; the names become
    /// `NAME#1`, `NAME#2`, ...
    replicates: Option<u32>,
}

fn default_scenario() -> String {
    "scenario.toml".to_owned()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawExpectation {
    observable: String,
    #[serde(default)]
    arguments: BTreeMap<String, f64>,
    runs: Option<Vec<String>>,
    metric: Metric,
    reference: Option<f64>,
    reference_band: Option<[f64; 2]>,
    reference_column: Option<String>,
    tolerance: f64,
    because: String,
    known_gap: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "read to be checked: all three have to be there")]
struct RawProvenance {
    source: String,
    how: String,
    uncertainty: String,
    doi: Option<String>,
    licence: Option<String>,
}

impl ScenarioRuns {
    /// Reads and checks `case.toml`.
    pub(crate) fn read(path: &Path) -> Result<(CaseHead, Self), CaseError> {
        let raw: RawCase = toml_of(path)?;
        let invalid = |reason| CaseError::invalid(path, reason);
        let head = CaseHead::new(path, raw.title, raw.kind, raw.tier, raw.claim);
        let reference = reference_table(&head)?;
        let runs = variants::expand(runs(&head.folder, raw.run), &raw.variant).map_err(invalid)?;
        let mut expectations = raw
            .expect
            .into_iter()
            .map(|expectation| resolve(expectation, &runs, &reference))
            .collect::<Result<Vec<_>, _>>()
            .map_err(invalid)?;
        let shown: Vec<Expectation> =
            expectations.iter().filter_map(|judged| variants::shown(judged, &runs)).collect();
        expectations.extend(shown);
        if expectations.is_empty() {
            return Err(invalid("a case without expectations claims nothing".to_owned()));
        }
        Ok((head, Self { runs, variants: raw.variant, expectations, reference }))
    }
}

fn runs(folder: &Path, raw: Vec<RawRun>) -> Vec<RunSpecification> {
    let only = RawRun {
        name: "run".to_owned(),
        scenario: default_scenario(),
        changes: toml::Table::new(),
        threads: None,
        mode: RunMode::Simulate,
        replicates: None,
    };
    let raw = if raw.is_empty() { vec![only] } else { raw };
    raw.into_iter().flat_map(|run| replicated(folder, &run)).collect()
}

/// The run itself, or its replicates.
fn replicated(folder: &Path, run: &RawRun) -> Vec<RunSpecification> {
    let single = RunSpecification {
        name: run.name.clone(),
        scenario: folder.join(&run.scenario),
        changes: run.changes.clone(),
        threads: run.threads,
        mode: run.mode,
    };
    let Some(count) = run.replicates else { return vec![single] };
    (1..=count)
        .map(|seed| {
            let mut replicate = single.clone();
            replicate.name = format!("{}{}{seed}", run.name, replicates::SEPARATOR);
            replicate.changes.insert("resolution.seed".to_owned(), i64::from(seed).into());
            replicate
        })
        .collect()
}

/// `reference.csv` with its provenance; a validation case has to have both.
fn reference_table(head: &CaseHead) -> Result<ReferenceTable, CaseError> {
    let data = head.folder.join("reference.csv");
    if data.is_file() {
        let _: RawProvenance = toml_of(&head.folder.join("PROVENANCE.toml"))?;
        return ReferenceTable::read(&data);
    }
    match head.kind {
        CaseKind::Validation => {
            Err(CaseError::invalid(&data, "a validation case needs measured figures"))
        }
        CaseKind::Verification | CaseKind::Regression => Ok(ReferenceTable::default()),
    }
}

fn resolve(
    raw: RawExpectation,
    runs: &[RunSpecification],
    table: &ReferenceTable,
) -> Result<Expectation, String> {
    let observable = observable::find(&raw.observable)
        .ok_or_else(|| format!("no observable is called `{}`", raw.observable))?;
    let arguments = ObservableArguments::resolve(observable, &raw.arguments)?;
    let indices: Vec<usize> = match &raw.runs {
        None => (0..runs.len()).filter(|run| !variants::is_variant(&runs[*run])).collect(),
        Some(names) => {
            let found = names.iter().map(|name| run_indices(runs, name));
            found.collect::<Result<Vec<_>, _>>()?.concat()
        }
    };
    let reference = reference(&raw)?;
    check_metric(raw.metric, &reference, indices.len())
        .and_then(|()| check_replicates(raw.metric, runs, &indices))
        .map_err(|reason| format!("expectation `{}`: {reason}", raw.observable))?;
    if let ReferenceValue::Column(column) = &reference {
        for index in &indices {
            table.lookup("run", variants::stem(&runs[*index].name), column)?;
        }
    }
    if raw.because.trim().is_empty() {
        return Err(format!("expectation `{}`: `because` is empty", raw.observable));
    }
    Ok(Expectation {
        observable,
        arguments,
        runs: indices,
        metric: raw.metric,
        reference,
        tolerance: raw.tolerance,
        because: raw.because,
        known_gap: raw.known_gap,
    })
}

/// The run `name`, or all its replicates.
fn run_indices(runs: &[RunSpecification], name: &str) -> Result<Vec<usize>, String> {
    let is_meant = |run: &RunSpecification| run.name == name || replicates::stem(&run.name) == name;
    let found: Vec<usize> = (0..runs.len()).filter(|index| is_meant(&runs[*index])).collect();
    if found.is_empty() { Err(format!("no run `{name}`")) } else { Ok(found) }
}

/// Means are compared between two groups at least, of two replicates at least.
fn check_replicates(
    metric: Metric,
    runs: &[RunSpecification],
    indices: &[usize],
) -> Result<(), String> {
    if !metric.needs_replicates() {
        return Ok(());
    }
    let mut sizes = BTreeMap::new();
    for index in indices {
        *sizes.entry(replicates::stem(&runs[*index].name)).or_insert(0) += 1;
    }
    if sizes.len() < 2 {
        return Err(format!("the metric `{}` compares two groups of runs", metric.name()));
    }
    match sizes.iter().find(|(_, size)| **size < 2) {
        Some((name, _)) => Err(format!("run `{name}` needs `replicates = 2` at least")),
        None => Ok(()),
    }
}

fn reference(raw: &RawExpectation) -> Result<ReferenceValue, String> {
    match (raw.reference, raw.reference_band, &raw.reference_column) {
        (None, None, None) => Ok(ReferenceValue::None),
        (Some(number), None, None) => Ok(ReferenceValue::Number(number)),
        (None, Some([low, high]), None) if low <= high => Ok(ReferenceValue::Band(low, high)),
        (None, Some(_), None) => Err("a band goes from low to high".to_owned()),
        (None, None, Some(column)) => Ok(ReferenceValue::Column(column.clone())),
        _ => Err(format!("expectation `{}` has several references", raw.observable)),
    }
}

fn check_metric(metric: Metric, reference: &ReferenceValue, runs: usize) -> Result<(), String> {
    let suits = match metric {
        Metric::Spread
        | Metric::Identical
        | Metric::Rising
        | Metric::DifferenceOfMeans
        | Metric::IntervalOfDifference => *reference == ReferenceValue::None,
        Metric::Within => matches!(reference, ReferenceValue::Band(..)),
        Metric::ConvergenceOrder | Metric::FallingError => {
            matches!(reference, ReferenceValue::Number(_))
        }
        _ => matches!(reference, ReferenceValue::Number(_) | ReferenceValue::Column(_)),
    };
    if !suits {
        return Err(format!("the metric `{}` does not suit its reference", metric.name()));
    }
    if metric.joins_runs() && runs < 2 {
        return Err(format!("the metric `{}` needs at least two runs", metric.name()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expectation(text: &str) -> Result<Expectation, String> {
        let raw: RawExpectation = toml::from_str(text).map_err(|error| error.to_string())?;
        let runs = runs(Path::new(""), Vec::new());
        resolve(raw, &runs, &ReferenceTable::default())
    }

    #[test]
    fn an_expectation_needs_a_reason_and_a_reference_that_suits() {
        let good = "observable = 'steps'\nmetric = 'at_most'\nreference = 3\ntolerance = 0\n";
        assert!(expectation(&format!("{good}because = 'x'")).is_ok());
        assert!(expectation(&format!("{good}because = ' '")).unwrap_err().contains("because"));
        let bad = |change: (&str, &str)| {
            expectation(&format!("{good}because = 'x'").replace(change.0, change.1)).unwrap_err()
        };
        assert!(bad(("'steps'", "'stepps'")).contains("stepps"));
        assert!(bad(("reference = 3", "")).contains("does not suit"));
        assert!(bad(("'at_most'", "'identical'")).contains("does not suit"));
        assert!(bad(("reference = 3", "reference = 3\narguments = { x = 1 }")).contains("x"));
        assert!(bad(("reference = 3", "reference = 3\nruns = ['fine']")).contains("fine"));
    }

    #[test]
    fn replicates_are_runs_with_seeds_and_go_by_one_name() {
        let text = "name = 'a'\nreplicates = 3\noverride = { 'numerics.courant' = 0.1 }";
        let raw: RawRun = toml::from_str(text).unwrap();
        let runs = runs(Path::new(""), vec![raw]);
        let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["a#1", "a#2", "a#3"]);
        assert_eq!(runs[1].changes["resolution.seed"].as_integer(), Some(2));
        assert_eq!(runs[1].changes["numerics.courant"].as_float(), Some(0.1));
        assert_eq!(run_indices(&runs, "a").unwrap(), [0, 1, 2]);
        assert_eq!(run_indices(&runs, "a#2").unwrap(), [1]);
        let one_group = check_replicates(Metric::DifferenceOfMeans, &runs, &[0, 1]);
        assert!(one_group.unwrap_err().contains("two groups"));
    }

    #[test]
    fn a_metric_over_runs_needs_two() {
        let text = "observable = 'steps'\nmetric = 'spread'\ntolerance = 0\nbecause = 'x'";
        assert!(expectation(text).unwrap_err().contains("two runs"));
    }
}
