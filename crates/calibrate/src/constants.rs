//! Which constants may be fitted, and what is known of each before a cut is made.

use crate::NORMAL_95;
use sphcut_diagnose::{Change, closed_form_cut, effect_strengths};
use sphcut_input::Problem;
use sphcut_physics::PUBLISHED_SPREAD;
use sphcut_scenario::{KeyPath, LoadOptions, Scenario, parse, shipped_materials};
use std::path::Path;
use toml::Table;

/// A constant that can be fitted, with what is known of it where nothing is published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantRule {
    /// As in scenarios.
    pub key: &'static str,
    /// As in `--fit`.
    pub symbol: &'static str,
    /// What SI values are multiplied with for people, and the unit then.
    pub shown: (f64, &'static str),
    /// Standard deviation of its logarithm between published sets of one material.
    spread: f64,
    /// Beyond these no run is made.
    limits: [f64; 2],
    /// Whether it is fitted where nobody says what to fit.
    pub usual: bool,
}

impl ConstantRule {
    /// Standard deviation of its logarithm between published sets of one material.
    #[must_use]
    pub const fn spread(&self) -> f64 {
        self.spread
    }
}

const fn rule(
    (key, symbol): (&'static str, &'static str),
    shown: (f64, &'static str),
    spread: f64,
    limits: [f64; 2],
    usual: bool,
) -> ConstantRule {
    ConstantRule { key, symbol, shown, spread, limits, usual }
}

const fn spread(of: usize) -> f64 {
    PUBLISHED_SPREAD[of].1
}

/// All that can be fitted. The spread of the edge is what grinding and preparation leave.
pub const CONSTANTS: [ConstantRule; 8] = [
    rule(("initial_yield", "A"), (1e-6, "MPa"), spread(0), [1e7, 5e9], true),
    rule(("hardening_modulus", "B"), (1e-6, "MPa"), spread(1), [1e6, 5e9], true),
    rule(("hardening_exponent", "n"), (1.0, ""), spread(2), [0.01, 0.99], true),
    rule(("rate_coefficient", "C"), (1.0, ""), spread(3), [1e-4, 0.5], true),
    rule(("softening_exponent", "m"), (1.0, ""), spread(4), [0.2, 4.0], true),
    rule(("friction_coefficient", "mu"), (1.0, ""), spread(5), [0.01, 2.0], true),
    rule(("shear_friction_factor", "m_s"), (1.0, ""), 0.3, [0.05, 1.0], false),
    rule(("edge_radius", "r_n"), (1e6, "um"), 0.4, [1e-6, 5e-4], false),
];

/// How much the general spread counts beside that of the sets that were found, in sets.
const WORTH: f64 = 3.0;

/// A published set of constants of the material.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedSet {
    /// Name in the library.
    pub name: String,
    /// Where it was published.
    pub source: String,
    /// A, B, n, C, m, at the reference rate of the scenario's own set.
    pub values: [f64; 5],
}

/// A constant to be fitted: its logarithm is known as a normal law.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeConstant {
    /// Which.
    pub rule: ConstantRule,
    /// Its value in the scenario.
    pub stated: f64,
    /// Mean of the logarithm.
    pub mean: f64,
    /// Standard deviation of the logarithm.
    pub deviation: f64,
    /// In how many published sets it was found; 0: only the general spread.
    pub sets: usize,
    /// Whether tests of the material have told of it, too.
    pub is_tested: bool,
    /// The effect whose strength it is, and what is missing without it.
    pub effect: Option<(&'static str, &'static str)>,
}

impl FreeConstant {
    /// The value at a coordinate: standard deviations of the prior from its mean.
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        let [low, high] = self.rule.limits;
        (self.mean + self.deviation * t).exp().clamp(low, high)
    }

    /// The coordinate of a value.
    #[must_use]
    pub fn coordinate(&self, value: f64) -> f64 {
        (value.ln() - self.mean) / self.deviation
    }

    /// The logarithm of the value at a coordinate over that of the scenario.
    #[must_use]
    pub fn log_factor(&self, t: f64) -> f64 {
        (self.value(t) / self.stated).ln()
    }

    /// A change of the scenario to values of constants at coordinates.
    #[must_use]
    pub fn change(constants: &[Self], t: &[f64]) -> Change {
        let mut change = Change::default();
        for (constant, &t) in constants.iter().zip(t) {
            match constant.effect {
                Some((key, _)) => change.effects.push((key, vec![constant.value(t)])),
                None => change.nuisances.push((constant.rule.key, constant.log_factor(t))),
            }
        }
        change
    }

    /// The ends of an interval of so many standard deviations about a coordinate.
    #[must_use]
    pub fn interval(&self, t: f64, half_width: f64) -> [f64; 2] {
        [self.value(t - half_width), self.value(t + half_width)]
    }
}

/// Why constants cannot be fitted.
#[derive(Debug, Clone, PartialEq)]
pub enum ConstantError {
    /// A name that is none.
    Unknown(String),
    /// The scenario has no such constant, or it is 0.
    Absent(&'static str),
    /// An effect that has not the strength of one positive number, or none.
    Effect(String),
    /// Nothing to be fitted.
    Nothing,
    /// The scenario cannot be taken.
    Scenario(String),
}

impl std::fmt::Display for ConstantError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unknown(name) => {
                let all = CONSTANTS.map(|rule| rule.symbol).join(", ");
                write!(f, "`{name}` is no constant that can be fitted; there are {all}")
            }
            Self::Absent(symbol) => write!(f, "the scenario has no {symbol} that could be fitted"),
            Self::Effect(name) => {
                let all: Vec<&str> = effect_strengths().iter().map(|effect| effect.key).collect();
                write!(f, "`{name}` is no effect that can be fitted; there are {}", all.join(", "))
            }
            Self::Nothing => write!(f, "no constant is to be fitted"),
            Self::Scenario(what) => write!(f, "{what}"),
        }
    }
}

impl std::error::Error for ConstantError {}

/// The constants to be fitted, by symbols or keys (the usual ones if there are none), with their priors.
///
/// ```text
/// ln x ~ N(mean, s^2 (1 + 1/k)),   s^2 = (3 s_0^2 + sum (ln x_i - mean)^2) / (3 + k - 1)
/// ```
///
/// over k published sets, each source once; s_0 is the spread of [`ConstantRule`]. With one set, and for friction and edge, it is
/// s_0 about the value of the scenario. Sets differ in their reference rates: A, B and C are turned to that of the scenario's set, which
/// is exact; reference and melting temperatures stay those of the scenario.
///
/// # Errors
/// See [`ConstantError`].
pub fn free_constants(
    scenario: &Scenario,
    wanted: &[String],
    sets: &[PublishedSet],
) -> Result<Vec<FreeConstant>, ConstantError> {
    let mut rules = Vec::new();
    for name in wanted {
        let found = CONSTANTS.iter().find(|rule| rule.symbol == name || rule.key == name);
        let found = *found.ok_or_else(|| ConstantError::Unknown(name.clone()))?;
        if !rules.contains(&found) {
            rules.push(found);
        }
    }
    if wanted.is_empty() {
        rules.extend(CONSTANTS.iter().filter(|rule| rule.usual));
    }
    if rules.is_empty() {
        return Err(ConstantError::Nothing);
    }
    let cut = closed_form_cut(scenario).map_err(|e| ConstantError::Scenario(e.to_string()))?;
    let law = |key: &str| scenario.setup.materials[0].flow_stress_values.get(key);
    let of = |rule: ConstantRule| {
        let place = CONSTANTS.iter().position(|own| own.key == rule.key).unwrap_or(0);
        let stated = match rule.key {
            "friction_coefficient" => cut.friction_coefficient,
            "shear_friction_factor" => cut.shear_friction_factor,
            "edge_radius" => cut.tool.edge_radius,
            key => law(key),
        };
        if stated.is_nan() || stated <= 0.0 {
            return Err(ConstantError::Absent(rule.symbol));
        }
        let logs: Vec<f64> = if place < 5 {
            sets.iter().map(|set| set.values[place].ln()).filter(|x| x.is_finite()).collect()
        } else {
            Vec::new()
        };
        let k = logs.len() as f64;
        let (mean, deviation) = if logs.len() < 2 {
            (stated.ln(), rule.spread)
        } else {
            let mean = logs.iter().sum::<f64>() / k;
            let sum: f64 = logs.iter().map(|x| (x - mean).powi(2)).sum();
            let variance = (WORTH * rule.spread.powi(2) + sum) / (WORTH + k - 1.0);
            (mean, (variance * (1.0 + 1.0 / k)).sqrt())
        };
        let sets = if logs.len() < 2 { 0 } else { logs.len() };
        Ok(FreeConstant { rule, stated, mean, deviation, sets, is_tested: false, effect: None })
    };
    rules.into_iter().map(of).collect()
}

/// The strengths of effects as constants: 95 % of the prior lie where the catalogue looks for them, evenly about the middle in the logarithm; in the
/// scenario, which lacks them, they are at the end at which they act least.
///
/// # Errors
/// A name that is no effect with one positive strength and runs of the particle solver.
pub fn effect_constants(names: &[String]) -> Result<Vec<FreeConstant>, ConstantError> {
    let known = effect_strengths();
    let of = |name: &String| {
        let effect = known.iter().find(|effect| effect.key == name);
        let effect = effect.ok_or_else(|| ConstantError::Effect(name.clone()))?;
        let [low, high] = effect.prior;
        let deviation = (high / low).ln() / (2.0 * NORMAL_95);
        let rule = ConstantRule {
            key: effect.parameter,
            symbol: effect.parameter,
            shown: (1.0, effect.unit),
            spread: deviation,
            limits: effect.prior,
            usual: false,
        };
        let mean = 0.5 * (low * high).ln();
        let effect_of = Some((effect.key, effect.title));
        Ok(FreeConstant {
            rule,
            stated: effect.weakest,
            mean,
            deviation,
            sets: 0,
            is_tested: false,
            effect: effect_of,
        })
    };
    names.iter().map(of).collect()
}

/// The published sets of the library for the material of `scenario`, whose name begins with `family` (up to the first `_` of the
/// scenario's material where it is not given), with the law of the scenario; sets with the same constants are one source.
#[must_use]
pub fn published_sets(
    (scenario, path): (&Scenario, &Path),
    family: Option<&str>,
    options: &LoadOptions,
) -> Vec<PublishedSet> {
    let table: Table = scenario.text.parse().unwrap_or_default();
    let workpiece = table.get("workpiece").and_then(toml::Value::as_table);
    let named = workpiece.and_then(|own| own.get("material")).and_then(toml::Value::as_str);
    let own = named.and_then(|name| name.split('_').next());
    let Some(family) = family.or(own.filter(|name| !name.ends_with(".toml"))) else {
        return Vec::new();
    };
    let law = scenario.setup.materials[0].flow_stress.key;
    let rate = scenario.setup.materials[0].flow_stress_values.get("reference_rate");
    let mut found: Vec<PublishedSet> = Vec::new();
    let members = shipped_materials().iter().filter(|(name, _)| {
        name.strip_prefix(family).is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    });
    for (name, text) in members {
        let Ok(other) = with_material(scenario, path, name, options) else { continue };
        let material = &other.setup.materials[0];
        if material.flow_stress.key != law {
            continue;
        }
        let of = |key: &str| material.flow_stress_values.get(key);
        let values = [
            of("initial_yield"),
            of("hardening_modulus"),
            of("hardening_exponent"),
            of("rate_coefficient"),
            of("softening_exponent"),
        ];
        let values = turned(values, of("reference_rate"), rate);
        let sources: Option<Table> = text.parse::<Table>().ok();
        let sources = sources.as_ref().and_then(|t| t.get("sources")?.as_table());
        let source = sources.and_then(|own| own.get("flow_stress")?.as_str()).unwrap_or_default();
        if !found.iter().any(|set| set.values == values) {
            found.push(PublishedSet {
                name: (*name).to_owned(),
                source: source.to_owned(),
                values,
            });
        }
    }
    found
}

/// A, B, n, C, m at the reference rate `to` instead of `from`: the same law.
///
/// ```text
/// (1 + C ln(r/r1)) = (1 + C ln(r0/r1)) (1 + C' ln(r/r0)),   C' = C / (1 + C ln(r0/r1))
/// ```
pub(crate) fn turned([a, b, n, c, m]: [f64; 5], from: f64, to: f64) -> [f64; 5] {
    let factor = 1.0 + c * (to / from).ln();
    [a * factor, b * factor, n, c / factor, m]
}

/// The scenario with another material of the library and nothing overridden.
fn with_material(
    scenario: &Scenario,
    path: &Path,
    name: &str,
    options: &LoadOptions,
) -> Result<Scenario, Vec<Problem>> {
    let written = |key: &str, literal: &str, text: &str| {
        let key = KeyPath::parse(key).expect("names with a dot");
        key.written(text, literal).unwrap_or_else(|_| text.to_owned())
    };
    let text = written("workpiece.material", &format!("{name:?}"), &scenario.text);
    let text = written("workpiece.override", "{}", &text);
    let options = LoadOptions { patch: None, ..options.clone() };
    parse(&text, name, path.parent(), &options)
}
