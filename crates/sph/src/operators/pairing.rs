//! Repulsion of neighbours that crowd (artificial stress).
//!
//! Material that is compressed along one direction brings neighbours to half a spacing, and some go
//! on until they coincide: the gradient of a kernel vanishes with the distance, the corrected operators
//! do not see how far a pair is apart, and each renewal of the reference forgets it (the pairing
//! instability, Dehnen & Aly 2012; Monaghan 2000 opposes it with an artificial stress). A pair carries
//! the material of two at the place of one, which leaves gaps elsewhere. Neighbours closer than `r_c`
//! therefore repel along the line of centres:
//! ```text
//! f = k (r_c - r),   k = 0.1 M dx^(D-2),   M = K + 4G/3,   r_c = 0.35 dx
//! ```
//! The force is central and the same for both, so both momenta are kept; it is conservative, and its
//! stored energy is the channel `artificial_stress_work`.
//!
//! **Limits.** Anything that keeps all particles apart resists the deformation of the whole: so `r_c`
//! lies below the distance to which affine compression brings neighbours in a chip (0.5 dx), and the
//! stiffness is a tenth of a contact's. The effect on forces and pictures is in `docs/numerics.md`.

use crate::engine::Engine;
use crate::tensor::{dot, minus, plus_scaled};

/// Stiffness of the repulsion over the p-wave modulus.
const STIFFNESS: f64 = 0.1;
/// Neighbours within this many spacings beyond `r_c` are watched until the next renewal.
const MARGIN: f64 = 0.3;

impl<const D: usize> Engine<D> {
    /// Distance in m below which neighbours repel.
    fn core_distance(&self) -> f64 {
        self.numerics.core_distance * self.spacing
    }

    /// k in N/m (N/m^2 in 2D).
    fn core_stiffness(&self) -> f64 {
        STIFFNESS * self.stiffest * self.spacing.powi(D as i32 - 2)
    }

    /// Lists the neighbours that may come too close before the next renewal, each pair from both
    /// sides in the order of the first.
    pub(crate) fn find_crowded(&mut self) {
        self.crowded.clear();
        if self.numerics.core_distance == 0.0 {
            return;
        }
        let reach = self.core_distance() + MARGIN * self.spacing;
        for i in 0..self.motion.len() {
            let (index, _) = self.list.row(i);
            for &j in index {
                let apart = minus(self.motion[j as usize].reference(), self.motion[i].reference());
                if dot(&apart, &apart) < reach * reach {
                    self.crowded.push((i as u32, j));
                }
            }
        }
    }

    /// Adds the repulsion to the internal forces.
    pub(crate) fn push_crowded_apart(&mut self) {
        let (core, stiffness) = (self.core_distance(), self.core_stiffness());
        for &(i, j) in &self.crowded {
            let (i, j) = (i as usize, j as usize);
            let separation = minus(&self.position[j], &self.position[i]);
            let square = dot(&separation, &separation);
            if square < core * core && square > 0.0 {
                let distance = square.sqrt();
                let push = stiffness * (core - distance) / distance;
                self.force[i] = plus_scaled(&self.force[i], -push, &separation);
            }
        }
    }

    /// Energy stored in the repulsion in J (J/m in 2D).
    pub(crate) fn crowding_energy(&self) -> f64 {
        let core = self.core_distance();
        let overlap_square = |&(i, j): &(u32, u32)| {
            let separation = minus(&self.position[j as usize], &self.position[i as usize]);
            let overlap = (core - dot(&separation, &separation).sqrt()).max(0.0);
            overlap * overlap
        };
        // Each pair is listed from both sides.
        0.25 * self.core_stiffness() * self.crowded.iter().map(overlap_square).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Body, Dimension, Material, Setup, Shape, TemperatureTables, VelocityField};
    use sphcut_physics::Values;
    use sphcut_physics::elasticity::ElasticModuli;
    use sphcut_physics::flow_stress;

    const SPACING: f64 = 0.05;

    fn norm(x: &[f64; 2]) -> f64 {
        dot(x, x).sqrt()
    }

    /// A square of 16 x 16 particles, one of which sits next to its neighbour, and the two.
    fn with_a_pair(core_distance: f64) -> (Engine<2>, usize, usize) {
        let mut setup = Setup::empty(Dimension::Two, SPACING, 1.0);
        let law = flow_stress::find("elastic").unwrap();
        setup.materials.push(Material {
            name: "metal".to_owned(),
            density: 7850.0,
            moduli: ElasticModuli::from_young(210e9, 0.3),
            specific_heat: 480.0,
            thermal_conductivity: 0.0,
            tables: TemperatureTables::default(),
            equation_of_state: None,
            flow_stress: law,
            flow_stress_values: Values::defaults(law.parameters),
        });
        setup.bodies.push(Body {
            name: "block".to_owned(),
            material: 0,
            shape: Shape::Box { min: [0.0; 3], max: [0.8; 3], rotation: 0.0, mirrored: false },
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: 300.0,
        });
        let mut engine = Engine::<2>::new(&setup).unwrap();
        assert!(engine.crowded.is_empty(), "an undisturbed lattice");
        engine.numerics.core_distance = core_distance;
        let place = |engine: &Engine<2>, x: [f64; 2]| {
            let near = |p: &[f64; 2]| norm(&minus(p, &x)) < 0.5 * SPACING;
            engine.position.iter().position(near).unwrap()
        };
        let middle = [0.425, 0.425];
        let moved = place(&engine, middle);
        engine.position[moved][0] += 0.9 * SPACING;
        engine.position[moved][1] += 0.02 * SPACING;
        let id = engine.id[moved];
        engine.refresh();
        let moved = engine.id.iter().position(|&other| other == id).unwrap();
        let partner = (0..engine.id.len())
            .filter(|&i| i != moved)
            .min_by(|&a, &b| {
                let far = |i: usize| norm(&minus(&engine.position[i], &engine.position[moved]));
                far(a).total_cmp(&far(b))
            })
            .unwrap();
        (engine, moved, partner)
    }

    fn distance(engine: &Engine<2>, i: usize, j: usize) -> f64 {
        norm(&minus(&engine.position[i], &engine.position[j])) / SPACING
    }

    #[test]
    fn a_pair_parts_and_keeps_momentum_and_energy() {
        let (mut engine, i, j) = with_a_pair(0.35);
        let (a, b) = (engine.id[i], engine.id[j]);
        assert!(distance(&engine, i, j) < 0.11);
        assert_eq!(engine.crowded.len(), 2, "the one pair, from both sides");
        engine.sweep_gradients(0.0);
        engine.sweep_forces();
        engine.push_crowded_apart();
        let stored = engine.crowding_energy();
        // k (r_c - r)^2 / 2 of the one pair.
        let expected = 0.5 * engine.core_stiffness() * ((0.35 - 0.102) * SPACING).powi(2);
        assert!((stored - expected).abs() < 0.01 * expected, "{stored} {expected}");
        let total = |engine: &Engine<2>| {
            engine.kinetic_energy()
                + engine.elastic_energy()
                + engine.crowding_energy()
                + engine.account.hourglass
                + engine.account.residue
        };
        let before = total(&engine);
        for _ in 0..200 {
            engine.advance(&mut |_| ()).unwrap();
        }
        let find = |id: u64| engine.id.iter().position(|&other| other == id).unwrap();
        let (i, j) = (find(a), find(b));
        // Its elastic surroundings, whose reference is the pair, hold it back.
        assert!(distance(&engine, i, j) > 0.15, "{}", distance(&engine, i, j));
        assert!((total(&engine) - before).abs() < 1e-3 * stored);
        for k in 0..2 {
            let momenta =
                (0..engine.id.len()).map(|i| engine.inertia(i) * engine.motion[i].velocity()[k]);
            let (sum, size) = momenta.fold((0.0, 0.0), |(s, a), p| (s + p, a + p.abs()));
            assert!(f64::abs(sum) < 1e-10 * size, "{sum} {size}");
        }
    }

    #[test]
    fn without_repulsion_the_pair_stays() {
        let (mut engine, i, j) = with_a_pair(0.0);
        assert!(engine.crowded.is_empty());
        assert!(engine.crowding_energy() == 0.0);
        let (a, b) = (engine.id[i], engine.id[j]);
        for _ in 0..200 {
            engine.advance(&mut |_| ()).unwrap();
        }
        let find = |id: u64| engine.id.iter().position(|&other| other == id).unwrap();
        let (i, j) = (find(a), find(b));
        assert!(distance(&engine, i, j) < 0.11, "{}", distance(&engine, i, j));
    }
}
