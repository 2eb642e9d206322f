//! Repulsion of neighbours that approach too far (artificial stress).
//!
//! Material that is compressed along one direction brings neighbours to half a spacing, and some go
//! on until they coincide: the gradient of a kernel vanishes with the distance, the corrected operators
//! do not see how far a pair is apart, and each reference update forgets it (the pairing
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

use crate::contact::repulsion::RepellingPairs;
use crate::numerics::Numerics;
use crate::setup::Setup;

/// Stiffness of the repulsion over the p-wave modulus.
const STIFFNESS: f64 = 0.1;
/// Neighbours within this many spacings beyond `r_c` are watched until the next reference update.
const MARGIN: f64 = 0.3;

/// The repulsion of neighbours at risk of the pairing instability; no pairs yet.
pub(crate) fn between_neighbours<const D: usize>(
    setup: &Setup,
    numerics: &Numerics,
) -> RepellingPairs {
    let Numerics { stiffest, spacing, .. } = numerics;
    RepellingPairs {
        pairs: Vec::new(),
        distance: setup.numerics.get("core_distance") * spacing,
        stiffness: STIFFNESS * stiffest * spacing.powi(D as i32 - 2),
    }
}

/// Distance in m up to which neighbours are watched.
pub(crate) fn watched_reach(repulsion: &RepellingPairs, spacing: f64) -> f64 {
    let acts = repulsion.distance > 0.0;
    if acts { repulsion.distance + MARGIN * spacing } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use crate::engine::Engine;
    use crate::setup::Setup;
    use crate::tensor::{dot, minus};

    const SPACING: f64 = 0.05;

    fn norm(x: &[f64; 2]) -> f64 {
        dot(x, x).sqrt()
    }

    /// A square of 16 x 16 particles, one of which sits next to its neighbour, and the two.
    fn with_a_pair(core_distance: f64) -> (Engine<2>, usize, usize) {
        let setup = Setup::elastic_square(SPACING, 0.8);
        let mut engine = Engine::<2>::new(&setup).unwrap();
        assert!(engine.pairing.pairs.is_empty(), "an undisturbed lattice");
        engine.pairing.distance = core_distance * SPACING;
        let place = |engine: &Engine<2>, x: [f64; 2]| {
            let near = |p: &[f64; 2]| norm(&minus(p, &x)) < 0.5 * SPACING;
            engine.particles.position.iter().position(near).unwrap()
        };
        let middle = [0.425, 0.425];
        let moved = place(&engine, middle);
        engine.particles.position[moved][0] += 0.9 * SPACING;
        engine.particles.position[moved][1] += 0.02 * SPACING;
        let id = engine.particles.id[moved];
        engine.update_reference();
        let moved = engine.particles.id.iter().position(|&other| other == id).unwrap();
        let partner = (0..engine.particles.id.len())
            .filter(|&i| i != moved)
            .min_by(|&a, &b| {
                let far = |i: usize| {
                    norm(&minus(&engine.particles.position[i], &engine.particles.position[moved]))
                };
                far(a).total_cmp(&far(b))
            })
            .unwrap();
        (engine, moved, partner)
    }

    fn distance(engine: &Engine<2>, i: usize, j: usize) -> f64 {
        norm(&minus(&engine.particles.position[i], &engine.particles.position[j])) / SPACING
    }

    #[test]
    fn a_pair_parts_and_keeps_momentum_and_energy() {
        let (mut engine, i, j) = with_a_pair(0.35);
        let (a, b) = (engine.particles.id[i], engine.particles.id[j]);
        assert!(distance(&engine, i, j) < 0.11);
        assert_eq!(engine.pairing.pairs.len(), 2, "the one pair, from both sides");
        engine.find_internal_forces();
        engine.pairing.push_apart(&engine.particles.position, &[], &mut engine.particles.force);
        let stored = engine.pairing.energy(&engine.particles.position, &[]);
        // k (r_c - r)^2 / 2 of the one pair.
        let expected = 0.5 * engine.pairing.stiffness * ((0.35 - 0.102) * SPACING).powi(2);
        assert!((stored - expected).abs() < 0.01 * expected, "{stored} {expected}");
        let total = |engine: &Engine<2>| {
            engine.particles.kinetic_energy()
                + engine.particles.elastic_energy()
                + engine.pairing.energy(&engine.particles.position, &[])
                + engine.ledger.hourglass
                + engine.ledger.residue
        };
        let before = total(&engine);
        for _ in 0..200 {
            engine.advance(&mut |_| ()).unwrap();
        }
        let find = |id: u64| engine.particles.id.iter().position(|&other| other == id).unwrap();
        let (i, j) = (find(a), find(b));
        // Its elastic surroundings, whose reference is the pair, hold it back.
        assert!(distance(&engine, i, j) > 0.15, "{}", distance(&engine, i, j));
        assert!((total(&engine) - before).abs() < 1e-3 * stored);
        for k in 0..2 {
            let momenta = (0..engine.particles.id.len())
                .map(|i| engine.particles.inertia(i) * engine.particles.motion[i].velocity()[k]);
            let (sum, size) = momenta.fold((0.0, 0.0), |(s, a), p| (s + p, a + p.abs()));
            assert!(f64::abs(sum) < 1e-10 * size, "{sum} {size}");
        }
    }

    #[test]
    fn without_repulsion_the_pair_stays() {
        let (mut engine, i, j) = with_a_pair(0.0);
        assert!(engine.pairing.pairs.is_empty());
        assert!(engine.pairing.energy(&engine.particles.position, &[]) == 0.0);
        let (a, b) = (engine.particles.id[i], engine.particles.id[j]);
        for _ in 0..200 {
            engine.advance(&mut |_| ()).unwrap();
        }
        let find = |id: u64| engine.particles.id.iter().position(|&other| other == id).unwrap();
        let (i, j) = (find(a), find(b));
        assert!(distance(&engine, i, j) < 0.11, "{}", distance(&engine, i, j));
    }
}
