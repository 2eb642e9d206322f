//! Length of the tool's outline that touches the workpiece.
//!
//! Each particle in contact is projected onto the outline and covers its share of the tool's surface
//! about there: a length in the plane, in space the side of a square as large (records without it: one
//! spacing). The contact length is the length of what is covered at least once. It is told apart
//! by the outward normal of the outline: rake side where it points along the cutting direction,
//! flank side where it points against it.
//!
//! **Sticking and sliding** divide the rake side as Zorev (1963) does, by stress: a particle sticks where
//! the shear stress reaches the shear strength sigma_y / sqrt(3) of the chip (95 % of it count), so that the
//! chip shears inside, or where it does not slip at all (friction below what the law allows). The
//! sticking part is the length that such particles cover, the sliding part is the rest: there
//! friction follows the law of sliding. Of the sticking part, the length without slip is told on its own.

use crate::cloud::CutParticles;
use crate::outline::{Outline, OutlineFoot};
use sphcut_sph::Snapshot;

/// Lengths of contact in m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ContactShape {
    /// Rake face and the part of the edge that faces the cut.
    pub rake: f64,
    /// Flank face and the part of the edge that faces the machined surface.
    pub flank: f64,
    /// The part of `rake` that is covered by particles that stick. Not a number where the record
    /// does not tell.
    pub sticking: f64,
    /// The part of `sticking` without slip.
    pub without_slip: f64,
}

impl ContactShape {
    /// Rake and flank together.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.rake + self.flank
    }
}

/// Forces below this share of the largest one are no contact.
const NEGLIGIBLE_FORCE: f64 = 1e-6;

/// Share of the shear strength at which the chip shears inside.
const SHEARS_INSIDE: f64 = 0.95;

/// A particle that touches the tool.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touching {
    /// Its index in the snapshot.
    pub particle: usize,
    /// Where on the outline.
    pub foot: OutlineFoot,
    /// Length of the outline that it covers in m.
    pub width: f64,
}

/// The particles in contact, loose ones left out.
pub(crate) fn touching(
    snapshot: &Snapshot,
    cloud: &CutParticles,
    outline: &Outline,
) -> Vec<Touching> {
    let size = |i: usize| snapshot.contact_force[i].iter().map(|f| f * f).sum::<f64>().sqrt();
    let largest = cloud.source.iter().map(|&i| size(i)).fold(0.0, f64::max);
    let limit = NEGLIGIBLE_FORCE * largest;
    cloud
        .source
        .iter()
        .zip(&cloud.points)
        .filter(|(particle, _)| size(**particle) > limit || snapshot.contact_area[**particle] > 0.0)
        .map(|(&particle, &point)| Touching {
            particle,
            foot: outline.foot(point),
            width: width(snapshot, particle),
        })
        .collect()
}

/// Length of the outline that a particle covers in m.
fn width(snapshot: &Snapshot, particle: usize) -> f64 {
    match (snapshot.contact_area[particle], snapshot.dimension) {
        (area, _) if area.is_nan() => snapshot.particle_spacing,
        (area, 2) => area,
        (area, _) => area.sqrt(),
    }
}

/// Measures the contact of the particles `touching`.
pub(crate) fn measure(
    snapshot: &Snapshot,
    touching: &[Touching],
    outline: &Outline,
) -> ContactShape {
    let covered = |chosen: &dyn Fn(&Touching) -> bool| {
        covered(outline, touching.iter().filter(|t| chosen(t)), snapshot.particle_spacing)
    };
    let [rake, flank] = covered(&|_| true);
    let [sticking, _] = covered(&|t| sticks(snapshot, t.particle));
    let [without_slip, _] = covered(&|t| snapshot.friction_use[t.particle] < 1.0);
    let told = touching.iter().all(|t| is_told(snapshot, t.particle));
    let if_told = |length: f64| if told { length } else { f64::NAN };
    ContactShape { rake, flank, sticking: if_told(sticking), without_slip: if_told(without_slip) }
}

/// Whether a particle in contact does not slip, or the chip shears inside.
pub(crate) fn sticks(snapshot: &Snapshot, particle: usize) -> bool {
    snapshot.friction_use[particle] < 1.0
        || snapshot.shear_friction_factor[particle] >= SHEARS_INSIDE
}

/// Whether the record tells.
pub(crate) fn is_told(snapshot: &Snapshot, particle: usize) -> bool {
    !snapshot.friction_use[particle].is_nan() && !snapshot.shear_friction_factor[particle].is_nan()
}

/// Gaps between touching particles up to this many spacings are contact as well: on the machined surface
/// the particles of an elongated lattice lie up to two spacings apart (`resolution.lattice_aspect`).
const BRIDGED: f64 = 1.0;

/// Length of the outline that is covered at least once: rake and flank side.
fn covered<'a>(
    outline: &Outline,
    touching: impl Iterator<Item = &'a Touching>,
    spacing: f64,
) -> [f64; 2] {
    let piece = |t: &Touching| (t.foot.arc - 0.5 * t.width, t.foot.arc + 0.5 * t.width);
    let mut pieces: Vec<(f64, f64)> = touching.map(piece).collect();
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut lengths = [0.0; 2];
    let mut end = f64::NEG_INFINITY;
    for (from, to) in pieces {
        let from = if from <= end + BRIDGED * spacing { end } else { from };
        add_piece(outline, (from, to.max(from)), &mut lengths);
        end = end.max(to);
    }
    lengths
}

/// Adds a piece of the outline to the sides it lies on; beyond the ends of the outline it wraps.
fn add_piece(outline: &Outline, piece: (f64, f64), lengths: &mut [f64; 2]) {
    for shift in [-outline.perimeter, 0.0, outline.perimeter] {
        for side in &outline.sides {
            let from = (piece.0 + shift).max(side.start);
            let to = (piece.1 + shift).min(side.start + side.length);
            lengths[usize::from(!side.faces_cut())] += (to - from).max(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::CutPlane;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    fn measured(snapshot: &Snapshot) -> Option<ContactShape> {
        let plane = CutPlane::new(CuttingFrame::default());
        let outline = Outline::of(snapshot, plane)?;
        let touching = touching(snapshot, &CutParticles::new(snapshot, plane), &outline);
        Some(measure(snapshot, &touching, &outline))
    }

    #[test]
    fn the_drawn_contact_length_is_found() {
        let cut = SyntheticCut::default();
        let snapshot = cut.snapshot(1.2e-3);
        let contact = measured(&snapshot).unwrap();
        // One row of particles of 0.12 mm; the ends may be off by half a spacing each, and the
        // row starts at the tip, around which half a spacing counts as flank.
        assert!((contact.total() - cut.contact_length).abs() < cut.particle_spacing, "{contact:?}");
        assert!(contact.flank <= 0.5 * cut.particle_spacing, "{contact:?}");
        // The first 40 um stick, the first 20 without slip: half a spacing to either side belongs
        // to them as well.
        let within = |length: f64, drawn: f64| (length - drawn).abs() < cut.particle_spacing;
        assert!(within(contact.sticking, cut.sticking_length), "{contact:?}");
        assert!(within(contact.without_slip, 0.5 * cut.sticking_length), "{contact:?}");
    }

    #[test]
    fn loose_particles_at_the_tool_are_no_contact_and_old_records_do_not_tell_what_sticks() {
        let cut = SyntheticCut { disorder: 0.0, ..SyntheticCut::default() };
        let mut snapshot = cut.snapshot(0.6e-3);
        let before = measured(&snapshot).unwrap();
        // A crumb that touches the rake face 0.5 mm above the edge, with a large force.
        let crumb = snapshot.id.len() - 1;
        let (sine, cosine) = cut.rake_angle.sin_cos();
        snapshot.position[crumb] =
            [0.6e-3 - sine * 0.5e-3 + cosine * 5e-6, -0.1e-3 + cosine * 0.5e-3, 0.0];
        snapshot.contact_force[crumb] = [1e6, 0.0, 0.0];
        assert_eq!(measured(&snapshot).unwrap(), before);
        snapshot.friction_use.fill(f64::NAN);
        snapshot.contact_area.fill(f64::NAN);
        let old = measured(&snapshot).unwrap();
        assert_eq!((old.rake, old.sticking.is_nan()), (before.rake, true));
    }

    #[test]
    fn a_gap_does_not_count_and_a_doubled_particle_counts_once() {
        let mut snapshot = Snapshot {
            dimension: 2,
            particle_spacing: 1.0,
            // Counter-clockwise square; the side at x = 10 faces the cut.
            tool: vec![[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]],
            ..Snapshot::default()
        };
        // A row of material beside it holds them together.
        let row = (0..40).map(|k| ([11.3, 0.25 * f64::from(k)], 0.0, 0.0));
        let touching =
            [(2.0, 1.0, 1.0), (2.0, 1.0, 1.0), (2.5, 1.0, 0.3), (7.0, 2.0, 1.0), (8.5, 0.0, 0.0)];
        let touching = touching.map(|(y, force, used)| ([10.3, y], force, used));
        for ([x, y], force, used) in row.chain(touching) {
            snapshot.position.push([x, y, 0.0]);
            snapshot.contact_force.push([force, 0.0, 0.0]);
            snapshot.friction_use.push(used);
            snapshot.shear_friction_factor.push(0.3);
            snapshot.contact_area.push(f64::from(force > 0.0));
        }
        let contact = measured(&snapshot).unwrap();
        // [1.5, 3.0] and [6.5, 7.5]; of them [2.0, 3.0] sticks.
        assert!((contact.rake - 2.5).abs() < 1e-12, "{contact:?}");
        assert!((contact.sticking - 1.0).abs() < 1e-12, "{contact:?}");
        assert_eq!(contact.flank, 0.0);
        // The last that touches, 1.5 spacings from the others: [1.5, 3.0] and [3.5, 4.5] are one contact.
        snapshot.position[43][1] = 4.0;
        let bridged = measured(&snapshot).unwrap();
        assert!((bridged.rake - 3.0).abs() < 1e-12, "{bridged:?}");
        snapshot.tool.clear();
        assert_eq!(measured(&snapshot), None);
    }
}
