//! Tests of the material beside the cuts: what `sphcut identify` found of its constants.

use crate::NORMAL_95;
use crate::constants::{FreeConstant, PublishedSet, turned};
use serde_json::Value;
use std::path::Path;
use toml::Table;

/// Share of the general spread that remains between tests and cuts of one material: tests end at strains and rates a tenth to a
/// hundredth of those of a cut, and the law is not exact in between.
const EXTRAPOLATION: f64 = 0.5;
/// The file with the constants and that with their intervals.
const FILES: [&str; 2] = ["johnson_cook.toml", "identification.json"];

/// Constants of Johnson and Cook's law from tests, at the reference rate of a scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialTests {
    /// A, B, n, C, m.
    values: [f64; 5],
    /// Standard deviation of the logarithm of each; infinite where the tests do not tell it.
    deviations: [f64; 5],
}

/// Keys of the constants, in their order.
const KEYS: [&str; 5] = [
    "initial_yield",
    "hardening_modulus",
    "hardening_exponent",
    "rate_coefficient",
    "softening_exponent",
];

impl MaterialTests {
    /// From the folder that `sphcut identify` has written, turned to the reference rate `rate` in 1/s.
    ///
    /// # Errors
    /// A file that is missing or is not one of an identification, in words.
    pub fn read(folder: &Path, rate: f64) -> Result<Self, String> {
        let text = |name: &str| {
            let path = folder.join(name);
            std::fs::read_to_string(&path).map_err(|error| format!("`{}`: {error}", path.display()))
        };
        let [material, numbers] = FILES;
        Self::parse(&text(material)?, &text(numbers)?, rate)
            .ok_or_else(|| format!("`{}` is no folder of `sphcut identify`", folder.display()))
    }

    fn parse(material: &str, numbers: &str, rate: f64) -> Option<Self> {
        let material: Table = material.parse().ok()?;
        let law = material.get("flow_stress")?.as_table()?;
        let own_rate = law.get("reference_rate")?.as_str()?.strip_suffix(" 1/s")?.parse().ok()?;
        let numbers: Value = serde_json::from_str(numbers).ok()?;
        let fit = numbers["fits"].as_array()?.iter().find(|fit| fit["law"] == "johnson_cook")?;
        let (mut values, mut deviations) = ([0.0; 5], [f64::INFINITY; 5]);
        for (k, key) in KEYS.into_iter().enumerate() {
            let found = &fit["parameters"][key];
            values[k] = found["value"].as_f64()?;
            let half = found["ci95"].as_f64().filter(|_| found["at_limit"] != true);
            if let (Some(half), true) = (half, values[k] > 0.0) {
                deviations[k] = half / (NORMAL_95 * values[k]);
            }
        }
        Some(Self { values: turned(values, own_rate, rate), deviations })
    }

    /// The priors of `constants` with what the tests say of them:
    ///
    /// ```text
    /// 1/s'^2 = 1/s^2 + 1/(s_t^2 + (s_0/2)^2);   mean' = s'^2 (mean/s^2 + ln x_t/(s_t^2 + (s_0/2)^2))
    /// ```
    ///
    /// s, mean: the prior from published sets; s_t: deviation of the tests; s_0: general spread of published constants, half of which remains
    /// between tests and cuts of one material. Correlations between constants of the tests, which are small beside that half, are not kept.
    pub fn join(&self, constants: &mut [FreeConstant]) {
        for constant in constants.iter_mut().filter(|constant| constant.effect.is_none()) {
            let Some(k) = KEYS.iter().position(|key| *key == constant.rule.key) else { continue };
            if !self.deviations[k].is_finite() {
                continue;
            }
            let of_tests =
                self.deviations[k].powi(2) + (EXTRAPOLATION * constant.rule.spread()).powi(2);
            let of_sets = constant.deviation.powi(2);
            let variance = 1.0 / (1.0 / of_sets + 1.0 / of_tests);
            constant.mean = variance * (constant.mean / of_sets + self.values[k].ln() / of_tests);
            constant.deviation = variance.sqrt();
            constant.is_tested = true;
        }
    }

    /// As a set beside those that were published.
    #[must_use]
    pub fn as_set(&self, name: &str) -> PublishedSet {
        let source = "sphcut identify: tests of this material".to_owned();
        PublishedSet { name: name.to_owned(), source, values: self.values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::CONSTANTS;

    const MATERIAL: &str = "[flow_stress]\nreference_rate = \"0.004 1/s\"\n";

    fn numbers(ci95: &str) -> String {
        let one = |key: &str, value: f64, ci95: &str| {
            format!("\"{key}\": {{ \"value\": {value}, \"ci95\": {ci95}, \"at_limit\": false }}")
        };
        let parts = [
            one("initial_yield", 4e8, "1.568e7"),
            one("hardening_modulus", 6e8, "1e7"),
            one("hardening_exponent", 0.25, ci95),
            one("rate_coefficient", 0.02, "1e-3"),
            one("softening_exponent", 1.1, "1e-2"),
        ];
        format!(
            "{{ \"fits\": [{{ \"law\": \"johnson_cook\", \"parameters\": {{ {} }} }}] }}",
            parts.join(", ")
        )
    }

    fn constant(k: usize, stated: f64) -> FreeConstant {
        let (mean, deviation) = (stated.ln(), 0.3);
        FreeConstant {
            rule: CONSTANTS[k],
            stated,
            mean,
            deviation,
            sets: 2,
            effect: None,
            is_tested: false,
        }
    }

    #[test]
    fn a_prior_is_joined_with_tests_by_precision() {
        let tests = MaterialTests::parse(MATERIAL, &numbers("null"), 4e-3).unwrap();
        let mut constants = vec![constant(0, 5e8), constant(2, 0.2), constant(5, 0.3)];
        let before = constants.clone();
        tests.join(&mut constants);
        // Deviation of ln A: 1.568e7 / (1.96 * 4e8) = 0.02; with half of 0.25: 0.0004 + 0.015625 = 0.016025.
        // 1/0.09 + 1/0.016025 = 73.514: deviation 0.116631; mean by 62.403 / 73.514 of the way from ln 5e8 to ln 4e8.
        assert!((constants[0].deviation - 0.116_631).abs() < 1e-6, "{}", constants[0].deviation);
        let mean = 5e8_f64.ln() + 62.403 / 73.514 * (4.0_f64 / 5.0).ln();
        assert!((constants[0].mean - mean).abs() < 1e-5);
        assert!(constants[0].is_tested);
        assert_eq!(constants[1..], before[1..], "not told by the tests, and no constant of theirs");
    }

    #[test]
    fn constants_of_tests_are_turned_to_the_reference_rate_of_the_scenario() {
        let at = |rate: f64| MaterialTests::parse(MATERIAL, &numbers("0.01"), rate).unwrap().values;
        let stress = |[a, _, _, c, _]: [f64; 5], rate: f64| a * (1.0 + c * (1e4_f64 / rate).ln());
        assert!((stress(at(1.0), 1.0) / stress(at(4e-3), 4e-3) - 1.0).abs() < 1e-12);
        assert!(at(1.0)[0] > 4e8);
    }

    #[test]
    fn a_folder_of_something_else_is_told() {
        assert_eq!(MaterialTests::parse("title = \"x\"", "{}", 1.0), None);
        let message = MaterialTests::read(Path::new("nowhere"), 1.0).unwrap_err();
        assert!(message.contains("johnson_cook.toml"), "{message}");
    }
}
