//! Files of an identification.

use crate::{CurvePoint, LawComparison, LawFit, Sequence};
use serde_json::{Value, json};
use sphcut_physics::Quantity;
use sphcut_physics::flow_stress::FlowStressTable;
use std::fmt::Write;

const NAMES: [&str; 5] = [
    "initial_yield",
    "hardening_modulus",
    "hardening_exponent",
    "rate_coefficient",
    "softening_exponent",
];

/// A material file with the law of `fit` to `points`, or with a table if `table_file` names one; `source` says where
/// the curves come from.
#[must_use]
pub fn material_toml(
    title: &str,
    properties: &[(&str, f64, Quantity)],
    points: &[CurvePoint],
    fit: &LawFit,
    table_file: Option<&str>,
    source: &str,
) -> String {
    let quoted = |text: &str| serde_json::to_string(text).expect("a text has a JSON form");
    let mut text = format!("title = {}\n", quoted(title));
    let mut put = |key: &str, value: f64, quantity: Quantity| {
        let unit = quantity.si_unit();
        let line = if unit.is_empty() {
            format!("{key} = {value:?}\n")
        } else {
            format!("{key} = \"{value:?} {unit}\"\n")
        };
        text.push_str(&line);
    };
    for (key, value, quantity) in properties {
        put(key, *value, *quantity);
    }
    text += "\n[flow_stress]\n";
    if let Some(file) = table_file {
        write!(text, "law = \"tabulated\"\ntable_file = {}\n", quoted(file)).expect("a string");
    } else {
        let entry = fit.law.entry();
        writeln!(text, "law = \"{}\"", entry.key).expect("a string");
        for parameter in entry.parameters {
            let value = fit.value(parameter.key).or(match parameter.key {
                "reference_rate" => Some(fit.references.rate),
                "reference_temperature" => Some(fit.references.temperature),
                "melting_temperature" => Some(fit.references.melting),
                _ => None,
            });
            let Some(value) = value else { continue };
            let unit = parameter.quantity.si_unit();
            let line = match parameter.quantity {
                Quantity::Stress => format!("{} = \"{:.3} MPa\"\n", parameter.key, value * 1e-6),
                Quantity::Dimensionless => format!("{} = {value:.6}\n", parameter.key),
                _ => format!("{} = \"{value:?} {unit}\"\n", parameter.key),
            };
            text += &line;
        }
    }
    let last = |of: fn(&CurvePoint) -> f64| points.iter().map(of).fold(0.0, f64::max);
    writeln!(
        text,
        "\n[tested]\nplastic_strain = {:.4}\nstrain_rate = \"{:.2e} 1/s\"\ntemperature = \"{:?} K\"",
        last(|point| point.plastic_strain),
        last(|point| point.plastic_strain_rate),
        last(|point| point.temperature)
    )
    .expect("a string");
    text += "\n[sources]\n";
    for (key, _, _) in properties {
        writeln!(text, "{key} = \"as stated for the identification\"").expect("a string");
    }
    writeln!(text, "flow_stress = {0}\ntested = {0}", quoted(source)).expect("a string");
    text
}

/// The file of a tabulated flow stress.
#[must_use]
pub fn table_csv(table: &FlowStressTable) -> String {
    let mut text =
        "plastic_strain,strain_rate [1/s],temperature [K],flow_stress [MPa]\n".to_owned();
    for [strain, rate, temperature, stress] in table.points() {
        writeln!(text, "{strain},{rate},{temperature},{:.4}", stress * 1e-6).expect("a string");
    }
    text
}

/// Every point with what the laws say.
#[must_use]
pub fn residuals_csv(points: &[CurvePoint], fits: [&LawFit; 2]) -> String {
    let mut text = "curve,plastic_strain,strain_rate [1/s],temperature [K],stress [MPa],\
                    johnson_cook ln ratio,tanh ln ratio\n"
        .to_owned();
    for (k, p) in points.iter().enumerate() {
        writeln!(
            text,
            "{},{},{},{},{},{:.5},{:.5}",
            p.curve + 1,
            p.plastic_strain,
            p.plastic_strain_rate,
            p.temperature,
            p.stress * 1e-6,
            fits[0].residuals[k],
            fits[1].residuals[k]
        )
        .expect("a string can be written");
    }
    text
}

/// Everything but the points, in SI units.
#[must_use]
pub fn identification_json(
    sequence: Option<&Sequence>,
    fits: [&LawFit; 2],
    comparison: &LawComparison,
) -> String {
    let finite = |value: f64| value.is_finite().then_some(value);
    let one = |fit: &LawFit| {
        let parameters = fit.parameters.iter().map(|p| {
            let value = json!({
                "value": p.value, "ci95": finite(p.half_width), "at_limit": p.at_limit,
            });
            (p.key.to_owned(), value)
        });
        json!({
            "law": fit.law.key(),
            "parameters": parameters.collect::<serde_json::Map<String, Value>>(),
            "correlation": fit.correlation.iter()
                .map(|row| row.iter().map(|v| finite(*v)).collect::<Vec<_>>()).collect::<Vec<_>>(),
            "rms_ln_ratio": fit.deviation,
        })
    };
    let page = json!({
        "schema_version": "1.0",
        "sequence": sequence.map(|s| NAMES.iter().zip(s.parameters)
            .map(|(key, value)| ((*key).to_owned(), json!(value))).collect::<serde_json::Map<String, Value>>()),
        "sequence_evidence": sequence.map(|s| json!({
            "yield_strain": s.yield_strain, "rms_ln_ratio": s.deviation.and_then(finite),
        })),
        "fits": fits.map(one),
        "comparison": {
            "conditions": comparison.conditions,
            "laws": comparison.laws.iter().map(|law| json!({
                "law": law.law, "rms_fitted": law.fitted, "rms_unseen": law.unseen,
                "advantage": law.advantage,
            })).collect::<Vec<_>>(),
        },
    });
    let mut text =
        serde_json::to_string_pretty(&page).expect("plain numbers and texts have a JSON form");
    text.push('\n');
    text
}
