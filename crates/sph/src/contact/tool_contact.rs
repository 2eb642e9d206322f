//! Contact of particles with a rigid tool: node to surface, by penalty, with friction.
//!
//! The point of a particle's material that faces the tool ([`crate::contact::surface_point`]) overlaps it by `g`, which
//! gives the normal force `f_n = kappa M dx^(D-2) g` (M: p-wave modulus; per width in 2D). Friction
//! ([`crate::contact::friction`]) sticks below the law's limit and slides at it, whatever the time step or stiffness. The
//! limit is that at the particle's own strength and the pressure of the contact surface, times its area there
//! ([`crate::contact::surface`]). Particles between those that press rub although they do not press themselves.
//! The strength is not averaged: one that melts must not be rubbed by the strength of its neighbours.
//! The slip is the true projection `v - (v.n) n`. Neglected: damping normal to the tool, finite curvature of the particle.

use crate::contact::friction::ContactFriction;
use crate::contact::surface::{ContactSurface, Footing, make_room};
use crate::contact::surface_point::{Neighbourhood, SurfacePoints};
use crate::contact::tool_holder::ToolHolder;
use crate::contact::tool_motion::ToolMotion;
use crate::contact::touch::Touch;
use crate::error::SetupError;
use crate::operators::neighbours::NeighbourList;
use crate::particles::Particles;
use crate::setup::Tool;
use crate::tensor::{Matrix, Vector, dot, extended, minus, plus_scaled, reduced};
use glam::DVec3;
use rayon::prelude::*;
use sphcut_geometry::tool_surface::{IndexedSurface, NearestPoint};
use sphcut_physics::friction::{ContactState, FrictionLaw};

/// Overlap at the start, in radii of a particle, that rounding may make.
const OVERLAP_TOLERANCE: f64 = 1e-6;
/// A particle that may touch the tool before the next reference update.
#[derive(Debug, Clone, Copy)]
struct Candidate<const D: usize> {
    particle: u32,
    first: u32,
    last: u32,
    /// M^-1 in the present reference, once it was needed.
    moment: Option<Matrix<D>>,
}

impl<const D: usize> Candidate<D> {
    fn inverse_moment(&mut self, around: &Neighbourhood<'_, D>) -> Matrix<D> {
        *self.moment.get_or_insert_with(|| around.inverse_moment(self.particle as usize))
    }
}

/// The tool in contact with particles.
#[derive(Debug)]
pub(crate) struct ToolContact<const D: usize> {
    pub(crate) surface: IndexedSurface,
    law: Box<dyn FrictionLaw>,
    motion: ToolMotion,
    /// What moves it off its path.
    pub(crate) holder: ToolHolder,
    /// Mean velocity of the tool over the present step in m/s.
    pub(crate) velocity: DVec3,
    radius: f64,
    stiffness: f64,
    candidates: Vec<Candidate<D>>,
    candidate_facets: Vec<u32>,
    /// Contacts of the last force evaluation, ordered by particle.
    pub(crate) touches: Vec<Touch<D>>,
    /// What became of each candidate in the present evaluation.
    found: Vec<Option<Footing>>,
    /// Who is near the tool in it.
    near: Vec<u32>,
    /// Place of each among the candidates.
    places: Vec<u32>,
    footings: Vec<Footing>,
    /// Where the touches act.
    pub(crate) points: SurfacePoints<D>,
    contact_surface: ContactSurface,
    /// Largest friction force of the touches in N (N/m in 2D).
    limits: Vec<f64>,
    friction: ContactFriction<D>,
}

fn in_space<const D: usize>(x: &Vector<D>) -> DVec3 {
    extended(x).into()
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
            surface: IndexedSurface::new(&tool.surface)?,
            law: (tool.friction.build)(&tool.friction_values),
            motion: ToolMotion::of(tool),
            holder: ToolHolder::default(),
            velocity: tool.velocity.into(),
            radius: 0.5 * spacing,
            stiffness: kappa * modulus * spacing.powi(power - 2),
            candidates: Vec::new(),
            candidate_facets: Vec::new(),
            touches: Vec::new(),
            found: Vec::new(),
            near: Vec::new(),
            footings: Vec::new(),
            places: Vec::new(),
            points: SurfacePoints::default(),
            contact_surface: ContactSurface::new(spacing, D),
            limits: Vec::new(),
            friction: ContactFriction::default(),
        })
    }

    /// The particles near the tool with their half thickness in m.
    pub(crate) fn half_thicknesses(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.near
            .iter()
            .zip(&self.footings)
            .map(|(&i, footing)| (i as usize, footing.half_thickness))
    }

    /// The particles near the tool with the normal out of it.
    pub(crate) fn near_normals(&self) -> impl Iterator<Item = (usize, Vector<D>)> + '_ {
        let normals = self.footings.iter().map(|footing| reduced(footing.normal.as_ref()));
        self.near.iter().map(|&i| i as usize).zip(normals)
    }

    /// Takes over the half thicknesses of the particles that touch.
    pub(crate) fn follow_half_thicknesses(&mut self, particles: &Particles<D>) {
        for touch in &mut self.touches {
            let half_thickness = particles.point[touch.particle as usize].half_thickness;
            touch.lever = touch.normal().map(|n| n * half_thickness);
        }
    }

    /// The same tool in a holder.
    pub(crate) fn held_by(self, holder: ToolHolder) -> Self {
        Self { holder, ..self }
    }

    /// Displacement of the tool at `time`.
    pub(crate) fn displacement(&self, time: f64) -> DVec3 {
        let path = self.motion.displacement(time);
        if self.holder.acts() { path + self.holder.displacement(time) } else { path }
    }

    /// Speeds along its path, from the start on.
    pub(crate) fn path_speeds(&self) -> Vec<f64> {
        self.motion.speeds()
    }

    /// Speed along its path at `time`.
    pub(crate) fn path_speed(&self, time: f64) -> f64 {
        self.motion.speed(time)
    }

    /// Way of the tool from the last reference update at `start` to `end`, which is now.
    pub(crate) fn way(&self, start: f64, end: f64) -> DVec3 {
        let path = self.motion.way(start, end);
        if self.holder.acts() { path + self.holder.way(start, end) } else { path }
    }

    /// Takes the velocity of the step of length `time_step` that begins at `time`.
    pub(crate) fn begin_step(&mut self, time: f64, time_step: f64) {
        if self.holder.acts() {
            let force = self.total_force();
            self.holder.begin_step(force, time_step);
        }
        self.velocity = self.mean_velocity(time, time_step);
    }

    /// The holder feels the forces at the end of the step.
    pub(crate) fn end_step(&mut self, time_step: f64) {
        if self.holder.acts() {
            let force = self.total_force();
            self.holder.end_step(force, time_step);
        }
    }

    /// Velocity over a step from `time` on, as far as the path and the present motion of the holder say.
    fn mean_velocity(&self, time: f64, time_step: f64) -> DVec3 {
        let path = self.motion.mean_velocity(time, time_step);
        if self.holder.acts() { path + self.holder.velocity(time, time_step) } else { path }
    }

    /// Force of the tool on the particles in N (N/m in 2D), in their order.
    fn total_force(&self) -> DVec3 {
        self.touches.iter().fold(DVec3::ZERO, |total, touch| total + in_space(&touch.force()))
    }

    /// An error if any particle overlaps the tool by more than rounding.
    pub(crate) fn check_start(&self, particles: &Particles<D>) -> Result<(), SetupError> {
        let tolerance = OVERLAP_TOLERANCE * self.radius;
        let mut deepest: Option<(f64, DVec3)> = None;
        let mut count = 0;
        for (i, position) in particles.position.iter().enumerate() {
            let x = in_space(position);
            if !self.surface.is_near(x, self.contact_surface.depth() * particles.size(i)) {
                continue;
            }
            let NearestPoint { distance, normal } = self.surface.nearest(x);
            let depth = particles.half_thickness(i, &reduced(normal.as_ref())) - distance;
            if depth > tolerance {
                count += 1;
                if deepest.is_none_or(|(most, _)| depth > most) {
                    deepest = Some((depth, x));
                }
            }
        }
        match deepest {
            None => Ok(()),
            Some((depth, position)) => {
                let position = position.to_array();
                Err(SetupError::InitialOverlap { position, depth, count })
            }
        }
    }

    /// Lists the particles that can come into contact, and the facets that can be nearest to them, while nothing moves by more
    /// than `way` relative to the tool.
    pub(crate) fn update_reference(
        &mut self,
        particles: &Particles<D>,
        list: &NeighbourList,
        time: f64,
        way: f64,
    ) {
        self.holder.update_reference();
        let displacement = self.displacement(time);
        self.candidates.clear();
        self.candidate_facets.clear();
        for (particle, position) in particles.position.iter().enumerate() {
            let reach = self.contact_surface.depth() * particles.size(particle) + way;
            let x = in_space(position) - displacement;
            if !self.surface.is_near(x, reach) {
                continue;
            }
            let first = self.candidate_facets.len() as u32;
            self.surface.facets_near(x, reach, way, &mut self.candidate_facets);
            let last = self.candidate_facets.len() as u32;
            if last > first {
                let particle = particle as u32;
                self.candidates.push(Candidate { particle, first, last, moment: None });
            }
        }
        // Room for all of them to touch: a step then asks for none.
        let most = self.candidates.len();
        make_room(&mut self.found, most);
        make_room(&mut self.footings, most);
        make_room(&mut self.places, most);
        make_room(&mut self.near, most);
        make_room(&mut self.touches, most);
        make_room(&mut self.limits, most);
        self.contact_surface.make_room(most);
        let neighbours = self.candidates.iter().map(|c| list.count(c.particle as usize) as usize);
        let neighbours = neighbours.max().unwrap_or(0);
        self.points.make_room(most, neighbours);
        self.friction.make_room(particles.count(), most, neighbours);
    }

    /// Finds who is near the tool at `time`, after a step.
    fn find_near(&mut self, time: f64, time_step: f64, around: &Neighbourhood<'_, D>) {
        let displacement = self.displacement(time);
        let mut found = std::mem::take(&mut self.found);
        let mut candidates = std::mem::take(&mut self.candidates);
        found.clear();
        found.resize(candidates.len(), None);
        let all =
            found.par_iter_mut().zip(&mut candidates).with_min_len(self.contact_surface.task());
        all.for_each(|(found, candidate)| {
            *found = self.footing(candidate, displacement, time_step, around);
        });
        self.footings.clear();
        self.places.clear();
        self.near.clear();
        for (place, (found, candidate)) in found.iter().zip(&candidates).enumerate() {
            if let Some(footing) = found {
                self.footings.push(*footing);
                self.places.push(place as u32);
                self.near.push(candidate.particle);
            }
        }
        self.found = found;
        self.candidates = candidates;
    }

    /// How `candidate` lies on the tool, unless it is too far from it.
    fn footing(
        &self,
        candidate: &mut Candidate<D>,
        displacement: DVec3,
        time_step: f64,
        around: &Neighbourhood<'_, D>,
    ) -> Option<Footing> {
        let particles = around.particles;
        let i = candidate.particle as usize;
        let centre = in_space(&particles.position[i]) - displacement;
        let facets = &self.candidate_facets[candidate.first as usize..candidate.last as usize];
        let foot = self.surface.foot_of(centre, facets)?;
        let NearestPoint { distance, normal } = foot.nearest;
        let size = particles.size(i);
        if distance >= self.contact_surface.depth() * size {
            return None;
        }
        let half_thickness = if distance < 2.0 * self.radius * size {
            around.followed_half_thickness(
                i,
                &reduced(normal.as_ref()),
                (time_step, 2.0 * self.radius),
                &candidate.inverse_moment(around),
            )
        } else {
            particles.point[i].half_thickness
        };
        let (station, turn) = self.surface.station(centre, &foot);
        Some(Footing {
            centre,
            foot: foot.place,
            normal,
            station,
            turn,
            distance,
            half_thickness,
            pressing: self.stiffness * (half_thickness - distance).max(0.0),
            volume: particles.volume[i] * particles.point[i].volume_ratio,
        })
    }

    /// Computes the contact forces at `time` on the particles for the coming step.
    pub(crate) fn evaluate(&mut self, time: f64, time_step: f64, around: &Neighbourhood<'_, D>) {
        let velocity = reduced(self.mean_velocity(time, time_step).as_ref());
        let particles = around.particles;
        self.find_near(time, time_step, around);
        self.contact_surface.lay(&self.footings, self.surface.perimeter());
        let mut touches = std::mem::take(&mut self.touches);
        touches.clear();
        self.limits.clear();
        self.points.clear();
        let shares = self.contact_surface.shares();
        let near = self.near.iter().zip(&self.places);
        for (((&particle, &place), footing), share) in near.zip(&self.footings).zip(shares) {
            // Outside the contact nothing has an area.
            if share.area > 0.0 || footing.pressing > 0.0 {
                let touch = Touch::without_friction(particle, footing, share);
                let moment = self.candidates[place as usize].inverse_moment(around);
                self.points.push(&touch, &moment, around);
                let moving = self.points.velocity(touches.len(), &particles.motion);
                let limit = self.shear_limit(&touch, &minus(&moving, &velocity), particles);
                self.limits.push(limit);
                touches.push(touch);
            }
        }
        self.friction.find(
            &mut touches,
            &self.points,
            &self.limits,
            &velocity,
            time_step,
            particles,
        );
        for (touch, &limit) in touches.iter_mut().zip(&self.limits) {
            let size = dot(&touch.friction_force, &touch.friction_force).sqrt();
            let flow_stress = particles.point[touch.particle as usize].flow_stress;
            let strength = touch.area * flow_stress / 3.0_f64.sqrt();
            touch.shear_friction_factor = if strength > 0.0 { size / strength } else { 0.0 };
            // Without friction nothing holds the particle: it slides.
            touch.friction_use = if limit > 0.0 { size / limit } else { 1.0 };
        }
        self.touches = touches;
    }

    /// Largest friction force of `touch` in N (N/m in 2D); `slip`: velocity of its surface point against the tool.
    fn shear_limit(&self, touch: &Touch<D>, slip: &Vector<D>, particles: &Particles<D>) -> f64 {
        let i = touch.particle as usize;
        let across = dot(slip, &touch.normal());
        let sliding = dot(slip, slip) - across * across;
        let state = ContactState {
            pressure: touch.pressure,
            flow_stress: particles.point[i].flow_stress,
            // Not the slip after the step: without friction it is too fast by a step's acceleration.
            sliding_speed: sliding.max(0.0).sqrt(),
            temperature: particles.point[i].temperature,
        };
        touch.area * self.law.shear_limit(&state)
    }

    /// Finds the surface points of the present touches anew.
    pub(crate) fn lay_points(&mut self, around: &Neighbourhood<'_, D>) {
        self.points.lay(&self.touches, around);
    }

    /// Adds the forces of the touches to those on the particles.
    pub(crate) fn add_forces(&self, force: &mut [Vector<D>]) {
        for (place, touch) in self.touches.iter().enumerate() {
            let contact = touch.force();
            for &(j, part) in &self.points.parts()[self.points.range(place)] {
                let force = &mut force[j as usize];
                *force = plus_scaled(force, part, &contact);
            }
        }
    }

    /// Particles that lie on the tool, or overlap it by no more than rounding: those that exchange heat
    /// with it where nothing moves.
    pub(crate) fn resting(&self, particles: &Particles<D>, time: f64) -> Vec<u32> {
        let displacement = self.displacement(time);
        let reach = (1.0 + OVERLAP_TOLERANCE) * self.radius;
        let facets = |c: &Candidate<D>| &self.candidate_facets[c.first as usize..c.last as usize];
        let lies = |c: &&Candidate<D>| {
            let i = c.particle as usize;
            let x = in_space(&particles.position[i]) - displacement;
            let reach = reach * particles.size(i);
            self.surface.nearest_of(x, facets(c)).is_some_and(|near| near.distance <= reach)
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
