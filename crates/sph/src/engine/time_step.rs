//! The largest stable time steps: of the particles and of conduction.

use crate::engine::Engine;
use crate::material::data::MaterialData;
use crate::operators::laplacian;
use crate::parallel::CHUNK;
use crate::particles::Particles;
use rayon::prelude::*;

/// Share of the explicit limit of the hourglass damping that the time step may use.
const DAMPING_SAFETY: f64 = 0.8;
/// The same for the oscillation of a particle on the contact penalty, in terms of (m/k)^(1/2).
const CONTACT_SAFETY: f64 = 0.5;
/// Share of the explicit limit of conduction, `C_i / (2 s_i k)`, that a conduction step may use. A
/// pair weighs at most 2 [`laplacian::LARGEST`] instead of 2, so a quarter keeps every new
/// temperature between its neighbours'.
const CONDUCTION_SAFETY: f64 = 1.0 / laplacian::LARGEST;
/// The time step never falls below this share of its value on the undisturbed lattice.
const SMALLEST_TIME_STEP: f64 = 0.1;

impl<const D: usize> Engine<D> {
    /// The time step from p-waves, hourglass damping, contact penalty and conduction.
    ///
    /// p-wave: `CFL h_s / c` on the undisturbed lattice, shortened as the discrete gradient
    /// operator grows where particles crowd together.
    pub(super) fn set_time_step(&mut self) {
        let Self { particles, reference, numerics, .. } = &*self;
        let (limits, length, spacing) =
            (&reference.limits, numerics.smoothing.length, numerics.spacing);
        let growth = (reference.lattice_gradient / limits.gradient).clamp(SMALLEST_TIME_STEP, 1.0);
        let touches =
            self.tool.is_some() || !self.self_contact.pairs.is_empty() || !numerics.bonded;
        let (mut mechanical, mut thermal) = (f64::INFINITY, f64::INFINITY);
        let best_conductor =
            particles.materials.iter().map(MaterialData::best_conductivity).fold(0.0, f64::max);
        for data in &particles.materials {
            let wave = numerics.courant * length / data.wave_speed * growth;
            let wave = wave * compression_shortening(particles, data);
            let wave = wave * viscous_shortening(data, length, limits.gradient);
            mechanical = mechanical.min(wave);
            if data.hourglass > 0.0 {
                let density = data.density * numerics.mass_scaling;
                mechanical = mechanical.min(
                    DAMPING_SAFETY * density / (2.0 * limits.damping * data.hourglass / data.size),
                );
            }
            if touches {
                let contact =
                    CONTACT_SAFETY * spacing / data.wave_speed / numerics.contact_stiffness.sqrt();
                mechanical = mechanical.min(contact);
            }
            if self.conduction.acts && data.best_conductivity() > 0.0 {
                let capacity = data.density * data.least_specific_heat();
                // The harmonic mean with any other material stays below both.
                let conductivity = best_conductor.min(2.0 * data.best_conductivity());
                thermal = thermal
                    .min(CONDUCTION_SAFETY * capacity / (2.0 * limits.weight * conductivity));
            }
        }
        let sources = self.heat_sources.iter().map(|source| source.longest_step(spacing));
        let moving = sources.fold(f64::INFINITY, f64::min);
        let tool = self.tool_heat.as_ref().map_or(f64::INFINITY, |heat| heat.interval);
        let resting = thermal.min(numerics.longest_step).min(tool);
        self.clock.time_step = if numerics.mechanics { mechanical } else { resting }.min(moving);
        self.conduction.interval = thermal;
    }
}

/// Factor on the time step of a p-wave: the slowest wave over the fastest of the compressed particles of a material; 1 for a
/// linear equation of state.
fn compression_shortening<const D: usize>(particles: &Particles<D>, data: &MaterialData) -> f64 {
    let Some(state) = &data.elasticity.equation_of_state else { return 1.0 };
    let moduli = data.elasticity.moduli;
    let shear = 4.0 / 3.0 * moduli.shear * data.stiffest();
    let stiffest = particles
        .point
        .par_iter()
        .zip(&particles.material)
        .with_min_len(CHUNK)
        .filter(|(_, material)| std::ptr::eq(&particles.materials[**material as usize], data))
        .map(|(point, _)| state.bulk_stiffness(point) + shear)
        .reduce(|| 0.0, f64::max);
    let undeformed = (moduli.bulk + 4.0 / 3.0 * moduli.shear) * data.stiffest();
    (undeformed / stiffest.max(undeformed)).sqrt()
}

/// How much bulk viscosity shortens the explicit step of a p-wave: `(1 + z^2)^(1/2) - z` with the
/// damping ratio `z = alpha h_s S / 2` of the shortest mode, S = sum_j |w B X| (Belytschko, Liu,
/// Moran, Nonlinear Finite Elements, 2000, section 6.2: central differences with damping).
fn viscous_shortening(data: &MaterialData, smoothing_length: f64, gradient: f64) -> f64 {
    let impedance = data.inertial_density() * data.wave_speed * smoothing_length;
    let ratio = 0.5 * data.linear_viscosity / data.size / impedance * smoothing_length * gradient;
    ratio.hypot(1.0) - ratio
}
