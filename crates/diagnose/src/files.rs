//! `diagnosis.json`.

use crate::check::forecast::Forecast;
use crate::check::held_out::{Competitor, HeldOutErrors, Part};
use crate::check::rerun::{Rerun, RerunChannel};
use crate::check::self_test::Rate;
use crate::data::recordings::{NoiseSource, Recordings};
use crate::inference::attribute::Hypothesis;
use crate::inference::commissioning::BiasOrigin;
use crate::inference::fit::Fit;
use crate::inference::verdict::ClaimVerdict;
use crate::model::predictor::{Predictor, RelationError};
use crate::session::{Diagnosis, ParameterEstimate, RankedEffect};
use serde_json::{Value, json};
use sphcut_physics::{CuttingCondition, ToolGeometry};

/// Version of the schema of `diagnosis.json`.
pub const DIAGNOSIS_SCHEMA_VERSION: &str = "1.3";

impl ClaimVerdict {
    /// Its name in files.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::NoAlarm => "no_alarm",
            Self::Named(_) => "named",
            Self::OneOf => "one_of",
            Self::NoneOfThese => "none_of_these",
        }
    }
}

impl Part {
    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::HighestSpeed => "highest_speed",
            Self::ThinnestChip => "thinnest_chip",
            Self::UnfittedChannel => "unfitted_channel",
            Self::Tools => "tools",
        }
    }
}

/// Where a diagnosis comes from.
#[derive(Debug, Clone, Copy)]
pub struct DiagnosisProvenance<'a> {
    /// What was measured.
    pub title: &'a str,
    /// Where it comes from.
    pub source: &'a str,
    /// The file of the diagnosis, as it was named.
    pub file: &'a str,
    /// The model that explains.
    pub model: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// Seed.
    pub seed: u64,
}

/// All figures; SI units.
#[must_use]
pub fn diagnosis_json(
    provenance: &DiagnosisProvenance<'_>,
    found: &Diagnosis,
    recordings: &Recordings,
    predictor: &dyn Predictor,
) -> String {
    let effects = predictor.effects();
    let keys = |list: &[usize]| list.iter().map(|&k| effects[k].key).collect::<Vec<_>>();
    let finding = &found.finding;
    let named =
        if let ClaimVerdict::Named(named) = &finding.verdict { keys(named) } else { Vec::new() };
    let page = json!({
        "schema_version": DIAGNOSIS_SCHEMA_VERSION,
        "program_version": provenance.version,
        "title": provenance.title,
        "source": provenance.source,
        "file": provenance.file,
        "model": provenance.model,
        "seed": provenance.seed,
        "recordings": recordings.all().len(),
        "noise": recordings.noise().iter().map(|noise| json!({
            "channel": noise.channel.symbol(),
            "deviation": noise.deviation,
            "constant_part": noise.parts[0],
            "share": noise.parts[1],
            "degrees_of_freedom": noise.freedom.is_finite().then_some(noise.freedom),
            "source": match noise.source { NoiseSource::Repeats => "repeats", NoiseSource::Stated => "stated" },
        })).collect::<Vec<_>>(),
        "verdict": finding.verdict.key(),
        "named": named,
        "family": finding.family(),
        "probability_of_nothing_missing": finding.nothing,
        "probability_of_none_of_these": finding.none_of_these,
        "set": keys(&finding.set),
        "set_has_none_of_these": finding.set_has_none,
        "ranking": ranking(found, predictor),
        "share_explained": finding.leading.as_ref().map(|found| found.explained),
        "families": finding.families.iter().map(|(name, p)| json!({ "family": name, "probability": p })).collect::<Vec<_>>(),
        "effects": effects.iter().enumerate().map(|(k, effect)| json!({
            "effect": effect.key,
            "probability": finding.inclusion[k],
            "expected_fall_of_chi_square": found.attribution.expected_gains[k],
            "testable": found.attribution.is_testable(k),
        })).collect::<Vec<_>>(),
        "explanations": found.attribution.scored.iter().map(|scored| json!({
            "explanation": match &scored.hypothesis {
                Hypothesis::Nothing => json!("nothing_missing"),
                Hypothesis::NoneOfThese => json!("none_of_these"),
                Hypothesis::Effects(list) => json!(keys(list)),
            },
            "prior": scored.prior,
            "log_evidence": scored.log_evidence,
            "probability": scored.probability,
        })).collect::<Vec<_>>(),
        "estimates": found.fits.iter().map(|fit| estimates(found, fit, predictor)).collect::<Vec<_>>(),
        "nuisances": nuisances(found, predictor),
        "channels": finding.gates.iter().map(|gate| json!({
            "channel": gate.channel.symbol(),
            "chi_square": gate.chi_square,
            "degrees_of_freedom": gate.freedom,
            "chance": gate.chance,
            "followed": gate.passed,
        })).collect::<Vec<_>>(),
        "bias": found.biases.iter().map(|(channel, bias)| json!({
            "channel": channel.symbol(),
            "amplitude": bias.amplitude,
            "length": bias.length,
            "origin": match bias.origin {
                BiasOrigin::Reference => "reference",
                BiasOrigin::Difference => "difference",
                BiasOrigin::Stated => "stated",
                BiasOrigin::Compared => "comparisons",
                BiasOrigin::AnotherBatch => "another_batch",
            },
        })).collect::<Vec<_>>(),
        "relation_errors": relation_errors(found, predictor),
        "scatter_between_conditions": found.setups.iter().map(|setup| json!({
            "channel": setup.channel.symbol(), "deviation": setup.deviation,
        })).collect::<Vec<_>>(),
        "where": found.location.contrasts.iter().map(|contrast| json!({
            "channel": contrast.channel.symbol(),
            "pattern": contrast.pattern,
            "score": contrast.score,
            "chance": contrast.chance,
            "discovered": contrast.discovered,
        })).collect::<Vec<_>>(),
        "maps": found.location.maps.iter().map(|(channel, points)| json!({
            "channel": channel.symbol(),
            "cutting_speed": points.iter().map(|p| p.cutting_speed).collect::<Vec<_>>(),
            "uncut_chip_thickness": points.iter().map(|p| p.uncut_chip_thickness).collect::<Vec<_>>(),
            "score": points.iter().map(|p| p.score).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "particle_solver": found.rerun.as_ref().map(particle_solver),
        "held_out": found.help.iter().map(held).collect::<Vec<_>>(),
        "false_alarms": found.false_alarms.map(|alarms| rate(alarms, found.asked[0])),
        "positive_control": found.control.as_ref().map(|control| json!({
            "effects": keys(&control.effects),
            "alarms": rate(control.alarms, found.asked[1]),
            "named": rate(control.named, found.asked[1]),
            "in_set": rate(control.in_set, found.asked[1]),
        })),
        "next": found.next.as_ref().map(|next| json!({
            "cuts": next.conditions.iter().map(condition).collect::<Vec<_>>(),
            "expected_probability_of_the_right_one": { "now": next.expected[0], "after": next.expected[1] },
            "with_one_more_channel": next.with_channel.iter().map(|(channel, p)| json!({
                "channel": channel.symbol(), "after": p,
            })).collect::<Vec<_>>(),
        })),
    });
    format!("{page:#}\n")
}

/// A table of forecasts: a line per condition; of each channel the value as simulated, corrected, and the ends of its 95 % interval. SI units
/// but v_c in m/min and h in mm.
#[must_use]
pub fn forecasts_csv(conditions: &[CuttingCondition], forecasts: &[Vec<Forecast>]) -> String {
    let mut text = "v_c [m/min],h [mm]".to_owned();
    for one in forecasts.iter().take(1).flatten() {
        let (name, unit) = (one.channel.symbol(), one.channel.unit());
        for part in ["as_simulated", "corrected", "low", "high"] {
            text += &format!(",{name}_{part} [{unit}]");
        }
    }
    for (condition, own) in conditions.iter().zip(forecasts) {
        let (speed, size) = (condition.cutting_speed, condition.uncut_chip_thickness);
        text += &format!("\n{},{}", significant(speed * 60.0), significant(size * 1e3));
        for one in own {
            let [low, high] = one.interval;
            for value in [one.as_simulated, one.value, low, high] {
                text += &format!(",{}", significant(value));
            }
        }
    }
    text + "\n"
}

/// Six digits, without those of the conversion of units.
fn significant(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Every value that was left out: its line in the table (from 1), what was measured, and what was predicted of it. SI units.
#[must_use]
pub fn held_out_csv(found: &Diagnosis, recordings: &Recordings) -> String {
    let methods: Vec<&str> = found
        .help
        .first()
        .map_or(Vec::new(), |h| h.grey_box.iter().map(|(m, _)| m.key()).collect());
    let mut text = "left_out,line,v_c [m/s],h [m],channel,unit,measured,as_simulated,nuisances_fitted_again,repaired"
        .to_owned();
    methods.iter().for_each(|method| text += &format!(",{method}"));
    text.push('\n');
    for held in &found.help {
        for value in &held.each {
            let recording = &recordings.all()[value.recording];
            let measured = recording.values[value.channel.index()].unwrap_or(f64::NAN);
            let condition = &recording.condition;
            text += &format!(
                "{},{},{:.6},{:.4e},{},{},{measured:.6e}",
                held.part.key(),
                value.recording + 1,
                condition.cutting_speed,
                condition.uncut_chip_thickness,
                value.channel.symbol(),
                value.channel.unit(),
            );
            let shown =
                value.plain.iter().chain(&value.grey_box).map(|error| error.exp() * measured);
            shown.for_each(|prediction| text += &format!(",{prediction:.6e}"));
            // A channel to which nothing is fitted has no regression.
            text += &",".repeat(methods.len() - value.grey_box.len());
            text.push('\n');
        }
    }
    text
}

fn condition(condition: &CuttingCondition) -> Value {
    let mut own = json!({
        "cutting_speed": condition.cutting_speed,
        "uncut_chip_thickness": condition.uncut_chip_thickness,
    });
    let ToolGeometry { rake_angle, edge_radius } = condition.tool;
    for (key, part) in [("rake_angle", rake_angle), ("edge_radius", edge_radius)] {
        if let Some(value) = part {
            own[key] = json!(value);
        }
    }
    own
}

/// The 95 % set, the most probable first.
fn ranking(found: &Diagnosis, predictor: &dyn Predictor) -> Vec<Value> {
    let ranked = found.ranking(predictor).into_iter().enumerate();
    let of = |(k, member): (usize, RankedEffect)| {
        json!({
            "rank": k + 1,
            "effect": member.effect.map_or("none_of_these", |k| predictor.effects()[k].key),
            "probability": member.probability,
            "parameters": parameters(&member.estimates, predictor),
        })
    };
    ranked.map(of).collect()
}

fn relation_errors(found: &Diagnosis, predictor: &dyn Predictor) -> Vec<Value> {
    let of = |error: RelationError| json!({ "relation": error.key, "deviation": error.deviation, "unit": error.unit });
    found.relation_errors(predictor).into_iter().map(of).collect()
}

fn estimates(found: &Diagnosis, fit: &Fit, predictor: &dyn Predictor) -> Value {
    let effects = predictor.effects();
    json!({
        "explanation": fit.effects.iter().map(|&k| effects[k].key).collect::<Vec<_>>(),
        "parameters": parameters(&found.estimates(predictor, fit), predictor),
    })
}

fn parameters(estimates: &[ParameterEstimate], predictor: &dyn Predictor) -> Vec<Value> {
    let of = |estimate: &ParameterEstimate| {
        let effect = &predictor.effects()[estimate.effect];
        let parameter = &effect.parameters[estimate.parameter];
        json!({
            "effect": effect.key,
            "parameter": parameter.key,
            "unit": parameter.unit,
            "value": estimate.value,
            "interval": estimate.interval,
        })
    };
    estimates.iter().map(of).collect()
}

/// The factors on material and friction when nothing is missing, and under the most probable repair.
fn nuisances(found: &Diagnosis, predictor: &dyn Predictor) -> Vec<Value> {
    let factors = |fit: &Fit| found.problem.nuisances(&fit.unknowns, 0);
    let (null, repaired) = (factors(&found.null), found.repair.map(|k| factors(&found.fits[k])));
    predictor
        .nuisances()
        .iter()
        .enumerate()
        .map(|(k, nuisance)| {
            json!({
                "quantity": nuisance.key,
                "prior": nuisance.deviation,
                "factor_when_nothing_is_missing": (null[k].exp()),
                "factor_with_the_repair": repaired.as_ref().map(|all| all[k].exp()),
            })
        })
        .collect()
}

fn particle_solver(rerun: &Rerun) -> Value {
    let of = |one: &RerunChannel| {
        json!({
            "channel": one.channel.symbol(),
            "values": one.values,
            "as_simulated": one.errors[0],
            "fitted_again": one.errors[1],
            "repaired": one.errors[2],
            "ratio": one.ratio[0],
            "ratio_interval": [one.ratio[1], one.ratio[2]],
        })
    };
    json!({
        "conditions": rerun.conditions,
        "channels": rerun.channels.iter().map(of).collect::<Vec<_>>(),
    })
}

fn rate(rate: Rate, asked: usize) -> Value {
    json!({ "asked": asked, "hits": rate.hits, "trials": rate.trials, "interval": rate.interval() })
}

fn held(held: &HeldOutErrors) -> Value {
    json!({
        "part": held.part.key(),
        "values": held.values,
        "before": held.before,
        "nuisances_fitted_again": held.refitted,
        "repaired": held.repaired,
        "ratio": held.ratio[0],
        "ratio_interval": [held.ratio[1], held.ratio[2]],
        "competitors": held.competitors.iter().map(|(competitor, ratio)| json!({
            "competitor": match competitor {
                Competitor::RunnerUp => "runner_up",
                Competitor::Regression(method) => method.key(),
            },
            "ratio": ratio[0],
            "ratio_interval": [ratio[1], ratio[2]],
        })).collect::<Vec<_>>(),
        "improves": held.improves(),
        "channels": held.channels.iter().map(|(channel, [refitted, repaired])| json!({
            "channel": channel.symbol(), "nuisances_fitted_again": refitted, "repaired": repaired,
        })).collect::<Vec<_>>(),
        "grey_box": held.grey_box.iter().map(|(method, error)| json!({
            "method": method.key(), "error": error,
        })).collect::<Vec<_>>(),
    })
}
