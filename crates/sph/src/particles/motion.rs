//! Position and velocity of a particle as the sweeps over neighbours read them.

use crate::tensor::Vector;

/// Where a particle was at the last renewal and how it moves: what every sweep asks of a neighbour, side by side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion<const D: usize>([Vector<D>; 2]);

impl<const D: usize> Motion<D> {
    pub(crate) fn new(reference: Vector<D>, velocity: Vector<D>) -> Self {
        Self([reference, velocity])
    }

    /// Position in the reference configuration.
    #[inline(always)]
    pub(crate) fn reference(&self) -> &Vector<D> {
        &self.0[0]
    }

    #[inline(always)]
    pub(crate) fn velocity(&self) -> &Vector<D> {
        &self.0[1]
    }

    pub(crate) fn set_reference(&mut self, reference: Vector<D>) {
        self.0[0] = reference;
    }

    #[inline(always)]
    pub(crate) fn set_velocity(&mut self, velocity: Vector<D>) {
        self.0[1] = velocity;
    }

    /// Reference and velocity, one after the other.
    #[inline(always)]
    pub(crate) fn numbers(&self) -> &[f64] {
        self.0.as_flattened()
    }
}
