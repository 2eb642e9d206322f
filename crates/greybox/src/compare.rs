//! A stored correction against measurements it was not taught with.

use crate::error::GreyBoxError;
use crate::fit::ForceTable;
use crate::metrics::{BootstrapEstimate, Outcomes, Scores, bias, scores};
use crate::model_file::{GreyBox, Prediction};
use crate::pairing::{ForceKind, ForceRow, Pairs, pair_at_least};
use crate::regressor::Method;
use crate::setting::{TableKind, same_width};

/// A comparison of both forces.
#[derive(Debug, Clone, PartialEq)]
pub struct TableComparison {
    /// What was compared.
    pub pairs: Pairs,
    /// F_c and F_f.
    pub forces: [ForceComparison; 2],
    /// Rows that were left out because the correction was fitted to them.
    pub seen: usize,
    /// What is to be kept in mind of the tables.
    pub notes: Vec<String>,
    /// How many rows lie inside the hull.
    pub inside: usize,
}

/// The comparison of one force.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceComparison {
    /// Which.
    pub force: ForceKind,
    /// The regressor that was used.
    pub method: Method,
    /// Row by row.
    pub predictions: Vec<Prediction>,
    /// The simulation alone.
    pub white_box: Scores,
    /// Corrected.
    pub grey_box: Scores,
    /// Corrected, rows inside the hull; `None` if there are none.
    pub grey_box_inside: Option<Scores>,
    /// Mean of measured minus corrected in N, all rows: how far they differ in one direction.
    pub bias: BootstrapEstimate,
    /// The same of the rows inside the hull; `None` if there are none.
    pub bias_inside: Option<BootstrapEstimate>,
    /// Share of the measurements inside the 95 % interval.
    pub coverage: f64,
}

/// Compares by `method` or by the regressor to use.
///
/// # Errors
/// Cuts of another material or width; no row that the fit has not seen; tables that cannot be paired; a regressor that was not fitted.
pub fn compare(
    model: &GreyBox,
    method: Option<Method>,
    simulated: &ForceTable,
    measured: &ForceTable,
    resamples: usize,
) -> Result<TableComparison, GreyBoxError> {
    same_width(&simulated.setting, &measured.setting)?;
    let mut notes = model.guard(simulated, TableKind::Simulated)?;
    notes.extend(model.guard(measured, TableKind::Measured)?);
    let new: Vec<ForceRow> =
        measured.rows.iter().filter(|row| !model.has_seen(measured, row)).copied().collect();
    if new.is_empty() {
        return Err(GreyBoxError::NothingNew(measured.rows.len()));
    }
    let pairs = pair_at_least(1, &simulated.rows, &new)?;
    let force = |force| one(model, method, force, &pairs, resamples);
    let forces = [force(ForceKind::Cutting)?, force(ForceKind::Feed)?];
    Ok(TableComparison {
        seen: measured.rows.len() - new.len(),
        notes,
        inside: forces[0].predictions.iter().filter(|prediction| prediction.inside).count(),
        forces,
        pairs,
    })
}

fn one(
    model: &GreyBox,
    method: Option<Method>,
    force: ForceKind,
    pairs: &Pairs,
    resamples: usize,
) -> Result<ForceComparison, GreyBoxError> {
    let samples = pairs.residuals(force);
    let (measured, simulated) = (pairs.measured(force), pairs.simulated(force));
    let predictions: Vec<Prediction> = samples
        .inputs
        .iter()
        .zip(&simulated)
        .map(|(&input, &simulated)| model.predict(force, method, input, simulated))
        .collect::<Result<_, _>>()?;
    let none = vec![0.0; samples.len()];
    let corrections: Vec<f64> = predictions.iter().map(|p| p.corrected - p.simulated).collect();
    let rows: Vec<usize> = (0..samples.len()).filter(|&row| predictions[row].inside).collect();
    let all: Vec<usize> = (0..samples.len()).collect();
    let judge = |predicted: &[f64], rows: &[usize]| {
        let of = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<_>>();
        let groups: Vec<usize> = rows.iter().map(|&row| samples.groups[row]).collect();
        let (measured, residuals) = (of(&measured), of(&samples.targets));
        let outcomes = Outcomes {
            measured: &measured,
            residuals: &residuals,
            predicted: &of(predicted),
            groups: &groups,
        };
        (scores(&outcomes, resamples, model.seed), bias(&outcomes, resamples, model.seed))
    };
    let (grey_box, bias) = judge(&corrections, &all);
    let inside = (!rows.is_empty()).then(|| judge(&corrections, &rows));
    let covered = (0..samples.len())
        .filter(|&row| {
            let [low, high] = predictions[row].interval;
            (low..=high).contains(&measured[row])
        })
        .count();
    Ok(ForceComparison {
        force,
        method: method.unwrap_or(model.corrections[force.index()].chosen),
        white_box: judge(&none, &all).0,
        grey_box,
        bias,
        grey_box_inside: inside.as_ref().map(|(scores, _)| scores.clone()),
        bias_inside: inside.map(|(_, bias)| bias),
        coverage: covered as f64 / samples.len() as f64,
        predictions,
    })
}
