//! `scenario.patch.toml`: what a named effect means for the scenario.

use sphcut_diagnose::{Diagnosis, Predictor, Provenance, Verdict};
use sphcut_scenario::DiagnosisCase;
use std::fmt::Write;

/// The patch; `None` unless effects are named.
pub fn patch(
    provenance: &Provenance<'_>,
    case: &DiagnosisCase,
    found: &Diagnosis,
    predictor: &dyn Predictor,
) -> Option<String> {
    let Verdict::Named(named) = &found.finding.verdict else { return None };
    let fit = &found.fits[found.repair?];
    let effects = predictor.effects();
    let quoted = |text: &str| format!("{text:?}");
    let mut text = format!(
        "# What is missing in the scenario, and with which probability: see diagnosis.html beside this file.\n\n\
         [provenance]\nprogram_version = {}\nmodel = {}\nscenario = {}\ntitle = {}\nsource = {}\nseed = {}\n",
        quoted(provenance.version),
        quoted(provenance.model),
        quoted(&case.base_path.display().to_string()),
        quoted(provenance.title),
        quoted(provenance.source),
        provenance.seed
    );
    let estimates = found.estimates(predictor, fit);
    let mut keys = Vec::new();
    for &effect in named {
        let own = &effects[effect];
        let probability = found.finding.inclusion[effect];
        let _ = write!(
            text,
            "\n[[effect]]\nkey = {}\ntitle = {}\nprobability = {probability:.4}\n",
            quoted(own.key),
            quoted(own.title)
        );
        for estimate in estimates.iter().filter(|estimate| estimate.effect == effect) {
            let parameter = &own.parameters[estimate.parameter];
            let [low, high] = estimate.interval;
            let value = estimate.value;
            let _ = write!(
                text,
                "\n[effect.parameters.{}]\nvalue = {value:.4e}\ninterval = [{low:.4e}, {high:.4e}]\nunit = {}\n",
                parameter.key,
                quoted(parameter.unit)
            );
            keys.extend(scenario_key(case, own.key, parameter.key, (value, parameter.unit)));
        }
    }
    if keys.is_empty() {
        text += "\n# The scenario has no key for this effect: it cannot be simulated with particles yet.\n";
    } else {
        text += "\n# Keys to set in the scenario.\n[scenario]\n";
        keys.iter().for_each(|line| text += &format!("{line}\n"));
    }
    Some(text)
}

/// The keys of the scenario that have the effect; none if the solver does not have it.
fn scenario_key(
    case: &DiagnosisCase,
    effect: &str,
    parameter: &str,
    (value, unit): (f64, &str),
) -> Vec<String> {
    let written = |value: f64| match unit {
        "" => format!("{value:.4e}"),
        unit => format!("\"{value:.4e} {unit}\""),
    };
    let friction = |law: &str| {
        vec![
            format!("tool.friction.law = \"{law}\""),
            format!("tool.friction.{parameter} = {}", written(value)),
        ]
    };
    match effect {
        "speed_dependent_friction" => friction("speed_dependent"),
        "temperature_dependent_friction" => friction("temperature_dependent"),
        "shear_capped_friction" => friction("shear_capped_coulomb"),
        "edge_radius" => {
            let base =
                case.base.setup.tool.as_ref().and_then(|tool| tool.edge_radius).unwrap_or(0.0);
            vec![format!("tool.edge_radius = {}", written(base + value))]
        }
        other if sphcut_physics::effects::EFFECTS.iter().any(|entry| entry.key == other) => {
            vec![format!("effects.{other}.{parameter} = {}", written(value))]
        }
        _ => Vec::new(),
    }
}
