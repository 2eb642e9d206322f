//! The surface of a rigid tool with its spatial index: which of its points is nearest.

use glam::{DVec2, DVec3};
use rstar::{AABB, PointDistance, RTree, RTreeObject};

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
    corners: [DVec3; 3],
    /// Unit normal out of the tool.
    normal: DVec3,
    kind: FacetKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FacetKind {
    Segment,
    Triangle,
    Plane,
}

/// Room for rounding in comparing distances, as a share of them.
const NEARLY: f64 = 1e-9;
/// The same where they vanish, in m.
const TINY: f64 = 1e-15;
/// Half-extent that stands for "everywhere" in the box of a plane, in m.
const FAR: f64 = 1e6;

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;
    fn envelope(&self) -> Self::Envelope {
        if self.kind == FacetKind::Plane {
            return AABB::from_corners([-FAR; 3], [FAR; 3]);
        }
        AABB::from_points(&self.corners.map(|corner| corner.to_array()))
    }
}

/// Point of the segment `a b` closest to `x`.
fn closest_on_segment(x: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let edge = b - a;
    let square = edge.length_squared();
    let share = if square > 0.0 { (x - a).dot(edge) / square } else { 0.0 };
    a + share.clamp(0.0, 1.0) * edge
}

impl Facet {
    fn closest(&self, x: DVec3) -> DVec3 {
        let [a, b, c] = self.corners;
        let height = (x - a).dot(self.normal);
        let foot = x - height * self.normal;
        match self.kind {
            FacetKind::Plane => foot,
            FacetKind::Segment => closest_on_segment(x, a, b),
            FacetKind::Triangle => {
                let inside = |p: DVec3, q: DVec3| (q - p).cross(foot - p).dot(self.normal) >= 0.0;
                if inside(a, b) && inside(b, c) && inside(c, a) {
                    return foot;
                }
                let candidates = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                    let point = closest_on_segment(x, p, q);
                    ((x - point).length_squared(), point)
                });
                candidates.into_iter().min_by(|p, q| p.0.total_cmp(&q.0)).expect("three edges").1
            }
        }
    }

    /// Length of its first side in m.
    fn length(&self) -> f64 {
        (self.corners[1] - self.corners[0]).length()
    }
}

/// The box around a facet along its longest side and across it: tells cheaply how far it is at least.
#[derive(Debug, Clone, Copy)]
struct Extent {
    corner: DVec3,
    along: DVec3,
    across: DVec3,
    normal: DVec3,
    /// Ends of the box along and across in m.
    low: DVec2,
    high: DVec2,
}

impl Extent {
    fn of(facet: &Facet) -> Self {
        let [a, b, c] = facet.corners;
        let longer =
            |p: DVec3, q: DVec3| if q.length_squared() > p.length_squared() { q } else { p };
        let along = longer(longer(b - a, c - b), a - c).normalize_or_zero();
        let mut extent = Self {
            corner: a,
            along,
            across: facet.normal.cross(along),
            normal: facet.normal,
            low: DVec2::ZERO,
            high: DVec2::ZERO,
        };
        for corner in [b, c] {
            extent.low = extent.low.min(extent.place(corner));
            extent.high = extent.high.max(extent.place(corner));
        }
        if facet.kind == FacetKind::Plane {
            extent.low = DVec2::NEG_INFINITY;
            extent.high = DVec2::INFINITY;
        }
        extent
    }

    /// Place of `x` along and across.
    fn place(&self, x: DVec3) -> DVec2 {
        let way = x - self.corner;
        DVec2::new(way.dot(self.along), way.dot(self.across))
    }

    /// No point of the facet is nearer to `x` than the root of this, but for rounding; in m^2.
    fn least_square(&self, x: DVec3) -> f64 {
        let place = self.place(x);
        let outside = (self.low - place).max(place - self.high).max(DVec2::ZERO);
        let height = (x - self.corner).dot(self.normal);
        outside.length_squared() + height * height
    }
}

/// The nearest point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// Distance in m, negative inside the tool.
    pub distance: f64,
    /// Unit normal out of the tool.
    pub normal: DVec3,
}

/// The surface of a rigid tool with its spatial index.
#[derive(Debug)]
pub struct IndexedSurface {
    facets: Vec<Facet>,
    extents: Vec<Extent>,
    tree: RTree<IndexedFacet>,
    low: DVec3,
    high: DVec3,
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
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from(*point);
        (point - self.facet.closest(point)).length_squared()
    }
}

/// The nearest point of the surface with the facet it lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceFoot {
    /// Where it is.
    pub place: DVec3,
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
                vec![Facet {
                    corners: [(*point).into(); 3],
                    normal: (*normal).into(),
                    kind: FacetKind::Plane,
                }]
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
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for facet in &facets {
            let envelope = facet.envelope();
            low = low.min(envelope.lower().into());
            high = high.max(envelope.upper().into());
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
                *length += facet.length();
                Some(here)
            })
            .collect();
        let extents = facets.iter().map(Extent::of).collect();
        Self { facets, extents, tree: RTree::bulk_load(indexed), low, high, start }
    }

    /// Length of a closed outline in m; infinity of a half space. Without meaning in space.
    pub fn perimeter(&self) -> f64 {
        let last = self.facets.len() - 1;
        let facet = &self.facets[last];
        if facet.kind == FacetKind::Plane {
            return f64::INFINITY;
        }
        self.start[last] + facet.length()
    }

    /// Length along the outline at `foot` of `x` in m, of a half space from its point; and at a corner of the
    /// outline, where many have their foot, the angle about it that orders them the same way, otherwise 0.
    /// Without meaning in space.
    pub fn station(&self, x: DVec3, foot: &SurfaceFoot) -> (f64, f64) {
        let number = foot.facet as usize;
        let facet = &self.facets[number];
        let along = |normal: DVec3, way: DVec3| way.y * normal.x - way.x * normal.y;
        if facet.kind == FacetKind::Plane {
            return (along(facet.normal, foot.place - facet.corners[0]), 0.0);
        }
        let [from, to, _] = facet.corners;
        let length = along(facet.normal, to - from);
        let way = along(facet.normal, x - from);
        let corner = match way {
            way if way <= 0.0 => number,
            way if way >= length => (number + 1) % self.facets.len(),
            _ => return (self.start[number] + way, 0.0),
        };
        let normal = self.facets[corner].normal;
        let turn = along(normal, foot.nearest.normal).atan2(normal.dot(foot.nearest.normal));
        (self.start[corner], turn)
    }

    /// Whether `x` (tool frame) lies within `reach` of the surface's bounding box.
    pub fn is_near(&self, x: DVec3, reach: f64) -> bool {
        (0..3).all(|k| x[k] >= self.low[k] - reach && x[k] <= self.high[k] + reach)
    }

    /// Facets within `reach` of `x` that can be the nearest of all while `x` moves by no more than `way`, in the order of
    /// their index.
    pub fn facets_near(&self, x: DVec3, reach: f64, way: f64, found: &mut Vec<u32>) {
        let range = AABB::from_corners((x - reach).to_array(), (x + reach).to_array());
        let first = found.len();
        // Boxes of large slanted facets reach far beyond them: one that is far away must not decide on which side x lies.
        let distance = |index: u32| (x - self.facets[index as usize].closest(x)).length();
        let in_box = self.tree.locate_in_envelope_intersecting(&range).map(|f| f.index);
        found.extend(in_box.filter(|&index| {
            (x - self.facets[index as usize].closest(x)).length_squared() <= reach * reach
        }));
        let nearest = found[first..].iter().map(|&f| distance(f)).fold(f64::INFINITY, f64::min);
        // By then the nearest of now has come no farther off than by `way`, and no other nearer than by as much.
        let limit = reach.min((1.0 + NEARLY) * (nearest + 2.0 * way) + TINY);
        let mut last = first;
        for place in first..found.len() {
            if distance(found[place]) <= limit {
                found[last] = found[place];
                last += 1;
            }
        }
        found.truncate(last);
        found[first..].sort_unstable();
    }

    /// NearestPoint point among the facets listed.
    pub fn nearest_of(&self, x: DVec3, facets: &[u32]) -> Option<NearestPoint> {
        self.foot_of(x, facets).map(|foot| foot.nearest)
    }

    /// NearestPoint point of the whole surface, found in its tree.
    pub fn foot(&self, x: DVec3) -> SurfaceFoot {
        let facet =
            self.tree.nearest_neighbor(&x.to_array()).expect("a surface has at least one facet");
        // All that are as near but for rounding: they decide together on which side x lies.
        let reach = (1.0 + NEARLY) * facet.distance_2(&x.to_array()).sqrt() + 1e-12;
        let mut near = Vec::new();
        self.facets_near(x, reach, f64::INFINITY, &mut near);
        self.foot_of(x, &near).expect("the nearest facet is among them")
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> [DVec3; 2] {
        [self.low, self.high]
    }

    /// NearestPoint point among the facets listed, with the facet it lies on.
    pub fn foot_of(&self, x: DVec3, facets: &[u32]) -> Option<SurfaceFoot> {
        let least = |index: u32| self.extents[index as usize].least_square(x);
        let guess =
            facets.iter().map(|&f| (least(f), f)).reduce(|a, b| if b.0 < a.0 { b } else { a })?.1;
        let guessed = (x - self.facets[guess as usize].closest(x)).length();
        // Those beyond cannot be the nearest, whatever rounding does to places.
        let limit = ((1.0 + NEARLY) * guessed + TINY).powi(2);
        let mut best: Option<(f64, DVec3, u32)> = None;
        for &index in facets {
            if least(index) > limit {
                continue;
            }
            let facet = &self.facets[index as usize];
            let d = x - facet.closest(x);
            let square = d.length_squared();
            // Of two facets that share the nearest corner, the one seen more frontally decides the side.
            let better = match best {
                None => true,
                Some((least, previous, other)) => {
                    let other = &self.facets[other as usize];
                    square < least * (1.0 - 1e-12)
                        || (square <= least * (1.0 + 1e-12)
                            && d.dot(facet.normal).abs() > previous.dot(other.normal).abs())
                }
            };
            if better {
                best = Some((square, d, index));
            }
        }
        best.map(|(square, d, index)| {
            let facet = &self.facets[index as usize];
            let length = square.sqrt();
            let side = if d.dot(facet.normal) >= 0.0 { 1.0 } else { -1.0 };
            // On the surface itself the direction of d is noise: take the facet's normal there.
            let normal = if length > TINY { side * d / length } else { facet.normal };
            let nearest = NearestPoint { distance: side * length, normal };
            SurfaceFoot { place: x - d, nearest, facet: index }
        })
    }

    /// NearestPoint point of the whole surface; for checks, not for the time loop.
    pub fn nearest(&self, x: DVec3) -> NearestPoint {
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
            let [a, b] = [a, b].map(|[x, y]| DVec3::new(x, y, 0.0));
            let normal = DVec3::new(dy / length, -dx / length, 0.0);
            Ok(Facet { corners: [a, b, b], normal, kind: FacetKind::Segment })
        })
        .collect()
}

fn triangle_facets(
    vertices: &[[f64; 3]],
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
        let [a, b, c] = triangle.map(|v| DVec3::from(vertices[v]));
        let area_vector = (b - a).cross(c - a);
        let length = area_vector.length();
        if length <= 0.0 || !length.is_finite() {
            return Err(unusable(format!("facet {index} has no area")));
        }
        volume += a.dot(b.cross(c));
        for k in 0..3 {
            let edge = (triangle[k], triangle[(k + 1) % 3]);
            if let Some(other) = edges.insert(edge, index) {
                return Err(unusable(format!(
                    "facets {other} and {index} run the same way along an edge: a flipped normal"
                )));
            }
        }
        let normal = area_vector / length;
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
        let near = |x: [f64; 3], reach: f64| {
            let mut found = Vec::new();
            surface.facets_near(x.into(), reach, f64::INFINITY, &mut found);
            found
        };
        // In the box of the slanted facet, 1.07 before its plane.
        assert_eq!(near([0.95; 3], 0.1), Vec::<u32>::new());
        assert_eq!(near([0.95; 3], 1.08), vec![3]);
        assert_eq!(near([0.4; 3], 0.12), vec![3]);
        assert_eq!(near([-0.05, 0.2, 0.2], 0.1), vec![2]);
        assert!(surface.foot(DVec3::new(-0.05, 0.2, 0.2)).nearest.distance > 0.0);
    }

    /// A sphere of radius 1 as an octahedron whose facets are parted `times` times.
    fn sphere(times: usize) -> IndexedSurface {
        let corner = |axis: usize, sign: f64| DVec3::AXES[axis] * sign;
        let mut facets = Vec::new();
        for signs in 0..8 {
            let sign = |k: usize| if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
            let [a, b, c] = [0, 1, 2].map(|k| corner(k, sign(k)));
            let outward = sign(0) * sign(1) * sign(2) > 0.0;
            facets.push(if outward { [a, b, c] } else { [a, c, b] });
        }
        for _ in 0..times {
            let part = |[a, b, c]: [DVec3; 3]| {
                let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(p, q)| (p + q).normalize());
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            };
            facets = facets.into_iter().flat_map(part).collect();
        }
        let facets = facets.into_iter().map(|corners| Facet {
            corners,
            normal: (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize(),
            kind: FacetKind::Triangle,
        });
        IndexedSurface::of_facets(facets.collect())
    }

    /// The nearest facets listed before a point moves are enough after it: nothing else decides, to the bit.
    #[test]
    fn facets_listed_before_a_move_hold_the_nearest_after_it() {
        let surface = sphere(4);
        let all: Vec<u32> = (0..surface.facets.len() as u32).collect();
        let (reach, way) = (0.25, 0.05);
        let unit = |k: i32| {
            DVec3::from([0.61803, 0.41421, 0.73205].map(|a| 2.0 * (a * f64::from(k)).fract() - 1.0))
        };
        let mut listed = 0;
        for k in 1..400 {
            let direction = unit(k).normalize();
            let x = direction * (0.85 + 0.3 * (0.32471 * f64::from(k)).fract());
            let mut near = Vec::new();
            surface.facets_near(x, reach, way, &mut near);
            listed += near.len();
            // At a corner of several facets, and anywhere.
            let corner = surface.facets[near[0] as usize].corners[0];
            let moved = x + 0.999 * way * unit(k + 77).normalize();
            for x in
                [x, moved, corner, 1.01 * corner].into_iter().filter(|y| (y - x).length() <= way)
            {
                assert_eq!(surface.foot_of(x, &near), surface.foot_of(x, &all), "{k}");
                let square = |f: &Facet| (x - f.closest(x)).length_squared();
                let least = surface.facets.iter().map(square).fold(f64::INFINITY, f64::min);
                let found = surface.foot_of(x, &all).unwrap().nearest.distance.powi(2);
                assert!((found - least).abs() <= 1e-11 * least, "{k}: {found} {least}");
            }
        }
        assert!(listed < 400 * 100, "{listed} of {}", 400 * all.len());
    }

    /// On the long triangles of an insert, from far away to less than rounding leaves of a place: facets that are passed over
    /// change nothing.
    #[test]
    fn what_is_passed_over_is_never_the_nearest() {
        let insert = crate::insert::InsertGeometry {
            nose_radius: 0.8e-3,
            edge_radius: 72e-6,
            rake_angle: 0.26,
            clearance_angle: 0.12,
            side_cutting_edge_angle: 0.087,
            front_cutting_edge_angle: 0.087,
            depth_of_cut: 50e-6,
            edge_length: 1.5e-3,
            particle_spacing: 50e-6,
            body: 2.5e-3,
        };
        let (vertices, triangles) = insert.surface();
        let vertices = vertices.into_iter().map(|v| v.to_array()).collect();
        let surface = IndexedSurface::new(&ToolSurface::Triangles { vertices, triangles }).unwrap();
        let all: Vec<u32> = (0..surface.facets.len() as u32).collect();
        let count = surface.facets.len();
        for (k, facet) in surface.facets.iter().enumerate().step_by(count / 60) {
            let [a, b, c] = facet.corners;
            for height in [0.0, 1e-17, 1e-13, 1e-12, 3e-11, 1e-10, 1e-9, 1e-6, 1e-3] {
                for place in [(a + b + c) / 3.0, a, 0.5 * (a + b)] {
                    let x = place + height * facet.normal;
                    let found = surface.foot_of(x, &all).expect("one is the nearest");
                    let square = |f: &Facet| (x - f.closest(x)).length_squared();
                    let least = surface.facets.iter().map(square).fold(f64::INFINITY, f64::min);
                    let missed = found.nearest.distance.abs() - least.sqrt();
                    assert!(
                        missed.abs() <= 1e-12 * least.sqrt() + 1e-18,
                        "{k}, {height}: {missed}"
                    );
                    assert_eq!(surface.foot(x).nearest.distance, found.nearest.distance);
                }
            }
        }
    }
}
