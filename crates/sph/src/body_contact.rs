//! Frictionless contact between bodies that are not bonded.
//!
//! Particles of different bodies do not see each other in the sums of the
//! method; closer than the spacing `dx` they repel along the line of centres
//! with `kappa M dx^(D-2) (dx - r)`, as particles and tool do. The force is
//! central and the same for both, so both momenta are kept; it is conservative,
//! and its stored energy is part of the contact energy. Chip and workpiece are
//! one body: their surfaces, once they touch, bond. Neglected: friction.

use crate::engine::Engine;
use crate::neighbours::{CHUNK, Cells};
use crate::tensor::{Vector, dot, minus, plus_scaled};
use rayon::prelude::*;

/// Pairs of different bodies within reach, in compressed rows.
#[derive(Debug, Default)]
pub(crate) struct BodyPairs {
    start: Vec<u32>,
    index: Vec<u32>,
}

impl BodyPairs {
    /// Pairs of different bodies closer than `reach`; `reach` must not exceed the cell size.
    pub(crate) fn build<const D: usize>(
        &mut self,
        cells: &Cells<D>,
        positions: &[Vector<D>],
        body: &[u32],
        reach: f64,
    ) {
        self.start.clear();
        self.index.clear();
        self.start.push(0);
        for (i, position) in positions.iter().enumerate() {
            cells.around(position, |range| {
                for j in range {
                    let separation = minus(&positions[j], position);
                    if body[j] != body[i] && dot(&separation, &separation) < reach * reach {
                        self.index.push(j as u32);
                    }
                }
            });
            self.start.push(self.index.len() as u32);
        }
    }

    fn row(&self, i: usize) -> &[u32] {
        &self.index[self.start[i] as usize..self.start[i + 1] as usize]
    }
}

impl<const D: usize> Engine<D> {
    /// Adds the forces between unbonded bodies to the internal forces.
    pub(crate) fn push_bodies_apart(&mut self) {
        let Some(pairs) = &self.body_pairs else { return };
        let (position, spacing, stiffness) = (&self.position, self.spacing, self.body_stiffness);
        self.force.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, forces)| {
            for (offset, force) in forces.iter_mut().enumerate() {
                let i = chunk * CHUNK + offset;
                for &j in pairs.row(i) {
                    let separation = minus(&position[j as usize], &position[i]);
                    let distance = dot(&separation, &separation).sqrt();
                    if distance < spacing && distance > 0.0 {
                        let push = stiffness * (spacing - distance) / distance;
                        *force = plus_scaled(force, -push, &separation);
                    }
                }
            }
        });
    }

    /// Energy stored in the overlap of unbonded bodies.
    pub(crate) fn body_contact_energy(&self) -> f64 {
        let Some(pairs) = &self.body_pairs else { return 0.0 };
        let mut sum = 0.0;
        for (i, position) in self.position.iter().enumerate() {
            for &j in pairs.row(i) {
                let separation = minus(&self.position[j as usize], position);
                let overlap = (self.spacing - dot(&separation, &separation).sqrt()).max(0.0);
                // Each pair is met from both sides.
                sum += 0.25 * self.body_stiffness * overlap * overlap;
            }
        }
        sum
    }
}
