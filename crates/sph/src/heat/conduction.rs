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

use crate::engine::Engine;
use crate::operators::laplacian;
use crate::operators::neighbours::{CHUNK, TURN};
use crate::operators::sweeps::exchange_width;
use crate::particles::supports::FREE;
use crate::tensor::minus;
use rayon::prelude::*;

impl<const D: usize> Engine<D> {
    /// Heats by the sources; conducts once the pending time reaches the conduction interval.
    pub(crate) fn conduct_when_due(&mut self, elapsed: f64) {
        self.heat_by_sources(elapsed);
        if !self.conducts {
            self.hold_temperatures();
            return;
        }
        self.conduction_pending += elapsed;
        // Half a step of tolerance: an interval equal to the step must be due every step.
        if self.conduction_pending + 0.5 * elapsed >= self.conduction_interval || !self.mechanics {
            let pending = std::mem::take(&mut self.conduction_pending);
            self.conduct(pending);
        }
        self.hold_temperatures();
    }

    fn conduct(&mut self, duration: f64) {
        if self.conduction_tensor.is_empty() {
            laplacian::find_tensors(&mut self.conduction_tensor, &self.list, &self.motion);
        }
        // The exchange of the force sweep, which is over, holds what conduction started from.
        let width = exchange_width::<D>();
        let places = self.exchange.chunks_exact_mut(width);
        for ((place, point), material) in places.zip(&self.point).zip(&self.material) {
            let data = &self.materials[*material as usize];
            let table = data.conductivity_table.as_ref();
            place[0] = point.temperature;
            place[1] = table.map_or(data.conductivity, |table| table.value(point.temperature));
        }
        let (list, frame, materials) = (&self.list, &self.frame, &self.materials);
        let (material, exchange) = (&self.material, &self.exchange);
        let before = |i: usize| (exchange[i * width], exchange[i * width + 1]);
        let (motion, tensor) = (&self.motion, &self.conduction_tensor);
        self.point.par_chunks_mut(CHUNK).enumerate().with_max_len(TURN).for_each(
            |(chunk, points)| {
                for (offset, point) in points.iter_mut().enumerate() {
                    let i = chunk * CHUNK + offset;
                    let (index, weight) = list.row(i);
                    let mut flux = 0.0;
                    let (own_temperature, own_conductivity) = before(i);
                    for (&j, &w) in index.iter().zip(weight) {
                        let j = j as usize;
                        let (temperature, conductivity) = before(j);
                        let both = own_conductivity + conductivity;
                        let mean = if both > 0.0 {
                            2.0 * own_conductivity * conductivity / both
                        } else {
                            0.0
                        };
                        let separation = minus(motion[j].reference(), motion[i].reference());
                        let factor = laplacian::pair(&separation, &tensor[i], &tensor[j]);
                        flux += w * mean * factor * (temperature - own_temperature);
                    }
                    let data = &materials[material[i] as usize];
                    point.temperature = data.heated(
                        point.temperature,
                        duration * flux * frame[i].volume_ratio,
                        1.0,
                    );
                }
            },
        );
    }

    /// Resets the particles of fixed-temperature supports and books the heat that takes.
    fn hold_temperatures(&mut self) {
        if self.holds.iter().all(|support| support.temperature.is_none()) {
            return;
        }
        for i in 0..self.hold.len() {
            if self.hold[i] == FREE {
                continue;
            }
            let Some(fixed) = self.holds[self.hold[i] as usize].temperature else { continue };
            let data = &self.materials[self.material[i] as usize];
            self.account.heat_supplied +=
                data.heat_between(self.point[i].temperature, fixed, self.volume[i]);
            self.point[i].temperature = fixed;
        }
    }
}
