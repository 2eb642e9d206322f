//! Conduction between particles.
//!
//! ```text
//! rho_0 cp V_0 dT_i/dt = V_i sum_j w_ij k_ij e.(S_i + S_j).e (T_j - T_i),   e = X_ij/|X_ij|
//! ```
//! with the harmonic mean conductivity `k_ij` (Cleary and Monaghan 1999) and the tensors S of
//! [`crate::operators::laplacian`]. With S = I this is the usual SPH Laplacian.
//! - Heat is conserved to rounding: the flux of a pair changes its sign with its sides.
//! - No factor of a pair is negative, so heat flows from hot to cold, and with the step taken a
//!   temperature stays between those of its neighbours.
//! - Second order inside and along and across an insulated surface, which needs nothing. On a
//!   disordered set the sum has a first moment that is not corrected.
//! - First order at a surface where a temperature is held.

use crate::operators::laplacian;
use crate::operators::reference::ReferenceConfiguration;
use crate::parallel::{CHUNK, TURN};
use crate::particles::Particles;
use crate::tensor::{Matrix, minus};
use rayon::prelude::*;

/// Conduction in steps of its own, which are longer than those of the particles.
#[derive(Debug)]
pub(crate) struct HeatConduction<const D: usize> {
    pub(crate) acts: bool,
    /// Time since the last step in s.
    pub(crate) pending: f64,
    /// Length of a step in s.
    pub(crate) interval: f64,
    /// S of the particles ([`crate::operators::laplacian`]); empty until a step needs it.
    pub(crate) tensor: Vec<Matrix<D>>,
}

impl<const D: usize> HeatConduction<D> {
    pub(crate) fn new(acts: bool) -> Self {
        Self { acts, pending: 0.0, interval: f64::INFINITY, tensor: Vec::new() }
    }

    /// Whether a step is due after another `elapsed` of time.
    pub(crate) fn is_due_after(&mut self, elapsed: f64) -> bool {
        if self.acts {
            self.pending += elapsed;
        }
        // Half a step of tolerance: an interval equal to the step must be due every step.
        self.acts && self.pending + 0.5 * elapsed >= self.interval
    }

    /// Conducts over the time pending; `room` is the exchange of the sweep over forces, which is over.
    pub(crate) fn step(
        &mut self,
        particles: &mut Particles<D>,
        reference: &ReferenceConfiguration<D>,
        room: &mut [f64],
    ) {
        let duration = std::mem::take(&mut self.pending);
        if self.tensor.is_empty() {
            laplacian::find_tensors(&mut self.tensor, &reference.list, &particles.motion);
        }
        let Particles { materials, material, motion, point, .. } = particles;
        let (materials, material, motion) = (&*materials, &*material, &*motion);
        let room = &mut room[..2 * point.len()];
        room.par_chunks_mut(2 * CHUNK)
            .zip(point.par_chunks(CHUNK))
            .zip(material.par_chunks(CHUNK))
            .with_max_len(TURN)
            .for_each(|((places, points), material)| {
                for ((place, point), material) in
                    places.chunks_exact_mut(2).zip(points).zip(material)
                {
                    place[0] = point.temperature;
                    place[1] = materials[*material as usize].conductivity_at(point.temperature);
                }
            });
        let room = &*room;
        let before = |i: usize| (room[2 * i], room[2 * i + 1]);
        let ReferenceConfiguration { list, frame, .. } = reference;
        let tensor = &self.tensor;
        point.par_chunks_mut(CHUNK).enumerate().with_max_len(TURN).for_each(|(chunk, points)| {
            for (offset, point) in points.iter_mut().enumerate() {
                let i = chunk * CHUNK + offset;
                let (index, weight) = list.row(i);
                let mut flux = 0.0;
                let (own_temperature, own_conductivity) = before(i);
                for (&j, &w) in index.iter().zip(weight) {
                    let j = j as usize;
                    let (temperature, conductivity) = before(j);
                    if temperature == own_temperature {
                        continue;
                    }
                    let both = own_conductivity + conductivity;
                    let mean =
                        if both > 0.0 { 2.0 * own_conductivity * conductivity / both } else { 0.0 };
                    let separation = minus(motion[j].reference(), motion[i].reference());
                    let factor = laplacian::pair(&separation, &tensor[i], &tensor[j]);
                    flux += w * mean * factor * (temperature - own_temperature);
                }
                let data = &materials[material[i] as usize];
                let heat = duration * flux * frame[i].volume_ratio;
                point.temperature = data.heated(point.temperature, heat, 1.0);
            }
        });
    }
}
