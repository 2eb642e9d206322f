//! A stored correction against measurements it was not taught with.

use crate::error::GreyBoxError;
use crate::fit::Table;
use crate::metrics::{Outcomes, Scores, scores};
use crate::model_file::{GreyBox, Prediction};
use crate::pairing::{ForceKind, Pairs, pair_at_least};
use crate::regressor::Method;

/// A comparison of both forces.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What was compared.
    pub pairs: Pairs,
    /// F_c and F_f.
    pub forces: [ForceComparison; 2],
    /// Whether the measurements are those that the correction was taught with.
    pub same_measurements: bool,
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
    /// Share of the measurements inside the 95 % interval.
    pub coverage: f64,
}

/// Compares by `method` or by the regressor to use.
///
/// # Errors
/// Tables that cannot be paired; a regressor that was not fitted.
pub fn compare(
    model: &GreyBox,
    method: Option<Method>,
    simulated: &Table,
    measured: &Table,
    resamples: usize,
) -> Result<Comparison, GreyBoxError> {
    let pairs = pair_at_least(1, &simulated.rows, &measured.rows)?;
    let force = |force| one(model, method, force, &pairs, resamples);
    let forces = [force(ForceKind::Cutting)?, force(ForceKind::Feed)?];
    Ok(Comparison {
        same_measurements: model.tables[1].sha256 == measured.origin.sha256,
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
    let judge = |white: bool, keep: &dyn Fn(usize) -> bool| {
        let rows: Vec<usize> = (0..samples.len()).filter(|&row| keep(row)).collect();
        let of =
            |pick: &dyn Fn(usize) -> f64| rows.iter().map(|&row| pick(row)).collect::<Vec<_>>();
        let correction = |row: usize| predictions[row].corrected - predictions[row].simulated;
        let groups: Vec<usize> = rows.iter().map(|&row| samples.groups[row]).collect();
        scores(
            &Outcomes {
                measured: &of(&|row| measured[row]),
                residuals: &of(&|row| samples.targets[row]),
                predicted: &of(&|row| if white { 0.0 } else { correction(row) }),
                groups: &groups,
            },
            resamples,
            model.seed,
        )
    };
    let inside = |row: usize| predictions[row].inside;
    let covered = (0..samples.len())
        .filter(|&row| {
            let [low, high] = predictions[row].interval;
            (low..=high).contains(&measured[row])
        })
        .count();
    Ok(ForceComparison {
        force,
        method: method.unwrap_or(model.corrections[force.index()].chosen),
        white_box: judge(true, &|_| true),
        grey_box: judge(false, &|_| true),
        grey_box_inside: (0..samples.len()).any(inside).then(|| judge(false, &inside)),
        coverage: covered as f64 / samples.len() as f64,
        predictions,
    })
}
