//! Contact of particles with a rigid tool: node to surface, by penalty, with friction.
//!
//! A particle is a sphere of radius `dx/2`. Its overlap `g` with the surface
//! gives the normal force `f_n = kappa M dx^(D-2) g` (M: p-wave modulus; per
//! width in 2D). Friction is the force that stops the slip predicted for the
//! coming step, clipped at the law's limit at the particle's own strength and the pressure of the contact
//! surface, times its area there ([`crate::contact_surface`]): it sticks below and slides at it, whatever the
//! time step or stiffness. Particles between those that press rub although they do not press themselves.
//! The strength is not averaged: one that melts must not be rubbed by the strength of its neighbours.
//! The slip is the true projection `v - (v.n) n`. Neglected: damping normal to the tool, finite curvature of the particle.

use crate::contact_surface::{ContactSurface, Footing, Share, make_room};
use crate::error::SetupError;
use crate::setup::{Tool, Vector as Vector3};
use crate::tensor::Vector;
use crate::tool_holder::ToolHolder;
use crate::tool_motion::ToolMotion;
use crate::tool_surface::{Nearest, Surface, sub, sum};
use sphcut_physics::friction::{ContactState, FrictionLaw};

/// Overlap at the start, in radii of a particle, that rounding may make.
const OVERLAP_TOLERANCE: f64 = 1e-6;
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
    /// Regularised pressure of the contact in Pa.
    pub(crate) pressure: f64,
    /// Tresca's m: shear stress over the shear strength sigma_y / sqrt(3) of the particle.
    pub(crate) shear_friction_factor: f64,
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
    candidates: Vec<Candidate>,
    candidate_facets: Vec<u32>,
    /// Contacts of the last force evaluation, ordered by particle.
    pub(crate) touches: Vec<Touch<D>>,
    /// Who is near the tool in the present evaluation.
    near: Vec<u32>,
    footings: Vec<Footing>,
    contact_surface: ContactSurface,
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
    /// In m^3 (m^2 in 2D).
    pub(crate) volume: f64,
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
            candidates: Vec::new(),
            candidate_facets: Vec::new(),
            touches: Vec::new(),
            near: Vec::new(),
            footings: Vec::new(),
            contact_surface: ContactSurface::new(spacing, D),
        })
    }

    /// The same tool in a holder.
    pub(crate) fn held_by(self, holder: ToolHolder) -> Self {
        Self { holder, ..self }
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
        let reach = self.contact_surface.depth() + margin;
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
        // Room for all of them to touch: a step then asks for none.
        let most = self.candidates.len();
        make_room(&mut self.footings, most);
        make_room(&mut self.near, most);
        make_room(&mut self.touches, most);
        self.contact_surface.make_room(most);
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
        let depth = self.contact_surface.depth();
        self.footings.clear();
        self.near.clear();
        for candidate in &self.candidates {
            let input = look(candidate.particle as usize);
            let centre = sub(&extended(&input.position), &displacement);
            let facets = &self.candidate_facets[candidate.first as usize..candidate.last as usize];
            let Some(foot) = self.surface.foot_of(&centre, facets) else { continue };
            let Nearest { distance, normal } = foot.nearest;
            if distance >= depth {
                continue;
            }
            let (station, turn) = self.surface.station(&centre, &foot);
            self.footings.push(Footing {
                centre,
                foot: foot.place,
                normal,
                station,
                turn,
                distance,
                pressing: self.stiffness * (self.radius - distance).max(0.0),
                volume: input.volume,
            });
            self.near.push(candidate.particle);
        }
        self.contact_surface.lay(&self.footings, self.surface.perimeter());
        let mut touches = std::mem::take(&mut self.touches);
        touches.clear();
        let shares = self.contact_surface.shares();
        for ((&particle, footing), share) in self.near.iter().zip(&self.footings).zip(shares) {
            // Outside the contact nothing has an area.
            if share.area > 0.0 || footing.pressing > 0.0 {
                let input = look(particle as usize);
                touches.push(self.touch(particle, &input, footing, share, &velocity, time_step));
            }
        }
        self.touches = touches;
    }

    fn touch(
        &self,
        particle: u32,
        input: &ContactInput<D>,
        footing: &Footing,
        share: &Share,
        tool_velocity: &Vector<D>,
        time_step: f64,
    ) -> Touch<D> {
        let normal: Vector<D> = reduced(&footing.normal);
        let normal_force = normal.map(|n| n * footing.pressing);
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
        let limit = share.area
            * self.law.shear_limit(&ContactState {
                pressure: share.pressure,
                flow_stress: input.flow_stress,
                // Not the predicted slip: without friction it is too fast by a step's acceleration.
                sliding_speed: sliding.max(0.0).sqrt(),
                temperature: input.temperature,
            });
        let sticking = input.inertia * speed / time_step;
        let size = sticking.min(limit);
        let friction_force = if speed > 0.0 { slip.map(|v| -v / speed * size) } else { [0.0; D] };
        let strength = share.area * input.flow_stress / 3.0_f64.sqrt();
        Touch {
            particle,
            normal_force,
            friction_force,
            // Without friction nothing holds the particle: it slides.
            friction_use: if limit > 0.0 { size / limit } else { 1.0 },
            area: share.area,
            pressure: share.pressure,
            shear_friction_factor: if strength > 0.0 { size / strength } else { 0.0 },
        }
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
