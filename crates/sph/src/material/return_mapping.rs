//! The return to the yield surface: a radial return on the Cauchy stress.

use crate::material::equation_of_state::Elasticity;
use crate::material::history::Memory;
use crate::material::point::MaterialPoint;
use crate::tensor::Matrix;
use sphcut_physics::TemperatureTable;
use sphcut_physics::flow_stress::FlowStressModel;
use sphcut_physics::radial_return::{Returned, TrialState};

/// Time constant of the smoothed plastic strain rate in steps.
const RATE_SMOOTHING_STEPS: f64 = 100.0;

/// What the stress update needs to know besides the point.
#[derive(Debug)]
pub(crate) struct UpdateContext<'a> {
    pub(crate) elasticity: &'a Elasticity,
    pub(crate) law: &'a dyn FlowStressModel,
    pub(crate) time_step: f64,
    /// beta; 0 without plastic heating.
    pub(crate) heating_share: f64,
    /// 1 / (rho_0 cp) at the temperature of the point in K m^3/J.
    pub(crate) per_heat_capacity: f64,
    /// rho_0 and cp(T), where it depends on temperature.
    pub(crate) heat_table: Option<(f64, &'a TemperatureTable)>,
    /// Linear bulk viscosity coefficient alpha rho c h in Pa s.
    pub(crate) linear_viscosity: f64,
    /// Quadratic bulk viscosity coefficient beta rho h^2 in Pa s^2.
    pub(crate) quadratic_viscosity: f64,
    /// Laws of what the point remembers.
    pub(crate) memory: &'a Memory,
}

impl<const D: usize> MaterialPoint<D> {
    /// Replaces the deviator by `trial` returned to the yield surface; the plastic increment.
    pub(crate) fn return_to_yield(&mut self, trial: &Matrix<D>, context: &UpdateContext) -> f64 {
        let equivalent = self.equivalent(trial);
        let limit_is_known = self.limit_temperature == self.temperature;
        let returned = if limit_is_known && equivalent <= self.flow_stress {
            Returned { plastic_increment: 0.0, flow_stress: self.flow_stress }
        } else {
            context.law.radial_return(&self.trial_state(equivalent, context))
        };
        if returned.plastic_increment > 0.0 {
            let scale = returned.flow_stress / equivalent;
            self.deviator = trial.map(|row| row.map(|component| component * scale));
            self.limit_temperature = f64::NAN;
        } else {
            self.deviator = *trial;
            self.limit_temperature = self.temperature;
        }
        self.flow(&returned, context.time_step);
        returned.plastic_increment
    }

    /// What the return needs to know of the point.
    #[inline]
    pub(crate) fn trial_state(&self, equivalent: f64, context: &UpdateContext) -> TrialState {
        TrialState {
            equivalent_stress: equivalent,
            plastic_strain: self.plastic_strain,
            temperature: self.temperature,
            shear_modulus: self.moduli(context.elasticity).shear / self.volume_ratio,
            time_step: context.time_step,
            heating: context.heating_share * context.per_heat_capacity,
            expected_increment: self.plastic_strain_rate * context.time_step,
        }
    }

    /// Books a return.
    #[inline]
    pub(crate) fn flow(&mut self, returned: &Returned, dt: f64) {
        let increment = returned.plastic_increment;
        self.flow_stress = returned.flow_stress;
        self.plastic_strain_rate +=
            (increment / dt - self.plastic_strain_rate) / RATE_SMOOTHING_STEPS;
        if increment > 0.0 {
            self.plastic_strain += increment;
        }
    }
}
