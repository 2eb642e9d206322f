//! Frictionless contact of particle surfaces with each other: unbonded bodies, and a chip that
//! curls onto the workpiece.
//!
//! Particles that do not belong together - of different bodies that are not
//! bonded, or of one body but more than `bonding_distance` spacings apart in the
//! undeformed state - do not see each other in the sums of the method: surfaces
//! that meet do not weld. Closer than the spacing `dx` they repel along the line
//! of centres with `kappa M dx^(D-2) (dx - r)`, as particles and tool do. The
//! force is central and the same for both, so both momenta are kept; it is
//! conservative, and its stored energy is part of the contact energy.
//! Neglected: friction and heat across such contacts.

use crate::engine::Engine;
use crate::tensor::{Vector, dot, minus, plus_scaled};

/// Who belongs together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kinship<'a, const D: usize> {
    pub(crate) body: &'a [u32],
    pub(crate) origin: &'a [Vector<D>],
    /// Whether different bodies are one continuum.
    pub(crate) bonded: bool,
    /// Largest undeformed distance of kin, squared, in m^2.
    pub(crate) reach_square: f64,
}

impl<const D: usize> Kinship<'_, D> {
    /// Whether `i` and `j` are parts of one piece of material.
    #[inline]
    pub(crate) fn joins(&self, i: usize, j: usize) -> bool {
        let apart = minus(&self.origin[j], &self.origin[i]);
        dot(&apart, &apart) < self.reach_square && (self.bonded || self.body[i] == self.body[j])
    }
}

impl<const D: usize> Engine<D> {
    /// Adds the forces between strangers to the internal forces.
    pub(crate) fn push_strangers_apart(&mut self) {
        for &(i, j) in &self.strangers {
            let (i, j) = (i as usize, j as usize);
            let separation = minus(&self.position[j], &self.position[i]);
            let distance = dot(&separation, &separation).sqrt();
            if distance < self.spacing && distance > 0.0 {
                let push = self.stranger_stiffness * (self.spacing - distance) / distance;
                self.force[i] = plus_scaled(&self.force[i], -push, &separation);
            }
        }
    }

    /// Energy stored in the overlap of strangers.
    pub(crate) fn stranger_energy(&self) -> f64 {
        let overlap_square = |&(i, j): &(u32, u32)| {
            let separation = minus(&self.position[j as usize], &self.position[i as usize]);
            let overlap = (self.spacing - dot(&separation, &separation).sqrt()).max(0.0);
            overlap * overlap
        };
        // Each pair is listed from both sides.
        0.25 * self.stranger_stiffness * self.strangers.iter().map(overlap_square).sum::<f64>()
    }
}
