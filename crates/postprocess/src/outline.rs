//! The outline of a plane tool in the frame of the cut: arc length, sides, rake angle.

use crate::cloud::{CutPlane, PlanePoint, difference};
use sphcut_sph::Snapshot;

/// Heights that differ by less than this share of the perimeter are one: far above rounding.
const LEVEL: f64 = 1e-9;

/// A side of the outline.
pub(crate) struct OutlineSide {
    pub from: PlanePoint,
    pub to: PlanePoint,
    /// Arc length at which it starts.
    pub start: f64,
    pub length: f64,
    /// Unit normal out of the tool.
    pub normal: PlanePoint,
}

impl OutlineSide {
    /// Whether its outward normal points along the cutting direction.
    pub fn faces_cut(&self) -> bool {
        self.normal[0] > 0.0
    }
}

/// The point of the outline nearest to a particle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OutlineFoot {
    /// Arc length.
    pub arc: f64,
    /// Index of the side.
    pub side: usize,
}

pub(crate) struct Outline {
    pub sides: Vec<OutlineSide>,
    pub perimeter: f64,
    /// +1 where the arc length grows up the rake face, else -1.
    upwards: f64,
    /// Arc length of the front end of the tool's lowest part.
    edge: f64,
    /// Height of the lowest point.
    pub lowest: f64,
    /// Position of the front end of the lowest part along the cutting direction.
    pub front: f64,
}

impl Outline {
    /// The outline in `snapshot`; `None` without one.
    pub fn of(snapshot: &Snapshot, plane: CutPlane) -> Option<Self> {
        let corners: Vec<PlanePoint> = snapshot.tool.iter().map(|c| plane.project(c)).collect();
        if corners.len() < 3 {
            return None;
        }
        // The direction in which the outline runs tells which side is outside: twice the signed area.
        let next = |k: usize| corners[(k + 1) % corners.len()];
        let area: f64 =
            corners.iter().enumerate().map(|(k, a)| a[0] * next(k)[1] - a[1] * next(k)[0]).sum();
        let upwards = area.signum();
        let mut perimeter = 0.0;
        let mut sides = Vec::with_capacity(corners.len());
        for (k, &from) in corners.iter().enumerate() {
            let to = next(k);
            let along = difference(to, from);
            let length = along[0].hypot(along[1]);
            if length > 0.0 {
                // Outward normal of a counter-clockwise outline: (dy, -dx).
                let normal = [along[1] / length * upwards, -along[0] / length * upwards];
                sides.push(OutlineSide { from, to, start: perimeter, length, normal });
                perimeter += length;
            }
        }
        let lowest = corners.iter().map(|corner| corner[1]).min_by(f64::total_cmp)?;
        let level = lowest + LEVEL * perimeter;
        let front = sides
            .iter()
            .filter(|side| side.from[1] <= level)
            .max_by(|a, b| a.from[0].total_cmp(&b.from[0]))?;
        let (edge, front) = (front.start, front.from[0]);
        Some(Self { sides, perimeter, upwards, edge, lowest, front })
    }

    /// The nearest point of the outline.
    pub fn foot(&self, point: PlanePoint) -> OutlineFoot {
        let mut best = (f64::INFINITY, OutlineFoot { arc: 0.0, side: 0 });
        for (index, side) in self.sides.iter().enumerate() {
            let along = difference(side.to, side.from);
            let offset = difference(point, side.from);
            let share = ((offset[0] * along[0] + offset[1] * along[1]) / side.length.powi(2))
                .clamp(0.0, 1.0);
            let gap = (offset[0] - share * along[0]).hypot(offset[1] - share * along[1]);
            if gap < best.0 {
                best = (gap, OutlineFoot { arc: side.start + share * side.length, side: index });
            }
        }
        best.1
    }

    /// Length along the outline from the front end of the tool's lowest part, round the edge and up
    /// the rake face.
    pub fn up_the_rake(&self, foot: OutlineFoot) -> f64 {
        let length = (self.upwards * (foot.arc - self.edge)).rem_euclid(self.perimeter);
        // Just behind the lowest point: a small negative length, not a whole turn.
        if length > 0.5 * self.perimeter { length - self.perimeter } else { length }
    }

    /// Unit vector up the rake along a side.
    pub fn up(&self, side: usize) -> PlanePoint {
        let side = &self.sides[side];
        let along = difference(side.to, side.from);
        along.map(|component| self.upwards * component / side.length)
    }

    /// Position along the cutting direction of the side that faces the cut at the height `level`;
    /// `None` above and below the tool.
    pub fn face_at(&self, level: f64) -> Option<f64> {
        let side = &self.sides[self.facing(level)?];
        let share = (level - side.from[1]) / (side.to[1] - side.from[1]);
        Some(side.from[0] + share * (side.to[0] - side.from[0]))
    }

    /// The side that faces the cut at the height `level`.
    fn facing(&self, level: f64) -> Option<usize> {
        self.sides.iter().position(|side| {
            let (low, high) = (side.from[1].min(side.to[1]), side.from[1].max(side.to[1]));
            side.faces_cut() && low < level && high >= level
        })
    }

    /// Rake angle of the side that faces the cut `height` above the lowest point, positive where it
    /// leans away from the chip; `None` without such a side.
    pub fn rake_angle(&self, height: f64) -> Option<f64> {
        let index = self.facing(self.lowest + height)?;
        let up = self.up(index);
        // No -0.
        Some((-up[0]).atan2(up[1]) + 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    #[test]
    fn the_rake_angle_and_the_way_up_the_rake_are_found_whichever_way_the_outline_runs() {
        for rake in [-15.0_f64, 0.0, 5.0, 25.0] {
            let cut = SyntheticCut { rake_angle: rake.to_radians(), ..SyntheticCut::default() };
            let mut snapshot = cut.snapshot(0.3e-3);
            for reversed in [false, true] {
                if reversed {
                    snapshot.tool.reverse();
                }
                let outline =
                    Outline::of(&snapshot, CutPlane::new(CuttingFrame::default())).unwrap();
                let found = outline.rake_angle(0.1e-3).unwrap();
                assert!((found.to_degrees() - rake).abs() < 1e-9, "{rake}: {found}");
                let (sine, cosine) = rake.to_radians().sin_cos();
                let place = |along: f64, off: f64| -> PlanePoint {
                    [0.3e-3 - sine * along + cosine * off, -0.1e-3 + cosine * along + sine * off]
                };
                let length = outline.up_the_rake(outline.foot(place(0.17e-3, 5e-6)));
                assert!((length - 0.17e-3).abs() < 1e-12, "{length}");
                let below = outline.up_the_rake(outline.foot([0.25e-3, -0.1e-3]));
                assert!(below < 0.0 && below > -0.06e-3, "{below}");
            }
        }
    }

    #[test]
    fn the_rake_of_a_rounded_edge_is_that_of_the_face_above_it() {
        // A quarter circle of 20 um below a face at 10 degrees.
        let arc = (0..=8).map(|k| {
            let angle = f64::from(k - 8) * 10.0_f64.to_radians();
            [20e-6 * angle.cos(), 20e-6 * (1.0 + angle.sin()), 0.0]
        });
        let mut corners: Vec<[f64; 3]> = vec![[-1e-3, 0.3e-3, 0.0]];
        corners.extend(arc);
        let [x, y, _] = corners[corners.len() - 1];
        let lean = 10.0_f64.to_radians();
        corners.push([x - 1e-3 * lean.sin(), y + 1e-3 * lean.cos(), 0.0]);
        let snapshot = Snapshot { tool: corners, ..Snapshot::default() };
        let outline = Outline::of(&snapshot, CutPlane::new(CuttingFrame::default())).unwrap();
        assert!((outline.rake_angle(50e-6).unwrap() - lean).abs() < 1e-9);
        assert!(outline.rake_angle(5e-6).unwrap() < 0.0);
        assert_eq!(outline.rake_angle(5e-3), None);
    }
}
