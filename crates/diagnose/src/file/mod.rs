//! A file of a diagnosis: what was measured, the scenario that is to explain it, priors and checks.

mod keys;
mod series;

pub use keys::reference_page;
use sphcut_physics::{BATCH_SCATTER, PUBLISHED_SPREAD};
use sphcut_scenario::{LoadOptions, Scenario};

pub use series::{AirRecord, SeriesPlan};
use sphcut_input::document::{self, contradiction};
use sphcut_input::files::{Surroundings, file_mistake};
use sphcut_input::findings::Findings;
use sphcut_input::problem::Problem;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::section::Section;
use sphcut_input::{CutTableRow, read_cut_table};
use std::path::{Path, PathBuf};

/// Largest table in bytes.
const LARGEST: u64 = 16 << 20;
/// Relative difference up to which two widths of cut are the same.
const SAME_WIDTH: f64 = 1e-3;

/// A checked file of a diagnosis. SI units.
#[derive(Debug, Clone)]
pub struct DiagnosisCase {
    /// What was measured.
    pub title: String,
    /// Where it comes from.
    pub source: String,
    /// The cut as it is simulated so far.
    pub base: Scenario,
    /// Its file.
    pub base_path: PathBuf,
    /// What is to be explained.
    pub measured: Vec<CutTableRow>,
    /// Cuts in which nothing is missing.
    pub reference: Option<ReferenceCuts>,
    /// Standard deviation of each quantity of material and friction, where it is stated.
    stated_scatter: [Option<f64>; BATCH_SCATTER.len()],
    /// Share by which the model is wrong by itself.
    pub model_error: Option<f64>,
    /// Standard deviations of gain (share), offset (N) and drift (share).
    pub instruments: [f64; 3],
    /// Simulated recordings of the self-test and of the positive control.
    pub checks: [usize; 2],
    /// Seed.
    pub seed: u64,
    /// Cuts that are proposed.
    pub next_cuts: usize,
    /// Lowest and highest v_c and h that can be cut.
    pub next_range: [[Option<f64>; 2]; 2],
    /// Runs of the particle solver.
    pub runs: PairedRunsPlan,
}

impl DiagnosisCase {
    /// Standard deviation of each quantity of material and friction as a share, by its key: as stated, else the scatter from batch to
    /// batch beside reference cuts, which have the same constants and teach what these are wrong by, and without them the spread
    /// of published sets.
    #[must_use]
    pub fn scatter(&self) -> Vec<(&'static str, f64)> {
        let from = if self.reference.is_some() { BATCH_SCATTER } else { PUBLISHED_SPREAD };
        let stated = |((key, usual), stated): ((&'static str, f64), Option<f64>)| {
            (key, stated.unwrap_or(usual))
        };
        from.into_iter().zip(self.stated_scatter).map(stated).collect()
    }
}

/// Which paired runs are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedRunsPlan {
    /// Lowest and highest v_c and h, where they are not those of the table.
    pub range: [[Option<f64>; 2]; 2],
    /// Travel in uncut chip thicknesses.
    pub travel: f64,
    /// Conditions at which the repaired scenario is run.
    pub repaired: usize,
    /// Most runs.
    pub most: usize,
}

/// Cuts in which nothing is missing.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceCuts {
    /// The cuts.
    pub rows: Vec<CutTableRow>,
    /// Whether only the difference of the two tables counts.
    pub difference: bool,
    /// Whether material and instruments are the same.
    pub same_batch: bool,
}

/// A checked file of a diagnosis: means, series, or both.
#[derive(Debug, Clone)]
pub struct DiagnosisFile {
    /// What was measured.
    pub title: String,
    /// Where it comes from.
    pub source: String,
    /// Simulated recordings of the self-test.
    pub self_test: usize,
    /// Seed.
    pub seed: u64,
    /// Means and the scenario that is to explain them.
    pub case: Option<Box<DiagnosisCase>>,
    /// Forces over time.
    pub series: Option<SeriesPlan>,
}

/// Reads the file of a diagnosis of means at `path`, the scenario and the tables it names.
///
/// # Errors
/// All mistakes of the file, in its order; those of the scenario where it has some.
pub fn load_diagnosis(path: &Path, options: &LoadOptions) -> Result<DiagnosisCase, Vec<Problem>> {
    let file = load(path, options, true)?;
    Ok(*file.case.expect("means are asked for"))
}

/// Reads the file of a diagnosis of means, of series, or of both.
///
/// # Errors
/// All mistakes of the file, in its order; those of the scenario or of the file of recordings where these have some.
pub fn load_diagnosis_file(
    path: &Path,
    options: &LoadOptions,
) -> Result<DiagnosisFile, Vec<Problem>> {
    load(path, options, false)
}

fn load(path: &Path, options: &LoadOptions, means: bool) -> Result<DiagnosisFile, Vec<Problem>> {
    let mut of_others = Vec::new();
    let section = keys::root();
    let file = document::load(path, options.outside_files, &section, |findings, root, around| {
        let series = series::read(findings, root, around, (options, &mut of_others));
        let means = means
            || ["measured", "reference"].iter().any(|key| !root.lacks(key))
            || root.lacks("series");
        if means {
            for key in ["scenario", "measured"].into_iter().filter(|key| root.lacks(key)) {
                let field = section.field(key).expect("a key of the section");
                findings.problem(
                    &root.source,
                    root.heading.clone(),
                    reader::missing(&section, field),
                );
            }
        }
        let case = means.then(|| read_document(findings, root, around, options, &mut of_others));
        // What is wrong in it is told with the means; series alone tell it here.
        let empty = toml::de::DeTable::new();
        let place = root.table("checks").unwrap_or((&empty, root.heading.clone()));
        let mut twice = Findings::default();
        let told = if means { &mut twice } else { findings };
        let checks = reader::read(told, &root.source, place, &keys::checks(), 2);
        let case = match case {
            Some(read) => Some(Box::new(read?)),
            None => None,
        };
        Some(DiagnosisFile {
            title: root.text("title")?.to_owned(),
            source: root.text("source")?.to_owned(),
            self_test: usize::try_from(checks.count("self_test")?).ok()?,
            seed: u64::try_from(checks.count("seed")?).ok()?,
            case,
            series: match series {
                Some(plan) => Some(plan?),
                None => None,
            },
        })
    });
    if of_others.is_empty() { file } else { Err(of_others) }
}

fn read_document(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    options: &LoadOptions,
    of_base: &mut Vec<Problem>,
) -> Option<DiagnosisCase> {
    let written = |findings: &mut Findings, key: &str, section: &Section| {
        Some(reader::read(findings, &root.source, root.table(key)?, section, 2))
    };
    // A section that is not there has the defaults of all its keys.
    let empty = toml::de::DeTable::new();
    let or_defaults = |findings: &mut Findings, key: &str, section: &Section| {
        let place = root.table(key).unwrap_or((&empty, root.heading.clone()));
        values(&reader::read(findings, &root.source, place, section, 2))
    };
    let measured = written(findings, "measured", &keys::measured());
    let reference = written(findings, "reference", &keys::reference());
    let priors = or_defaults(findings, "priors", &keys::priors());
    let checks = or_defaults(findings, "checks", &keys::checks());
    let next = ends(findings, root, ("next", &keys::next()), &empty);
    let runs = ends(findings, root, ("runs", &keys::runs()), &empty);
    let base = base(findings, root, surroundings, (options, of_base));
    let rows = |findings: &mut Findings, record: &Record<'_>| table(findings, record, surroundings);
    let measured_rows = measured.as_ref().and_then(|record| rows(findings, record));
    let reference = match &reference {
        None => None,
        Some(record) => Some(ReferenceCuts {
            rows: rows(findings, record)?,
            difference: record.text("use")? == "difference",
            same_batch: record.switch("same_batch")?,
        }),
    };
    let (base, base_path) = base?;
    let measured_rows = measured_rows?;
    let width = base.setup.width_of_cut;
    if let Some(other) = measured_rows
        .iter()
        .filter_map(|row| row.width_of_cut)
        .find(|other| (other / width - 1.0).abs() > SAME_WIDTH)
    {
        let message = format!(
            "the table was cut {} mm wide and the scenario cuts {} mm: forces of the two cannot be compared",
            other * 1e3,
            width * 1e3
        );
        contradiction(
            findings,
            measured.as_ref()?,
            "file",
            message,
            "set width_of_cut in the scenario",
        );
    }
    let ((next, next_range), (runs, runs_range)) = (next, runs);
    let number = |all: &Values, key: &str| all.iter().find(|(k, _)| *k == key).map(|(_, x)| *x);
    let count = |all: &Values, key: &str| number(all, key).map(|x| x as usize);
    let model_error = number(&priors, "model_error");
    if model_error.is_some() && reference.is_some() {
        let message =
            "`model_error` is stated although [reference] teaches what the model gets wrong";
        contradiction(findings, root, "priors", message, "leave one of the two out");
    }
    Some(DiagnosisCase {
        title: root.text("title")?.to_owned(),
        source: root.text("source")?.to_owned(),
        base,
        base_path,
        measured: measured_rows,
        reference,
        stated_scatter: BATCH_SCATTER.map(|(key, _)| number(&priors, key)),
        model_error,
        instruments: [
            number(&priors, "gain")?,
            number(&priors, "offset")?,
            number(&priors, "drift")?,
        ],
        checks: [count(&checks, "self_test")?, count(&checks, "control")?],
        seed: number(&checks, "seed")? as u64,
        next_cuts: count(&next, "cuts")?,
        next_range,
        runs: PairedRunsPlan {
            range: runs_range,
            travel: number(&runs, "travel")?,
            repaired: count(&runs, "repaired")?,
            most: count(&runs, "most")?,
        },
    })
}

type Values = Vec<(&'static str, f64)>;

fn values(record: &Record<'_>) -> Values {
    let all = record.items.iter();
    all.filter_map(|(key, _)| {
        Some((*key, record.number(key).or_else(|| record.count(key).map(|n| n as f64))?))
    })
    .collect()
}

type Ends = [[Option<f64>; 2]; 2];

/// The keys of a section that says between which speeds and thicknesses something is done, and those ends.
fn ends(
    findings: &mut Findings,
    root: &Record<'_>,
    (name, section): (&str, &Section),
    empty: &toml::de::DeTable<'_>,
) -> (Values, Ends) {
    let place = root.table(name);
    let is_there = place.is_some();
    let place = place.unwrap_or((empty, root.heading.clone()));
    let record = reader::read(findings, &root.source, place, section, 2);
    let mut ends = Ends::default();
    if !is_there {
        return (values(&record), ends);
    }
    let keys = [["lowest_speed", "highest_speed"], ["thinnest", "thickest"]];
    for (end, keys) in ends.iter_mut().zip(keys) {
        *end = keys.map(|key| record.number(key));
        if let [Some(low), Some(high)] = *end
            && high <= low
        {
            let message = format!("`{}` does not lie above `{}`", keys[1], keys[0]);
            contradiction(findings, &record, keys[1], message, "");
        }
    }
    (values(&record), ends)
}

fn base(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    (options, of_base): (&LoadOptions, &mut Vec<Problem>),
) -> Option<(Scenario, PathBuf)> {
    let path = findings.accept(root, "scenario", surroundings.path(root.text("scenario")?))?;
    match sphcut_scenario::load(&path, options) {
        Ok(base) if base.setup.uncut_chip_thickness.is_none() => {
            let help = "name a scenario with [workpiece], [tool] and [process]";
            contradiction(findings, root, "scenario", "the scenario is no cut", help);
            None
        }
        Ok(base) => Some((base, path)),
        Err(problems) => {
            *of_base = problems;
            None
        }
    }
}

fn table(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<CutTableRow>> {
    let named = record.text("file")?;
    let read = surroundings.read(named, LARGEST).and_then(|text| {
        read_cut_table(&text).map_err(|problem| file_mistake(named, problem.to_string(), ""))
    });
    findings.accept(record, "file", read)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without reference cuts nothing says that the constants are those of this batch; what is stated counts in any case.
    #[test]
    fn without_reference_cuts_constants_are_as_far_off_as_published_ones() {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis/example.toml");
        let mut case = load_diagnosis(&path, &LoadOptions::default()).unwrap();
        case.stated_scatter = [None; BATCH_SCATTER.len()];
        case.stated_scatter[5] = Some(0.07);
        let stated = |usual: [(&'static str, f64); 6]| {
            let mut all = usual.to_vec();
            all[5].1 = 0.07;
            all
        };
        case.reference = None;
        assert_eq!(case.scatter(), stated(PUBLISHED_SPREAD));
        case.reference =
            Some(ReferenceCuts { rows: Vec::new(), difference: false, same_batch: true });
        assert_eq!(case.scatter(), stated(BATCH_SCATTER));
        let keys = |of: [(&'static str, f64); 6]| of.map(|(key, _)| key);
        assert_eq!(keys(PUBLISHED_SPREAD), keys(BATCH_SCATTER));
    }
}
