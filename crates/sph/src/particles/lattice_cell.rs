//! The cell that a particle fills in the lattice at the start.

use crate::particles::lattice;
use crate::setup::{Body, Setup, Shape};
use crate::tensor::{Vector, dot, reduced};

/// The cell of a particle as its lattice made it: an ellipsoid about one of its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LatticeCell<const D: usize> {
    axis: Vector<D>,
    /// Half lengths along and across the axis in m.
    along: f64,
    across: f64,
}

impl<const D: usize> LatticeCell<D> {
    /// Those of the bodies of a setup.
    pub(crate) fn all(setup: &Setup) -> Vec<Self> {
        let narrowing = |aspect| lattice::narrowing(setup.dimension, aspect);
        let cell = |body: &Body| {
            let aspect = match body.shape {
                Shape::Box { .. } => setup.discretisation.lattice_aspect,
                Shape::Cylinder { .. } => 1.0,
            };
            let across = 0.5 * setup.particle_spacing * narrowing(aspect);
            let axis = reduced(&lattice::placed(&body.shape, &[1.0, 0.0, 0.0]));
            Self { axis, along: aspect * across, across }
        };
        setup.bodies.iter().map(cell).collect()
    }

    /// Half thickness along `normal` in m.
    pub(crate) fn half_thickness(&self, normal: &Vector<D>) -> f64 {
        let through = dot(&self.axis, normal).powi(2).min(1.0);
        (through * self.along.powi(2) + (1.0 - through) * self.across.powi(2)).sqrt()
    }
}
