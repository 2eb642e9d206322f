//! Particle shifting: particles that flow has crowded together are moved apart.
//!
//! Material that is drawn out carries its particles into strings: those along one direction leave each other, those
//! across it meet. Corrected operators are exact for linear fields on any arrangement, so no force sees it; but strings
//! and clumps see velocities that alternate from one to the next, their stresses point at random, and a layer that has
//! flowed far (secondary shear zone, stagnation in front of a round edge, machined surface) loses strength, mixes and tears.
//! At each reference update a particle that flows moves away from neighbours closer than `r_s`:
//! ```text
//! delta_i = - sum_j a_ij V_j/(V_i + V_j) (r_s - r_ij)+ X_ij/r_ij,    a_ij = min(a_i, a_j)
//! a = min(beta d_eps_p, 1/2) min(max((eps_p - eps_0)/(eps_1 - eps_0), 0), 1)
//! ```
//! (d_eps_p: plastic strain since the last update; beta = 10). Only places change: velocity, stress, volume and temperature stay
//! those of the particle, so both energies and linear momentum are exact, and a pair's centre of mass stays where it was.
//! After the particle shifting of Xu, Stansby and Laurence (Journal of Computational Physics 228 (2009) 6703), which moves
//! particles of a fluid down the gradient of their concentration; here pair by pair, since a sum over a support that ends at a
//! surface has a gradient there too.
//!
//! A stretch of e brings neighbours together as exp(-e), so their distance settles where `beta (r_s - r)` is r: at 0.91 dx for the
//! default, instead of falling without end. What is sheared once, as in the shear zone of a chip, lies below `eps_0` and is not shifted.
//!
//! On the tool the surface of the material stays where it is: the half thickness of a particle takes up what its
//! centre moves along the normal, and the gap of the contact does not change.
//!
//! **Limits.** A particle carries its state to a place where the material has another one: by a twentieth of a spacing at an update, in no
//! preferred direction, which is a diffusion of all fields over less than a spacing for each strain of one. Angular momentum changes
//! by the same order. The energy of the repulsion of pairs (`pairing.rs`) that shifting releases belongs to the error of the balance.

use crate::contact::tool_contact::ToolContact;
use crate::numerics::Numerics;
use crate::operators::kinship::pair_mean;
use crate::operators::reference::ReferenceConfiguration;
use crate::operators::sweeps::{Sweeps, exchange_width};
use crate::parallel::{CHUNK, TURN};
use crate::particles::Particles;
use crate::particles::supports::FREE;
use crate::tensor::{dot, minus, plus_scaled};
use rayon::prelude::*;

/// beta: what of an overlap goes for a plastic strain of one.
const RATE: f64 = 10.0;
/// Largest share of an overlap that goes at once.
const LARGEST: f64 = 0.5;
/// Plastic strain from which on particles are shifted.
const ONSET: f64 = 0.7;
/// Plastic strain from which on they are in full.
const FULL: f64 = 1.2;
/// A particle on the tool keeps a half thickness between these, in spacings.
const HALF_THICKNESS: (f64, f64) = (0.1, 1.0);

/// Moves crowded particles apart, `elapsed` after the last reference update; an update has to follow, which finds the forces
/// anew. Nothing without a `shifting_distance`.
pub(crate) fn shift<const D: usize>(
    particles: &mut Particles<D>,
    reference: &ReferenceConfiguration<D>,
    sweeps: &mut Sweeps,
    tool: Option<&mut ToolContact<D>>,
    numerics: &Numerics,
    elapsed: f64,
) {
    if numerics.shifting_distance == 0.0 {
        return;
    }
    let width = exchange_width::<D>();
    let amount = |i: usize| {
        let point = &particles.point[i];
        let flown = ((point.plastic_strain - ONSET) / (FULL - ONSET)).clamp(0.0, 1.0);
        let free = particles.hold[i] == FREE;
        if free { (RATE * point.plastic_strain_rate * elapsed).min(LARGEST) * flown } else { 0.0 }
    };
    sweeps.exchange.par_chunks_mut(CHUNK * width).enumerate().with_max_len(TURN).for_each(
        |(chunk, places)| {
            for (offset, place) in places.chunks_exact_mut(width).enumerate() {
                place[0] = amount(chunk * CHUNK + offset);
            }
        },
    );
    let exchange = &sweeps.exchange;
    let Particles { position, volume, force, .. } = particles;
    let (position, volume) = (&*position, &*volume);
    let least = numerics.shifting_distance * numerics.spacing;
    // The forces are found anew afterwards and lend their room.
    let moves = &mut *force;
    moves.par_chunks_mut(CHUNK).enumerate().with_max_len(TURN).for_each(|(chunk, moves)| {
        for (offset, way) in moves.iter_mut().enumerate() {
            let i = chunk * CHUNK + offset;
            *way = [0.0; D];
            let own = exchange[i * width];
            if own == 0.0 {
                continue;
            }
            let (index, _) = reference.list.row(i);
            for &j in index {
                let j = j as usize;
                let share = own.min(exchange[j * width]);
                let apart = minus(&position[j], &position[i]);
                let distance = dot(&apart, &apart).sqrt();
                let overlap = least * pair_mean(&reference.sizes, i, j) - distance;
                if share > 0.0 && overlap > 0.0 && distance > 0.0 {
                    let share = share * volume[j] / (volume[i] + volume[j]);
                    *way = plus_scaled(way, -share * overlap / distance, &apart);
                }
            }
        }
    });
    if let Some(tool) = tool {
        keep_gaps(particles, tool, numerics.spacing);
    }
    let Particles { position, force: moves, .. } = particles;
    for (position, way) in position.iter_mut().zip(&*moves) {
        *position = plus_scaled(position, 1.0, way);
    }
}

/// Lets the half thicknesses of the particles near the tool take up what they are about to move along its normal.
fn keep_gaps<const D: usize>(
    particles: &mut Particles<D>,
    tool: &mut ToolContact<D>,
    spacing: f64,
) {
    for (i, normal) in tool.near_normals() {
        let before = particles.point[i].half_thickness;
        if before == 0.0 {
            continue;
        }
        let along = dot(&particles.force[i], &normal);
        let spacing = spacing * particles.size(i);
        let (thinnest, thickest) = (HALF_THICKNESS.0 * spacing, HALF_THICKNESS.1 * spacing);
        // What is beyond a limit already may come back.
        let after = (before + along).clamp(thinnest.min(before), thickest.max(before));
        particles.point[i].half_thickness = after;
        let excess = along - (after - before);
        particles.force[i] = plus_scaled(&particles.force[i], -excess, &normal);
    }
    tool.follow_half_thicknesses(particles);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Engine;
    use crate::setup::{Setup, Tool};
    use crate::tensor::Vector;
    use sphcut_geometry::tool_surface::ToolSurface;
    use sphcut_physics::{Values, friction};

    const SPACING: f64 = 0.05;
    const ELAPSED: f64 = 1e-3;

    /// A square of 16 x 16 particles that flow at a rate and have the strain given.
    fn flowing(strain: f64, rate: f64) -> Engine<2> {
        let setup = Setup::elastic_square(SPACING, 0.8);
        let mut engine = Engine::<2>::new(&setup).unwrap();
        for point in &mut engine.particles.point {
            (point.plastic_strain, point.plastic_strain_rate) = (strain, rate);
        }
        engine.numerics.shifting_distance = 0.75;
        engine
    }

    /// Brings a particle to 0.3 spacings from its neighbour to the right; the two.
    fn crowd(engine: &mut Engine<2>) -> [usize; 2] {
        let place = |engine: &Engine<2>, x: [f64; 2]| {
            let square = |p: &Vector<2>| dot(&minus(p, &x), &minus(p, &x));
            engine.particles.position.iter().position(|p| square(p) < 1e-6).unwrap()
        };
        let pair = [place(engine, [0.425, 0.425]), place(engine, [0.475, 0.425])];
        engine.particles.position[pair[0]][0] += 0.7 * SPACING;
        pair
    }

    fn shifted(engine: &mut Engine<2>) -> Vec<Vector<2>> {
        let before = engine.particles.position.clone();
        let Engine { particles, reference, sweeps, numerics, .. } = engine;
        shift(particles, reference, sweeps, None, numerics, ELAPSED);
        particles.position.iter().zip(&before).map(|(a, b)| minus(a, b)).collect()
    }

    #[test]
    fn a_crowded_pair_parts_about_its_centre() {
        // A strain of 0.02 since the last update takes a fifth of the overlap.
        let mut engine = flowing(2.0, 20.0);
        let [i, j] = crowd(&mut engine);
        let ways = shifted(&mut engine);
        let expected = 0.5 * 0.2 * (0.75 - 0.3) * SPACING;
        assert!((ways[j][0] - expected).abs() < 1e-12, "{ways:?}");
        assert!((ways[i][0] + expected).abs() < 1e-12 && ways[i][1].abs() < 1e-12);
        assert!(ways.iter().filter(|way| dot(way, way) > 0.0).count() == 2);
        // However much it flows, half of it at once.
        let mut engine = flowing(2.0, 1e4);
        let [_, j] = crowd(&mut engine);
        assert!((shifted(&mut engine)[j][0] - 0.5 * 0.5 * 0.45 * SPACING).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_crowded_or_does_not_flow_stays() {
        let stays = |engine: &mut Engine<2>| shifted(engine).iter().all(|way| *way == [0.0; 2]);
        assert!(stays(&mut flowing(2.0, 20.0)), "an undisturbed lattice");
        for (strain, rate) in [(ONSET, 20.0), (2.0, 0.0)] {
            let mut engine = flowing(strain, rate);
            crowd(&mut engine);
            assert!(stays(&mut engine), "{strain} {rate}");
        }
    }

    #[test]
    fn on_the_tool_no_gap_changes() {
        let law = friction::find("coulomb").unwrap();
        let mut setup = Setup::elastic_square(SPACING, 0.8);
        let corners = vec![[0.83, -0.5], [2.0, -0.5], [2.0, 1.3], [0.83, 1.3]];
        setup.tool = Some(Tool {
            surface: ToolSurface::Polygon(corners),
            velocity: [-50.0, 0.0, 0.0],
            velocity_changes: Vec::new(),
            edge_radius: None,
            friction: law,
            friction_values: Values::resolve(law.parameters, &[("friction_coefficient", 0.0)])
                .unwrap(),
            heat: None,
        });
        let mut engine = Engine::<2>::new(&setup).unwrap();
        while engine.tool.as_ref().unwrap().touches.is_empty() {
            engine.advance(&mut |_| ()).unwrap();
        }
        let Engine { particles, tool, .. } = &mut engine;
        let tool = tool.as_mut().unwrap();
        let half = |particles: &Particles<2>, i: usize| particles.point[i].half_thickness;
        // Along the normal, which is -x, within the limits of the half thickness and beyond them.
        for (way, kept) in [(-0.1, -0.1), (0.1, 0.1), (-3.0, -0.5), (3.0, 0.9)] {
            particles.force.fill([way * SPACING, 0.2 * SPACING]);
            let touched: Vec<usize> = tool.touches.iter().map(|t| t.particle as usize).collect();
            let before: Vec<f64> = touched.iter().map(|&i| half(particles, i)).collect();
            keep_gaps(particles, tool, SPACING);
            for ((&i, before), touch) in touched.iter().zip(before).zip(&tool.touches) {
                let [along, across] = particles.force[i];
                assert!((half(particles, i) - before + along).abs() < 1e-12, "{way}");
                assert!((along / SPACING - kept).abs() < 0.05, "{way}: {along}");
                assert!((across - 0.2 * SPACING).abs() < 1e-12);
                assert!(
                    (dot(&touch.lever, &touch.lever).sqrt() - half(particles, i)).abs() < 1e-12
                );
            }
        }
    }
}
