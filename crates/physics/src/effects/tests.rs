//! Tests over all effects of the catalogue.

use super::*;
use crate::flow_stress::{self, JohnsonCook};
use crate::radial_return::TrialState;

/// AISI 1045 normalized: A 331 MPa, B 614 MPa, n 0.26, C 0.07, m 1.19.
pub(super) const STEEL: JohnsonCook = JohnsonCook {
    initial_yield: 331e6,
    hardening_modulus: 614e6,
    hardening_exponent: 0.26,
    rate_coefficient: 0.07,
    softening_exponent: 1.19,
    reference_rate: 1.0,
    reference_temperature: 293.15,
    melting_temperature: 1733.0,
};

const CUT: EffectContext = EffectContext { uncut_chip_thickness: Some(0.1e-3) };

/// The steel with one effect; `given` replaces values of its example.
pub(super) fn on(entry: &'static EffectEntry, given: &[(&str, f64)]) -> Box<dyn FlowStressModel> {
    with_effects(Box::new(STEEL), &[chosen(entry, given)], &CUT)
}

fn chosen(entry: &'static EffectEntry, given: &[(&str, f64)]) -> ChosenEffect {
    // The last of two values of the same key counts.
    let all: Vec<(&str, f64)> = entry.example.iter().chain(given).copied().collect();
    ChosenEffect { entry, values: Values::resolve(entry.parameters, &all).unwrap() }
}

fn on_flow_stress() -> impl Iterator<Item = &'static EffectEntry> {
    EFFECTS.iter().copied().filter(|entry| matches!(entry.action, Action::FlowStress(_)))
}

/// States of cutting, from the undeformed material to the chip at the tool.
fn states() -> Vec<FlowState> {
    let mut states = Vec::new();
    for plastic_strain in [0.0, 1e-3, 0.2, 1.0, 3.0] {
        for plastic_strain_rate in [0.0, 0.3, 1e2, 3e4, 2e6] {
            for temperature in [250.0, 293.15, 500.0, 800.0, 1300.0, 1732.0] {
                states.push(FlowState { plastic_strain, plastic_strain_rate, temperature });
            }
        }
    }
    states
}

#[test]
fn the_example_gives_what_has_no_default_and_says_what_is_seen() {
    for entry in EFFECTS {
        assert!(!entry.signature.is_empty(), "{}", entry.key);
        for parameter in entry.parameters {
            let given = entry.example.iter().any(|(key, _)| *key == parameter.key);
            assert!(given || parameter.default.is_some(), "{}: {}", entry.key, parameter.key);
        }
        chosen(entry, &[]);
        chosen(entry, entry.vanishing);
        assert!(!entry.vanishing.is_empty(), "{}", entry.key);
    }
}

#[test]
fn a_vanishing_effect_leaves_every_bit_of_the_base_law() {
    let change = FlowState { plastic_strain: 1e-4, plastic_strain_rate: 2e3, temperature: 0.7 };
    for entry in on_flow_stress() {
        let law = on(entry, entry.vanishing);
        for state in states() {
            assert_eq!(law.flow_stress(&state), STEEL.flow_stress(&state), "{}", entry.key);
            let (slope, base) =
                (law.flow_stress_along(&state, &change), STEEL.flow_stress_along(&state, &change));
            assert_eq!(slope, base, "{} {state:?}", entry.key);
        }
    }
}

#[test]
fn an_effect_that_acts_is_seen_and_stays_finite() {
    for entry in on_flow_stress() {
        let law = on(entry, &[]);
        let mut largest = 0.0_f64;
        for state in states() {
            let (stress, base) = (law.flow_stress(&state), STEEL.flow_stress(&state));
            assert!(stress.is_finite() && stress >= 0.0, "{} {state:?}", entry.key);
            largest = largest.max((stress / base - 1.0).abs());
        }
        assert!(largest > 0.01, "{}: {largest}", entry.key);
    }
}

#[test]
fn the_slope_is_that_of_the_flow_stress() {
    for entry in on_flow_stress() {
        let law = on(entry, &[]);
        let flowing =
            |state: &FlowState| state.plastic_strain > 0.0 && state.plastic_strain_rate > 0.0;
        // Away from the clamps of the base law, where it has a kink.
        let smooth = |state: &FlowState| state.temperature > 294.0 && state.temperature < 1700.0;
        for state in states().into_iter().filter(|state| flowing(state) && smooth(state)) {
            let change = FlowState {
                plastic_strain: 0.3 * state.plastic_strain,
                plastic_strain_rate: 0.7 * state.plastic_strain_rate,
                temperature: 20.0,
            };
            let moved = |share: f64| {
                law.flow_stress(&FlowState {
                    plastic_strain: state.plastic_strain + share * change.plastic_strain,
                    plastic_strain_rate: state.plastic_strain_rate
                        + share * change.plastic_strain_rate,
                    temperature: state.temperature + share * change.temperature,
                })
            };
            let (stress, slope) = law.flow_stress_along(&state, &change);
            assert_eq!(stress, moved(0.0), "{} {state:?}", entry.key);
            // Central difference of a function rounded to 1e-16: 1e-16/1e-5 of the stress, and
            // (1e-5)^2 of its third derivative.
            let quotient = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!(
                (slope - quotient).abs() < 1e-8 * stress,
                "{} {state:?}: {slope} {quotient}",
                entry.key
            );
        }
    }
}

#[test]
fn the_return_ends_on_the_changed_yield_surface() {
    for entry in on_flow_stress() {
        let law = on(entry, &[]);
        for time_step in [1e-11, 1e-9, 1e-6] {
            for (overshoot, temperature) in [(1.01, 300.0), (1.5, 700.0), (3.0, 1200.0)] {
                let limit = law.elastic_limit(0.3, temperature);
                let trial = TrialState {
                    equivalent_stress: limit * overshoot,
                    plastic_strain: 0.3,
                    temperature,
                    shear_modulus: 80e9,
                    time_step,
                    heating: 0.9 / (7850.0 * 480.0),
                    expected_increment: 0.0,
                };
                let returned = law.radial_return(&trial);
                let increment = returned.plastic_increment;
                let on_surface = law.flow_stress(&FlowState {
                    plastic_strain: 0.3 + increment,
                    plastic_strain_rate: increment / time_step,
                    temperature: temperature + trial.heating * returned.flow_stress * increment,
                });
                // 1e-10 of the increment, in a stress that changes by 3 G d with it.
                let error = (returned.flow_stress - on_surface).abs();
                assert!(error < 1e-8 * limit, "{} {trial:?}: {error}", entry.key);
            }
        }
    }
}

#[test]
fn a_material_that_never_yields_goes_on_so() {
    for entry in on_flow_stress() {
        let elastic = flow_stress::find("elastic").unwrap();
        let base = (elastic.build)(&Values::defaults(elastic.parameters));
        let law = with_effects(base, &[chosen(entry, &[])], &CUT);
        assert_eq!(law.elastic_limit(0.0, 300.0), f64::INFINITY, "{}", entry.key);
    }
}

#[test]
fn effects_act_together() {
    let all: Vec<ChosenEffect> = on_flow_stress().map(|entry| chosen(entry, &[])).collect();
    let law = with_effects(Box::new(STEEL), &all, &CUT);
    let state = FlowState { plastic_strain: 0.4, plastic_strain_rate: 2e5, temperature: 700.0 };
    let none = with_effects(Box::new(STEEL), &[], &CUT);
    assert_eq!(none.flow_stress(&state), STEEL.flow_stress(&state));
    assert!(law.flow_stress(&state) != none.flow_stress(&state));
}
