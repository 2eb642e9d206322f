//! Facets of a surface that pass through each other.
//!
//! Pairs whose boxes meet come from an R-tree. Two facets cross if an edge of one goes from one
//! side of the other's plane to the other side through the facet, or if both lie in one plane and
//! cover each other. Facets with a common edge can only be folded onto each other. "One side" means
//! farther from the plane than [`TOUCHING`] of the size of the mesh; mere touching is no crossing.

use super::Mesh;
use super::error::MeshError;
use super::vector::area_vector;
use glam::DVec3;
use rstar::{AABB, RTree, RTreeObject};

/// Distance that counts as touching, as a share of the size of the mesh.
const TOUCHING: f64 = 1e-9;
/// Most pairs of facets that are looked at: bounds the time on a hostile file.
const MOST_PAIRS: usize = 20_000_000;

struct Boxed {
    index: usize,
    envelope: AABB<[f64; 3]>,
}

impl RTreeObject for Boxed {
    type Envelope = AABB<[f64; 3]>;
    fn envelope(&self) -> Self::Envelope {
        self.envelope
    }
}

pub(super) fn check(mesh: &Mesh) -> Result<(), MeshError> {
    let triangles: Vec<Triangle> =
        mesh.facets.iter().map(|facet| Triangle::new(facet.corners, mesh.corners(facet))).collect();
    let boxed =
        |(index, triangle): (usize, &Triangle)| Boxed { index, envelope: triangle.envelope() };
    let tree = RTree::bulk_load(triangles.iter().enumerate().map(boxed).collect());
    let touching = TOUCHING * mesh.extent();
    let mut pairs = 0;
    for (index, triangle) in triangles.iter().enumerate() {
        let envelope = triangle.envelope();
        let mut met: Option<usize> = None;
        for other in tree.locate_in_envelope_intersecting(&envelope) {
            pairs += 1;
            if pairs > 2 * MOST_PAIRS {
                return Err(MeshError::Entangled);
            }
            // Of several the first of the file, whatever the order of the tree.
            let new = other.index > index && met.is_none_or(|found| other.index < found);
            if new && triangle.meets(&triangles[other.index], touching) {
                met = Some(other.index);
            }
        }
        if let Some(other) = met {
            return Err(MeshError::Crossing {
                first: mesh.facets[index].name,
                second: mesh.facets[other].name,
            });
        }
    }
    Ok(())
}

struct Triangle {
    vertices: [usize; 3],
    points: [DVec3; 3],
    /// Unit normal.
    normal: DVec3,
}

impl Triangle {
    fn new(vertices: [usize; 3], points: [DVec3; 3]) -> Self {
        let area = area_vector(points);
        Self { vertices, points, normal: area / area.length() }
    }

    fn envelope(&self) -> AABB<[f64; 3]> {
        AABB::from_points(&self.points.map(|point| point.to_array()))
    }

    fn meets(&self, other: &Self, touching: f64) -> bool {
        let own = |vertex: &usize| self.vertices.contains(vertex);
        let common = other.vertices.iter().filter(|vertex| own(vertex)).count();
        let heights = other.points.map(|point| self.height(point));
        if heights.iter().all(|height| *height > touching)
            || heights.iter().all(|height| *height < -touching)
        {
            return false;
        }
        let coplanar = heights.iter().all(|height| height.abs() <= touching);
        match (common, coplanar) {
            (3, _) => true,
            (2, coplanar) => coplanar && self.folded_onto(other),
            (_, true) => self.covers(other, touching) || other.covers(self, touching),
            (_, false) => {
                self.is_pierced_by(other, touching) || other.is_pierced_by(self, touching)
            }
        }
    }

    /// Distance of a point from the plane, positive outside.
    fn height(&self, point: DVec3) -> f64 {
        (point - self.points[0]).dot(self.normal)
    }

    /// Directions in the plane, into the triangle, across each side; with a point of the side.
    fn inwards(&self) -> [(DVec3, DVec3); 3] {
        std::array::from_fn(|side| {
            let (a, b) = (self.points[side], self.points[(side + 1) % 3]);
            let along = b - a;
            (a, self.normal.cross(along) / along.length())
        })
    }

    /// Whether a point of the plane lies in the triangle, at least `margin` from its sides.
    fn contains(&self, point: DVec3, margin: f64) -> bool {
        self.inwards().iter().all(|(start, inwards)| (point - start).dot(*inwards) >= margin)
    }

    /// Whether an edge of `other` passes through the triangle from side to side.
    fn is_pierced_by(&self, other: &Self, touching: f64) -> bool {
        (0..3).any(|side| {
            let (a, b) = (other.points[side], other.points[(side + 1) % 3]);
            let (above, below) = (self.height(a), self.height(b));
            above.abs() > touching
                && below.abs() > touching
                && (above > 0.0) != (below > 0.0)
                && self.contains(a + above / (above - below) * (b - a), -touching)
        })
    }

    /// Whether `other`, in the same plane, covers a part of the triangle: an inner point of one
    /// lies in the other, or sides cross.
    fn covers(&self, other: &Self, touching: f64) -> bool {
        let centre = (other.points[0] + other.points[1] + other.points[2]) / 3.0;
        if other.points.iter().chain([&centre]).any(|point| self.contains(*point, touching)) {
            return true;
        }
        // A side of `other` crosses a side: its ends lie on both sides of it, and the reverse.
        let own = self.inwards();
        let theirs = other.inwards();
        let apart = |line: &(DVec3, DVec3), a: DVec3, b: DVec3| {
            let (first, second) = ((a - line.0).dot(line.1), (b - line.0).dot(line.1));
            first.min(second) < -touching && first.max(second) > touching
        };
        (0..3).any(|i| {
            (0..3).any(|j| {
                apart(&own[i], other.points[j], other.points[(j + 1) % 3])
                    && apart(&theirs[j], self.points[i], self.points[(i + 1) % 3])
            })
        })
    }

    /// Two facets in one plane with a common edge, both on the same side of it: as neighbours run
    /// along the edge in opposite directions, their normals are then opposite.
    fn folded_onto(&self, other: &Self) -> bool {
        self.normal.dot(other.normal) < 0.0
    }
}
