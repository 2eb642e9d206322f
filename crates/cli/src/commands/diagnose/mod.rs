//! `sphcut diagnose`: which physics a simulation left out.

mod runs;
mod series;

use crate::common_arguments::ScenarioArguments;
use crate::failure::{ExitCode, Failure};
use crate::progress::ShareDisplay;
use crate::{files, loading, terminal};
use clap::Args;
pub(crate) use runs::refused;
use runs::{Ended, Paired};
use sphcut_diagnose::series::{SeriesDiagnosis, series_csv, series_json, trends_csv, with_series};
use sphcut_diagnose::{
    ClosedForm, DIAGNOSIS_SCHEMA_VERSION, DiagnoseError, DiagnosisCase, DiagnosisFile,
    DiagnosisProvenance, PairedRuns, Predictor, ProgressListener, closed_form_cut, compare_rerun,
    diagnose_case_as, diagnosis_json, held_out_csv, patch,
};
use sphcut_report::{
    DiagnosisPage, SeriesPage, diagnosis_text, render_diagnosis, render_series, series_summary,
};
use std::num::NonZeroUsize;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut diagnose scenarios/diagnosis/example.toml --out missing --closed-form
  sphcut diagnose CASE.toml --out missing --closed-form --confirm   and its correction in particles, some twenty runs
  sphcut diagnose CASE.toml --out missing --dry-run       what it takes with the particle solver
  sphcut diagnose CASE.toml --out missing --store kept    the runs are kept for the next diagnosis
  sphcut predict --diagnosis missing --conditions new.csv --out new_forces.csv    corrected forces at other cuts

What appears in the output folder:
  diagnosis.html        one page: residual pattern, candidates, correction, validation, limits, next experiment
  diagnosis.json        the same as numbers
  held_out.csv          every held-out value with its predictions
  lines.csv             with [series]: lines in the spectra of the forces, and what they follow
  trends.csv            with [series]: trend, run-in and zero of every force in every cut
  scenario.patch.toml   the missing effect with its parameters, where one is named
  runs/                 what each effect changes: a sweep of the particle solver with its table and page

Without --closed-form every effect is tried in paired runs of the particle solver, some two hundred. Ctrl-C writes
checkpoints; the same command goes on. Runs that are in the store already are not computed again.

See docs/howto/diagnose.md, and docs/diagnosis_keys.md for all keys.";

/// Arguments of `diagnose`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct DiagnoseArguments {
    /// The file of the diagnosis (TOML).
    #[command(flatten)]
    pub scene: ScenarioArguments,
    /// Output folder [default: out/NAME_diagnose, NAME being that of the file].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Explain with the closed-form model instead of runs of the particle solver.
    #[arg(long)]
    pub closed_form: bool,
    /// With --closed-form: run the scenario as it is, recalibrated and corrected in the particle solver at some of the measured conditions.
    #[arg(long, requires = "closed_form")]
    pub confirm: bool,
    /// Folder that keeps the runs of the particle solver, also for other diagnoses of the same scenario [default: DIR/runs/store].
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// Say how many runs it takes and how long, and compute nothing.
    #[arg(long, conflicts_with = "closed_form")]
    pub dry_run: bool,
    /// List the runs that are missing as a sweep for another machine or a cluster, and compute none: when they are there, the same command goes on.
    #[arg(long, conflicts_with = "dry_run")]
    pub list_runs: bool,
    /// Threads [default: all].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

impl DiagnoseArguments {
    /// Output folder.
    fn folder(&self) -> PathBuf {
        files::out(self.out.as_deref(), &self.scene.scenario, "_diagnose")
    }
}

/// How the closed form is called in `diagnosis.json`.
pub(crate) const CLOSED_FORM: &str = "the closed-form model (Oxley's shear zone, Zorev's contact)";
const PAGE: &str = "diagnosis.html";
pub(crate) const NUMBERS: &str = "diagnosis.json";
const PATCH: &str = "scenario.patch.toml";
const HELD_OUT: &str = "held_out.csv";
const LINES: &str = "lines.csv";
const TRENDS: &str = "trends.csv";

/// The paired runs of a case as a model; `None` if they were stopped, or only listed.
pub(crate) fn paired_model(
    case: &DiagnosisCase,
    arguments: &DiagnoseArguments,
) -> Result<Option<PairedRuns>, Failure> {
    match Paired::library(case, arguments)?.run(arguments)? {
        Ended::Interrupted => Ok(None),
        Ended::Finished(results) => runs::model(case, &results).map(Some),
    }
}

/// Diagnoses and writes page, numbers and, where an effect is named, the patch.
pub fn diagnose(arguments: &DiagnoseArguments) -> Result<ExitCode, Failure> {
    if arguments.closed_form && !arguments.confirm {
        let asked = [("--store", arguments.store.is_some()), ("--list-runs", arguments.list_runs)];
        if let Some((option, _)) = asked.into_iter().find(|(_, is_asked)| *is_asked) {
            let message = format!(
                "{option} is for runs of the particle solver, and --closed-form makes none"
            );
            return Err(
                Failure::input(message).advise(format!("add --confirm, or leave {option} out"))
            );
        }
    }
    let out = &arguments.folder();
    let files = [PAGE, NUMBERS, PATCH, HELD_OUT, LINES, TRENDS].map(|name| out.join(name));
    files::unless_there(files.clone(), arguments.force)?;
    let file = loading::diagnosis(&arguments.scene)?;
    let pool = loading::pool(loading::threads(arguments.threads))?;
    if arguments.dry_run {
        let Some(case) = &file.case else {
            return Err(Failure::input(
                "[series] alone needs no runs: there is nothing to compute",
            ));
        };
        return Paired::library(case, arguments)?.dry_run(arguments);
    }
    let plan = file.series.as_ref();
    let series = plan.map(|plan| pool.install(|| series::diagnose(&file, plan))).transpose()?;
    let Some(case) = file.case.as_deref() else {
        let found = series.expect("a file without means has series");
        files::create_folder(out)?;
        return series_alone(&files, &file, &found);
    };
    let mistaken = |error: DiagnoseError| Failure::input(error.to_string());
    let closed;
    let paired;
    let (model, name): (&dyn Predictor, &str) = if arguments.closed_form {
        closed = ClosedForm::new(closed_form_cut(&case.base).map_err(mistaken)?, &case.scatter());
        (&closed, CLOSED_FORM)
    } else {
        let Some(model) = paired_model(case, arguments)? else { return Ok(ExitCode::Interrupted) };
        paired = model;
        (&paired, "paired runs of the particle solver")
    };
    let display = ShareDisplay::new(false);
    let told = |share: f64, what: &str| display.update(share, what);
    let found = pool.install(|| diagnose_case_as(case, model, ProgressListener(&told), |_| {}));
    display.finish();
    let (recordings, mut found) = found.map_err(mistaken)?;
    let mut pairs = Vec::new();
    if (!arguments.closed_form || arguments.confirm)
        && let Some((runs, null, repair)) = Paired::repaired(case, arguments, (&found, model))?
    {
        match runs.run(arguments)? {
            Ended::Interrupted => return Ok(ExitCode::Interrupted),
            Ended::Finished(results) => {
                let states = runs.in_order(&results);
                let own = runs::without_folders(&states);
                found.rerun = compare_rerun(&found.problem, (&null, &repair), &own, case.seed);
                pairs = runs::pairs(&states)?;
            }
        }
    }
    files::create_folder(out)?;
    let path = arguments.scene.scenario.display().to_string();
    let provenance = DiagnosisProvenance {
        file: &path,
        title: &case.title,
        source: &case.source,
        model: name,
        version: env!("CARGO_PKG_VERSION"),
        seed: case.seed,
    };
    let page = DiagnosisPage {
        provenance,
        diagnosis: &found,
        recordings: &recordings,
        predictor: model,
        series: series.as_ref(),
        pairs: &pairs,
    };
    files::save(&files[0], render_diagnosis(&page).as_bytes())?;
    let numbers = diagnosis_json(&provenance, &found, &recordings, model);
    let numbers = match &series {
        Some(series) => with_series(&numbers, series),
        None => numbers,
    };
    files::save(&files[1], numbers.as_bytes())?;
    let texts = [
        patch(&provenance, case, &found, model).map_err(mistaken)?,
        Some(held_out_csv(&found, &recordings)),
        series.as_ref().map(series_csv),
        series.as_ref().map(trends_csv),
    ];
    write_or_remove(&files[2..], &texts)?;
    diagnosis_text(&page).iter().for_each(|words| terminal::line(words));
    series.iter().flat_map(series_summary).for_each(|words| terminal::line(&words));
    let next = if files[2].is_file() {
        let base = case.base_path.display();
        format!("`sphcut run {base} --patch {}` cuts with what was missing", files[2].display())
    } else {
        "open the page: it ends with the measurement that would tell most".to_owned()
    };
    terminal::report(&files[0], &next);
    Ok(ExitCode::Done)
}

/// Page and numbers of series without means.
fn series_alone(
    files: &[PathBuf],
    file: &DiagnosisFile,
    found: &SeriesDiagnosis,
) -> Result<ExitCode, Failure> {
    let version = env!("CARGO_PKG_VERSION");
    let page = SeriesPage { title: &file.title, source: &file.source, version, series: found };
    files::save(&files[0], render_series(&page).as_bytes())?;
    let numbers = serde_json::json!({
        "schema_version": DIAGNOSIS_SCHEMA_VERSION,
        "program_version": version,
        "title": file.title,
        "source": file.source,
        "seed": file.seed,
        "series": series_json(found),
    });
    files::save(&files[1], format!("{numbers}\n").as_bytes())?;
    write_or_remove(&files[2..], &[None, None, Some(series_csv(found)), Some(trends_csv(found))])?;
    series_summary(found).iter().for_each(|words| terminal::line(words));
    terminal::report(&files[0], "open the page: lines, what they follow, and trends");
    Ok(ExitCode::Done)
}

/// Writes what there is, and removes what an earlier diagnosis has left of the rest: an old patch beside a new verdict would be believed.
fn write_or_remove(files: &[PathBuf], texts: &[Option<String>]) -> Result<(), Failure> {
    for (file, text) in files.iter().zip(texts) {
        match text {
            Some(text) => files::save(file, text.as_bytes())?,
            None if file.exists() => std::fs::remove_file(file).map_err(|error| {
                Failure::output(format!("cannot remove `{}`", file.display()), &error)
            })?,
            None => {}
        }
    }
    Ok(())
}
