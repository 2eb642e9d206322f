//! The state of one particle as a piece of material.
//!
//! The stress is the Kirchhoff stress `tau = J sigma = S - p J I`, so that stress power per reference volume is `tau : D`
//! and stored energy is exact: `S:S / 4G + K (J - 1 - ln J)` (another equation of state: `equation_of_state.rs`). In the
//! plane the out-of-plane deviator is minus the in-plane trace, which makes every formula the same in two and three
//! dimensions.

use crate::tensor::{Matrix, Vector, contract, identity, trace, zero};

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
            deformation: identity(),
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

    /// Equivalent stress of a deviator; the law speaks of Cauchy stress: tau / J.
    #[inline]
    pub(crate) fn equivalent(&self, deviator: &Matrix<D>) -> f64 {
        (1.5 * Self::deviator_square(deviator)).sqrt() / self.volume_ratio
    }

    /// All numbers in the order of a checkpoint.
    pub(crate) fn numbers(&mut self) -> Vec<&mut f64> {
        let tensors = [&mut self.deviator, &mut self.deformation];
        let mut numbers: Vec<&mut f64> = tensors.into_iter().flatten().flatten().collect();
        numbers.extend([
            &mut self.volume_ratio,
            &mut self.plastic_strain,
            &mut self.plastic_strain_rate,
            &mut self.temperature,
            &mut self.flow_stress,
            &mut self.viscous_pressure,
        ]);
        numbers.extend(&mut self.offset);
        numbers.extend([&mut self.stiffness, &mut self.half_thickness]);
        numbers
    }
}
