//! `sphcut diagnose`: which physics a simulation left out.

mod patch;
mod runs;

use crate::arguments::DiagnoseArguments;
use crate::failure::{ExitCode, Failure};
use crate::{loading, results, terminal};
use runs::{Ended, Paired};
use sphcut_diagnose::{
    ClosedForm, DiagnoseError, Predictor, Provenance, closed_form_cut, compare_rerun,
    diagnose_case, diagnosis_json, held_out_csv,
};
use sphcut_report::{DiagnosisPage, diagnosis_words, render_diagnosis};

const PAGE: &str = "diagnosis.html";
const NUMBERS: &str = "diagnosis.json";
const PATCH: &str = "scenario.patch.toml";
const HELD_OUT: &str = "held_out.csv";

/// Diagnoses and writes page, numbers and, where an effect is named, the patch.
pub fn diagnose(arguments: &DiagnoseArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.out;
    let files = [PAGE, NUMBERS, PATCH, HELD_OUT].map(|name| out.join(name));
    if let Some(old) = files.iter().find(|path| path.exists())
        && !arguments.force
    {
        let message = format!("`{}` exists: use --force to replace it", old.display());
        return Err(Failure::input(message));
    }
    let case = loading::diagnosis(&arguments.scene)?;
    if arguments.dry_run {
        return Paired::library(&case, arguments)?.dry_run(arguments);
    }
    let mistaken = |error: DiagnoseError| Failure::input(error.to_string());
    let closed;
    let paired;
    let (model, name): (&dyn Predictor, &str) = if arguments.closed_form {
        closed = ClosedForm::new(closed_form_cut(&case.base).map_err(mistaken)?, &case.scatter);
        (&closed, "the closed-form model (Oxley's shear zone, Zorev's contact)")
    } else {
        match Paired::library(&case, arguments)?.run(arguments)? {
            Ended::Interrupted => return Ok(interrupted()),
            Ended::Finished(results) => paired = runs::model(&case, &results)?,
        }
        (&paired, "paired runs of the particle solver")
    };
    let pool = loading::pool(loading::threads(arguments.threads))?;
    let (recordings, mut found) = pool.install(|| diagnose_case(&case, model)).map_err(mistaken)?;
    if !arguments.closed_form
        && let Some((runs, null, repair)) = Paired::repaired(&case, arguments, (&found, model))?
    {
        match runs.run(arguments)? {
            Ended::Interrupted => return Ok(interrupted()),
            Ended::Finished(results) => {
                let own = runs.in_order(&results);
                found.rerun = compare_rerun(&found.problem, (&null, &repair), &own, case.seed);
            }
        }
    }
    std::fs::create_dir_all(out)
        .map_err(|error| Failure::output(format!("cannot create `{}`", out.display()), &error))?;
    let provenance = Provenance {
        title: &case.title,
        source: &case.source,
        model: name,
        version: env!("CARGO_PKG_VERSION"),
        seed: case.seed,
    };
    let page =
        DiagnosisPage { provenance, diagnosis: &found, recordings: &recordings, predictor: model };
    results::save(&files[0], render_diagnosis(&page).as_bytes())?;
    let numbers = diagnosis_json(&provenance, &found, &recordings, model);
    results::save(&files[1], numbers.as_bytes())?;
    match patch::patch(&provenance, &case, &found, model) {
        Some(text) => results::save(&files[2], text.as_bytes())?,
        // An old patch beside a new verdict would be believed.
        None if files[2].exists() => std::fs::remove_file(&files[2]).map_err(|error| {
            Failure::output(format!("cannot remove `{}`", files[2].display()), &error)
        })?,
        None => {}
    }
    results::save(&files[3], held_out_csv(&found, &recordings).as_bytes())?;
    diagnosis_words(&page).iter().for_each(|words| terminal::line(words));
    terminal::line(&format!("report  {}", files[0].display()));
    Ok(ExitCode::Done)
}

fn interrupted() -> ExitCode {
    terminal::note("interrupted: checkpoints are written; the same command goes on");
    ExitCode::Interrupted
}
