//! The stress update of one material point.
//!
//! State is the Kirchhoff stress `tau = J sigma = S - p J I`, so that stress
//! power per reference volume is `tau : D` and stored energy is exact:
//! `S:S / 4G + K (J - 1 - ln J)` (another equation of state: `equation_of_state.rs`). One step is hypoelastic with the Jaumann rate
//! (an exact rotation, then `2 G dev D dt`), then a radial return on the Cauchy
//! stress. In the plane the out-of-plane deviator is minus the in-plane trace,
//! which makes every formula the same in two and three dimensions.

use crate::tensor::{
    Matrix, Vector, apply, contract, determinant, inverse_nonsingular, product, rotated,
    step_rotation, sum_scaled, trace, transpose, zero,
};
use sphcut_physics::TemperatureTable;
use sphcut_physics::flow_stress::FlowStressModel;
use sphcut_physics::radial_return::{Returned, TrialState};

use crate::material::equation_of_state::Elasticity;
use crate::material::history::{History, Memory};

/// Time constant of the smoothed plastic strain rate in steps.
const RATE_SMOOTHING_STEPS: f64 = 100.0;

/// State of one particle as a piece of material.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MaterialPoint<const D: usize> {
    /// Deviatoric Kirchhoff stress S in Pa (in-plane part in 2D).
    pub(crate) deviator: Matrix<D>,
    /// Deformation gradient F since the last refresh of the reference.
    pub(crate) deformation: Matrix<D>,
    /// V / V_0.
    pub(crate) volume_ratio: f64,
    /// Equivalent plastic strain.
    pub(crate) plastic_strain: f64,
    /// Smoothed equivalent plastic strain rate in 1/s.
    pub(crate) plastic_strain_rate: f64,
    /// Temperature in K.
    pub(crate) temperature: f64,
    /// Flow stress of the last step in Pa.
    pub(crate) flow_stress: f64,
    /// Bulk viscous pressure of the last step (Kirchhoff) in Pa.
    pub(crate) viscous_pressure: f64,
    /// Non-affine displacement n against the neighbours that hourglass stiffness remembers, in m.
    pub(crate) offset: Vector<D>,
    /// Young's modulus that the stress is expressed with, over that at room temperature: 1 where
    /// it does not depend on temperature ([`crate::material::thermoelasticity`]).
    pub(crate) stiffness: f64,
    /// Half thickness towards the tool in m ([`crate::contact::surface_point`]); 0 before the tool is near.
    pub(crate) half_thickness: f64,
    /// Temperature at which `flow_stress` is the limit of elastic steps, which spares evaluating the law; not a
    /// number while the point flows, and where an effect remembers more than the point.
    pub(crate) limit_temperature: f64,
}

impl<const D: usize> MaterialPoint<D> {
    /// Undeformed and stress-free at `temperature`.
    pub(crate) fn at_rest(temperature: f64) -> Self {
        Self {
            deviator: zero(),
            deformation: crate::tensor::identity(),
            volume_ratio: 1.0,
            plastic_strain: 0.0,
            plastic_strain_rate: 0.0,
            temperature,
            flow_stress: 0.0,
            viscous_pressure: 0.0,
            offset: [0.0; D],
            stiffness: 1.0,
            half_thickness: 0.0,
            limit_temperature: f64::NAN,
        }
    }

    /// S : S with the out-of-plane component of plane strain.
    #[inline]
    pub(crate) fn deviator_square(deviator: &Matrix<D>) -> f64 {
        let out_of_plane = trace(deviator);
        contract(deviator, deviator) + out_of_plane * out_of_plane
    }

    /// Stored elastic energy per reference volume in J/m^3.
    pub(crate) fn elastic_energy(&self, elasticity: &Elasticity) -> f64 {
        Self::deviator_square(&self.deviator) / (4.0 * self.moduli(elasticity).shear)
            + self.volumetric_energy(elasticity)
    }

    /// Kirchhoff stress S - (p J + q) I in Pa.
    pub(crate) fn kirchhoff_stress(&self, elasticity: &Elasticity) -> Matrix<D> {
        let pressure = self.pressure(elasticity) * self.volume_ratio + self.viscous_pressure;
        let mut stress = self.deviator;
        for (k, row) in stress.iter_mut().enumerate() {
            row[k] -= pressure;
        }
        stress
    }

    /// First Piola-Kirchhoff stress per volume of the refreshed reference times V_ref / V_0:
    /// `tau F^-T` in Pa.
    pub(crate) fn piola_stress(&self, elasticity: &Elasticity) -> Matrix<D> {
        product(
            &self.kirchhoff_stress(elasticity),
            &transpose(&inverse_nonsingular(&self.deformation)),
        )
    }
}

/// What the stress update needs to know besides the point.
#[derive(Debug)]
pub(crate) struct UpdateContext<'a> {
    pub(crate) elasticity: &'a Elasticity,
    pub(crate) law: &'a dyn FlowStressModel,
    pub(crate) time_step: f64,
    /// beta / (rho_0 cp) in K m^3/J; 0 without plastic heating.
    pub(crate) heating: f64,
    /// beta / rho_0 and cp(T), where it depends on temperature.
    pub(crate) heat_table: Option<(f64, &'a TemperatureTable)>,
    /// Linear bulk viscosity coefficient alpha rho c h in Pa s.
    pub(crate) linear_viscosity: f64,
    /// Quadratic bulk viscosity coefficient beta rho h^2 in Pa s^2.
    pub(crate) quadratic_viscosity: f64,
    /// Laws of what the point remembers.
    pub(crate) memory: &'a Memory,
}

/// Energies of one update per reference volume in J/m^3.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct UpdateWork {
    /// Mean plastic dissipation `(S_n + S_n+1)/2 : d(eps_p)`; never negative unless a back stress
    /// exceeds the flow stress.
    pub(crate) plastic: f64,
    /// Dissipation by bulk viscosity.
    pub(crate) viscosity: f64,
    /// Work of the thermal pressure of an equation of state.
    pub(crate) thermal: f64,
    /// Heat beside that of plastic work.
    pub(crate) heat: f64,
    /// Stress power minus stored, plastic, thermal and viscous energy.
    pub(crate) residue: f64,
}

impl<const D: usize> MaterialPoint<D> {
    /// Advances the stress by one step of the deformation rate `F_dot` (relative to the
    /// refreshed reference, in 1/s). `past` is what effects with memory know of the point.
    pub(crate) fn advance(
        &mut self,
        deformation_rate: &Matrix<D>,
        context: &UpdateContext,
        past: Option<&mut History<D>>,
    ) -> UpdateWork {
        let dt = context.time_step;
        let elasticity = context.elasticity;
        let shear = self.moduli(elasticity).shear;
        let energy_before = self.elastic_energy(elasticity);
        let pressure_before = self.pressure(elasticity);

        let middle = sum_scaled(&self.deformation, 0.5 * dt, deformation_rate);
        let gradient = product(deformation_rate, &inverse_nonsingular(&middle));
        let (strain_rate, spin) = symmetric_and_skew(&gradient);

        let determinant_before = determinant(&self.deformation);
        self.deformation = sum_scaled(&self.deformation, dt, deformation_rate);
        let volume_before = self.volume_ratio;
        self.volume_ratio *= determinant(&self.deformation) / determinant_before;
        let thermal = self.compress(volume_before, context);

        let volumetric_rate = trace(&strain_rate);
        let mut deviatoric_rate = strain_rate;
        for (k, row) in deviatoric_rate.iter_mut().enumerate() {
            row[k] -= volumetric_rate / 3.0;
        }
        let rotation = step_rotation(&spin, dt);
        let carried = rotated(&self.deviator, &rotation);
        self.offset = apply(&rotation, &self.offset);
        let trial = sum_scaled(&carried, 2.0 * shear * dt, &deviatoric_rate);
        let increment = match past {
            None => self.return_to_yield(&trial, context),
            Some(past) => {
                past.turn(&rotation);
                self.return_with_memory(&trial, context, past)
            }
        };

        // Plastic part of the strain increment: D dt - (S_n+1 - S_n) / 2G, deviatoric.
        let mean = sum_scaled(&carried, 1.0, &self.deviator);
        let plastic_flow = sum_scaled(&trial, -1.0, &self.deviator);
        let plastic = full_contract(&mean, &plastic_flow) / (4.0 * shear);
        let plastic = if increment > 0.0 { plastic } else { 0.0 };
        match context.heat_table {
            None => self.temperature += context.heating * plastic,
            Some((share, table)) => {
                self.temperature = table.heated(self.temperature, share * plastic);
            }
        }

        let viscosity_before = self.viscous_pressure;
        self.viscous_pressure = self.bulk_viscosity(volumetric_rate, context);
        let volume_change = self.volume_ratio - volume_before;
        let viscosity = -0.5 * (viscosity_before + self.viscous_pressure) * volumetric_rate * dt;

        let heat = thermal + self.keep_dissipation(elasticity, viscosity);
        let mean_pressure = 0.5 * (pressure_before + self.pressure(elasticity));
        let stress_power =
            0.5 * full_contract(&mean, &deviatoric_rate) * dt - mean_pressure * volume_change;
        let stored = self.elastic_energy(elasticity) - energy_before;
        let residue = stress_power - stored - plastic - thermal;
        UpdateWork { plastic, viscosity, thermal, heat, residue }
    }

    /// Replaces the deviator by `trial` returned to the yield surface; the plastic increment.
    fn return_to_yield(&mut self, trial: &Matrix<D>, context: &UpdateContext) -> f64 {
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

    /// Equivalent stress of a deviator; the law speaks of Cauchy stress: tau / J.
    #[inline]
    pub(crate) fn equivalent(&self, deviator: &Matrix<D>) -> f64 {
        (1.5 * Self::deviator_square(deviator)).sqrt() / self.volume_ratio
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
            heating: context.heating,
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

    /// `q = -alpha rho c h tr D + beta rho h^2 (tr D)^2` in compression, linear term only in
    /// expansion (von Neumann and Richtmyer 1950; Landshoff 1955); Kirchhoff pressure in Pa.
    fn bulk_viscosity(&self, volumetric_rate: f64, context: &UpdateContext) -> f64 {
        let quadratic = if volumetric_rate < 0.0 {
            context.quadratic_viscosity * volumetric_rate * volumetric_rate
        } else {
            0.0
        };
        quadratic - context.linear_viscosity * volumetric_rate
    }
}

/// Symmetric and skew part.
fn symmetric_and_skew<const D: usize>(gradient: &Matrix<D>) -> (Matrix<D>, Matrix<D>) {
    let mirrored = transpose(gradient);
    let mut symmetric = zero();
    let mut skew = zero();
    for row in 0..D {
        for column in 0..D {
            symmetric[row][column] = 0.5 * (gradient[row][column] + mirrored[row][column]);
            skew[row][column] = 0.5 * (gradient[row][column] - mirrored[row][column]);
        }
    }
    (symmetric, skew)
}

/// a : b of two deviators with their out-of-plane components (minus the in-plane traces).
fn full_contract<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> f64 {
    contract(a, b) + trace(a) * trace(b)
}
