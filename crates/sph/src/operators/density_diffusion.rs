//! Diffusion of checkerboard pressure.
//!
//! Checkerboard patterns of the volume ratio exert no force in the corrected momentum
//! equation, so nothing removes them once plastic flow has left them behind.
//! What the linear fit of J does not explain is diffused (as in delta-SPH,
//! Antuono et al. 2010):
//! ```text
//! dJ_i/dt = sum_j w_ij nu_ij (J_j - J_i - (g_i + g_j)/2 . X_ij)
//! nu_i = delta h_s^2 eps_p_dot + delta_r h_s |v_i - v_tool| min(eps_p / 0.1, 1)
//! ```
//! with the gradient `g` of J from the corrected operator and the mean `nu` of a
//! pair (weighted with the reference volumes, so that `sum V J` is kept).
//!
//! - The first term of `nu` acts while material flows: tied to the plastic strain rate it takes a
//!   fixed strain, whatever the mass scaling.
//! - The second goes on when the flow has ceased: behind the tool the rows of the machined surface
//!   are unloaded too quickly for the first, and would keep alternating pressures of 1 to 2 GPa for
//!   ever. Its clock is the way that the tool and the particle have moved past each other, in terms
//!   of `h_s`: the same at every cutting speed and mass scaling, and none without a tool. Elastic
//!   material has none of it, so that waves, vibrations and contact pressures below yield stay as
//!   they are.
//!
//! **Limits.** A pressure that varies within a few spacings in material that has flowed, as at the
//! edge of a punch, is smoothed as well (the figures are in `docs/numerics.md`). Bodies that flow
//! without a tool (impact) keep the checkerboard that their flow leaves behind. The change of stored
//! energy is booked as `density_diffusion_work`; the kick after it still has the forces from before, which leaves an error
//! of first order in the time step in the balance of energy (1e-4 of the work at most, `validation/ring_upsetting`).

use crate::material::point::MaterialPoint;
use crate::numerics::Numerics;
use crate::operators::reference::ReferenceConfiguration;
use crate::operators::sweeps::Sweeps;
use crate::parallel::{CHUNK, TURN};
use crate::particles::Particles;
use crate::tensor::{Vector, apply, dot, minus, plus_scaled};
use rayon::prelude::*;

/// Steps between two applications.
const INTERVAL: u64 = 5;
/// Share of the explicit limit that one application may use.
const SAFETY: f64 = 0.25;
/// Plastic strain from which on the second term acts in full. (At 1 it leaves 300 MPa behind the
/// tool where 0.1 leaves 55: docs/numerics.md.)
const FLOWED: f64 = 0.1;
/// What is known of each particle before the gradients: J, and nu times the pending time in m^2.
const KNOWN: usize = 2;

/// What a pair needs to know of a particle; it lies in the exchange of the force sweep.
#[derive(Debug, Clone, Copy)]
struct Smooth<const D: usize> {
    gradient: Vector<D>,
    volume_ratio: f64,
    /// nu times the pending time in m^2.
    reach: f64,
}

impl<const D: usize> Smooth<D> {
    /// Numbers of each.
    const WIDTH: usize = D + 2;

    #[inline]
    fn write(&self, place: &mut [f64]) {
        place[..D].copy_from_slice(&self.gradient);
        place[D] = self.volume_ratio;
        place[D + 1] = self.reach;
    }

    #[inline]
    fn read(all: &[f64], i: usize) -> Self {
        let place = &all[i * Self::WIDTH..(i + 1) * Self::WIDTH];
        Self {
            gradient: std::array::from_fn(|k| place[k]),
            volume_ratio: place[D],
            reach: place[D + 1],
        }
    }
}

/// Applies the diffusion every few steps of length `elapsed`; `tool` is the velocity of the tool. The stored energy that
/// it releases in J (J/m in 2D).
pub(crate) fn diffuse_when_due<const D: usize>(
    numerics: &Numerics,
    particles: &mut Particles<D>,
    reference: &ReferenceConfiguration<D>,
    sweeps: &mut Sweeps,
    (step, elapsed): (u64, f64),
    tool: Option<Vector<D>>,
) -> f64 {
    let acts = numerics.density_diffusion + numerics.residual_density_diffusion > 0.0;
    if !acts || !step.is_multiple_of(INTERVAL) {
        return 0.0;
    }
    diffuse(numerics, particles, reference, sweeps, elapsed * INTERVAL as f64, tool)
}

fn diffuse<const D: usize>(
    numerics: &Numerics,
    particles: &mut Particles<D>,
    reference: &ReferenceConfiguration<D>,
    sweeps: &mut Sweeps,
    duration: f64,
    tool: Option<Vector<D>>,
) -> f64 {
    let length = numerics.smoothing.length;
    let flowing = numerics.density_diffusion * length * length * duration;
    let left = numerics.residual_density_diffusion * length * duration;
    let Particles { materials, material, volume, motion, point, .. } = particles;
    let (materials, material, volume, motion) = (&*materials, &*material, &*volume, &*motion);
    let ReferenceConfiguration { list, frame, limits, .. } = reference;
    let largest = SAFETY / limits.weight;
    let passing = |i: usize| {
        tool.map_or(0.0, |tool| {
            let slip = minus(&tool, motion[i].velocity());
            dot(&slip, &slip).sqrt()
        })
    };
    let reach_of = |point: &MaterialPoint<D>, i: usize| {
        let size = materials[material[i] as usize].size;
        let (flowing, left) = (flowing * size * size, left * size);
        let flowed = (point.plastic_strain / FLOWED).min(1.0);
        (flowing * point.plastic_strain_rate + left * passing(i) * flowed).min(largest)
    };
    // The exchange of the force sweep, which is over, has room for what pairs need to know.
    let before = &*point;
    let count = before.len();
    let (known, rest) = sweeps.exchange.split_at_mut(KNOWN * count);
    let known_chunks = known.par_chunks_mut(KNOWN * CHUNK).enumerate().with_max_len(TURN);
    known_chunks.for_each(|(chunk, known)| {
        for (offset, known) in known.chunks_exact_mut(KNOWN).enumerate() {
            let i = chunk * CHUNK + offset;
            known[0] = before[i].volume_ratio;
            known[1] = reach_of(&before[i], i);
        }
    });
    let known = &*known;
    let reach = |i: usize| known[KNOWN * i + 1];
    let width = Smooth::<D>::WIDTH;
    let all = &mut rest[..width * count];
    let places = all.par_chunks_mut(width * CHUNK).enumerate().with_max_len(TURN);
    places.for_each(|(chunk, places)| {
        for (offset, place) in places.chunks_exact_mut(width).enumerate() {
            let i = chunk * CHUNK + offset;
            let (index, weight) = list.row(i);
            let mut sum = [0.0; D];
            // Where nothing flows or has flowed no pair asks for the gradient.
            if reach(i) > 0.0 || index.iter().any(|&j| reach(j as usize) > 0.0) {
                let own = known[KNOWN * i];
                for (&j, &w) in index.iter().zip(weight) {
                    let j = j as usize;
                    let separation = minus(motion[j].reference(), motion[i].reference());
                    sum = plus_scaled(&sum, w * (known[KNOWN * j] - own), &separation);
                }
            }
            let gradient = apply(&frame[i].correction, &sum);
            Smooth { gradient, volume_ratio: known[KNOWN * i], reach: reach(i) }.write(place);
        }
    });
    let all = &*all;
    point
        .par_chunks_mut(CHUNK)
        .zip(sweeps.tallies.par_iter_mut())
        .enumerate()
        .with_max_len(TURN)
        .for_each(|(chunk, (points, tally))| {
            let mut released = 0.0;
            for (offset, point) in points.iter_mut().enumerate() {
                let i = chunk * CHUNK + offset;
                let (index, weight) = list.row(i);
                let own = Smooth::<D>::read(all, i);
                let mut change = 0.0;
                for (&j, &w) in index.iter().zip(weight) {
                    let other = Smooth::<D>::read(all, j as usize);
                    let both = own.reach + other.reach;
                    if both == 0.0 {
                        continue;
                    }
                    let separation = minus(motion[j as usize].reference(), motion[i].reference());
                    let slope: Vector<D> =
                        std::array::from_fn(|k| 0.5 * (own.gradient[k] + other.gradient[k]));
                    let jump = other.volume_ratio - own.volume_ratio - dot(&slope, &separation);
                    change += w * 0.5 * both * jump;
                }
                let elasticity = &materials[material[i] as usize].elasticity;
                if change == 0.0 && elasticity.equation_of_state.is_none() {
                    continue;
                }
                let before = point.volumetric_energy(elasticity);
                // V_ref/V_0 makes the exchange symmetric in V_0 J.
                let smoothed = point.volume_ratio + change * frame[i].volume_ratio;
                point.set_volume_ratio(smoothed, elasticity);
                let after = point.volumetric_energy(elasticity);
                released += volume[i] * (before - after);
            }
            tally.diffused = released;
        });
    sweeps.tallies.iter().map(|tally| tally.diffused).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Engine;
    use crate::setup::{Setup, Tool};
    use crate::tensor::reduced;
    use sphcut_geometry::tool_surface::ToolSurface;
    use sphcut_physics::Values;
    use sphcut_physics::friction;

    /// A tool out of reach of the block.
    fn passing_tool(speed: f64) -> Tool {
        let law = friction::find("coulomb").unwrap();
        Tool {
            surface: ToolSurface::Polygon(vec![[2.0, 0.0], [3.0, 0.0], [2.5, 1.0]]),
            velocity: [speed, 0.0, 0.0],
            velocity_changes: Vec::new(),
            edge_radius: None,
            friction: law,
            friction_values: Values::resolve(law.parameters, &[("friction_coefficient", 0.0)])
                .unwrap(),
            heat: None,
        }
    }

    /// A square of 20 x 20 particles at rest whose rows alternate in volume on top of a gradient,
    /// and a tool that passes it.
    fn alternating(plastic_strain: f64, speed: f64) -> Engine<2> {
        let mut setup = Setup::elastic_square(0.05, 1.0);
        setup.tool = Some(passing_tool(speed));
        let mut engine = Engine::<2>::new(&setup).unwrap();
        for (point, position) in engine.particles.point.iter_mut().zip(&engine.particles.position) {
            let row = (position[1] / 0.05).floor();
            let sign = if row % 2.0 == 0.0 { 1.0 } else { -1.0 };
            point.volume_ratio = 1.0 + 0.01 * position[0] + 0.003 * sign;
            point.plastic_strain = plastic_strain;
        }
        engine
    }

    fn diffused(engine: &mut Engine<2>, duration: f64) {
        let Engine { numerics, particles, reference, sweeps, tool, ledger, .. } = engine;
        let tool = tool.as_ref().map(|tool| reduced(tool.velocity.as_ref()));
        ledger.density_diffusion += diffuse(numerics, particles, reference, sweeps, duration, tool);
    }

    /// Volume, and the checkerboard's amplitude in the middle of the block.
    fn measured(engine: &Engine<2>) -> (f64, f64) {
        let volume = engine
            .particles
            .point
            .iter()
            .zip(&engine.particles.volume)
            .map(|(p, v)| p.volume_ratio * v)
            .sum();
        let deviations = engine.particles.point.iter().zip(&engine.particles.position).filter_map(
            |(point, x)| {
                let inside = x.iter().all(|along| (0.3..0.7).contains(along));
                inside.then(|| (point.volume_ratio - 1.0 - 0.01 * x[0]).abs())
            },
        );
        (volume, deviations.fold(0.0, f64::max))
    }

    /// Way of the tool in spacings after which the checkerboard is measured.
    const WAY: f64 = 100.0;

    #[test]
    fn what_flow_left_behind_fades_and_volume_and_gradient_stay() {
        let speed = 3.0;
        let mut engine = alternating(2.0, speed);
        let (volume, amplitude) = measured(&engine);
        let energy = engine.particles.elastic_energy();
        assert!((amplitude - 0.003).abs() < 1e-12);
        for _ in 0..400 {
            diffused(&mut engine, WAY * 0.05 / speed / 400.0);
        }
        let (after, left) = measured(&engine);
        // Rounding of four hundred sums of four hundred terms.
        assert!((after - volume).abs() < 1e-12 * volume, "{after} {volume}");
        assert!(left < 0.05 * amplitude, "{left}");
        let released = energy - engine.particles.elastic_energy();
        assert!(released > 0.0);
        assert!((engine.ledger.density_diffusion - released).abs() < 1e-9 * energy);
    }

    #[test]
    fn the_way_of_the_tool_counts_and_not_its_speed() {
        let left = [0.5, 8.0].map(|speed| {
            let mut engine = alternating(0.3, speed);
            for _ in 0..100 {
                diffused(&mut engine, 0.1 * 0.05 / speed / 100.0);
            }
            measured(&engine).1
        });
        assert!(left[0] < 0.0029 && left[0] > 0.0003, "{left:?}");
        assert!((left[0] - left[1]).abs() < 1e-9 * left[0], "{left:?}");
    }

    #[test]
    fn elastic_material_and_a_tool_at_rest_keep_every_bit() {
        for (plastic_strain, speed) in [(0.0, 3.0), (2.0, 0.0)] {
            let mut engine = alternating(plastic_strain, speed);
            let before: Vec<f64> =
                engine.particles.point.iter().map(|point| point.volume_ratio).collect();
            diffused(&mut engine, 1e-3);
            let mut pairs = engine.particles.point.iter().zip(before);
            assert!(pairs.all(|(point, before)| point.volume_ratio == before));
        }
    }
}
