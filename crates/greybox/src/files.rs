//! `greybox.json` and the tables of a fit, of predictions and of a comparison.

use crate::compare::TableComparison;
use crate::fit::{ForceFit, GreyBoxFit, MethodFit};
use crate::model_file::Prediction;
use crate::pairing::ForceKind;
use crate::samples::Input;
use serde_json::{Value, json};
use std::fmt::Write;

/// Version of the schema of `greybox.json`.
const SCHEMA_VERSION: &str = "1.2";
const M_PER_MIN: f64 = 60.0;
const MM: f64 = 1e3;

/// The figures of a fit; forces in N, the rest in SI units.
#[must_use]
pub fn fit_json(fit: &GreyBoxFit) -> String {
    let page = json!({
        "schema_version": SCHEMA_VERSION,
        "program_version": fit.version,
        "seed": fit.options.seed,
        "folds": fit.options.folds,
        "resamples": fit.options.resamples,
        "simulated_table": fit.origins[0],
        "measured_table": fit.origins[1],
        "settings": fit.settings,
        "rows": fit.pairs.rows.len(),
        "conditions": fit.pairs.conditions.len(),
        "condensed": fit.pairs.condensed,
        "hull": fit.hull.corners(),
        "forces": fit.forces.iter().map(force_json).collect::<Vec<_>>(),
    });
    format!("{page:#}\n")
}

fn force_json(force: &ForceFit) -> Value {
    json!({
        "force": force.force,
        "choice": force.choice,
        "white_box": force.white_box,
        "procedure": force.procedure,
        "noise_floor": force.floor,
        "pays": force.pays(),
        "outliers": force.outliers,
        "without_outliers": force.without_outliers,
        "methods": force.methods.iter().map(method_json).collect::<Vec<_>>(),
        "without_simulation": {
            "interpolation": force.alone.interpolation,
            "speed_left_out": force.alone.extrapolation[0],
            "thickness_left_out": force.alone.extrapolation[1],
        },
        "learning_curve": force.learning.iter().map(|point| json!({
            "conditions": point.conditions,
            "mae": point.mae,
            "range": point.range,
            "without_simulation": point.alone,
        })).collect::<Vec<_>>(),
    })
}

fn method_json(fit: &MethodFit) -> Value {
    let extrapolated = |axis: usize| {
        fit.extrapolation[axis].as_ref().map(|part| {
            json!({
                "parts": part.parts,
                "all": part.all.scores,
                "ends": part.ends,
                "white_box_at_ends": part.white_box_at_ends,
            })
        })
    };
    json!({
        "method": fit.method,
        "settings": fit.settings,
        "interpolation": fit.interpolation.scores,
        "speed_left_out": extrapolated(0),
        "thickness_left_out": extrapolated(1),
        "permutation_importance": fit.permutation,
        "gain_importance": fit.gain,
        "sobol": fit.sobol,
        "half_widths": fit.half_widths,
        "coverage_of_own_interval": fit.coverage,
    })
}

/// A number as short as its digits allow: units other than SI would leave rounding behind.
fn cell(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    rounded.to_string()
}

/// One line per measured row: measured, simulated, corrected with the row's condition held out.
#[must_use]
pub fn points_csv(fit: &GreyBoxFit) -> String {
    let mut text = "v_c [m/min],h [mm]".to_owned();
    for force in ForceKind::BOTH {
        let f = force.symbol();
        let _ = write!(text, ",{f} measured [N],{f} simulated [N],{f} corrected [N]");
    }
    text.push('\n');
    let inputs = fit.pairs.inputs();
    let columns = ForceKind::BOTH.map(|force| {
        let held = &fit.forces[force.index()].chosen().interpolation.predicted;
        (fit.pairs.measured(force), fit.pairs.simulated(force), held)
    });
    for (row, input) in inputs.iter().enumerate() {
        text += &format!("{},{}", cell(input[0] * M_PER_MIN), cell(input[1] * MM));
        for (measured, simulated, held) in &columns {
            let corrected = simulated[row] + held[row];
            for value in [measured[row], simulated[row], corrected] {
                let _ = write!(text, ",{}", cell(value));
            }
        }
        text.push('\n');
    }
    text
}

/// One line per condition: simulated and corrected forces with 95 % intervals of a new measurement, and whether the
/// condition lies within the hull (1) or not (0).
#[must_use]
pub fn predictions_csv(rows: &[(Input, [Prediction; 2])]) -> String {
    let mut text = "v_c [m/min],h [mm]".to_owned();
    for force in ForceKind::BOTH {
        let f = force.symbol();
        let _ = write!(text, ",{f} simulated [N],{f} [N],{f} low [N],{f} high [N]");
    }
    text += ",inside\n";
    for (input, predictions) in rows {
        text += &format!("{},{}", cell(input[0] * M_PER_MIN), cell(input[1] * MM));
        for found in predictions {
            let [low, high] = found.interval;
            for value in [found.simulated, found.corrected, low, high] {
                let _ = write!(text, ",{}", cell(value));
            }
        }
        text += if predictions[0].inside { ",1\n" } else { ",0\n" };
    }
    text
}

/// The figures of a comparison; forces in N.
#[must_use]
pub fn comparison_json(comparison: &TableComparison) -> String {
    let page = json!({
        "schema_version": SCHEMA_VERSION,
        "rows": comparison.pairs.rows.len(),
        "conditions": comparison.pairs.conditions.len(),
        "rows_inside_hull": comparison.inside,
        "rows_of_the_fit_left_out": comparison.seen,
        "forces": comparison.forces.iter().map(|force| json!({
            "force": force.force,
            "method": force.method,
            "white_box": force.white_box,
            "grey_box": force.grey_box,
            "grey_box_inside_hull": force.grey_box_inside,
            "bias": force.bias,
            "bias_inside_hull": force.bias_inside,
            "coverage": force.coverage,
        })).collect::<Vec<_>>(),
    });
    format!("{page:#}\n")
}
