//! The file of a diagnosis, carried out.

use crate::DiagnosisCase;
use crate::data::mistakes::refuse_mistakes;
use crate::data::recordings::{Recording, Recordings};
use crate::error::DiagnoseError;
use crate::inference::commissioning::{Batch, ReferenceComparison};
use crate::inference::problem::InstrumentPriors;
use crate::model::predictor::Predictor;
use crate::progress::ProgressListener;
use crate::session::{Diagnosis, DiagnosisRequest, diagnose};
use sphcut_input::CutTableRow;
use sphcut_scenario::Scenario;

/// The recordings of a case and what they say against `model`.
///
/// # Errors
/// A table that cannot be used; all that [`diagnose`] may meet.
pub fn diagnose_case(
    case: &DiagnosisCase,
    model: &dyn Predictor,
) -> Result<(Recordings, Diagnosis), DiagnoseError> {
    diagnose_case_as(case, model, ProgressListener::NOBODY, |_| {})
}

/// The same, of which `told` hears, with a request that `change` has changed: what is not wanted is left out there.
///
/// # Errors
/// As [`diagnose_case`].
pub fn diagnose_case_as(
    case: &DiagnosisCase,
    model: &dyn Predictor,
    told: ProgressListener<'_>,
    change: impl FnOnce(&mut DiagnosisRequest<'_>),
) -> Result<(Recordings, Diagnosis), DiagnoseError> {
    let measured = recordings(&case.measured, model, &case.base, "measured")?;
    let reference = case.reference.as_ref();
    let cuts =
        reference.map(|cuts| recordings(&cuts.rows, model, &case.base, "reference")).transpose()?;
    let reference = cuts.as_ref().zip(reference).map(|(cuts, stated)| {
        let comparison = if stated.difference {
            ReferenceComparison::Difference
        } else {
            ReferenceComparison::BiasField
        };
        (cuts, comparison, if stated.same_batch { Batch::Same } else { Batch::Another })
    });
    let [gain, offset, drift] = case.instruments;
    let mut request = DiagnosisRequest {
        recordings: &measured,
        reference,
        model_error: case.model_error,
        instruments: InstrumentPriors { gain, offset, drift },
        self_test: case.checks[0],
        control: case.checks[1],
        held_out: true,
        batch: case.next_cuts,
        range: range(case),
        seed: case.seed,
        told,
    };
    change(&mut request);
    let found = diagnose(&request, model)?;
    Ok((measured, found))
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

/// The lines of a table as recordings of what `model` predicts.
pub(crate) fn recordings(
    rows: &[CutTableRow],
    model: &dyn Predictor,
    scenario: &Scenario,
    section: &'static str,
) -> Result<Recordings, DiagnoseError> {
    let cuts = rows.iter().map(|row| Recording {
        condition: row.condition(),
        count: row.count,
        values: row.values,
        deviations: row.deviations,
    });
    Recordings::new(cuts.collect(), model.channels())
        .and_then(|found| refuse_mistakes(&found, model, scenario).map(|()| found))
        .map_err(|reason| DiagnoseError::Table { section, reason: Box::new(reason) })
}
