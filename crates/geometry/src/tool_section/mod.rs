//! The cross-section of an orthogonal cutting tool as a polygon.
//!
//! Local frame: the tool cuts towards +x, the uncut surface is y = 0, and the
//! lowest point of the tool lies at y = -h. With the rake angle gamma and the
//! clearance angle alpha the outward normals are
//! `n_rake = (cos gamma, sin gamma)` and `n_flank = (-sin alpha, -cos alpha)`;
//! the edge is the arc of radius r_n tangent to both faces.
//!
//! Three changes of this base, each without effect where its lengths are zero: a chamfer or a
//! built-up edge replaces the lower part of the rake face by a face of another rake angle, and a wear
//! land or a built-up edge opens the outline at its lowest point by a straight piece along the cut.

mod built_up_edge;
mod chamfer;

pub use built_up_edge::BuiltUpEdge;
pub use chamfer::Chamfer;

use std::f64::consts::{FRAC_PI_2, PI};

/// Chords of the arc per particle spacing.
const CHORDS_PER_SPACING: f64 = 20.0;
/// Fewest chords of the arc: keeps the deviation of the polygon below 0.06 % of the radius.
const FEWEST_CHORDS: f64 = 48.0;
/// Most chords of the arc.
const MOST_CHORDS: f64 = 4000.0;

/// A tool with plane faces and a rounded edge. Lengths in m, angles in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeGeometry {
    /// gamma.
    pub rake_angle: f64,
    /// alpha.
    pub clearance_angle: f64,
    /// r_n; 0 for a sharp edge.
    pub edge_radius: f64,
    /// Depth of the lowest point below the uncut surface.
    pub uncut_chip_thickness: f64,
    /// Length of rake face and flank.
    pub face_length: f64,
    /// Initial particle spacing: the arc is resolved well below it.
    pub particle_spacing: f64,
    /// Chamfer between edge and rake face.
    pub chamfer: Option<Chamfer>,
    /// VB, length of the wear land: parallel to the cut, behind the lowest point; 0 for a new tool.
    pub wear_land: f64,
    /// Cap of work material in front of the edge.
    pub built_up_edge: Option<BuiltUpEdge>,
}

/// What leads from the edge to the rake face.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Front {
    /// Rake angle of the face that begins at the edge.
    rake_angle: f64,
    /// Where it ends and the rake face begins; `None` if it is the rake face.
    corner: Option<[f64; 2]>,
}

impl EdgeGeometry {
    /// Wedge angle between the faces, pi/2 - gamma - alpha; positive for a solid tool.
    #[must_use]
    pub fn wedge_angle(&self) -> f64 {
        FRAC_PI_2 - self.rake_angle - self.clearance_angle
    }

    /// The face that begins at the edge. A chamfer and a built-up edge exclude each other.
    fn front(&self) -> Front {
        match (&self.chamfer, &self.built_up_edge) {
            (Some(chamfer), _) => chamfer.front(self),
            (None, Some(cap)) => cap.front(self),
            (None, None) => Front { rake_angle: self.rake_angle, corner: None },
        }
    }

    /// Rake angle at the edge, that of a chamfer or a built-up edge if there is one.
    #[must_use]
    pub fn rake_angle_at_edge(&self) -> f64 {
        self.front().rake_angle
    }

    /// Length of the straight piece along the cut at the lowest point.
    fn opening(&self) -> f64 {
        self.wear_land + self.built_up_edge.map_or(0.0, |cap| cap.length)
    }

    /// The closed counter-clockwise polygon, its foremost lowest point at (0, -h) (sharp: the tip).
    #[must_use]
    pub fn polygon(&self) -> Vec<[f64; 2]> {
        let front = self.front();
        let mut points = self.edge(front.rake_angle);
        points.extend(front.corner);
        let (first, last) = (points[0], points[points.len() - 1]);
        let along_flank = [-self.clearance_angle.cos(), self.clearance_angle.sin()];
        let along_rake = [-self.rake_angle.sin(), self.rake_angle.cos()];
        let flank_end = moved(first, along_flank, self.face_length);
        let rake_end = moved(last, along_rake, self.face_length);
        points.push(rake_end);
        points.push(moved(rake_end, along_flank, self.face_length));
        points.push(flank_end);
        points
    }

    /// The edge from the flank's tangent point to that of the face with `rake_angle`.
    fn edge(&self, rake_angle: f64) -> Vec<[f64; 2]> {
        let lowest = -self.uncut_chip_thickness;
        let opening = self.opening();
        let mut points = Vec::new();
        if self.edge_radius == 0.0 {
            points.extend((opening > 0.0).then_some([-opening, lowest]));
            points.push([0.0, lowest]);
            return points;
        }
        let centre = [0.0, lowest + self.edge_radius];
        let behind = [-opening, centre[1]];
        points.extend(self.arc(behind, -FRAC_PI_2 - self.clearance_angle, -FRAC_PI_2));
        points.extend((opening > 0.0).then_some([-opening, lowest]));
        points.push([0.0, lowest]);
        points.extend(self.arc(centre, -FRAC_PI_2, rake_angle).into_iter().skip(1));
        points.push(on_circle(centre, self.edge_radius, rake_angle));
        points
    }

    /// Points of the arc from `start` (included) to `end` (excluded).
    fn arc(&self, centre: [f64; 2], start: f64, end: f64) -> Vec<[f64; 2]> {
        let per_turn = (2.0 * PI * self.edge_radius / self.particle_spacing * CHORDS_PER_SPACING)
            .clamp(FEWEST_CHORDS * 4.0, MOST_CHORDS);
        let chords = ((end - start) / (2.0 * PI) * per_turn).ceil();
        // `chords` is between 0 and MOST_CHORDS: the cast is exact.
        (0..chords as usize)
            .map(|chord| {
                let share = chord as f64 / chords;
                on_circle(centre, self.edge_radius, start + share * (end - start))
            })
            .collect()
    }
}

fn on_circle(centre: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    moved(centre, [angle.cos(), angle.sin()], radius)
}

fn moved(point: [f64; 2], direction: [f64; 2], length: f64) -> [f64; 2] {
    [point[0] + length * direction[0], point[1] + length * direction[1]]
}

/// Twice the area enclosed, positive for a counter-clockwise polygon.
#[must_use]
pub fn signed_double_area(polygon: &[[f64; 2]]) -> f64 {
    sides(polygon).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum()
}

/// The sides of a closed polygon.
fn sides(polygon: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

/// The first two sides that cross or touch without being neighbours, by number; O(n log n) on
/// usual outlines, by a sweep over x.
#[must_use]
pub fn self_intersection(polygon: &[[f64; 2]]) -> Option<(usize, usize)> {
    let all: Vec<_> = sides(polygon).collect();
    let mut order: Vec<usize> = (0..all.len()).collect();
    let left = |side: usize| all[side].0[0].min(all[side].1[0]);
    let right = |side: usize| all[side].0[0].max(all[side].1[0]);
    order.sort_by(|a, b| left(*a).total_cmp(&left(*b)));
    let mut active: Vec<usize> = Vec::new();
    for side in order {
        active.retain(|other| right(*other) >= left(side));
        for other in &active {
            let apart = side.abs_diff(*other);
            let neighbours = apart == 1 || apart == all.len() - 1;
            if !neighbours && cross(all[side], all[*other]) {
                return Some((side.min(*other), side.max(*other)));
            }
        }
        active.push(side);
    }
    None
}

/// A segment by its ends.
pub type Side = ([f64; 2], [f64; 2]);

/// Whether two closed segments share a point.
fn cross(first: Side, second: Side) -> bool {
    segment_distance(first, second) == 0.0
}

/// Distance of two segments.
fn segment_distance(first: Side, second: Side) -> f64 {
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let opposite = |u: f64, v: f64| (u > 0.0 && v < 0.0) || (u < 0.0 && v > 0.0);
    let crossing = opposite(turn(first.0, first.1, second.0), turn(first.0, first.1, second.1))
        && opposite(turn(second.0, second.1, first.0), turn(second.0, second.1, first.1));
    if crossing {
        return 0.0;
    }
    point_distance(first.0, second)
        .min(point_distance(first.1, second))
        .min(point_distance(second.0, first))
        .min(point_distance(second.1, first))
}

/// Distance of a point from a segment.
pub fn point_distance(point: [f64; 2], (a, b): Side) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let to_point = [point[0] - a[0], point[1] - a[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let share = if length_squared > 0.0 {
        ((to_point[0] * along[0] + to_point[1] * along[1]) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to_point[0] - share * along[0]).hypot(to_point[1] - share * along[1])
}

/// How far to move `polygon` along +x from the left of the rectangle `[0, length] x [-height, 0]`
/// until their distance is `gap`.
///
/// Moving by the distance that is left can never jump over the contact, because no point gets
/// closer by more than the movement; the remaining error shrinks at every step.
#[must_use]
pub fn shift_to_gap(polygon: &[[f64; 2]], length: f64, height: f64, gap: f64) -> f64 {
    let rectangle = [[0.0, 0.0], [0.0, -height], [length, -height], [length, 0.0]];
    let right_end = polygon.iter().map(|point| point[0]).fold(f64::NEG_INFINITY, f64::max);
    let mut shift = -right_end - gap;
    for _ in 0..MOST_STEPS {
        let left = distance(polygon, shift, &rectangle) - gap;
        shift += left;
        if left.abs() <= 1e-12 * (length + gap) {
            break;
        }
    }
    shift
}

/// Steps of [`shift_to_gap`]; a rake of 60 deg needs about 60.
const MOST_STEPS: usize = 500;

fn distance(polygon: &[[f64; 2]], shift: f64, rectangle: &[[f64; 2]]) -> f64 {
    let move_side = |(a, b): Side| ([a[0] + shift, a[1]], [b[0] + shift, b[1]]);
    sides(polygon)
        .map(move_side)
        .flat_map(|side| sides(rectangle).map(move |edge| segment_distance(side, edge)))
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests;
