//! Particles whose motion or temperature is prescribed.

use crate::particles::lattice;
use crate::setup::{Setup, Shape};
use crate::tensor::{Matrix, Vector, apply, identity, reduced, transpose};

/// A resolved support.
#[derive(Debug, Clone)]
pub(crate) struct Hold<const D: usize> {
    /// Columns are the local axes in the global frame.
    axes: Matrix<D>,
    velocity: [Option<f64>; 3],
    /// Fixed temperature in K.
    pub(crate) temperature: Option<f64>,
}

/// Marks a free particle.
pub(crate) const FREE: u8 = u8::MAX;

impl<const D: usize> Hold<D> {
    /// All supports of a setup.
    pub(crate) fn all(setup: &Setup) -> Vec<Self> {
        setup
            .supports
            .iter()
            .map(|support| {
                let axis = |unit: Vector<3>| {
                    let image = match &support.region {
                        Shape::Box { .. } => lattice::placed(&support.region, &unit),
                        Shape::Cylinder { .. } => unit,
                    };
                    reduced::<D>(&image)
                };
                let rows: Matrix<D> = std::array::from_fn(|k| {
                    let mut unit = [0.0; 3];
                    unit[k] = 1.0;
                    axis(unit)
                });
                Self {
                    axes: transpose(&rows),
                    velocity: support.velocity,
                    temperature: support.temperature,
                }
            })
            .collect()
    }

    /// The same region at rest.
    pub(crate) fn at_rest(&self) -> Self {
        Self { velocity: [Some(0.0); 3], ..self.clone() }
    }

    /// Rest without a temperature.
    pub(crate) fn rest() -> Self {
        Self { axes: identity(), velocity: [Some(0.0); 3], temperature: None }
    }

    /// Index of the last support whose region contains `position`.
    pub(crate) fn of(setup: &Setup, position: &Vector<3>) -> u8 {
        let found = setup
            .supports
            .iter()
            .rposition(|s| lattice::contains(&s.region, setup.dimension, position));
        found.map_or(FREE, |index| u8::try_from(index).expect("fewer than 255 supports"))
    }

    /// The velocity with the held components prescribed.
    pub(crate) fn constrained(&self, velocity: &Vector<D>) -> Vector<D> {
        let mut local = apply(&transpose(&self.axes), velocity);
        for k in 0..D {
            local[k] = self.velocity[k].unwrap_or(local[k]);
        }
        apply(&self.axes, &local)
    }

    /// The reaction that balances `force` along the held components.
    pub(crate) fn reaction(&self, force: &Vector<D>) -> Vector<D> {
        let mut local = apply(&transpose(&self.axes), force);
        for k in 0..D {
            local[k] = if self.velocity[k].is_some() { -local[k] } else { 0.0 };
        }
        apply(&self.axes, &local)
    }
}
