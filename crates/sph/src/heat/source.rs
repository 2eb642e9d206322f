//! Heat released in the volume of the bodies by moving sources.
//!
//! ```text
//! rho_0 cp V_0 dT_i/dt = q(x_i - c - v t) V_i
//! Gaussian:  q = P / (2 pi s^2)^(D/2) exp(-|x|^2 / 2 s^2)        s: standard deviation
//! box:       q = P / (volume of the box) inside, 0 outside
//! ```
//! P in W (W/m in two dimensions), V_i the present volume. The density is sampled at the particles:
//! what of a source lies outside the bodies heats nothing, and a Gaussian gives its whole power to
//! a square lattice up to `2 D exp(-2 pi^2 s^2/dx^2)`: 1e-8 for s = dx, 3 % for s = dx/2 (2D). A box is
//! resolved to a particle: `dx` over its width. In time the density of the middle of the step
//! counts. Neglected: absorption, shadow, the dependence of the power on the surface it meets.

use crate::parallel::CHUNK;
use crate::particles::Particles;
use crate::setup::{HeatSource, HeatSourceForm};
use crate::tensor::Vector;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Standard deviations beyond which a Gaussian is cut off: 3e-14 of its peak.
const REACH: f64 = 8.0;

/// A source at one instant.
struct Present<'a> {
    form: &'a HeatSourceForm,
    /// Way since the start.
    shift: Vector<3>,
    /// P over the normalisation, in W/m^3.
    strength: f64,
}

impl HeatSource {
    fn at(&self, time: f64, dimension: usize) -> Present<'_> {
        let normalisation = match &self.form {
            HeatSourceForm::Gaussian { standard_deviation, .. } => {
                let power = i32::try_from(dimension).expect("2 or 3");
                (TAU.sqrt() * standard_deviation).powi(power)
            }
            HeatSourceForm::Box { min, max } => (0..dimension).map(|k| max[k] - min[k]).product(),
        };
        Present {
            form: &self.form,
            shift: self.velocity.map(|v| v * time),
            strength: self.power / normalisation,
        }
    }

    /// Longest step in s over which the middle stands for the whole: half a standard deviation of
    /// way, half a spacing for the sharp sides of a box.
    pub(crate) fn longest_step(&self, spacing: f64) -> f64 {
        let way = match &self.form {
            HeatSourceForm::Gaussian { standard_deviation, .. } => 0.5 * standard_deviation,
            HeatSourceForm::Box { .. } => 0.5 * spacing,
        };
        let [x, y, z] = self.velocity;
        // Infinite for a source at rest.
        way / x.hypot(y).hypot(z)
    }
}

impl Present<'_> {
    /// q at `position` in W/m^3.
    fn density<const D: usize>(&self, position: &Vector<D>) -> f64 {
        match self.form {
            HeatSourceForm::Gaussian { centre, standard_deviation } => {
                let square: f64 =
                    (0..D).map(|k| (position[k] - centre[k] - self.shift[k]).powi(2)).sum();
                let scaled = square / (standard_deviation * standard_deviation);
                if scaled > REACH * REACH { 0.0 } else { self.strength * (-0.5 * scaled).exp() }
            }
            HeatSourceForm::Box { min, max } => {
                // Half-open: sides that pass from particle to particle count each of them once.
                let inside = (0..D).all(|k| {
                    let x = position[k] - self.shift[k];
                    min[k] <= x && x < max[k]
                });
                if inside { self.strength } else { 0.0 }
            }
        }
    }
}

/// Heats by the sources during the step of length `elapsed` that ends at `time`; the heat in J (J/m in 2D).
pub(crate) fn heat_by_sources<const D: usize>(
    sources: &[HeatSource],
    particles: &mut Particles<D>,
    time: f64,
    elapsed: f64,
) -> f64 {
    if sources.is_empty() {
        return 0.0;
    }
    let middle = time - 0.5 * elapsed;
    let present: Vec<Present<'_>> = sources.iter().map(|source| source.at(middle, D)).collect();
    let Particles { position, volume, material, materials, point, .. } = particles;
    let (position, volume, material, materials) = (&*position, &*volume, &*material, &*materials);
    let supplied: Vec<f64> = point
        .par_chunks_mut(CHUNK)
        .enumerate()
        .map(|(chunk, points)| {
            let mut supplied = 0.0;
            for (offset, point) in points.iter_mut().enumerate() {
                let i = chunk * CHUNK + offset;
                let density: f64 = present.iter().map(|source| source.density(&position[i])).sum();
                let heat = density * elapsed * volume[i] * point.volume_ratio;
                let data = &materials[material[i] as usize];
                point.temperature = data.heated(point.temperature, heat, volume[i]);
                supplied += heat;
            }
            supplied
        })
        .collect();
    // Chunk by chunk: the sum does not depend on the number of threads.
    supplied.iter().sum()
}
