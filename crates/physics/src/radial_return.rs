//! Radial return of a von Mises stress to the yield surface, implicit in strain,
//! strain rate and temperature.
//!
//! With the trial equivalent stress `q`, the plastic increment `d` solves
//! ```text
//! g(d) = q - 3 G d - sigma_y(eps_p + d, d / dt, T + beta sigma_y d / (rho cp)) = 0
//! ```
//! (Simo and Hughes, Computational Inelasticity, 1998, chapter 3; adiabatic
//! heating within the step). `g` is positive at `d = 0` and not positive at
//! `d = q / 3G`, so a bracketed search always ends, whatever the law and the
//! time step. In flowing material the increments of two steps differ little: the
//! search starts from the one expected.

use crate::flow_stress::{FlowState, FlowStressLaw};

/// What a return needs to know of one material point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialState {
    /// Trial equivalent (von Mises) stress q in Pa.
    pub equivalent_stress: f64,
    /// Equivalent plastic strain at the start of the step.
    pub plastic_strain: f64,
    /// Temperature at the start of the step in K.
    pub temperature: f64,
    /// Shear modulus G in Pa.
    pub shear_modulus: f64,
    /// Time step in s.
    pub time_step: f64,
    /// beta / (rho cp): temperature rise per plastic work in K m^3/J; 0 switches the coupling off.
    pub heating: f64,
    /// Where the search starts: the plastic increment expected, or 0. Does not change the result
    /// beyond the search's tolerance.
    pub expected_increment: f64,
}

/// The state after the return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Returned {
    /// Increment of the equivalent plastic strain.
    pub plastic_increment: f64,
    /// Flow stress at the end of the step in Pa; the equivalent stress equals it after a plastic step.
    pub flow_stress: f64,
}

/// The radial return, compiled once for each law.
pub trait RadialReturn {
    /// Flow stress without plastic flow, below which a step is elastic, in Pa.
    fn elastic_limit(&self, plastic_strain: f64, temperature: f64) -> f64;
    /// Returns `trial` to the yield surface.
    fn radial_return(&self, trial: &TrialState) -> Returned;
}

/// Largest relative error of the increment at which the search ends.
const TOLERANCE: f64 = 1e-10;
/// The bracket is halved at least every fourth time, and 34 halvings leave 1e-10 of it.
const MAX_ITERATIONS: usize = 160;

impl<Law: FlowStressLaw> RadialReturn for Law {
    #[inline]
    fn elastic_limit(&self, plastic_strain: f64, temperature: f64) -> f64 {
        self.flow_stress(&FlowState { plastic_strain, plastic_strain_rate: 0.0, temperature })
    }

    fn radial_return(&self, trial: &TrialState) -> Returned {
        let limit = self.elastic_limit(trial.plastic_strain, trial.temperature);
        if trial.equivalent_stress <= limit {
            return Returned { plastic_increment: 0.0, flow_stress: limit };
        }
        let increment = plastic_increment(self, trial, limit);
        Returned {
            plastic_increment: increment,
            flow_stress: (trial.equivalent_stress - 3.0 * trial.shear_modulus * increment).max(0.0),
        }
    }
}

/// The root of `g` in `[0, q / 3G]` by Newton's method inside a bracket, for a trial stress above
/// `limit`, the flow stress without flow.
///
/// With `s = d(sigma_y) / d(ln d)` a step is `d (1 + r)`, `r = g / (3 G d + s)`, and `d exp(r)`
/// where `s > 3 G d`: the rate term, a logarithm, makes `g` straight in `ln d` there. Where a step
/// leaves the bracket and every fourth time it is halved instead. Newton's error after a step is
/// at most `r^2 / 2` of `d` for a power or a logarithm: the search ends when that is below
/// [`TOLERANCE`].
fn plastic_increment<Law: FlowStressLaw>(law: &Law, trial: &TrialState, limit: f64) -> f64 {
    let three_g = 3.0 * trial.shear_modulus;
    let (mut low, mut high) = (0.0, trial.equivalent_stress / three_g);
    let expected = trial.expected_increment;
    let mut increment = if expected > low && expected < high {
        expected
    } else {
        0.5 * (trial.equivalent_stress - limit) / three_g
    };
    for iteration in 0..MAX_ITERATIONS {
        let elastic = three_g * increment;
        // q - 3G d is the stress at the solution: it stands for sigma_y in the heating term.
        let stress = (trial.equivalent_stress - elastic).max(0.0);
        let rate = increment / trial.time_step;
        let state = FlowState {
            plastic_strain: trial.plastic_strain + increment,
            plastic_strain_rate: rate,
            temperature: trial.temperature + trial.heating * stress * increment,
        };
        let change = FlowState {
            plastic_strain: increment,
            plastic_strain_rate: rate,
            temperature: trial.heating * (stress - elastic) * increment,
        };
        let (flow_stress, hardening) = law.flow_stress_along(&state, &change);
        let excess = stress - flow_stress;
        if excess > 0.0 {
            low = increment;
        } else {
            high = increment;
        }
        let slope = elastic + hardening;
        let relative = excess / slope;
        let factor = if hardening > elastic { relative.exp() } else { 1.0 + relative };
        let next = increment * factor;
        if slope > 0.0 && 0.5 * relative * relative <= TOLERANCE {
            return next;
        }
        if high - low <= TOLERANCE * high {
            return increment;
        }
        let follow = next > low && next < high && iteration % 4 != 3;
        increment = if follow { next } else { 0.5 * (low + high) };
    }
    increment
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow_stress::{JohnsonCook, LinearHardening};
    use approx::assert_relative_eq;

    const STEEL: JohnsonCook = JohnsonCook {
        initial_yield: 553.1e6,
        hardening_modulus: 600.8e6,
        hardening_exponent: 0.234,
        rate_coefficient: 0.0134,
        softening_exponent: 1.0,
        reference_rate: 1.0,
        reference_temperature: 293.15,
        melting_temperature: 1733.0,
    };

    fn trial(equivalent_stress: f64, time_step: f64) -> TrialState {
        TrialState {
            equivalent_stress,
            plastic_strain: 0.0,
            temperature: 293.15,
            shear_modulus: 80e9,
            time_step,
            heating: 0.9 / (7850.0 * 480.0),
            expected_increment: 0.0,
        }
    }

    #[test]
    fn linear_hardening_has_a_closed_form() {
        // d = (q - sigma_0) / (3G + H) = 200e6 / 240.1e9
        let law = LinearHardening { initial_yield: 400e6, hardening_modulus: 0.1e9 };
        let returned = law.radial_return(&trial(600e6, 1e-9));
        assert_relative_eq!(returned.plastic_increment, 200e6 / 240.1e9, max_relative = 1e-9);
    }

    #[test]
    fn below_yield_nothing_flows() {
        assert_eq!(STEEL.radial_return(&trial(500e6, 1e-9)).plastic_increment, 0.0);
    }

    #[test]
    fn the_returned_stress_lies_on_the_yield_surface_for_any_time_step() {
        for time_step in [1e-12, 1e-9, 1e-6, 1.0] {
            for overshoot in [1.0001, 1.1, 3.0, 30.0] {
                let start = trial(553.1e6 * overshoot, time_step);
                let returned = STEEL.radial_return(&start);
                let temperature = start.temperature
                    + start.heating * returned.flow_stress * returned.plastic_increment;
                let on_surface = STEEL.flow_stress(&FlowState {
                    plastic_strain: returned.plastic_increment,
                    plastic_strain_rate: returned.plastic_increment / time_step,
                    temperature,
                });
                // The hardening slope is infinite at zero strain: an increment found to 1e-12 q/3G
                // leaves at most B (1e-12 q/3G)^n of stress there.
                let width = TOLERANCE * start.equivalent_stress / (3.0 * start.shear_modulus);
                let bound = STEEL.hardening_modulus * width.powf(STEEL.hardening_exponent);
                assert_relative_eq!(returned.flow_stress, on_surface, epsilon = bound);
            }
        }
    }

    #[test]
    fn where_the_search_starts_does_not_matter() {
        let cold = STEEL.radial_return(&trial(800e6, 1e-9)).plastic_increment;
        for expected_increment in [1e-12, 1e-8, 1e-5, 1e-3, 3e-3, 1.0, f64::NAN] {
            let started = TrialState { expected_increment, ..trial(800e6, 1e-9) };
            let increment = STEEL.radial_return(&started).plastic_increment;
            assert_relative_eq!(increment, cold, max_relative = 2.0 * TOLERANCE);
        }
    }

    /// Softening with strain, a jump and a plateau: nothing a tangent likes.
    #[derive(Debug)]
    struct Rugged;

    impl FlowStressLaw for Rugged {
        fn flow_stress(&self, state: &FlowState) -> f64 {
            let jump = if state.plastic_strain > 1e-3 { 2e8 } else { 0.0 };
            (5e8 - 4e11 * state.plastic_strain).max(1e8) + jump
        }
    }

    #[test]
    fn a_rugged_law_still_ends_on_a_stress_between_its_values() {
        for overshoot in [1.01, 1.2, 2.0, 10.0] {
            let returned = Rugged.radial_return(&trial(5e8 * overshoot, 1e-9));
            assert!(returned.plastic_increment > 0.0);
            let at = |shift: f64| {
                Rugged.flow_stress(&FlowState {
                    plastic_strain: returned.plastic_increment * (1.0 + shift),
                    plastic_strain_rate: 0.0,
                    temperature: 300.0,
                })
            };
            // At the jump the stress lies between both sides; elsewhere 1e-6 of d moves it by 4e5 Pa
            // times d / 1e-6 at most.
            let (low, high) = (at(-1e-6).min(at(1e-6)), at(-1e-6).max(at(1e-6)));
            assert!(returned.flow_stress >= low - 1e4 && returned.flow_stress <= high + 1e4);
        }
    }

    #[test]
    fn a_molten_point_bears_no_stress() {
        let mut molten = trial(100e6, 1e-9);
        molten.temperature = 1800.0;
        let returned = STEEL.radial_return(&molten);
        assert!(returned.flow_stress < 1.0, "{returned:?}");
    }
}
