//! Diffusion of the pressure's zig-zag.
//!
//! Zig-zag patterns of the volume ratio exert no force in the corrected momentum
//! equation, so nothing removes them once plastic flow has left them behind.
//! What the linear fit of J does not explain is diffused (as in delta-SPH,
//! Antuono et al. 2010):
//! ```text
//! dJ_i/dt = sum_j w_ij nu_ij (J_j - J_i - (g_i + g_j)/2 . X_ij),   nu_i = delta h_s^2 eps_p_dot
//! ```
//! with the gradient `g` of J from the corrected operator and the mean `nu` of a
//! pair (weighted with the reference volumes, so that `sum V J` is kept). Tying
//! `nu` to the plastic strain rate makes the relaxation take a fixed strain,
//! whatever the mass scaling, and leaves elastic waves alone. The change of
//! stored energy is booked as `density_diffusion_work`.

use crate::engine::Engine;
use crate::neighbours::{CHUNK, TURN};
use crate::tensor::{Vector, apply, dot, minus, plus_scaled};
use rayon::prelude::*;

/// Steps between two applications.
const INTERVAL: u64 = 5;
/// Share of the explicit limit that one application may use.
const SAFETY: f64 = 0.25;

/// What a pair needs to know of a particle.
#[derive(Debug, Clone, Copy)]
struct Smooth<const D: usize> {
    volume_ratio: f64,
    gradient: Vector<D>,
    /// nu times the pending time in m^2.
    reach: f64,
}

impl<const D: usize> Engine<D> {
    /// Applies the diffusion every few steps.
    pub(crate) fn diffuse_density_when_due(&mut self, elapsed: f64) {
        if self.numerics.density_diffusion > 0.0 && self.step.is_multiple_of(INTERVAL) {
            self.diffuse_density(elapsed * INTERVAL as f64);
        }
    }

    fn diffuse_density(&mut self, duration: f64) {
        let length = self.smoothing.length;
        let strength = self.numerics.density_diffusion * length * length * duration;
        let largest = SAFETY / self.largest_weight;
        let (list, reference, frame, point) =
            (&self.list, &self.reference, &self.frame, &self.point);
        let smooth: Vec<Smooth<D>> = (0..point.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .with_max_len(TURN * CHUNK)
            .map(|i| {
                let (index, weight) = list.row(i);
                let mut sum = [0.0; D];
                for (&j, &w) in index.iter().zip(weight) {
                    let j = j as usize;
                    let change = point[j].volume_ratio - point[i].volume_ratio;
                    sum = plus_scaled(&sum, w * change, &minus(&reference[j], &reference[i]));
                }
                Smooth {
                    volume_ratio: point[i].volume_ratio,
                    gradient: apply(&frame[i].correction, &sum),
                    reach: (strength * point[i].plastic_strain_rate).min(largest),
                }
            })
            .collect();
        let smooth = &smooth;
        let (materials, material, volume) = (&self.materials, &self.material, &self.volume);
        let released: Vec<f64> = self
            .point
            .par_chunks_mut(CHUNK)
            .enumerate()
            .with_max_len(TURN)
            .map(|(chunk, points)| {
                let mut released = 0.0;
                for (offset, point) in points.iter_mut().enumerate() {
                    let i = chunk * CHUNK + offset;
                    let own = &smooth[i];
                    let (index, weight) = list.row(i);
                    let mut change = 0.0;
                    for (&j, &w) in index.iter().zip(weight) {
                        let other = &smooth[j as usize];
                        let separation = minus(&reference[j as usize], &reference[i]);
                        let slope: Vector<D> =
                            std::array::from_fn(|k| 0.5 * (own.gradient[k] + other.gradient[k]));
                        let jump = other.volume_ratio - own.volume_ratio - dot(&slope, &separation);
                        change += w * 0.5 * (own.reach + other.reach) * jump;
                    }
                    let moduli = point.moduli(&materials[material[i] as usize].moduli);
                    let before = moduli.volumetric_energy(point.volume_ratio);
                    // V_ref/V_0 makes the exchange symmetric in V_0 J.
                    point.volume_ratio += change * frame[i].volume_ratio;
                    let after = moduli.volumetric_energy(point.volume_ratio);
                    released += volume[i] * (before - after);
                }
                released
            })
            .collect();
        self.account.density_diffusion += released.iter().sum::<f64>();
    }
}
