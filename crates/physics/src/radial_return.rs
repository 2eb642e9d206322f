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
//! time step.

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

/// Relative width of the bracket at which the search ends, in terms of `q / 3G`.
const TOLERANCE: f64 = 1e-12;
/// Bisection alone needs 40 halvings for [`TOLERANCE`]; the mixed search stays well below.
const MAX_ITERATIONS: usize = 60;

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
        let three_g = 3.0 * trial.shear_modulus;
        let flow_stress = |increment: f64| {
            // q - 3G d is the stress at the solution: it stands for sigma_y in the heating term.
            let stress = (trial.equivalent_stress - three_g * increment).max(0.0);
            self.flow_stress(&FlowState {
                plastic_strain: trial.plastic_strain + increment,
                plastic_strain_rate: increment / trial.time_step,
                temperature: trial.temperature + trial.heating * stress * increment,
            })
        };
        let excess =
            |increment: f64| trial.equivalent_stress - three_g * increment - flow_stress(increment);
        let increment = bracketed_root(excess, trial.equivalent_stress / three_g);
        Returned {
            plastic_increment: increment,
            flow_stress: (trial.equivalent_stress - three_g * increment).max(0.0),
        }
    }
}

/// The root of `excess` in `[0, upper]`, with `excess(0) > 0 >= excess(upper)`:
/// Illinois false position with a bisection whenever the bracket shrinks too slowly.
fn bracketed_root(excess: impl Fn(f64) -> f64, upper: f64) -> f64 {
    let (mut low, mut excess_low) = (0.0, excess(0.0));
    if excess_low <= 0.0 {
        return 0.0;
    }
    let (mut high, mut excess_high) = (upper, excess(upper));
    let mut last_side = 0_i8;
    for iteration in 0..MAX_ITERATIONS {
        let width = high - low;
        if width <= TOLERANCE * upper || excess_high == 0.0 {
            break;
        }
        let secant = high - excess_high * width / (excess_high - excess_low);
        let candidate = if iteration % 4 == 3 { 0.5 * (low + high) } else { secant };
        let inside = candidate > low && candidate < high;
        let candidate = if inside { candidate } else { 0.5 * (low + high) };
        let value = excess(candidate);
        if value > 0.0 {
            (low, excess_low) = (candidate, value);
            if last_side == 1 {
                excess_high *= 0.5;
            }
            last_side = 1;
        } else {
            (high, excess_high) = (candidate, value);
            if last_side == -1 {
                excess_low *= 0.5;
            }
            last_side = -1;
        }
        if value.abs() <= TOLERANCE * trial_scale(excess_low, excess_high, value) {
            return candidate;
        }
    }
    high
}

/// Scale against which a residual counts as zero.
fn trial_scale(excess_low: f64, excess_high: f64, value: f64) -> f64 {
    excess_low.abs().max(excess_high.abs()).max(value.abs()).max(1.0)
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
    fn a_molten_point_bears_no_stress() {
        let mut molten = trial(100e6, 1e-9);
        molten.temperature = 1800.0;
        let returned = STEEL.radial_return(&molten);
        assert!(returned.flow_stress < 1.0, "{returned:?}");
    }
}
