//! `sphcut diagnose`: which physics a simulation left out.

mod runs;
mod series;

use crate::arguments::DiagnoseArguments;
use crate::failure::{ExitCode, Failure};
use crate::{loading, results, terminal};
use runs::{Ended, Paired};
use sphcut_diagnose::series::{SeriesDiagnosis, series_csv, series_json, trends_csv, with_series};
use sphcut_diagnose::{
    ClosedForm, DiagnoseError, DiagnosisFile, DiagnosisProvenance, Predictor, closed_form_cut,
    compare_rerun, diagnose_case, diagnosis_json, held_out_csv, patch,
};
use sphcut_report::{
    DiagnosisPage, SeriesPage, diagnosis_words, render_diagnosis, render_series, series_summary,
};
use std::path::{Path, PathBuf};

const PAGE: &str = "diagnosis.html";
const NUMBERS: &str = "diagnosis.json";
const PATCH: &str = "scenario.patch.toml";
const HELD_OUT: &str = "held_out.csv";
const LINES: &str = "lines.csv";
const TRENDS: &str = "trends.csv";

/// Diagnoses and writes page, numbers and, where an effect is named, the patch.
pub fn diagnose(arguments: &DiagnoseArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.out;
    let files = [PAGE, NUMBERS, PATCH, HELD_OUT, LINES, TRENDS].map(|name| out.join(name));
    if let Some(old) = files.iter().find(|path| path.exists())
        && !arguments.force
    {
        let message = format!("`{}` exists: use --force to replace it", old.display());
        return Err(Failure::input(message));
    }
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
        return series_alone(&files, &file, &found);
    };
    let mistaken = |error: DiagnoseError| Failure::input(error.to_string());
    let closed;
    let paired;
    let (model, name): (&dyn Predictor, &str) = if arguments.closed_form {
        closed = ClosedForm::new(closed_form_cut(&case.base).map_err(mistaken)?, &case.scatter);
        (&closed, "the closed-form model (Oxley's shear zone, Zorev's contact)")
    } else {
        match Paired::library(case, arguments)?.run(arguments)? {
            Ended::Interrupted => return Ok(interrupted()),
            Ended::Finished(results) => paired = runs::model(case, &results)?,
        }
        (&paired, "paired runs of the particle solver")
    };
    let (recordings, mut found) = pool.install(|| diagnose_case(case, model)).map_err(mistaken)?;
    if !arguments.closed_form
        && let Some((runs, null, repair)) = Paired::repaired(case, arguments, (&found, model))?
    {
        match runs.run(arguments)? {
            Ended::Interrupted => return Ok(interrupted()),
            Ended::Finished(results) => {
                let own = runs.in_order(&results);
                found.rerun = compare_rerun(&found.problem, (&null, &repair), &own, case.seed);
            }
        }
    }
    create_folder(&files[0])?;
    let provenance = DiagnosisProvenance {
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
    };
    results::save(&files[0], render_diagnosis(&page).as_bytes())?;
    let numbers = diagnosis_json(&provenance, &found, &recordings, model);
    let numbers = match &series {
        Some(series) => with_series(&numbers, series),
        None => numbers,
    };
    results::save(&files[1], numbers.as_bytes())?;
    let texts = [
        patch(&provenance, case, &found, model).map_err(mistaken)?,
        Some(held_out_csv(&found, &recordings)),
        series.as_ref().map(series_csv),
        series.as_ref().map(trends_csv),
    ];
    write_or_remove(&files[2..], &texts)?;
    diagnosis_words(&page).iter().for_each(|words| terminal::line(words));
    series.iter().flat_map(series_summary).for_each(|words| terminal::line(&words));
    terminal::line(&format!("report  {}", files[0].display()));
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
    create_folder(&files[0])?;
    results::save(&files[0], render_series(&page).as_bytes())?;
    let numbers = serde_json::json!({
        "schema_version": "1.0",
        "program_version": version,
        "title": file.title,
        "source": file.source,
        "seed": file.seed,
        "series": series_json(found),
    });
    results::save(&files[1], format!("{numbers}\n").as_bytes())?;
    write_or_remove(&files[2..], &[None, None, Some(series_csv(found)), Some(trends_csv(found))])?;
    series_summary(found).iter().for_each(|words| terminal::line(words));
    terminal::line(&format!("report  {}", files[0].display()));
    Ok(ExitCode::Done)
}

fn create_folder(file: &Path) -> Result<(), Failure> {
    let folder = file.parent().unwrap_or(file);
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::output(format!("cannot create `{}`", folder.display()), &error))
}

/// Writes what there is, and removes what an earlier diagnosis has left of the rest: an old patch beside a new verdict would be believed.
fn write_or_remove(files: &[PathBuf], texts: &[Option<String>]) -> Result<(), Failure> {
    for (file, text) in files.iter().zip(texts) {
        match text {
            Some(text) => results::save(file, text.as_bytes())?,
            None if file.exists() => std::fs::remove_file(file).map_err(|error| {
                Failure::output(format!("cannot remove `{}`", file.display()), &error)
            })?,
            None => {}
        }
    }
    Ok(())
}

fn interrupted() -> ExitCode {
    terminal::note("interrupted: checkpoints are written; the same command goes on");
    ExitCode::Interrupted
}
