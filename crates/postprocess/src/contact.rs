//! Length of the tool's outline that touches the workpiece.
//!
//! Each particle on which the tool presses is projected onto the outline and covers one spacing
//! of it; the contact length is the length of what is covered at least once. It is told apart
//! by the outward normal of the outline: rake side where it points along the cutting direction,
//! flank side where it points against it.

use crate::cloud::{CutPlane, Point, difference};
use sphcut_sph::Snapshot;

/// Lengths of contact in m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ContactShape {
    /// Rake face and the part of the edge that faces the cut.
    pub rake: f64,
    /// Flank face and the part of the edge that faces the machined surface.
    pub flank: f64,
}

impl ContactShape {
    /// Both together.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.rake + self.flank
    }
}

/// Forces below this share of the largest one are no contact.
const NEGLIGIBLE_FORCE: f64 = 1e-6;

/// Measures the contact; `None` without an outline.
pub(crate) fn measure(snapshot: &Snapshot, plane: CutPlane) -> Option<ContactShape> {
    let corners: Vec<Point> = snapshot.tool.iter().map(|c| plane.project(c)).collect();
    if corners.len() < 3 {
        return None;
    }
    let sides = sides(&corners);
    let size = |i: usize| snapshot.contact_force[i].iter().map(|f| f * f).sum::<f64>().sqrt();
    let forces: Vec<f64> = (0..snapshot.contact_force.len()).map(size).collect();
    let limit = NEGLIGIBLE_FORCE * forces.iter().copied().fold(0.0, f64::max);
    let mut covered: Vec<(f64, f64)> = (0..forces.len())
        .filter(|&i| forces[i] > limit)
        .map(|i| plane.project(&snapshot.position[i]))
        .filter(|point| point.iter().all(|x| x.is_finite()))
        .map(|point| {
            let arc = nearest_arc(&sides, point);
            let half = 0.5 * snapshot.particle_spacing;
            (arc - half, arc + half)
        })
        .collect();
    covered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut shape = ContactShape::default();
    let mut end = f64::NEG_INFINITY;
    for (from, to) in covered {
        add_piece(&sides, (from.max(end), to), &mut shape);
        end = end.max(to);
    }
    Some(shape)
}

/// A side of the outline.
struct Side {
    from: Point,
    to: Point,
    start: f64,
    length: f64,
    faces_cut: bool,
}

fn sides(corners: &[Point]) -> Vec<Side> {
    // The direction in which the outline runs tells which side is outside: twice the signed area.
    let next = |k: usize| corners[(k + 1) % corners.len()];
    let area: f64 =
        corners.iter().enumerate().map(|(k, a)| a[0] * next(k)[1] - a[1] * next(k)[0]).sum();
    let mut start = 0.0;
    corners
        .iter()
        .enumerate()
        .map(|(k, &from)| {
            let to = next(k);
            let along = difference(to, from);
            let length = along[0].hypot(along[1]);
            // Outward normal of a counter-clockwise outline: (dy, -dx).
            let side = Side { from, to, start, length, faces_cut: along[1] * area > 0.0 };
            start += length;
            side
        })
        .collect()
}

/// Arc length along the outline of the point of it that is nearest.
fn nearest_arc(sides: &[Side], point: Point) -> f64 {
    let mut best = (f64::INFINITY, 0.0);
    for side in sides.iter().filter(|side| side.length > 0.0) {
        let along = difference(side.to, side.from);
        let offset = difference(point, side.from);
        let share =
            ((offset[0] * along[0] + offset[1] * along[1]) / side.length.powi(2)).clamp(0.0, 1.0);
        let gap = (offset[0] - share * along[0]).hypot(offset[1] - share * along[1]);
        if gap < best.0 {
            best = (gap, side.start + share * side.length);
        }
    }
    best.1
}

/// Adds a piece of the outline to the sides it lies on; beyond the ends of the outline it wraps.
fn add_piece(sides: &[Side], piece: (f64, f64), shape: &mut ContactShape) {
    let perimeter = sides.iter().map(|side| side.length).sum::<f64>();
    for shift in [-perimeter, 0.0, perimeter] {
        for side in sides {
            let from = (piece.0 + shift).max(side.start);
            let to = (piece.1 + shift).min(side.start + side.length);
            let length = (to - from).max(0.0);
            if side.faces_cut {
                shape.rake += length;
            } else {
                shape.flank += length;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    #[test]
    fn the_drawn_contact_length_is_found() {
        let cut = SyntheticCut::default();
        let snapshot = cut.snapshot(1.2e-3);
        let contact = measure(&snapshot, CutPlane::new(CuttingFrame::default())).unwrap();
        // One row of particles of 0.12 mm; the ends may be off by half a spacing each, and the
        // row starts at the tip, around which half a spacing counts as flank.
        assert!((contact.total() - cut.contact_length).abs() < cut.particle_spacing, "{contact:?}");
        assert!(contact.flank <= 0.5 * cut.particle_spacing, "{contact:?}");
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
        for (y, force) in [(2.0, 1.0), (2.0, 1.0), (2.5, 1.0), (7.0, 2.0), (8.5, 0.0)] {
            snapshot.position.push([10.3, y, 0.0]);
            snapshot.contact_force.push([force, 0.0, 0.0]);
        }
        let contact = measure(&snapshot, CutPlane::new(CuttingFrame::default())).unwrap();
        // [1.5, 3.0] and [6.5, 7.5].
        assert!((contact.rake - 2.5).abs() < 1e-12, "{contact:?}");
        assert_eq!(contact.flank, 0.0);
        snapshot.tool.clear();
        assert_eq!(measure(&snapshot, CutPlane::new(CuttingFrame::default())), None);
    }
}
