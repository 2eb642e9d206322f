//! The surface of a rigid tool with its spatial index: which of its points is nearest.

use rstar::{AABB, PointDistance, RTree, RTreeObject};

type Vector3 = [f64; 3];

/// The surface of a rigid tool. Normals point out of the tool.
#[derive(Debug, Clone, PartialEq)]
pub enum ToolSurface {
    /// Closed polygon in the plane, counter-clockwise: the tool lies to the left of each side.
    Polygon(Vec<[f64; 2]>),
    /// Closed triangle mesh, vertices of each triangle counter-clockwise seen from outside.
    Triangles {
        /// Vertex coordinates.
        vertices: Vec<[f64; 3]>,
        /// Indices of the vertices of each triangle.
        triangles: Vec<[usize; 3]>,
    },
    /// A half space that is all tool: a wall.
    HalfSpace {
        /// A point of the wall.
        point: [f64; 3],
        /// Unit normal out of the wall.
        normal: [f64; 3],
    },
}

/// This surface bounds no tool.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the tool's surface is unusable: {reason}")]
pub struct ToolSurfaceError {
    /// What is wrong, with the number of the facet.
    pub reason: String,
}

/// One flat piece of the tool's surface in the tool's own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Facet {
    /// Corners; a segment repeats its second one.
    corners: [Vector3; 3],
    /// Unit normal out of the tool.
    normal: Vector3,
    kind: FacetKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FacetKind {
    Segment,
    Triangle,
    Plane,
}

/// Half-extent that stands for "everywhere" in the box of a plane, in m.
const FAR: f64 = 1e6;

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;
    fn envelope(&self) -> Self::Envelope {
        if self.kind == FacetKind::Plane {
            return AABB::from_corners([-FAR; 3], [FAR; 3]);
        }
        AABB::from_points(&self.corners)
    }
}

fn sub(a: &Vector3, b: &Vector3) -> Vector3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot3(a: &Vector3, b: &Vector3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector3, b: &Vector3) -> Vector3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn along(a: &Vector3, factor: f64, direction: &Vector3) -> Vector3 {
    [a[0] + factor * direction[0], a[1] + factor * direction[1], a[2] + factor * direction[2]]
}

/// Point of the segment `a b` closest to `x`.
fn closest_on_segment(x: &Vector3, a: &Vector3, b: &Vector3) -> Vector3 {
    let edge = sub(b, a);
    let length_square = dot3(&edge, &edge);
    let t = if length_square > 0.0 { dot3(&sub(x, a), &edge) / length_square } else { 0.0 };
    along(a, t.clamp(0.0, 1.0), &edge)
}

impl Facet {
    fn closest(&self, x: &Vector3) -> Vector3 {
        let [a, b, c] = &self.corners;
        let height = dot3(&sub(x, a), &self.normal);
        let foot = along(x, -height, &self.normal);
        match self.kind {
            FacetKind::Plane => foot,
            FacetKind::Segment => closest_on_segment(x, a, b),
            FacetKind::Triangle => {
                let inside = |p: &Vector3, q: &Vector3| {
                    dot3(&cross(&sub(q, p), &sub(&foot, p)), &self.normal) >= 0.0
                };
                if inside(a, b) && inside(b, c) && inside(c, a) {
                    return foot;
                }
                let candidates = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                    let point = closest_on_segment(x, p, q);
                    let d = sub(x, &point);
                    (dot3(&d, &d), point)
                });
                candidates.into_iter().min_by(|p, q| p.0.total_cmp(&q.0)).expect("three edges").1
            }
        }
    }
}

/// The nearest point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// Distance in m, negative inside the tool.
    pub distance: f64,
    /// Unit normal out of the tool.
    pub normal: Vector3,
}

/// The surface of a rigid tool with its spatial index.
#[derive(Debug)]
pub struct IndexedSurface {
    facets: Vec<Facet>,
    tree: RTree<IndexedFacet>,
    low: Vector3,
    high: Vector3,
    /// In the plane: length of the outline up to each facet in m.
    start: Vec<f64>,
}

#[derive(Debug, Clone)]
struct IndexedFacet {
    facet: Facet,
    index: u32,
}

impl RTreeObject for IndexedFacet {
    type Envelope = AABB<[f64; 3]>;
    fn envelope(&self) -> Self::Envelope {
        self.facet.envelope()
    }
}

impl PointDistance for IndexedFacet {
    fn distance_2(&self, point: &Vector3) -> f64 {
        let d = sub(point, &self.facet.closest(point));
        dot3(&d, &d)
    }
}

/// The nearest point of the surface with the facet it lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceFoot {
    /// Where it is.
    pub place: Vector3,
    /// Distance in m, negative inside the tool, and the normal there.
    pub nearest: NearestPoint,
    /// Its number.
    pub facet: u32,
}

impl IndexedSurface {
    /// From the description of the setup.
    ///
    /// # Errors
    /// Fewer than three corners, a degenerate or inward-facing facet, an open surface.
    pub fn new(surface: &ToolSurface) -> Result<Self, ToolSurfaceError> {
        let facets = match surface {
            ToolSurface::Polygon(corners) => polygon_facets(corners)?,
            ToolSurface::Triangles { vertices, triangles } => triangle_facets(vertices, triangles)?,
            ToolSurface::HalfSpace { point, normal } => {
                vec![Facet { corners: [*point; 3], normal: *normal, kind: FacetKind::Plane }]
            }
        };
        Ok(Self::of_facets(facets))
    }

    /// Without the facets marked; only distances from it mean something.
    pub fn without(&self, is_left_out: &[bool]) -> Self {
        let kept = self.facets.iter().zip(is_left_out).filter(|(_, left_out)| !**left_out);
        Self::of_facets(kept.map(|(facet, _)| *facet).collect())
    }

    fn of_facets(facets: Vec<Facet>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for facet in &facets {
            let envelope = facet.envelope();
            for k in 0..3 {
                low[k] = low[k].min(envelope.lower()[k]);
                high[k] = high[k].max(envelope.upper()[k]);
            }
        }
        let indexed = facets
            .iter()
            .enumerate()
            .map(|(index, facet)| IndexedFacet { facet: *facet, index: index as u32 })
            .collect();
        let start = facets
            .iter()
            .scan(0.0, |length, facet| {
                let here = *length;
                let side = sub(&facet.corners[1], &facet.corners[0]);
                *length += dot3(&side, &side).sqrt();
                Some(here)
            })
            .collect();
        Self { facets, tree: RTree::bulk_load(indexed), low, high, start }
    }

    /// Length of a closed outline in m; infinity of a half space. Without meaning in space.
    pub fn perimeter(&self) -> f64 {
        let last = self.facets.len() - 1;
        let facet = &self.facets[last];
        if facet.kind == FacetKind::Plane {
            return f64::INFINITY;
        }
        let side = sub(&facet.corners[1], &facet.corners[0]);
        self.start[last] + dot3(&side, &side).sqrt()
    }

    /// Length along the outline at `foot` of `x` in m, of a half space from its point; and at a corner of the
    /// outline, where many have their foot, the angle about it that orders them the same way, otherwise 0.
    /// Without meaning in space.
    pub fn station(&self, x: &Vector3, foot: &SurfaceFoot) -> (f64, f64) {
        let number = foot.facet as usize;
        let facet = &self.facets[number];
        let along = |normal: &Vector3, way: &Vector3| way[1] * normal[0] - way[0] * normal[1];
        if facet.kind == FacetKind::Plane {
            return (along(&facet.normal, &sub(&foot.place, &facet.corners[0])), 0.0);
        }
        let [from, to, _] = &facet.corners;
        let length = along(&facet.normal, &sub(to, from));
        let way = along(&facet.normal, &sub(x, from));
        let corner = match way {
            way if way <= 0.0 => number,
            way if way >= length => (number + 1) % self.facets.len(),
            _ => return (self.start[number] + way, 0.0),
        };
        let normal = &self.facets[corner].normal;
        let turn = along(normal, &foot.nearest.normal).atan2(dot3(normal, &foot.nearest.normal));
        (self.start[corner], turn)
    }

    /// Whether `x` (tool frame) lies within `reach` of the surface's bounding box.
    pub fn is_near(&self, x: &Vector3, reach: f64) -> bool {
        (0..3).all(|k| x[k] >= self.low[k] - reach && x[k] <= self.high[k] + reach)
    }

    /// Facets within `reach` of `x`, in the order of their index.
    pub fn facets_near(&self, x: &Vector3, reach: f64, found: &mut Vec<u32>) {
        let range = AABB::from_corners(
            [x[0] - reach, x[1] - reach, x[2] - reach],
            [x[0] + reach, x[1] + reach, x[2] + reach],
        );
        let first = found.len();
        // Boxes of large slanted facets reach far beyond them: one that is far away must not decide on which side x lies.
        let near = |f: &&IndexedFacet| {
            let d = sub(x, &self.facets[f.index as usize].closest(x));
            dot3(&d, &d) <= reach * reach
        };
        let in_box = self.tree.locate_in_envelope_intersecting(&range);
        found.extend(in_box.filter(near).map(|f| f.index));
        found[first..].sort_unstable();
    }

    /// NearestPoint point among the facets listed.
    pub fn nearest_of(&self, x: &Vector3, facets: &[u32]) -> Option<NearestPoint> {
        self.foot_of(x, facets).map(|foot| foot.nearest)
    }

    /// NearestPoint point of the whole surface, found in its tree.
    pub fn foot(&self, x: &Vector3) -> SurfaceFoot {
        let facet = self.tree.nearest_neighbor(x).expect("a surface has at least one facet");
        // All that are as near but for rounding: they decide together on which side x lies.
        let reach = (1.0 + 1e-9) * facet.distance_2(x).sqrt() + 1e-12;
        let mut near = Vec::new();
        self.facets_near(x, reach, &mut near);
        self.foot_of(x, &near).expect("the nearest facet is among them")
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> [Vector3; 2] {
        [self.low, self.high]
    }

    /// NearestPoint point among the facets listed, with the facet it lies on.
    pub fn foot_of(&self, x: &Vector3, facets: &[u32]) -> Option<SurfaceFoot> {
        let mut best: Option<(f64, Vector3, u32)> = None;
        for &index in facets {
            let facet = &self.facets[index as usize];
            let d = sub(x, &facet.closest(x));
            let square = dot3(&d, &d);
            // Of two facets that share the nearest corner, the one seen more frontally decides the side.
            let better = match best {
                None => true,
                Some((least, previous, other)) => {
                    let other = &self.facets[other as usize];
                    square < least * (1.0 - 1e-12)
                        || (square <= least * (1.0 + 1e-12)
                            && dot3(&d, &facet.normal).abs() > dot3(&previous, &other.normal).abs())
                }
            };
            if better {
                best = Some((square, d, index));
            }
        }
        best.map(|(square, d, index)| {
            let facet = &self.facets[index as usize];
            let length = square.sqrt();
            let side = if dot3(&d, &facet.normal) >= 0.0 { 1.0 } else { -1.0 };
            // On the surface itself the direction of d is noise: take the facet's normal there.
            let normal = if length > 1e-15 {
                [side * d[0] / length, side * d[1] / length, side * d[2] / length]
            } else {
                facet.normal
            };
            let nearest = NearestPoint { distance: side * length, normal };
            SurfaceFoot { place: sub(x, &d), nearest, facet: index }
        })
    }

    /// NearestPoint point of the whole surface; for checks, not for the time loop.
    pub fn nearest(&self, x: &Vector3) -> NearestPoint {
        let all: Vec<u32> = (0..self.facets.len() as u32).collect();
        self.nearest_of(x, &all).expect("a surface has at least one facet")
    }
}

fn unusable(reason: String) -> ToolSurfaceError {
    ToolSurfaceError { reason }
}

fn polygon_facets(corners: &[[f64; 2]]) -> Result<Vec<Facet>, ToolSurfaceError> {
    if corners.len() < 3 {
        return Err(unusable(format!("{} corners; a polygon needs three", corners.len())));
    }
    let next = |i: usize| (i + 1) % corners.len();
    let area: f64 = (0..corners.len())
        .map(|i| corners[i][0] * corners[next(i)][1] - corners[next(i)][0] * corners[i][1])
        .sum();
    if area <= 0.0 {
        return Err(unusable(
            "its corners run clockwise, so its normals point into the tool".to_owned(),
        ));
    }
    (0..corners.len())
        .map(|i| {
            let (a, b) = (corners[i], corners[next(i)]);
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let length = dx.hypot(dy);
            if length <= 0.0 || !length.is_finite() {
                return Err(unusable(format!("side {i} has no length")));
            }
            let (a, b) = ([a[0], a[1], 0.0], [b[0], b[1], 0.0]);
            let normal = [dy / length, -dx / length, 0.0];
            Ok(Facet { corners: [a, b, b], normal, kind: FacetKind::Segment })
        })
        .collect()
}

fn triangle_facets(
    vertices: &[Vector3],
    triangles: &[[usize; 3]],
) -> Result<Vec<Facet>, ToolSurfaceError> {
    let mut edges = std::collections::BTreeMap::new();
    let mut volume = 0.0;
    let mut facets = Vec::with_capacity(triangles.len());
    for (index, triangle) in triangles.iter().enumerate() {
        if let Some(missing) = triangle.iter().find(|&&v| v >= vertices.len()) {
            return Err(unusable(format!(
                "facet {index} uses vertex {missing}, which is not there"
            )));
        }
        let [a, b, c] = triangle.map(|v| vertices[v]);
        let area_vector = cross(&sub(&b, &a), &sub(&c, &a));
        let length = dot3(&area_vector, &area_vector).sqrt();
        if length <= 0.0 || !length.is_finite() {
            return Err(unusable(format!("facet {index} has no area")));
        }
        volume += dot3(&a, &cross(&b, &c));
        for k in 0..3 {
            let edge = (triangle[k], triangle[(k + 1) % 3]);
            if let Some(other) = edges.insert(edge, index) {
                return Err(unusable(format!(
                    "facets {other} and {index} run the same way along an edge: a flipped normal"
                )));
            }
        }
        let normal = area_vector.map(|component| component / length);
        facets.push(Facet { corners: [a, b, c], normal, kind: FacetKind::Triangle });
    }
    if let Some(((from, to), index)) =
        edges.iter().find(|((p, q), _)| !edges.contains_key(&(*q, *p)))
    {
        return Err(unusable(format!(
            "facet {index} has an open edge between vertices {from} and {to}: a hole"
        )));
    }
    if volume <= 0.0 {
        return Err(unusable("its normals point into the tool".to_owned()));
    }
    Ok(facets)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A facet of which the box alone is near must not be listed: behind its plane a particle beside the tool would lie deep
    /// inside.
    #[test]
    fn a_facet_is_near_by_its_distance_and_not_by_its_box() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let surface = IndexedSurface::new(&ToolSurface::Triangles { vertices, triangles }).unwrap();
        let near = |x: Vector3, reach: f64| {
            let mut found = Vec::new();
            surface.facets_near(&x, reach, &mut found);
            found
        };
        // In the box of the slanted facet, 1.07 before its plane.
        assert_eq!(near([0.95; 3], 0.1), Vec::<u32>::new());
        assert_eq!(near([0.95; 3], 1.08), vec![3]);
        assert_eq!(near([0.4; 3], 0.12), vec![3]);
        assert_eq!(near([-0.05, 0.2, 0.2], 0.1), vec![2]);
        assert!(surface.foot(&[-0.05, 0.2, 0.2]).nearest.distance > 0.0);
    }
}
