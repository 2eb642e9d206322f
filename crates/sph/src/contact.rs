//! Contact of particles with a rigid tool: node to surface, by penalty, with friction.
//!
//! A particle is a sphere of radius `dx/2`. Its overlap `g` with the surface
//! gives the normal force `f_n = kappa M dx^(D-2) g` (M: p-wave modulus; per
//! width in 2D). Friction is the force that stops the slip predicted for the
//! coming step, clipped at the law's limit on the particle's share of the surface
//! ([`crate::contact_area`]): it sticks below and slides at it, whatever the time step or stiffness.
//! The slip is the true projection `v - (v.n) n`. Neglected: damping normal to the tool, finite curvature of the particle.

use crate::contact_area::{Footing, SurfaceShares};
use crate::error::SetupError;
use crate::setup::{Tool, ToolSurface, Vector as Vector3};
use crate::tensor::Vector;
use crate::tool_holder::ToolHolder;
use crate::tool_motion::ToolMotion;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use sphcut_physics::friction::{ContactState, FrictionLaw};

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

/// Overlap at the start, in radii of a particle, that rounding may make.
const OVERLAP_TOLERANCE: f64 = 1e-6;
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

fn sum(a: &Vector3, b: &Vector3) -> Vector3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
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
pub(crate) struct Nearest {
    /// Distance in m, negative inside the tool.
    pub(crate) distance: f64,
    /// Unit normal out of the tool.
    pub(crate) normal: Vector3,
}

/// The surface of a rigid tool with its spatial index.
#[derive(Debug)]
pub(crate) struct Surface {
    facets: Vec<Facet>,
    tree: RTree<IndexedFacet>,
    low: Vector3,
    high: Vector3,
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
pub(crate) struct Foot {
    /// Where it is.
    pub(crate) place: Vector3,
    /// Distance in m, negative inside the tool, and the normal there.
    pub(crate) nearest: Nearest,
    pub(crate) facet: u32,
}

impl Surface {
    /// From the description of the setup.
    ///
    /// # Errors
    /// Fewer than three corners, a degenerate or inward-facing facet, an open surface.
    pub(crate) fn new(surface: &ToolSurface) -> Result<Self, SetupError> {
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
    pub(crate) fn without(&self, is_left_out: &[bool]) -> Self {
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
        Self { facets, tree: RTree::bulk_load(indexed), low, high }
    }

    /// Whether `x` (tool frame) lies within `reach` of the surface's bounding box.
    pub(crate) fn is_near(&self, x: &Vector3, reach: f64) -> bool {
        (0..3).all(|k| x[k] >= self.low[k] - reach && x[k] <= self.high[k] + reach)
    }

    /// Facets whose boxes lie within `reach` of `x`, in the order of their index.
    fn facets_near(&self, x: &Vector3, reach: f64, found: &mut Vec<u32>) {
        let range = AABB::from_corners(
            [x[0] - reach, x[1] - reach, x[2] - reach],
            [x[0] + reach, x[1] + reach, x[2] + reach],
        );
        let first = found.len();
        found.extend(self.tree.locate_in_envelope_intersecting(&range).map(|f| f.index));
        found[first..].sort_unstable();
    }

    /// Nearest point among the facets listed.
    fn nearest_of(&self, x: &Vector3, facets: &[u32]) -> Option<Nearest> {
        self.foot_of(x, facets).map(|foot| foot.nearest)
    }

    /// Nearest point of the whole surface, found in its tree.
    pub(crate) fn foot(&self, x: &Vector3) -> Foot {
        let facet = self.tree.nearest_neighbor(x).expect("a surface has at least one facet");
        // All that are as near but for rounding: they decide together on which side x lies.
        let reach = (1.0 + 1e-9) * facet.distance_2(x).sqrt() + 1e-12;
        let mut near = Vec::new();
        self.facets_near(x, reach, &mut near);
        self.foot_of(x, &near).expect("the nearest facet is among them")
    }

    /// Smallest and largest coordinates.
    pub(crate) fn bounds(&self) -> [Vector3; 2] {
        [self.low, self.high]
    }

    fn foot_of(&self, x: &Vector3, facets: &[u32]) -> Option<Foot> {
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
            let nearest = Nearest { distance: side * length, normal };
            Foot { place: sub(x, &d), nearest, facet: index }
        })
    }

    /// Nearest point of the whole surface; for checks, not for the time loop.
    pub(crate) fn nearest(&self, x: &Vector3) -> Nearest {
        let all: Vec<u32> = (0..self.facets.len() as u32).collect();
        self.nearest_of(x, &all).expect("a surface has at least one facet")
    }
}

fn unusable(reason: String) -> SetupError {
    SetupError::ToolSurface { reason }
}

fn polygon_facets(corners: &[[f64; 2]]) -> Result<Vec<Facet>, SetupError> {
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
) -> Result<Vec<Facet>, SetupError> {
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

/// A particle that may touch the tool before the next refresh.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    particle: u32,
    first: u32,
    last: u32,
}

/// A particle in contact and its forces in N (N/m in 2D).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Touch<const D: usize> {
    pub(crate) particle: u32,
    pub(crate) normal_force: Vector<D>,
    pub(crate) friction_force: Vector<D>,
    /// Friction over the law's limit: 1 slides, less sticks.
    pub(crate) friction_use: f64,
    /// Share of the tool's surface in m^2 (m in 2D).
    pub(crate) area: f64,
}

/// The tool in contact with particles.
#[derive(Debug)]
pub(crate) struct ToolContact<const D: usize> {
    pub(crate) surface: Surface,
    law: Box<dyn FrictionLaw>,
    motion: ToolMotion,
    /// What moves it off its path.
    pub(crate) holder: ToolHolder,
    /// Mean velocity of the tool over the present step in m/s.
    pub(crate) velocity: Vector3,
    radius: f64,
    stiffness: f64,
    spacing: f64,
    candidates: Vec<Candidate>,
    candidate_facets: Vec<u32>,
    /// Contacts of the last force evaluation, ordered by particle.
    pub(crate) touches: Vec<Touch<D>>,
    /// Who touches in the present evaluation, and where they stand.
    pressed: Vec<(u32, Nearest)>,
    footings: Vec<Footing>,
    shares: SurfaceShares,
}

/// Kinematics of one particle as contact sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactInput<const D: usize> {
    pub(crate) position: Vector<D>,
    pub(crate) velocity: Vector<D>,
    /// Force on the particle without contact in N (N/m in 2D).
    pub(crate) other_force: Vector<D>,
    /// Inertia in kg (kg/m in 2D).
    pub(crate) inertia: f64,
    pub(crate) flow_stress: f64,
    pub(crate) temperature: f64,
}

pub(crate) fn extended<const D: usize>(x: &Vector<D>) -> Vector3 {
    std::array::from_fn(|k| if k < D { x[k] } else { 0.0 })
}

pub(crate) fn reduced<const D: usize>(x: &Vector3) -> Vector<D> {
    std::array::from_fn(|k| x[k])
}

impl<const D: usize> ToolContact<D> {
    /// `modulus`: p-wave modulus of the workpiece in Pa; `kappa`: the contact option `stiffness`.
    pub(crate) fn new(
        tool: &Tool,
        spacing: f64,
        modulus: f64,
        kappa: f64,
    ) -> Result<Self, SetupError> {
        let power = i32::try_from(D).expect("2 or 3");
        Ok(Self {
            surface: Surface::new(&tool.surface)?,
            law: (tool.friction.build)(&tool.friction_values),
            motion: ToolMotion::of(tool),
            holder: ToolHolder::default(),
            velocity: tool.velocity,
            radius: 0.5 * spacing,
            stiffness: kappa * modulus * spacing.powi(power - 2),
            spacing,
            candidates: Vec::new(),
            candidate_facets: Vec::new(),
            touches: Vec::new(),
            pressed: Vec::new(),
            footings: Vec::new(),
            shares: SurfaceShares::default(),
        })
    }

    /// The same tool in a holder.
    pub(crate) fn held_by(self, holder: ToolHolder) -> Self {
        Self { holder, ..self }
    }

    /// Friction of `touch` over the shear strength sigma_y / sqrt(3) of the particle: Tresca's m.
    pub(crate) fn shear_friction_factor(&self, touch: &Touch<D>, flow_stress: f64) -> f64 {
        let friction = crate::tensor::dot(&touch.friction_force, &touch.friction_force).sqrt();
        friction / touch.area * 3.0_f64.sqrt() / flow_stress
    }

    /// Displacement of the tool at `time`.
    pub(crate) fn displacement(&self, time: f64) -> Vector3 {
        let path = self.motion.displacement(time);
        if self.holder.acts() { sum(&path, &self.holder.displacement(time)) } else { path }
    }

    /// Speed along its path at `time`.
    pub(crate) fn path_speed(&self, time: f64) -> f64 {
        self.motion.speed(time)
    }

    /// Way of the tool from the last refresh at `start` to `end`, which is now.
    pub(crate) fn way(&self, start: f64, end: f64) -> Vector3 {
        let path = self.motion.way(start, end);
        if self.holder.acts() { sum(&path, &self.holder.way(start, end)) } else { path }
    }

    /// Takes the velocity of the step of length `time_step` that begins at `time`.
    pub(crate) fn begin_step(&mut self, time: f64, time_step: f64) {
        if self.holder.acts() {
            let force = self.total_force();
            self.holder.begin_step(&force, time_step);
        }
        self.velocity = self.mean_velocity(time, time_step);
    }

    /// The holder feels the forces at the end of the step.
    pub(crate) fn end_step(&mut self, time_step: f64) {
        if self.holder.acts() {
            let force = self.total_force();
            self.holder.end_step(&force, time_step);
        }
    }

    /// Velocity over a step from `time` on, as far as the path and the present motion of the holder say.
    fn mean_velocity(&self, time: f64, time_step: f64) -> Vector3 {
        let path = self.motion.mean_velocity(time, time_step);
        if self.holder.acts() { sum(&path, &self.holder.velocity(time, time_step)) } else { path }
    }

    /// Force of the tool on the particles in N (N/m in 2D), in their order.
    fn total_force(&self) -> Vector3 {
        self.touches.iter().fold([0.0; 3], |total, touch| {
            let force = crate::tensor::plus_scaled(&touch.normal_force, 1.0, &touch.friction_force);
            sum(&total, &extended(&force))
        })
    }

    /// An error if any particle overlaps the tool by more than rounding.
    pub(crate) fn check_start(&self, positions: &[Vector<D>]) -> Result<(), SetupError> {
        let tolerance = OVERLAP_TOLERANCE * self.radius;
        let mut deepest: Option<(f64, Vector3)> = None;
        let mut count = 0;
        for position in positions {
            let x = extended(position);
            if !self.surface.is_near(&x, self.radius) {
                continue;
            }
            let depth = self.radius - self.surface.nearest(&x).distance;
            if depth > tolerance {
                count += 1;
                if deepest.is_none_or(|(most, _)| depth > most) {
                    deepest = Some((depth, x));
                }
            }
        }
        match deepest {
            None => Ok(()),
            Some((depth, position)) => Err(SetupError::InitialOverlap { position, depth, count }),
        }
    }

    /// Lists the particles that can come into contact while nothing moves by more than
    /// `margin` relative to the tool.
    pub(crate) fn refresh(&mut self, positions: &[Vector<D>], time: f64, margin: f64) {
        let reach = self.radius + margin;
        self.holder.refresh();
        let displacement = self.displacement(time);
        self.candidates.clear();
        self.candidate_facets.clear();
        for (particle, position) in positions.iter().enumerate() {
            let x = sub(&extended(position), &displacement);
            if !self.surface.is_near(&x, reach) {
                continue;
            }
            let first = self.candidate_facets.len() as u32;
            self.surface.facets_near(&x, reach, &mut self.candidate_facets);
            let last = self.candidate_facets.len() as u32;
            if last > first {
                self.candidates.push(Candidate { particle: particle as u32, first, last });
            }
        }
    }

    /// Computes the contact forces at `time`; `look` tells about a particle.
    pub(crate) fn evaluate(
        &mut self,
        time: f64,
        time_step: f64,
        look: impl Fn(usize) -> ContactInput<D>,
    ) {
        let displacement = self.displacement(time);
        let velocity = reduced(&self.mean_velocity(time, time_step));
        self.footings.clear();
        self.pressed.clear();
        for candidate in &self.candidates {
            let centre = sub(&extended(&look(candidate.particle as usize).position), &displacement);
            let facets = &self.candidate_facets[candidate.first as usize..candidate.last as usize];
            let Some(nearest) = self.surface.nearest_of(&centre, facets) else { continue };
            if nearest.distance >= self.radius {
                continue;
            }
            let foot = along(&centre, -nearest.distance, &nearest.normal);
            self.footings.push(Footing { centre, foot, normal: nearest.normal });
            self.pressed.push((candidate.particle, nearest));
        }
        self.shares.share_out(&self.footings, self.spacing, D);
        let mut touches = std::mem::take(&mut self.touches);
        touches.clear();
        for (&(particle, nearest), &area) in self.pressed.iter().zip(self.shares.areas()) {
            let input = look(particle as usize);
            touches.push(self.touch(particle, &input, &nearest, area, &velocity, time_step));
        }
        self.touches = touches;
    }

    fn touch(
        &self,
        particle: u32,
        input: &ContactInput<D>,
        nearest: &Nearest,
        area: f64,
        tool_velocity: &Vector<D>,
        time_step: f64,
    ) -> Touch<D> {
        let normal: Vector<D> = reduced(&nearest.normal);
        let pressing = self.stiffness * (self.radius - nearest.distance);
        let normal_force = normal.map(|n| n * pressing);
        // Slip now, and after the coming step without friction, projected on the surface.
        let now: Vector<D> = std::array::from_fn(|k| input.velocity[k] - tool_velocity[k]);
        let mut slip: Vector<D> = std::array::from_fn(|k| {
            now[k] + time_step / input.inertia * (input.other_force[k] + normal_force[k])
        });
        let through = crate::tensor::dot(&slip, &normal);
        for k in 0..D {
            slip[k] -= through * normal[k];
        }
        let speed = crate::tensor::dot(&slip, &slip).sqrt();
        let across = crate::tensor::dot(&now, &normal);
        let sliding = crate::tensor::dot(&now, &now) - across * across;
        let limit = area
            * self.law.shear_limit(&ContactState {
                pressure: pressing / area,
                flow_stress: input.flow_stress,
                // Not the predicted slip: without friction it is too fast by a step's acceleration.
                sliding_speed: sliding.max(0.0).sqrt(),
                temperature: input.temperature,
            });
        let sticking = input.inertia * speed / time_step;
        let size = sticking.min(limit);
        let friction_force = if speed > 0.0 { slip.map(|v| -v / speed * size) } else { [0.0; D] };
        // Without friction nothing holds the particle: it slides.
        let friction_use = if limit > 0.0 { size / limit } else { 1.0 };
        Touch { particle, normal_force, friction_force, friction_use, area }
    }

    /// Particles that lie on the tool, or overlap it by no more than rounding: those that exchange heat
    /// with it where nothing moves.
    pub(crate) fn resting(&self, positions: &[Vector<D>], time: f64) -> Vec<u32> {
        let displacement = self.displacement(time);
        let reach = (1.0 + OVERLAP_TOLERANCE) * self.radius;
        let facets = |c: &Candidate| &self.candidate_facets[c.first as usize..c.last as usize];
        let lies = |c: &&Candidate| {
            let x = sub(&extended(&positions[c.particle as usize]), &displacement);
            self.surface.nearest_of(&x, facets(c)).is_some_and(|near| near.distance <= reach)
        };
        self.candidates.iter().filter(lies).map(|candidate| candidate.particle).collect()
    }

    /// Follows a reordering of the particles: `new_place[old]`.
    pub(crate) fn reorder(&mut self, new_place: &[u32]) {
        for touch in &mut self.touches {
            touch.particle = new_place[touch.particle as usize];
        }
        self.touches.sort_by_key(|touch| touch.particle);
    }
}
