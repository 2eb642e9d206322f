//! The return to the yield surface of a particle with memory: back stress, damage and the gradient of its plastic strain.
//!
//! The back stress X moves the yield surface; damage and the strain gradient scale the flow stress by `s`
//! (that of the gradient belongs to the flow stress at the beginning of the step):
//! ```text
//! S_1 = S_trial - 2 G de_p,   X_1 = (X_0 + 2/3 C de_p) / (1 + g d),   |S_1 - X_1|_eq = s sigma_y
//! ```
//! With `r = 1/(1 + g d)` the plastic increment d has the direction of `Z = S_trial - r X_0`, and
//! ```text
//! |Z|_eq - (3 G + r C) d = s sigma_y(eps_p + d, d/dt, T + ...)
//! ```
//! For a given r this is the return without effects, of a material with the modulus `G + r C/3` and
//! all stresses divided by s. It is repeated with the r of the increment found: an error of d in r
//! comes back multiplied by at most `g |X|/(3 G + C) <= C/(3 G + C)`, so the search converges, and
//! with steps of 1e-4 of strain and less it takes three or four rounds.

use crate::material::history::History;
use crate::material::point::MaterialPoint;
use crate::material::return_mapping::UpdateContext;
use crate::tensor::{Matrix, sum_scaled};
use sphcut_physics::effects::KinematicHardening;
use sphcut_physics::flow_stress::FlowState;
use sphcut_physics::radial_return::{Returned, TrialState};

/// Relative change of the increment at which the rounds end.
const TOLERANCE: f64 = 1e-9;
/// Each round divides the error by 1 + 3 G/C at least: enough for C up to 10 G.
const MOST_ROUNDS: usize = 100;

impl<const D: usize> MaterialPoint<D> {
    /// Replaces the deviator by `trial` returned to the yield surface of the past; the plastic
    /// increment.
    pub(crate) fn return_with_memory(
        &mut self,
        trial: &Matrix<D>,
        context: &UpdateContext,
        past: &mut History<D>,
    ) -> f64 {
        let memory = context.memory;
        let strength = memory.strength(past.softening) * self.gradient_strength(context, past);
        let (direction, remaining, returned) = match &memory.hardening {
            None => {
                let state = self.trial_state(self.equivalent(trial), context);
                (*trial, 1.0, weakened(context, &state, strength))
            }
            Some(law) => self.return_to_back_stress(trial, context, past, (law, strength)),
        };
        let increment = returned.plastic_increment;
        if increment > 0.0 {
            let equivalent = self.equivalent(&direction);
            if let Some(law) = &memory.hardening {
                let growth = law.kinematic_modulus * increment / equivalent;
                past.back_stress = sum_scaled(&past.back_stress, growth, &direction)
                    .map(|row| row.map(|component| component * remaining));
                let scale = returned.flow_stress / equivalent;
                self.deviator = sum_scaled(&past.back_stress, scale, &direction);
            } else {
                let scale = returned.flow_stress / equivalent;
                self.deviator = direction.map(|row| row.map(|component| component * scale));
            }
        } else {
            self.deviator = *trial;
        }
        self.flow(&returned, context.time_step);
        if increment > 0.0 {
            let pressure = self.pressure(context.elasticity);
            let equivalent = self.equivalent(&self.deviator).max(f64::MIN_POSITIVE);
            let state = (-pressure / equivalent, self.plastic_strain_rate, self.temperature);
            past.wear(memory, increment, state);
        }
        increment
    }

    /// Factor of the strain gradient on the flow stress at the beginning of the step.
    fn gradient_strength(&self, context: &UpdateContext, past: &History<D>) -> f64 {
        let Some(law) = &context.memory.gradient else { return 1.0 };
        let base = context.law.flow_stress(&FlowState {
            plastic_strain: self.plastic_strain,
            plastic_strain_rate: self.plastic_strain_rate,
            temperature: self.temperature,
        });
        law.strength(past.strain_gradient, base)
    }

    /// Z, r and the return along Z.
    fn return_to_back_stress(
        &self,
        trial: &Matrix<D>,
        context: &UpdateContext,
        past: &History<D>,
        (law, strength): (&KinematicHardening, f64),
    ) -> (Matrix<D>, f64, Returned) {
        let round = |remaining: f64, expected: f64| {
            let direction = sum_scaled(trial, -remaining, &past.back_stress);
            let mut state = self.trial_state(self.equivalent(&direction), context);
            state.shear_modulus += remaining * law.kinematic_modulus / 3.0;
            state.expected_increment = expected;
            (direction, remaining, weakened(context, &state, strength))
        };
        let mut found = round(1.0, self.plastic_strain_rate * context.time_step);
        for _ in 0..MOST_ROUNDS {
            let before = found.2.plastic_increment;
            // Whether the step is elastic is decided by the surface at its beginning.
            if before == 0.0 {
                break;
            }
            let next = round(law.remaining(before), before);
            // What was found is confirmed, and kept: without back stress it is the plain return.
            if (next.2.plastic_increment - before).abs() <= TOLERANCE * before {
                break;
            }
            found = next;
        }
        found
    }
}

/// The return with a flow stress times `strength`: all stresses are divided by it.
fn weakened(context: &UpdateContext, state: &TrialState, strength: f64) -> Returned {
    let returned = context.law.radial_return(&TrialState {
        equivalent_stress: state.equivalent_stress / strength,
        shear_modulus: state.shear_modulus / strength,
        heating: state.heating * strength,
        ..*state
    });
    Returned { flow_stress: returned.flow_stress * strength, ..returned }
}

#[cfg(test)]
mod tests;
