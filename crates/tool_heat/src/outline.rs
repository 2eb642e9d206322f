//! The outline of the tool as finite elements see it: short chords of an arc merged, long sides
//! divided, fine where particles can touch.

use crate::description::ToolHeat;
use glam::DVec2;

/// Growth of the element size per length away from where it is smallest.
pub(crate) const GROWTH: f64 = 0.25;
/// Largest element over the extent of the tool.
pub(crate) const COARSEST: f64 = 0.1;
/// Corners sharper than this are kept, in rad.
const SHARP: f64 = 20.0 / 180.0 * std::f64::consts::PI;
/// Chords of an arc are merged while they turn by less than this, in rad.
const MERGED: f64 = 12.0 / 180.0 * std::f64::consts::PI;

/// The closed outline, counter-clockwise; side k leads from point k to the next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeshOutline {
    pub(crate) points: Vec<DVec2>,
    /// Whether the model of the tool is cut off at side k.
    pub(crate) is_outer: Vec<bool>,
}

pub(crate) fn length(vector: DVec2) -> f64 {
    vector.x.hypot(vector.y)
}

/// Smallest and largest coordinates.
pub(crate) fn bounds(points: &[DVec2]) -> [DVec2; 2] {
    let start = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    points.iter().fold(start, |[low, high], point| [low.min(*point), high.max(*point)])
}

/// Twice the signed area of the triangle.
pub(crate) fn double_area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Distance of `x` from the segment.
pub(crate) fn segment_distance(x: DVec2, from: DVec2, to: DVec2) -> f64 {
    let (side, way) = (to - from, x - from);
    let share = (way.dot(side) / side.length_squared()).clamp(0.0, 1.0);
    length(way - share * side)
}

/// The wanted length of elements at a place.
#[derive(Debug)]
pub(crate) struct SizeField {
    smallest: f64,
    largest: f64,
    centre: DVec2,
    reach: f64,
    /// Sides that particles can touch.
    sides: Vec<[DVec2; 2]>,
}

impl SizeField {
    pub(crate) fn new(corners: &[DVec2], heat: &ToolHeat) -> Self {
        let [low, high] = bounds(corners);
        let extent = (high - low).max_element();
        let is_outer = |side: &usize| heat.outer_sides.contains(side);
        let next = |side: usize| corners[(side + 1) % corners.len()];
        let sides = (0..corners.len())
            .filter(|side| !is_outer(side))
            .map(|side| [corners[side], next(side)])
            .collect();
        Self {
            smallest: heat.element_size,
            largest: (COARSEST * extent).max(heat.element_size),
            centre: DVec2::new(heat.fine_centre[0], heat.fine_centre[1]),
            reach: heat.fine_reach,
            sides,
        }
    }

    /// Growing with the distance from the sides that can touch and, beyond `fine_reach`, with that
    /// from the place where they do.
    pub(crate) fn at(&self, x: DVec2) -> f64 {
        let along = length(x - self.centre) - self.reach;
        let free = (self.largest - self.smallest) / GROWTH;
        if along >= free {
            return self.largest;
        }
        let inwards = self
            .sides
            .iter()
            .map(|[from, to]| segment_distance(x, *from, *to))
            .fold(f64::INFINITY, f64::min);
        let away = inwards.max(along).max(0.0);
        (self.smallest + GROWTH * away).min(self.largest)
    }
}

impl MeshOutline {
    /// The polygon `corners` with sides of about the length that `size` asks for.
    pub(crate) fn new(corners: &[DVec2], heat: &ToolHeat, size: &SizeField) -> Self {
        let merged = Self::merged(corners, heat, size);
        let (mut points, mut is_outer) = (Vec::new(), Vec::new());
        for side in 0..merged.points.len() {
            let (from, to) = (merged.points[side], merged.points[(side + 1) % merged.points.len()]);
            let divided = divide(from, to, size);
            is_outer.extend(vec![merged.is_outer[side]; divided.len()]);
            points.extend(divided);
        }
        let mut outline = Self { points, is_outer };
        if let Some(coating) = &heat.coating {
            outline.make_room(coating.thickness);
        }
        outline
    }

    /// Removes the points of outer sides that lie beside the end of a coating.
    fn make_room(&mut self, thickness: f64) {
        let count = self.points.len();
        let mut stays = vec![true; count];
        for k in 0..count {
            let ends = [self.is_outer[self.previous(k)], self.is_outer[k]];
            let step = match ends {
                [false, true] => 1,
                [true, false] => count - 1,
                _ => continue,
            };
            // The coated side on the other hand of the corner.
            let far = self.points[(k + count - step) % count];
            let corner = self.points[k];
            let side = far - corner;
            let depth = |x: DVec2| double_area(corner, far, x).abs() / length(side);
            let mut point = (k + step) % count;
            // Half a thickness of room behind the end of the coating.
            while depth(self.points[point]) < 1.5 * thickness
                && self.is_outer[point]
                && self.is_outer[self.previous(point)]
                && is_straight(self, point)
            {
                stays[point] = false;
                point = (point + step) % count;
            }
        }
        let kept = |k: &usize| stays[*k];
        let old = std::mem::replace(self, Self { points: Vec::new(), is_outer: Vec::new() });
        self.points = (0..count).filter(kept).map(|k| old.points[k]).collect();
        self.is_outer = (0..count).filter(kept).map(|k| old.is_outer[k]).collect();
    }

    /// Without the corners of arcs that are finer than the elements.
    fn merged(corners: &[DVec2], heat: &ToolHeat, size: &SizeField) -> Self {
        let count = corners.len();
        let outer = |side: usize| heat.outer_sides.contains(&(side % count));
        let direction = |side: usize| corners[(side + 1) % count] - corners[side % count];
        let turn = |a: DVec2, b: DVec2| a.perp_dot(b).atan2(a.dot(b)).abs();
        let must_stay = |corner: usize| {
            let before = (corner + count - 1) % count;
            outer(before) || outer(corner) || turn(direction(before), direction(corner)) > SHARP
        };
        let start = (0..count).find(|corner| must_stay(*corner)).unwrap_or(0);
        let (mut points, mut is_outer) = (vec![corners[start]], Vec::new());
        let mut first_side = start;
        for corner in start + 1..start + count {
            let place = corners[corner % count];
            let far = length(place - points[points.len() - 1]);
            // The side that begins here ends at the next corner: it must not lose a long side.
            let longest = length(direction(corner - 1)).max(length(direction(corner)));
            let wanted = size.at(place);
            let turned = turn(direction(first_side), direction(corner));
            if must_stay(corner % count) || far >= wanted || longest >= wanted || turned > MERGED {
                is_outer.push(outer(corner - 1));
                points.push(place);
                first_side = corner;
            }
        }
        is_outer.push(outer(start + count - 1));
        Self { points, is_outer }
    }

    pub(crate) fn next(&self, point: usize) -> usize {
        (point + 1) % self.points.len()
    }

    pub(crate) fn previous(&self, point: usize) -> usize {
        (point + self.points.len() - 1) % self.points.len()
    }

    /// Whether `x` lies inside, by the even-odd rule.
    pub(crate) fn contains(&self, x: DVec2) -> bool {
        let mut inside = false;
        for (k, from) in self.points.iter().enumerate() {
            let to = self.points[self.next(k)];
            if (from.y <= x.y) != (to.y <= x.y)
                && x.x < from.x + (x.y - from.y) / (to.y - from.y) * (to.x - from.x)
            {
                inside = !inside;
            }
        }
        inside
    }

    /// Distance of `x` from the outline.
    pub(crate) fn distance(&self, x: DVec2) -> f64 {
        (0..self.points.len())
            .map(|k| segment_distance(x, self.points[k], self.points[self.next(k)]))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Whether the outline goes straight on at a point.
fn is_straight(outline: &MeshOutline, k: usize) -> bool {
    let here = outline.points[k];
    let (before, after) = (outline.points[outline.previous(k)], outline.points[outline.next(k)]);
    let scale = length(here - before) * length(after - here);
    double_area(before, here, after).abs() < 1e-6 * scale
}

/// Points of the side from `from` (included) to `to` (excluded), spaced by the wanted size.
fn divide(from: DVec2, to: DVec2, size: &SizeField) -> Vec<DVec2> {
    let whole = length(to - from);
    let at = |share: f64| from + share * (to - from);
    // Number of elements up to a place: integral of ds/size, by trapezoids finer than the size.
    let pieces = ((4.0 * whole / size.smallest).ceil().clamp(1.0, 20_000.0)) as usize;
    let mut sum = vec![0.0];
    let mut before = 1.0 / size.at(from);
    for piece in 1..=pieces {
        let here = 1.0 / size.at(at(piece as f64 / pieces as f64));
        sum.push(sum[piece - 1] + 0.5 * (before + here) * whole / pieces as f64);
        before = here;
    }
    let elements = sum[pieces].round().max(1.0);
    // At most 20 000: exact.
    (0..elements as usize)
        .map(|element| {
            let wanted = element as f64 / elements * sum[pieces];
            let piece = sum.partition_point(|value| *value <= wanted).clamp(1, pieces);
            let within = (wanted - sum[piece - 1]) / (sum[piece] - sum[piece - 1]);
            at(((piece - 1) as f64 + within) / pieces as f64)
        })
        .collect()
}
