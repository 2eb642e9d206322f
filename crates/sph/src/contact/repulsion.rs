//! Linear springs between particles that come too close.

use crate::operators::kinship::pair_mean;
use crate::operators::neighbours::Watched;
use crate::tensor::{Vector, dot, minus, plus_scaled};

/// Particles that repel along the line of centres where they are closer than a distance, as linear springs.
#[derive(Debug)]
pub(crate) struct RepellingPairs {
    /// Those that may come closer before the next reference update; each from both sides.
    pub(crate) pairs: Vec<(u32, u32)>,
    /// Of two particles of size 1, in m; of others times their mean size.
    pub(crate) distance: f64,
    /// In N/m (N/m^2 in 2D).
    pub(crate) stiffness: f64,
}

impl RepellingPairs {
    /// The pairs to be found anew, up to a distance of `reach` in m.
    pub(crate) fn watched(&mut self, reach: f64) -> Watched<'_> {
        Watched { pairs: &mut self.pairs, reach }
    }

    /// Adds the repulsion to the forces; `sizes` as of [`pair_mean`].
    pub(crate) fn push_apart<const D: usize>(
        &self,
        position: &[Vector<D>],
        sizes: &[f64],
        force: &mut [Vector<D>],
    ) {
        for &(i, j) in &self.pairs {
            let (i, j) = (i as usize, j as usize);
            let separation = minus(&position[j], &position[i]);
            let distance = dot(&separation, &separation).sqrt();
            let least = self.distance * pair_mean(sizes, i, j);
            if distance < least && distance > 0.0 {
                let push = self.stiffness * (least - distance) / distance;
                force[i] = plus_scaled(&force[i], -push, &separation);
            }
        }
    }

    /// Energy stored in the repulsion in J (J/m in 2D).
    pub(crate) fn energy<const D: usize>(&self, position: &[Vector<D>], sizes: &[f64]) -> f64 {
        let overlap_square = |&(i, j): &(u32, u32)| {
            let (i, j) = (i as usize, j as usize);
            let separation = minus(&position[j], &position[i]);
            let overlap = (self.distance * pair_mean(sizes, i, j)
                - dot(&separation, &separation).sqrt())
            .max(0.0);
            overlap * overlap
        };
        // Each pair is listed from both sides.
        0.25 * self.stiffness * self.pairs.iter().map(overlap_square).sum::<f64>()
    }
}
