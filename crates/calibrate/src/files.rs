//! Files of a calibration.

use crate::NORMAL_95;
use crate::constants::PublishedSet;
use crate::cuts::short;
use crate::next::NextCuts;
use crate::posterior::DISCREPANCIES;
use crate::session::{ComparedValue, CutCalibration};
use crate::words::standings;
use serde_json::{Value, json};
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_scenario::{KeyPath, Scenario, shipped_materials};
use std::path::Path;
use toml::Table;

/// Where a calibration comes from.
#[derive(Debug, Clone, Copy)]
pub struct CalibrationSource<'a> {
    /// Title of the scenario.
    pub title: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// Name of the measured table.
    pub measured: &'a str,
    /// What computed the cuts.
    pub model: &'a str,
    /// The published sets behind the priors.
    pub sets: &'a [PublishedSet],
}

fn condition_json(condition: &CuttingCondition) -> Value {
    json!({
        "cutting_speed": condition.cutting_speed,
        "uncut_chip_thickness": condition.uncut_chip_thickness,
        "rake_angle": condition.tool.rake_angle,
        "edge_radius": condition.tool.edge_radius,
    })
}

fn value_json(found: &CutCalibration, compared: &ComparedValue) -> Value {
    let cut = found.cut(&compared.value);
    let half = NORMAL_95 * compared.after.1;
    let after = compared.after.0;
    json!({
        "lines": cut.lines,
        "condition": condition_json(&cut.condition),
        "channel": compared.value.channel.symbol(),
        "measured": compared.value.log.exp(),
        "measured_deviation": compared.value.log.exp() * compared.value.variance.sqrt(),
        "before": compared.before.exp(),
        "after": after.exp(),
        "after_interval": [(after - half).exp(), (after + half).exp()],
        "wrong": compared.wrong,
        "left_out": compared.left_out.map(|f| json!({
            "predicted": f.log.exp(),
            "interval": interval(f.log, f.deviation),
        })),
    })
}

fn interval(log: f64, deviation: f64) -> [f64; 2] {
    [(log - NORMAL_95 * deviation).exp(), (log + NORMAL_95 * deviation).exp()]
}

/// Further cuts, in SI units: `open` is the standard deviation of ln y by channel, root mean square over all candidates.
#[must_use]
pub fn next_json(next: &NextCuts) -> Value {
    let open = |open: &[f64]| {
        let all = next.channels.iter().zip(open);
        all.map(|(c, s)| (c.symbol().to_owned(), json!(s))).collect::<serde_json::Map<_, _>>()
    };
    json!({
        "candidates": next.candidates,
        "open": open(&next.open),
        "cuts": next.cuts.iter().map(|cut| json!({
            "condition": condition_json(&cut.condition), "open": open(&cut.open),
        })).collect::<Vec<_>>(),
    })
}

/// A table for the further cuts, to be filled in and measured: `calibrate --measured` reads it.
#[must_use]
pub fn next_csv(next: &NextCuts) -> String {
    let heads: Vec<String> = next
        .channels
        .iter()
        .map(|channel| match channel {
            Channel::InterfaceTemperature => format!("{} [degC]", channel.symbol()),
            channel if channel.is_force() => format!("{} [N]", channel.symbol()),
            channel => format!("{} [mm]", channel.symbol()),
        })
        .collect();
    let tool =
        next.cuts.first().map_or([false; 2], |cut| cut.condition.tool.parts().map(|p| p.is_some()));
    let mut text = "v_c [m/min],h [mm]".to_owned();
    for (name, is_known) in ["rake [deg]", "edge_radius [um]"].into_iter().zip(tool) {
        if is_known {
            text += &format!(",{name}");
        }
    }
    text += &format!(",{}\n", heads.join(","));
    for cut in &next.cuts {
        let CuttingCondition { cutting_speed, uncut_chip_thickness, tool, .. } = cut.condition;
        text += &format!("{},{}", short(cutting_speed * 60.0), short(uncut_chip_thickness * 1e3));
        let parts = [tool.rake_angle.map(f64::to_degrees), tool.edge_radius.map(|r| r * 1e6)];
        for part in parts.into_iter().flatten() {
            text += &format!(",{}", short(part));
        }
        text += &",".repeat(heads.len());
        text.push('\n');
    }
    text
}

/// `calibration.json`, in SI units.
#[must_use]
pub fn cut_calibration_json(
    source: &CalibrationSource<'_>,
    found: &CutCalibration,
    next: Option<&NextCuts>,
) -> String {
    let posterior = &found.posterior;
    let standing = standings(found);
    let constants = found.constants.iter().enumerate().map(|(k, constant)| {
        let (t, half) = (posterior.mean[k], NORMAL_95 * posterior.deviation(k));
        json!({
            "key": constant.rule.key,
            "effect": constant.effect.map(|(key, _)| key),
            "symbol": constant.rule.symbol,
            "stated": constant.stated,
            "prior": { "median": constant.value(0.0), "interval": constant.interval(0.0, NORMAL_95), "sets": constant.sets, "material_tests": constant.is_tested },
            "value": constant.value(t),
            "interval": constant.interval(t, half),
            "share_of_prior": posterior.deviation(k),
            "standing": standing[k].word(),
        })
    });
    let runs = found.runs.iter().map(|(point, values)| {
        let constants = found.constants.iter().zip(&point.t);
        json!({
            "condition": condition_json(&point.condition),
            "constants": constants.map(|(c, t)| (c.rule.symbol.to_owned(), json!(c.value(*t)))).collect::<serde_json::Map<_, _>>(),
            "values": Channel::RECORDED.iter().zip(values)
                .filter_map(|(c, v)| v.map(|(log, variance)| (c.symbol().to_owned(), json!([log.exp(), log.exp() * variance.sqrt()]))))
                .collect::<serde_json::Map<_, _>>(),
        })
    });
    let rows = (0..found.constants.len())
        .map(|i| posterior.covariance.row(i).iter().copied().collect::<Vec<f64>>());
    let page = json!({
        "schema_version": "1.1",
        "scenario": source.title,
        "version": source.version,
        "measured": source.measured,
        "model": source.model,
        "published_sets": source.sets.iter().map(|set| json!({
            "name": set.name, "source": set.source, "values": set.values,
        })).collect::<Vec<_>>(),
        "constants": constants.collect::<Vec<_>>(),
        "covariance_over_priors": rows.collect::<Vec<_>>(),
        "discrepancy": DISCREPANCIES.iter().zip(&posterior.weights).map(|(one, probability)| json!({
            "amplitude": one.amplitude, "thrust": one.thrust, "own": one.own, "probability": probability,
        })).collect::<Vec<_>>(),
        "cuts": found.values.iter().map(|v| value_json(found, v)).collect::<Vec<_>>(),
        "effects": found.effects.iter().map(|(k, evidence)| json!({
            "effect": found.constants[*k].effect.map(|(key, _)| key), "log_evidence": evidence,
        })).collect::<Vec<_>>(),
        "contradicting_tools": found.contradicting.iter().map(|one| json!({
            "rake_angle": one.tool.rake_angle, "edge_radius": one.tool.edge_radius, "channel": one.channel.symbol(),
            "shift": one.log_shift.exp_m1(), "log_evidence": one.evidence,
        })).collect::<Vec<_>>(),
        "left_out": found.errors.iter().map(|e| json!({
            "by": e.by, "channel": e.channel.symbol(), "calibrated": e.calibrated, "regression": e.regression,
            "corrected": e.corrected, "covered": e.covered,
        })).collect::<Vec<_>>(),
        "held_out": found.foreseen.iter().map(|(simulated, f)| json!({
            "condition": condition_json(&found.cut(&f.value).condition),
            "channel": f.value.channel.symbol(),
            "measured": f.value.log.exp(),
            "simulated": simulated.exp(),
            "predicted": f.log.exp(),
            "interval": interval(f.log, f.deviation),
        })).collect::<Vec<_>>(),
        "next": next.map(next_json),
        "runs": runs.collect::<Vec<_>>(),
    });
    let mut text =
        serde_json::to_string_pretty(&page).expect("plain numbers and texts have a JSON form");
    text.push('\n');
    text
}

/// The material of the scenario with the constants found, as a material file: `None` where the scenario writes its material out itself.
#[must_use]
pub fn material_file(
    (scenario, path): (&Scenario, &Path),
    source: &CalibrationSource<'_>,
    found: &CutCalibration,
) -> Option<String> {
    let table: Table = scenario.text.parse().ok()?;
    let name = table.get("workpiece")?.as_table()?.get("material")?.as_str()?;
    let mut text = match shipped_materials().iter().find(|(own, _)| *own == name) {
        Some((_, text)) => (*text).to_owned(),
        None => std::fs::read_to_string(path.parent()?.join(name)).ok()?,
    };
    let mut write = |key: &str, literal: &str| {
        text = KeyPath::parse(key).ok()?.written(&text, literal).ok()?;
        Some(())
    };
    for (k, constant) in found.constants.iter().enumerate() {
        let value = constant.value(found.posterior.mean[k]);
        let literal = match constant.rule.key {
            "initial_yield" | "hardening_modulus" => format!("\"{:.2} MPa\"", value * 1e-6),
            "hardening_exponent" | "rate_coefficient" | "softening_exponent" => {
                format!("{value:.5}")
            }
            _ => continue,
        };
        write(&format!("flow_stress.{}", constant.rule.key), &literal)?;
    }
    let origin = format!(
        "sphcut {} calibrate, from `{}` by {}, begun with `{name}`",
        source.version, source.measured, source.model
    );
    write(
        "title",
        &format!("{:?}", format!("{} calibrated to cuts", scenario.setup.materials[0].name)),
    )?;
    write("sources.flow_stress", &format!("{origin:?}"))?;
    // The constants are those of the cuts now: how far tests of the material went does not matter.
    for key in ["tested", "sources.tested"] {
        text = KeyPath::parse(key).ok()?.removed(&text).unwrap_or(text);
    }
    Some(text)
}
