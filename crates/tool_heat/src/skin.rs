//! The surface of the tool in space that particles can touch: which nodes a contact heats.

use crate::outline::double_area;
use glam::{DVec2, DVec3};
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// Most corners of a triangle clipped by a square.
const MOST_CORNERS: usize = 7;
/// Least part of a square that must meet the skin.
const LEAST_COVER: f64 = 1e-9;

/// One triangle with the numbers of its nodes.
#[derive(Debug, Clone, Copy)]
struct Piece {
    corners: [DVec3; 3],
    nodes: [u32; 3],
}

impl Piece {
    /// Weights of the corners in the point nearest to `x` (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
    fn nearest(&self, x: DVec3) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let (ab, ac, ax) = (b - a, c - a, x - a);
        let (d1, d2) = (ab.dot(ax), ac.dot(ax));
        if d1 <= 0.0 && d2 <= 0.0 {
            return [1.0, 0.0, 0.0];
        }
        let bx = x - b;
        let (d3, d4) = (ab.dot(bx), ac.dot(bx));
        if d3 >= 0.0 && d4 <= d3 {
            return [0.0, 1.0, 0.0];
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            let share = d1 / (d1 - d3);
            return [1.0 - share, share, 0.0];
        }
        let cx = x - c;
        let (d5, d6) = (ab.dot(cx), ac.dot(cx));
        if d6 >= 0.0 && d5 <= d6 {
            return [0.0, 0.0, 1.0];
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            let share = d2 / (d2 - d6);
            return [1.0 - share, 0.0, share];
        }
        let va = d3 * d6 - d5 * d4;
        if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
            let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            return [0.0, 1.0 - share, share];
        }
        let whole = va + vb + vc;
        [va / whole, vb / whole, vc / whole]
    }

    /// Two axes across the normal, right-handed with it: along the axes of space where the triangle is.
    fn axes(&self) -> [DVec3; 2] {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a);
        let unit = |vector: DVec3| vector / vector.length();
        let second = unit(normal.cross(DVec3::AXES[normal.abs().min_position()]));
        [unit(second.cross(normal)), second]
    }

    fn at(&self, weights: &[f64; 3]) -> DVec3 {
        let [a, b, c] = self.corners;
        weights[0] * a + weights[1] * b + weights[2] * c
    }
}

impl RTreeObject for Piece {
    type Envelope = AABB<[f64; 3]>;
    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.corners.map(|corner| corner.to_array()))
    }
}

impl PointDistance for Piece {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from(*point);
        point.distance_squared(self.at(&self.nearest(point)))
    }
}

/// The triangles that can be touched.
#[derive(Debug)]
pub(crate) struct Skin {
    tree: RTree<Piece>,
}

impl Skin {
    pub(crate) fn new(nodes: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let piece = |numbers: &[u32; 3]| Piece {
            corners: numbers.map(|node| nodes[node as usize]),
            nodes: *numbers,
        };
        Self { tree: RTree::bulk_load(triangles.iter().map(piece).collect()) }
    }

    /// Bytes, the inner boxes of the tree included.
    pub(crate) fn memory(&self) -> usize {
        self.tree.size() * (size_of::<Piece>() + size_of::<AABB<[f64; 3]>>() / 2)
    }

    /// Adds the shares of the nodes in the square of side `width` about the foot of `middle`: integrals of
    /// their shape functions over what of the skin lies behind it, seen along the normal there. They
    /// add up to 1. On a plane, squares side by side give each node what belongs to it.
    pub(crate) fn footprint(&self, middle: DVec3, width: f64, shares: &mut Vec<(u32, f64)>) {
        let first = shares.len();
        let nearest = self.tree.nearest_neighbor(&middle.to_array()).expect("a skin has triangles");
        let weights = nearest.nearest(middle);
        let foot = nearest.at(&weights);
        let axes = nearest.axes();
        let corner = |way: f64| (foot + 0.5 * std::f64::consts::SQRT_2 * way).to_array();
        let mut whole = 0.0;
        // The order is that of the tree, which is that of its making.
        let range = AABB::from_corners(corner(-width), corner(width));
        for piece in self.tree.locate_in_envelope_intersecting(&range) {
            let flat = piece.corners.map(|corner| {
                let way = corner - foot;
                DVec2::from(axes.map(|axis| way.dot(axis) / width))
            });
            let parts = covered(&flat);
            for (node, part) in piece.nodes.iter().zip(parts) {
                whole += part;
                match shares[first..].iter().position(|known| known.0 == *node) {
                    Some(known) => shares[first + known].1 += part,
                    None => shares.push((*node, part)),
                }
            }
        }
        if whole < LEAST_COVER {
            shares.truncate(first);
            shares.extend(nearest.nodes.iter().copied().zip(weights));
            return;
        }
        shares[first..].iter_mut().for_each(|share| share.1 /= whole);
    }
}

/// Integrals of the shape functions of a triangle over its part in the unit square about the origin;
/// nothing if it is seen from behind.
fn covered(triangle: &[DVec2; 3]) -> [f64; 3] {
    let whole = double_area(triangle[0], triangle[1], triangle[2]);
    if whole <= 0.0 {
        return [0.0; 3];
    }
    let mut polygon = [DVec2::ZERO; MOST_CORNERS];
    polygon[..3].copy_from_slice(triangle);
    let mut count = 3;
    for (axis, side) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
        let inside = |point: DVec2| 0.5 - side * point[axis];
        let old = polygon;
        let mut kept = 0;
        for k in 0..count {
            let (here, next) = (old[k], old[(k + 1) % count]);
            let (s, t) = (inside(here), inside(next));
            if s >= 0.0 {
                polygon[kept] = here;
                kept += 1;
            }
            if s * t < 0.0 {
                let share = s / (s - t);
                polygon[kept] = here + share * (next - here);
                kept += 1;
            }
        }
        count = kept;
        if count < 3 {
            return [0.0; 3];
        }
    }
    let mut parts = [0.0; 3];
    for k in 1..count - 1 {
        let fan = [polygon[0], polygon[k], polygon[k + 1]];
        let area = 0.5 * double_area(fan[0], fan[1], fan[2]);
        let middle = (fan[0] + fan[1] + fan[2]) / 3.0;
        for (corner, part) in parts.iter_mut().enumerate() {
            let (next, last) = (triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]);
            *part += area * double_area(middle, next, last) / whole;
        }
    }
    parts
}
