//! One particle in contact with the tool.

use crate::contact::surface::{Footing, Share};
use crate::tensor::{Vector, dot, plus_scaled, reduced};

/// A particle in contact and its forces in N (N/m in 2D).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Touch<const D: usize> {
    pub(crate) particle: u32,
    pub(crate) normal_force: Vector<D>,
    pub(crate) friction_force: Vector<D>,
    /// Friction over the law's limit: 1 slides, less sticks.
    pub(crate) friction_use: f64,
    /// From the point of the surface on which they act to the centre, in m.
    pub(crate) lever: Vector<D>,
    /// Share of the tool's surface in m^2 (m in 2D).
    pub(crate) area: f64,
    /// Regularised pressure of the contact in Pa.
    pub(crate) pressure: f64,
    /// Tresca's m: shear stress over the shear strength sigma_y / sqrt(3) of the particle.
    pub(crate) shear_friction_factor: f64,
}

impl<const D: usize> Touch<D> {
    /// Unit normal out of the tool.
    pub(crate) fn normal(&self) -> Vector<D> {
        let length = dot(&self.lever, &self.lever).sqrt();
        self.lever.map(|x| x / length)
    }

    /// A touch without friction.
    pub(crate) fn without_friction(particle: u32, footing: &Footing, share: &Share) -> Self {
        let normal: Vector<D> = reduced(footing.normal.as_ref());
        Self {
            particle,
            normal_force: normal.map(|n| n * footing.pressing),
            friction_force: [0.0; D],
            friction_use: 1.0,
            lever: normal.map(|n| n * footing.half_thickness),
            area: share.area,
            pressure: share.pressure,
            shear_friction_factor: 0.0,
        }
    }

    /// Force of the tool on the particle in N (N/m in 2D).
    pub(crate) fn force(&self) -> Vector<D> {
        plus_scaled(&self.normal_force, 1.0, &self.friction_force)
    }
}
