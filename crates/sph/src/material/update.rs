//! The stress update of one material point.
//!
//! One step is hypoelastic with the Jaumann rate (an exact rotation, then `2 G dev D dt`), then a return to the yield
//! surface.

use crate::material::history::History;
use crate::material::point::MaterialPoint;
use crate::material::return_mapping::UpdateContext;
use crate::tensor::{
    Matrix, apply, contract, determinant, inverse_nonsingular, product, rotated, step_rotation,
    sum_scaled, trace, transpose, zero,
};

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
    /// Heat of all of them but bulk viscosity.
    pub(crate) heat: f64,
    /// Heat of bulk viscosity.
    pub(crate) viscous_heat: f64,
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
        let thermal = self.compress(volume_before, elasticity);

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
        let plastic_heat = self.heat_by_work(context, plastic);

        let viscosity_before = self.viscous_pressure;
        self.viscous_pressure = self.bulk_viscosity(volumetric_rate, context);
        let volume_change = self.volume_ratio - volume_before;
        let viscosity = -0.5 * (viscosity_before + self.viscous_pressure) * volumetric_rate * dt;

        let heat = thermal + plastic_heat;
        let viscous_heat = self.keep_dissipation(context, viscosity);
        let mean_pressure = 0.5 * (pressure_before + self.pressure(elasticity));
        let stress_power =
            0.5 * full_contract(&mean, &deviatoric_rate) * dt - mean_pressure * volume_change;
        let stored = self.elastic_energy(elasticity) - energy_before;
        let residue = stress_power - stored - plastic - thermal;
        UpdateWork { plastic, viscosity, thermal, heat, viscous_heat, residue }
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
