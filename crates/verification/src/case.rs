//! Case folders: what is run, what is expected and why.

use crate::error::CaseError;
use crate::observable::{self, Arguments};
use crate::replicates;
use crate::table::Table;
use crate::variants::{self, Variant};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What kind of evidence a case is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Against an exact or published solution of the same equations.
    Verification,
    /// Against measurements, with provenance and uncertainty.
    Validation,
    /// Against our own frozen output.
    Regression,
}

/// How long a case takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// Seconds; part of `cargo test`.
    Quick,
    /// Minutes.
    Standard,
    /// Up to hours.
    Long,
}

/// Whether a run is stepped to its end or only set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Stepped to its end.
    #[default]
    Simulate,
    /// Only set up: for laws and kernels.
    Setup,
}

/// How values and reference are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// |value - reference| / |reference| at most the tolerance; for every run.
    RelativeError,
    /// |value - reference| at most the tolerance; for every run.
    AbsoluteError,
    /// Distance of the value from the band at most the tolerance; for every run.
    Within,
    /// value at most reference + tolerance; for every run.
    AtMost,
    /// value at least reference - tolerance; for every run.
    AtLeast,
    /// Slope of ln |value - reference| over ln spacing, over all runs, at least the tolerance.
    ConvergenceOrder,
    /// |value - reference| falls with every finer spacing, to at most the tolerance at the finest.
    FallingError,
    /// The value rises with every finer spacing by at least the tolerance.
    Rising,
    /// (largest - smallest) / |mean| over the runs at most the tolerance.
    Spread,
    /// All runs give the same value, bit by bit.
    Identical,
    /// Largest difference of the mean of a group of replicates from that of the first group that
    /// exceeds its own 95 % interval, as a share of the mean; at most the tolerance.
    DifferenceOfMeans,
    /// Widest of these intervals (half width) as a share of the mean; at most the tolerance.
    IntervalOfDifference,
    /// Nothing is expected: a variant beside what is judged.
    #[serde(skip)]
    Shown,
}

impl Metric {
    /// Whether one number is made of all runs rather than one per run.
    #[must_use]
    pub fn joins_runs(self) -> bool {
        matches!(
            self,
            Self::ConvergenceOrder
                | Self::FallingError
                | Self::Rising
                | Self::Spread
                | Self::Identical
        ) || self.needs_replicates()
    }

    /// Whether it compares means of replicates.
    #[must_use]
    pub fn needs_replicates(self) -> bool {
        matches!(self, Self::DifferenceOfMeans | Self::IntervalOfDifference)
    }

    /// Name as in the case file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RelativeError => "relative error",
            Self::AbsoluteError => "absolute error",
            Self::Within => "within band",
            Self::AtMost => "at most",
            Self::AtLeast => "at least",
            Self::ConvergenceOrder => "convergence order",
            Self::FallingError => "falling error",
            Self::Rising => "rising",
            Self::Spread => "spread",
            Self::Identical => "identical",
            Self::DifferenceOfMeans => "difference of means",
            Self::IntervalOfDifference => "interval of the difference of means",
            Self::Shown => "shown",
        }
    }
}

/// What a value is compared with, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// Nothing: the runs are compared among themselves.
    None,
    /// One number.
    Number(f64),
    /// A band from low to high.
    Band(f64, f64),
    /// A column of `reference.csv`; the row is the one whose cell `run` is the run's name.
    Column(String),
}

/// One expectation of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// Name in [`crate::observable::ALL`].
    pub observable: &'static observable::Observable,
    /// Its arguments.
    pub arguments: Arguments,
    /// The runs it is about, by index.
    pub runs: Vec<usize>,
    /// How it is compared.
    pub metric: Metric,
    /// With what.
    pub reference: Reference,
    /// The limit.
    pub tolerance: f64,
    /// Why this tolerance.
    pub because: String,
    /// Why it is known not to hold yet.
    pub known_gap: Option<String>,
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
    pub mode: Mode,
}

/// A case folder, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name of the folder.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Title.
    pub title: String,
    /// Kind of evidence.
    pub kind: Kind,
    /// How long it takes.
    pub tier: Tier,
    /// What it claims.
    pub claim: String,
    /// Its runs.
    pub runs: Vec<RunSpecification>,
    /// The same runs with other models.
    pub variants: Vec<Variant>,
    /// Its expectations.
    pub expectations: Vec<Expectation>,
    /// `reference.csv`; empty if there is none.
    pub reference: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: Kind,
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
    mode: Mode,
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

/// All cases below `root`, by name.
///
/// # Errors
/// A folder that cannot be read, the first case that is not well formed.
pub fn cases(root: &Path) -> Result<Vec<Case>, CaseError> {
    let entries = fs::read_dir(root).map_err(|error| CaseError::unreadable(root, &error))?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| CaseError::unreadable(root, &error))?.path();
        if path.join("case.toml").is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    folders.iter().map(|folder| Case::read(folder)).collect()
}

impl Case {
    /// Reads and checks one case folder.
    ///
    /// # Errors
    /// A missing or malformed file; an unknown observable, argument or run; a reference that
    /// does not suit the metric; validation without reference and provenance.
    pub fn read(folder: &Path) -> Result<Self, CaseError> {
        let path = folder.join("case.toml");
        let text =
            fs::read_to_string(&path).map_err(|error| CaseError::unreadable(&path, &error))?;
        let raw: RawCase =
            toml::from_str(&text).map_err(|error| CaseError::invalid(&path, error.to_string()))?;
        let reference = reference_table(folder, raw.kind)?;
        let runs = variants::expand(runs(folder, raw.run), &raw.variant)
            .map_err(|reason| CaseError::invalid(&path, reason))?;
        let mut expectations = raw
            .expect
            .into_iter()
            .map(|expectation| resolve(expectation, &runs, &reference))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|reason| CaseError::invalid(&path, reason))?;
        let shown: Vec<Expectation> =
            expectations.iter().filter_map(|judged| variants::shown(judged, &runs)).collect();
        expectations.extend(shown);
        if expectations.is_empty() {
            return Err(CaseError::invalid(&path, "a case without expectations claims nothing"));
        }
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(Self {
            name: name.unwrap_or_default(),
            folder: folder.to_owned(),
            title: raw.title,
            kind: raw.kind,
            tier: raw.tier,
            claim: raw.claim,
            runs,
            variants: raw.variant,
            expectations,
            reference,
        })
    }
}

fn runs(folder: &Path, raw: Vec<RawRun>) -> Vec<RunSpecification> {
    let only = RawRun {
        name: "run".to_owned(),
        scenario: default_scenario(),
        changes: toml::Table::new(),
        threads: None,
        mode: Mode::Simulate,
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
fn reference_table(folder: &Path, kind: Kind) -> Result<Table, CaseError> {
    let (data, provenance) = (folder.join("reference.csv"), folder.join("PROVENANCE.toml"));
    if !data.is_file() {
        return match kind {
            Kind::Validation => {
                Err(CaseError::invalid(&data, "a validation case needs measured figures"))
            }
            Kind::Verification | Kind::Regression => Ok(Table::default()),
        };
    }
    let text = fs::read_to_string(&provenance)
        .map_err(|error| CaseError::unreadable(&provenance, &error))?;
    let _: RawProvenance = toml::from_str(&text)
        .map_err(|error| CaseError::invalid(&provenance, error.to_string()))?;
    Table::read(&data)
}

fn resolve(
    raw: RawExpectation,
    runs: &[RunSpecification],
    table: &Table,
) -> Result<Expectation, String> {
    let observable = observable::find(&raw.observable)
        .ok_or_else(|| format!("no observable is called `{}`", raw.observable))?;
    let arguments = Arguments::resolve(observable, &raw.arguments)?;
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
    if let Reference::Column(column) = &reference {
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

fn reference(raw: &RawExpectation) -> Result<Reference, String> {
    match (raw.reference, raw.reference_band, &raw.reference_column) {
        (None, None, None) => Ok(Reference::None),
        (Some(number), None, None) => Ok(Reference::Number(number)),
        (None, Some([low, high]), None) if low <= high => Ok(Reference::Band(low, high)),
        (None, Some(_), None) => Err("a band goes from low to high".to_owned()),
        (None, None, Some(column)) => Ok(Reference::Column(column.clone())),
        _ => Err(format!("expectation `{}` has several references", raw.observable)),
    }
}

fn check_metric(metric: Metric, reference: &Reference, runs: usize) -> Result<(), String> {
    let suits = match metric {
        Metric::Spread
        | Metric::Identical
        | Metric::Rising
        | Metric::DifferenceOfMeans
        | Metric::IntervalOfDifference => *reference == Reference::None,
        Metric::Within => matches!(reference, Reference::Band(..)),
        Metric::ConvergenceOrder | Metric::FallingError => {
            matches!(reference, Reference::Number(_))
        }
        _ => matches!(reference, Reference::Number(_) | Reference::Column(_)),
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
        resolve(raw, &runs, &Table::default())
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
