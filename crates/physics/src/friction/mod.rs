//! Friction laws: the largest shear stress or force that contact can transmit.
//!
//! A law is one file; [`LAWS`] is the only registration.

mod coulomb;
mod shear_capped_coulomb;
mod speed_dependent;
mod temperature_dependent;
mod usui;

pub use coulomb::Coulomb;
pub use shear_capped_coulomb::ShearCappedCoulomb;
pub use speed_dependent::SpeedDependent;
pub use temperature_dependent::TemperatureDependent;
pub use usui::Usui;

use crate::{Parameter, Values};
use std::fmt::Debug;

/// The state of a contact on which a friction limit depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Contact pressure in Pa, never negative.
    pub pressure: f64,
    /// Flow stress of the workpiece at the contact in Pa.
    pub flow_stress: f64,
    /// Magnitude of the sliding velocity in m/s.
    pub sliding_speed: f64,
    /// Temperature of the workpiece at the contact in K.
    pub temperature: f64,
}

/// A friction law: a pure function of the contact state.
pub trait FrictionLaw: Debug + Send + Sync {
    /// Largest tangential stress in Pa; never negative. Below it the contact sticks.
    fn shear_limit(&self, state: &ContactState) -> f64;
}

/// One law of the catalogue.
#[derive(Debug)]
pub struct FrictionEntry {
    /// Name in the scenario file.
    pub key: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The equation in one line of text.
    pub equation: &'static str,
    /// Where the law comes from.
    pub source: &'static str,
    /// Where it holds and what it neglects.
    pub validity: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Builds the law from checked values of `parameters`.
    pub build: fn(&Values) -> Box<dyn FrictionLaw>,
}

/// All friction laws.
pub const LAWS: &[&FrictionEntry] = &[
    &coulomb::ENTRY,
    &shear_capped_coulomb::ENTRY,
    &speed_dependent::ENTRY,
    &temperature_dependent::ENTRY,
    &usui::ENTRY,
];

/// The law named `key`, if there is one.
#[must_use]
pub fn find(key: &str) -> Option<&'static FrictionEntry> {
    LAWS.iter().copied().find(|law| law.key == key)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners and inner points of the ranges of a law's parameters.
    fn choices(law: &FrictionEntry) -> Vec<Values> {
        let mut choices: Vec<Vec<(&str, f64)>> = vec![Vec::new()];
        for parameter in law.parameters {
            let (min, max) = (parameter.range.min, parameter.range.max);
            let lowest = if parameter.range.min_excluded { 1e-6 * max } else { min };
            let points = [lowest, 0.5 * (min + max), max];
            choices = choices
                .iter()
                .flat_map(|one| points.map(|value| [&one[..], &[(parameter.key, value)]].concat()))
                .collect();
        }
        choices.iter().map(|given| Values::resolve(law.parameters, given).unwrap()).collect()
    }

    fn states() -> Vec<ContactState> {
        let mut states = Vec::new();
        for pressure in [0.0, 1.0, 1e8, 1e10] {
            for flow_stress in [0.0, 1e6, 1e9, f64::INFINITY] {
                for sliding_speed in [0.0, 1e-6, 1.0, 1e4] {
                    for temperature in [1e-3, 300.0, 1836.0, 2000.0, 1e4] {
                        states.push(ContactState {
                            pressure,
                            flow_stress,
                            sliding_speed,
                            temperature,
                        });
                    }
                }
            }
        }
        states
    }

    /// Friction never gives energy back and never pulls: the limit is finite and not negative, zero
    /// without pressure, and never above `mu p` with the coefficient at rest in the cold.
    #[test]
    fn every_law_dissipates_and_needs_pressure() {
        for law in LAWS {
            for values in choices(law) {
                let built = (law.build)(&values);
                let most = values.get("friction_coefficient");
                for state in states() {
                    let limit = built.shear_limit(&state);
                    assert!(limit.is_finite() && limit >= 0.0, "{}: {limit} {state:?}", law.key);
                    let coulomb = most * state.pressure * (1.0 + 1e-12);
                    assert!(limit <= coulomb, "{}: {limit} for {state:?}", law.key);
                }
            }
        }
    }

    /// Only Coulomb's own law may exceed the shear strength of the chip.
    #[test]
    fn every_capped_law_keeps_below_the_shear_strength() {
        for law in LAWS.iter().filter(|law| law.key != "coulomb") {
            for values in choices(law) {
                let built = (law.build)(&values);
                for state in states() {
                    let cap =
                        values.get("shear_friction_factor") * state.flow_stress / 3.0_f64.sqrt();
                    assert!(built.shear_limit(&state) <= cap * (1.0 + 1e-12), "{}", law.key);
                }
            }
        }
    }
}
