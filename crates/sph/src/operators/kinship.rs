//! Which particles are one piece of material.

use crate::tensor::{Vector, dot, minus};

/// Who belongs together: those that were near each other in the undeformed state, and those between which flow has left no
/// gap since.
///
/// Particles far apart in the undeformed state belong together once they are neighbours with at least D + 1 neighbours in
/// common that belong to both, as many as tell a linear motion: where layers slide past each other (a layer that sticks to the
/// tool, material that stagnates in front of its edge) the next neighbour along always has them. Two surfaces that meet, as a chip
/// that curls onto the workpiece, have none, and stay two. Such a pair is kept while it is in the support.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kinship<'a, const D: usize> {
    pub(crate) id: &'a [u64],
    /// Pairs that belong together though they were far apart, by id, the lower first; sorted.
    pub(crate) bonds: &'a [(u64, u64)],
    /// Whether there may be new ones.
    pub(crate) grows: bool,
    pub(crate) body: &'a [u32],
    pub(crate) origin: &'a [Vector<D>],
    /// Whether different bodies are one continuum.
    pub(crate) bonded: bool,
    /// Undeformed distance in m up to which particles of size 1 belong together without more ado.
    pub(crate) reach: f64,
    /// Spacing of each particle over the particle spacing; empty where all are the same.
    pub(crate) sizes: &'a [f64],
}

impl<const D: usize> Kinship<'_, D> {
    /// Whether `i` and `j` were near each other in the undeformed state, in one piece of material.
    #[inline]
    pub(crate) fn joins(&self, i: usize, j: usize) -> bool {
        let apart = minus(&self.origin[j], &self.origin[i]);
        let reach = self.reach * self.size(i, j);
        dot(&apart, &apart) < reach * reach && self.may_join(i, j)
    }

    /// Whether `i` and `j` can belong together at all.
    #[inline]
    pub(crate) fn may_join(&self, i: usize, j: usize) -> bool {
        self.bonded || self.body[i] == self.body[j]
    }

    /// Whether `i` and `j` have come to belong together before.
    pub(crate) fn is_bond(&self, i: usize, j: usize) -> bool {
        self.bonds.binary_search(&self.bond(i, j)).is_ok()
    }

    /// `i` and `j` as a bond.
    pub(crate) fn bond(&self, i: usize, j: usize) -> (u64, u64) {
        let (a, b) = (self.id[i], self.id[j]);
        (a.min(b), a.max(b))
    }

    /// The size of a pair.
    #[inline]
    pub(crate) fn size(&self, i: usize, j: usize) -> f64 {
        pair_mean(self.sizes, i, j)
    }
}

/// The mean of two particles' values, which are 1 where there are none.
#[inline]
pub(crate) fn pair_mean(values: &[f64], i: usize, j: usize) -> f64 {
    if values.is_empty() { 1.0 } else { 0.5 * (values[i] + values[j]) }
}
