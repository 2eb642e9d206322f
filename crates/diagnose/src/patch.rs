//! `scenario.patch.toml`: what named effects, and what was fitted with them, mean for the scenario.

use crate::DiagnosisCase;
use crate::error::DiagnoseError;
use crate::files::DiagnosisProvenance;
use crate::inference::verdict::ClaimVerdict;
use crate::model::paired::Change;
use crate::model::predictor::Predictor;
use crate::model::scenario_keys::ScenarioKeys;
use crate::session::Diagnosis;
use sphcut_scenario::Scenario;
use std::fmt::Write;

/// The patch; `None` unless effects are named.
///
/// # Errors
/// A change that the scenario cannot have.
pub fn patch(
    provenance: &DiagnosisProvenance<'_>,
    case: &DiagnosisCase,
    found: &Diagnosis,
    predictor: &dyn Predictor,
) -> Result<Option<String>, DiagnoseError> {
    let (ClaimVerdict::Named(named), Some(repair)) = (&found.finding.verdict, found.repair) else {
        return Ok(None);
    };
    let fit = &found.fits[repair];
    let effects = predictor.effects();
    let quoted = |text: &str| format!("{text:?}");
    let mut text = format!(
        "# What is missing in the scenario, and with which probability: see diagnosis.html beside this file.\n\
         # `sphcut run SCENARIO --patch FILE` (also check, sweep, calibrate-friction) sets the keys under [scenario].\n\n\
         [provenance]\nprogram_version = {}\nmodel = {}\nscenario = {}\ntitle = {}\nsource = {}\nseed = {}\n",
        quoted(provenance.version),
        quoted(provenance.model),
        quoted(&case.base_path.display().to_string()),
        quoted(provenance.title),
        quoted(provenance.source),
        provenance.seed
    );
    let estimates = found.estimates(predictor, fit);
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
        }
    }
    let rows = (0..found.problem.rows.len()).filter(|&row| found.problem.is_diagnosed(row));
    let cut = rows.map(|row| found.problem.condition(row).cut_length).fold(0.0, f64::max);
    let change = fit.change(&found.problem, predictor, cut);
    text += &scenario_patch(&case.base, &change)?;
    Ok(Some(text))
}

/// The table `[scenario]` of a patch that makes `change`, and why the scenario has no keys for the rest.
///
/// # Errors
/// A change that the scenario cannot have.
pub fn scenario_patch(scenario: &Scenario, change: &Change) -> Result<String, DiagnoseError> {
    let keys = ScenarioKeys::of(scenario)?;
    let mut text = String::new();
    for (effect, _) in &change.effects {
        if let Some(why) = keys.why_none(effect) {
            let _ = write!(text, "\n# No key of the scenario has {effect}: {why}.\n");
        }
    }
    let settings = keys.changed(change)?;
    if !settings.is_empty() {
        text += "\n# The effects, and the properties as they were fitted together with them.\n[scenario]\n";
        for (key, value) in settings {
            let _ = writeln!(text, "{key} = {value}");
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::paired::{PairedScenario, changes};
    use sphcut_physics::CuttingCondition;
    use sphcut_scenario::{LoadOptions, ScenarioPatch, load, parse};
    use sphcut_sweep::Sweep;
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    fn shipped() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml")
    }

    type Settings = BTreeSet<(String, String, String)>;

    fn settings(scenario: &Scenario) -> Settings {
        let all = scenario.description.iter();
        all.map(|e| (e.section.clone(), e.key.to_string(), e.value.clone())).collect()
    }

    fn patched(scenario: &Scenario, change: &Change) -> Result<Scenario, String> {
        let patch = scenario_patch(scenario, change).unwrap();
        let patch = ScenarioPatch::parse(&patch, "patch").map_err(|p| p[0].mistake.message())?;
        let text = patch.applied(&scenario.text).map_err(|p| p[0].mistake.message())?;
        let path = shipped();
        parse(&text, "cut.toml", path.parent(), &LoadOptions::default())
            .map_err(|all| all.iter().map(|p| p.mistake.message()).collect())
    }

    /// Key by key: what `run --patch` computes is what the paired run with the same change has computed.
    #[test]
    fn a_patched_scenario_is_that_of_the_paired_run() {
        let path = shipped();
        let options = LoadOptions::default();
        let text = std::fs::read_to_string(&path).unwrap().replace("[tool.heat]\n", "")
            + "\n[heat]\nfriction_heat_share = 1.0\n";
        let scenario = parse(&text, "cut", path.parent(), &options).unwrap();
        let number = |key: &str| {
            let mut all = scenario.description.iter();
            all.find(|e| e.section == "process" && e.key == key).unwrap().number.unwrap()
        };
        let condition =
            CuttingCondition::new(number("cutting_speed"), number("uncut_chip_thickness"));
        let base = PairedScenario::of(&scenario, 30.0).unwrap();
        let scatter = [("initial_yield", 0.08), ("friction_coefficient", 0.15)];
        let all = changes(&scatter, |key| base.can_have(key));
        let keys = base.keys(true);
        let mut compared = 0;
        for change in all.iter().filter(|change| !change.is_none() && change.repeat == 0) {
            let values = base.values(&condition, change, true).unwrap();
            let runs = [values];
            let sweep =
                Sweep::listed(("a", "a"), (&scenario, &path), &options, (&keys, &runs)).unwrap();
            let run: Vec<&str> = runs[0].iter().map(String::as_str).collect();
            let run = settings(&sweep.scenario(&run).unwrap());
            let own = settings(&patched(&scenario, change).unwrap());
            let differs: Vec<_> = run
                .symmetric_difference(&own)
                .filter(|(section, key, _)| {
                    // How far a run goes, what follows from that, and a tool that is said to be new.
                    !(section.starts_with("stop")
                        || section.starts_with("output")
                        || section == "workpiece" && key == "length"
                        || section == "tool" && key == "wear_land" && change.wear_land.is_none())
                })
                .collect();
            assert!(differs.is_empty(), "{change:?}: {differs:?}");
            compared += 1;
        }
        assert!(compared > 15, "{compared}");
    }

    /// Every effect of the closed form makes a patch that `check` takes, or says why the scenario has no key for it.
    #[test]
    fn every_effect_has_keys_or_a_reason() {
        let scenario = load(&shipped(), &LoadOptions::default()).unwrap();
        let before = settings(&scenario);
        for effect in sphcut_analytic::EFFECTS.iter() {
            let middle = |free: &sphcut_analytic::Free| 0.6 * free.prior.0 + 0.4 * free.prior.1;
            let values: Vec<f64> = effect.candidate.free.iter().map(middle).collect();
            let change = match effect.key {
                "flank_wear" => Change { wear_land: Some(1e-4), ..Change::default() },
                key => Change { effects: vec![(key, values)], ..Change::default() },
            };
            let text = scenario_patch(&scenario, &change).unwrap();
            if ScenarioKeys::of(&scenario).unwrap().why_none(effect.key).is_some() {
                assert!(text.contains("# No key") && !text.contains("[scenario]"), "{text}");
                continue;
            }
            let found = patched(&scenario, &change)
                .unwrap_or_else(|error| panic!("{}: {error}\n{text}", effect.key));
            assert_ne!(settings(&found), before, "{}", effect.key);
        }
    }

    #[test]
    fn nothing_changed_is_no_patch() {
        let scenario = load(&shipped(), &LoadOptions::default()).unwrap();
        assert_eq!(scenario_patch(&scenario, &Change::default()).unwrap(), "");
    }
}
