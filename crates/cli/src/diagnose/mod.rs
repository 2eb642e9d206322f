//! `sphcut diagnose`: which physics a simulation left out.

mod closed_form;
mod patch;

use crate::arguments::DiagnoseArguments;
use crate::failure::{ExitCode, Failure};
use crate::{loading, results, terminal};
use sphcut_diagnose::{
    Batch, Channel, ClosedForm, Comparison, Condition, Diagnosis, InstrumentPriors, Predictor,
    Provenance, Recording, Recordings, Request, diagnose as infer, diagnosis_json,
};
use sphcut_report::{DiagnosisPage, diagnosis_words, render_diagnosis};
use sphcut_scenario::{CutTableRow, DiagnosisCase, MEASURED};

const PAGE: &str = "diagnosis.html";
const NUMBERS: &str = "diagnosis.json";
const PATCH: &str = "scenario.patch.toml";

/// Diagnoses and writes page, numbers and, where an effect is named, the patch.
pub fn diagnose(arguments: &DiagnoseArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.out;
    let files = [PAGE, NUMBERS, PATCH].map(|name| out.join(name));
    if let Some(old) = files.iter().find(|path| path.exists())
        && !arguments.force
    {
        let message = format!("`{}` exists: use --force to replace it", old.display());
        return Err(Failure::input(message));
    }
    let case = loading::diagnosis(&arguments.scene)?;
    if !arguments.closed_form {
        return Err(Failure::input(
            "a diagnosis with the particle solver needs what each effect changes in paired runs, and such runs are \
             not made yet",
        )
        .advise("use --closed-form: a diagnosis with the closed-form model of docs/analytic_model.md"));
    }
    let model = ClosedForm::new(closed_form::cut(&case.base)?, &case.scatter);
    let pool = loading::pool(loading::threads(arguments.threads))?;
    let recordings = recordings(&case.measured, &model, "measured")?;
    let found = pool.install(|| run(&case, &recordings, &model))?;
    std::fs::create_dir_all(out)
        .map_err(|error| Failure::output(format!("cannot create `{}`", out.display()), &error))?;
    let provenance = Provenance {
        title: &case.title,
        source: &case.source,
        model: "the closed-form model (Oxley's shear zone, Zorev's contact)",
        version: env!("CARGO_PKG_VERSION"),
        seed: case.seed,
    };
    let page =
        DiagnosisPage { provenance, diagnosis: &found, recordings: &recordings, predictor: &model };
    results::save(&files[0], render_diagnosis(&page).as_bytes())?;
    let numbers = diagnosis_json(&provenance, &found, &recordings, &model);
    results::save(&files[1], numbers.as_bytes())?;
    match patch::patch(&provenance, &case, &found, &model) {
        Some(text) => results::save(&files[2], text.as_bytes())?,
        // An old patch beside a new verdict would be believed.
        None if files[2].exists() => std::fs::remove_file(&files[2]).map_err(|error| {
            Failure::output(format!("cannot remove `{}`", files[2].display()), &error)
        })?,
        None => {}
    }
    diagnosis_words(&page).iter().for_each(|words| terminal::line(words));
    terminal::line(&format!("report  {}", files[0].display()));
    Ok(ExitCode::Done)
}

fn run(
    case: &DiagnosisCase,
    measured: &Recordings,
    model: &ClosedForm,
) -> Result<Diagnosis, Failure> {
    let reference = case.reference.as_ref();
    let cuts = reference.map(|cuts| recordings(&cuts.rows, model, "reference")).transpose()?;
    let reference = cuts.as_ref().zip(reference).map(|(cuts, stated)| {
        let comparison =
            if stated.difference { Comparison::Difference } else { Comparison::BiasField };
        (cuts, comparison, if stated.same_batch { Batch::Same } else { Batch::Another })
    });
    let [gain, offset, drift] = case.instruments;
    let request = Request {
        recordings: measured,
        reference,
        instruments: InstrumentPriors { gain, offset, drift },
        self_test: case.checks[0],
        control: case.checks[1],
        batch: case.next_cuts,
        range: range(case),
        seed: case.seed,
    };
    infer(&request, model).map_err(|error| Failure::input(error.to_string()))
}

/// The range that can be cut, where the case says any of its ends; the others half beyond the table.
fn range(case: &DiagnosisCase) -> Option<[[f64; 2]; 2]> {
    if case.next_range.iter().flatten().all(Option::is_none) {
        return None;
    }
    let axes: [fn(&CutTableRow) -> f64; 2] =
        [|row| row.cutting_speed, |row| row.uncut_chip_thickness];
    Some([0, 1].map(|k: usize| {
        let values = || case.measured.iter().map(axes[k]);
        let low = values().fold(f64::INFINITY, f64::min) / 1.5;
        let high = values().fold(0.0, f64::max) * 1.5;
        let [stated_low, stated_high] = case.next_range[k];
        [stated_low.unwrap_or(low), stated_high.unwrap_or(high)]
    }))
}

fn recordings(
    rows: &[CutTableRow],
    model: &ClosedForm,
    section: &str,
) -> Result<Recordings, Failure> {
    let cuts = rows.iter().map(|row| {
        let mut recording = Recording {
            condition: Condition {
                cutting_speed: row.cutting_speed,
                uncut_chip_thickness: row.uncut_chip_thickness,
                cut_length: row.cut_length.unwrap_or(0.0),
                run_order: row.order.unwrap_or(0.0),
            },
            count: row.count,
            values: [None; MEASURED.len()],
            deviations: [None; MEASURED.len()],
        };
        for (k, key) in MEASURED.iter().enumerate() {
            let channel = Channel::from_key(key).expect("a test compares the names of both");
            recording.values[channel.index()] = row.values[k];
            recording.deviations[channel.index()] = row.deviations[k];
        }
        recording
    });
    Recordings::new(cuts.collect(), model.channels())
        .map_err(|error| Failure::input(format!("the table of [{section}]: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_of_the_table_is_a_channel() {
        let channels: Vec<&str> = sphcut_diagnose::CHANNELS.iter().map(|c| c.key()).collect();
        assert_eq!(channels, MEASURED);
    }
}
