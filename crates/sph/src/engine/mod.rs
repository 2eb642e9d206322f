//! The solver in `D` dimensions: one step is the method, one call per equation.
//!
//! Momentum and velocity gradient are a work-conjugate pair: with the weights
//! `w_ij = -W'(r_ij)/r_ij V_j` and separations `X_ij = X_j - X_i` of the
//! reference configuration (updated every few per cent of strain),
//! ```text
//! F_dot_i = sum_j w_ij (v_j - v_i) (x) X_ij B_i,    B_i = (sum_j w_ij X_ij (x) X_ij)^-1
//! f_i     = V_i sum_j w_ij (P_i B_i + P_j B_j) X_ij
//! ```
//! so that internal power is `sum_i V_i P_i : F_dot_i` exactly, linear fields
//! are differentiated exactly, and momentum and angular momentum are kept to
//! rounding. What the affine fit does not see (hourglass motion,
//! `d_ij = v_j - v_i - F_dot_i X_ij`) is damped by the potential
//! `1/2 sum_i eta_i V_i sum_j w_ij |d_ij|^2`; because `F_dot_i` is the
//! least-squares fit with the same weights, its force needs no second sweep and
//! keeps both momenta. `docs/theory.md` derives all of it.

#[cfg(test)]
mod graded;
mod time_step;
mod tool;

use crate::contact::repulsion::RepellingPairs;
use crate::contact::self_contact;
use crate::contact::surface_point::Neighbourhood;
use crate::contact::tool_contact::ToolContact;
use crate::contact::tool_holder::ToolHolder;
use crate::error::{Diverged, SetupError};
use crate::heat::conduction::HeatConduction;
use crate::heat::source::heat_by_sources;
use crate::ledger::Ledger;
use crate::numerics::Numerics;
use crate::operators::reference::{Bonding, Frame, ReferenceConfiguration};
use crate::operators::sweeps::{Sweeps, exchange_width};
use crate::operators::{density_diffusion, pairing, shifting, strain_gradient, support_shape};
use crate::particles::window::{Window, with_resting};
use crate::particles::{Particles, Rest, lattice};
use crate::setup::{HeatSource, Setup, Tool};
use crate::stage::Stage;
use crate::tensor::{Matrix, Vector, extended, reduced};
use glam::DVec3;
use sphcut_tool_heat::HeatedTool;

/// Spread of the displacements since the last reference update, in particle spacings, that triggers the next.
const UPDATE_SPREAD: f64 = 0.25;
/// Nothing moves against the tool by more than this many spacings until the next reference update: the root of three times the
/// spread (0.43), and a step, even as fast as half the speed of sound.
const WAY_OF_CONTACT: f64 = 0.7;

/// How far a run is.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Clock {
    /// In s.
    pub(crate) time: f64,
    /// Steps since the start.
    pub(crate) step: u64,
    /// Length of the next step in s.
    pub(crate) time_step: f64,
}

/// The particles and all that moves them.
#[derive(Debug)]
pub(crate) struct Engine<const D: usize> {
    pub(crate) particles: Particles<D>,
    pub(crate) reference: ReferenceConfiguration<D>,
    pub(crate) sweeps: Sweeps,
    pub(crate) clock: Clock,
    pub(crate) ledger: Ledger,
    pub(crate) numerics: Numerics,
    /// What comes and goes while the tool moves on; `None`: everything is followed from start to end.
    pub(crate) window: Option<Window<D>>,
    pub(crate) self_contact: RepellingPairs,
    /// Neighbours at risk of the pairing instability.
    pub(crate) pairing: RepellingPairs,
    pub(crate) tool: Option<ToolContact<D>>,
    /// Heat in the tool, where it is asked for.
    pub(crate) tool_heat: Option<HeatedTool>,
    /// Share of the heat of friction that the particles take, if any heats.
    friction_heat_share: Option<f64>,
    pub(crate) conduction: HeatConduction<D>,
    heat_sources: Vec<HeatSource>,
    /// New place of each particle, kept for its room.
    new_place: Vec<u32>,
}

/// How the forces of the tool come about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Touches {
    /// From the present positions, for the coming step.
    Anew,
    /// As they are, after an update of the reference changed what they act on.
    Kept,
}

impl<const D: usize> Engine<D> {
    /// Fills the bodies and prepares the first step.
    pub(crate) fn new(setup: &Setup) -> Result<Self, SetupError> {
        let mut engine = Self::without_particles(setup)?;
        let particles = &mut engine.particles;
        let seeds = lattice::fill(setup)?.into_iter().enumerate();
        let all: Vec<Rest<D>> = seeds.map(|(id, seed)| particles.rest(setup, id, &seed)).collect();
        if setup.window.is_some() {
            particles.holds = with_resting(std::mem::take(&mut particles.holds));
            engine.window = Window::of(setup, all, engine.reference.reach);
            engine.move_window();
        } else {
            all.iter().for_each(|rest| particles.follow(rest));
            engine.resize();
        }
        if let Some(tool) = &engine.tool {
            tool.check_start(&engine.particles)?;
        }
        engine.update_reference();
        engine.ledger.initial_energy =
            engine.particles.kinetic_energy() + engine.particles.elastic_energy();
        engine.ledger.initial_heat = engine.particles.heat_content();
        engine.find_internal_forces();
        engine.add_contact(Touches::Anew);
        Ok(engine)
    }

    fn without_particles(setup: &Setup) -> Result<Self, SetupError> {
        let numerics = Numerics::of(setup);
        let Numerics { spacing, stiffest, contact_stiffness, .. } = numerics;
        let tool = match &setup.tool {
            None => None,
            Some(tool) => {
                let contact = ToolContact::new(tool, spacing, stiffest, contact_stiffness)?;
                Some(contact.held_by(ToolHolder::of(setup)))
            }
        };
        let tool_heat = match (&setup.tool, &tool) {
            (Some(Tool { surface, heat: Some(heat), .. }), Some(tool)) => {
                Some(HeatedTool::new(surface, heat, &tool.path_speeds(), spacing)?)
            }
            _ => None,
        };
        let friction_heats = setup.heat.friction_heating.is_on();
        Ok(Self {
            particles: Particles::none(setup, &numerics),
            reference: ReferenceConfiguration::none(setup, &numerics),
            sweeps: Sweeps::default(),
            clock: Clock::default(),
            ledger: Ledger::default(),
            window: None,
            self_contact: self_contact::between_pieces::<D>(&numerics),
            pairing: pairing::between_neighbours::<D>(setup, &numerics),
            tool,
            tool_heat,
            friction_heat_share: friction_heats
                .then(|| setup.heat.values.get("friction_heat_share")),
            conduction: HeatConduction::new(setup.heat.conduction.is_on()),
            heat_sources: setup.heat_sources.clone(),
            new_place: Vec::new(),
            numerics,
        })
    }

    /// Gives every particle its place in all arrays; new places are those of the undeformed state.
    pub(crate) fn resize(&mut self) {
        self.particles.resize(self.numerics.support_stretch);
        let count = self.particles.position.len();
        self.reference.resize(count);
        self.sweeps.resize::<D>(count);
    }

    /// One step, kick-drift-kick; tells `passed` which stage has just ended.
    pub(crate) fn advance(&mut self, passed: &mut dyn FnMut(Stage)) -> Result<(), Diverged> {
        let dt = self.clock.time_step;
        self.clock.step += 1;
        if !self.numerics.mechanics {
            self.clock.time += dt;
            self.rest_on_tool(dt);
            self.conduct_heat(dt);
            passed(Stage::Diffusion);
            return Ok(());
        }
        if let Some(tool) = &mut self.tool {
            tool.begin_step(self.clock.time, dt);
        }
        self.kick_and_drift(0.5 * dt, dt);
        self.book_contact(0.5 * dt);
        passed(Stage::Motion);
        self.update_stresses(dt)?;
        passed(Stage::Gradients);
        self.sweeps.forces(&mut self.particles, &self.reference);
        passed(Stage::Forces);
        self.add_contact(Touches::Anew);
        self.book_contact(0.5 * dt);
        if let Some(tool) = &mut self.tool {
            tool.end_step(dt);
        }
        passed(Stage::Contact);
        self.kick_and_drift(0.5 * dt, 0.0);
        passed(Stage::Motion);
        self.diffuse_density(dt);
        strain_gradient::find_when_due(&mut self.particles, &self.reference, self.clock.step);
        self.conduct_heat(dt);
        passed(Stage::Diffusion);
        if self.update_is_due() {
            self.shift_particles();
            self.move_window();
            self.update_reference();
            self.find_internal_forces();
            self.add_contact(Touches::Kept);
            passed(Stage::ReferenceUpdate);
        }
        Ok(())
    }

    /// v += a dt, then x += v `drift` and the clock; books what supports do.
    fn kick_and_drift(&mut self, kick: f64, drift: f64) {
        self.particles.kick_and_drift(kick, drift);
        self.clock.time += drift;
        self.particles.book_reactions(kick, &mut self.ledger);
    }

    /// Stresses after a step of length `dt`, and what that takes.
    ///
    /// # Errors
    /// The first number that blew up.
    fn update_stresses(&mut self, dt: f64) -> Result<(), Diverged> {
        let Self { sweeps, particles, reference, numerics, .. } = self;
        sweeps.gradients(particles, reference, numerics.yield_fraction, dt);
        let whole = sweeps.whole();
        self.ledger.add(&whole);
        self.reference.since = whole;
        whole.failure.map_or(Ok(()), |failure| {
            Err(Diverged {
                step: self.clock.step,
                time: self.clock.time,
                particle: self.particles.id[failure.index],
                position: extended(&self.particles.position[failure.index]),
                quantity: failure.quantity.to_owned(),
                value: failure.value,
            })
        })
    }

    /// Internal forces of the present stresses.
    pub(crate) fn find_internal_forces(&mut self) {
        let Self { sweeps, particles, reference, numerics, .. } = self;
        sweeps.gradients(particles, reference, numerics.yield_fraction, 0.0);
        sweeps.forces(particles, reference);
    }

    /// Adds the forces of contact to the internal ones: of particles that do not belong together, of neighbours that
    /// approach too far, and of the tool.
    fn add_contact(&mut self, touches: Touches) {
        let Self { self_contact, pairing, particles, reference, clock, tool, .. } = self;
        self_contact.push_apart(&particles.position, &reference.sizes, &mut particles.force);
        pairing.push_apart(&particles.position, &reference.sizes, &mut particles.force);
        let Some(tool) = tool else { return };
        let around = Neighbourhood { particles: &*particles, reference: &*reference };
        match touches {
            Touches::Kept => tool.lay_points(&around),
            Touches::Anew => {
                tool.evaluate(clock.time, clock.time_step, &around);
                for (particle, half_thickness) in tool.half_thicknesses() {
                    particles.point[particle].half_thickness = half_thickness;
                }
            }
        }
        tool.add_forces(&mut particles.force);
    }

    /// Lets the checkerboard of the volume ratio diffuse.
    fn diffuse_density(&mut self, dt: f64) {
        let Self { numerics, particles, reference, sweeps, clock, tool, ledger, .. } = self;
        let tool: Option<Vector<D>> = tool.as_ref().map(|tool| reduced(tool.velocity.as_ref()));
        let step = (clock.step, dt);
        ledger.density_diffusion +=
            density_diffusion::diffuse_when_due(numerics, particles, reference, sweeps, step, tool);
    }

    /// Heat of sources, conduction and fixed temperatures, and that of the tool.
    fn conduct_heat(&mut self, elapsed: f64) {
        let Self { particles, reference, sweeps, clock, ledger, conduction, .. } = self;
        ledger.heat_supplied += heat_by_sources(&self.heat_sources, particles, clock.time, elapsed);
        let is_due = conduction.is_due_after(elapsed);
        if is_due || (conduction.acts && !self.numerics.mechanics) {
            conduction.step(particles, reference, &mut sweeps.exchange);
        }
        particles.hold_temperatures(ledger);
        self.heat_tool_when_due(elapsed);
    }

    /// Whether strain or displacement since the last update demand a new one.
    fn update_is_due(&self) -> bool {
        let way = |tool: &ToolContact<D>| tool.way(self.reference.time, self.clock.time);
        let (strain, spread) = self.reference.changes(self.tool.as_ref().map(way));
        strain >= self.numerics.refresh_strain || spread > UPDATE_SPREAD * self.numerics.spacing
    }

    /// Moves crowded particles apart; an update of the reference must come after it.
    fn shift_particles(&mut self) {
        let Self { particles, reference, sweeps, tool, numerics, clock, .. } = self;
        let elapsed = clock.time - reference.time;
        shifting::shift(particles, reference, sweeps, tool.as_mut(), numerics, elapsed);
    }

    /// Makes the present configuration the reference.
    pub(crate) fn update_reference(&mut self) {
        let Self { particles, reference, numerics, tool, tool_heat, .. } = self;
        reference.reach = support_shape::carry_shapes(particles, numerics);
        reference.take(particles, numerics, self.clock.time);
        if let Some(tool) = tool {
            let order = &reference.cells.order;
            self.new_place.resize(order.len(), 0);
            for (place, &old) in order.iter().enumerate() {
                self.new_place[old as usize] = place as u32;
            }
            tool.reorder(&self.new_place);
            if let Some(heat) = tool_heat {
                heat.reorder(&self.new_place);
            }
        }
        self.rebuild(Bonding::Anew);
    }

    /// Rebuilds everything that follows from positions and volumes in the reference, at which the particles are.
    pub(crate) fn rebuild(&mut self, bonding: Bonding) {
        let Self { particles, reference, numerics, self_contact, pairing, .. } = self;
        let near = self_contact::watched_reach(numerics);
        let close = pairing::watched_reach(pairing, numerics.spacing);
        let watched = [self_contact.watched(near), pairing.watched(close)];
        reference.rebuild(particles, numerics, watched, bonding);
        self.set_time_step();
        let Self { particles, reference, numerics, tool, .. } = self;
        if let Some(tool) = tool {
            let way = WAY_OF_CONTACT * numerics.spacing;
            tool.update_reference(particles, &reference.list, reference.time, way);
        }
        self.conduction.tensor.clear();
    }

    /// Number of particles once the window is full; all of them without one.
    pub(crate) fn expected_count(&self) -> usize {
        self.particles.count() + self.window.as_ref().map_or(0, Window::full)
    }

    /// Follows what the window has reached and leaves what has left it; an update of the reference must come after it.
    fn move_window(&mut self) {
        let Self { particles, window, tool, tool_heat, clock, .. } = self;
        let Some(window) = window else { return };
        let displacement = tool.as_ref().map_or(DVec3::ZERO, |tool| tool.displacement(clock.time));
        let travel = window.travel(displacement);
        let touched = tool.iter().flat_map(|tool| tool.touches.iter().map(|t| t.particle));
        let exposed = tool_heat.iter().flat_map(|heat| heat.exposed());
        if let Some(new_place) = window.retire(particles, travel, touched.chain(exposed)) {
            if let Some(tool) = tool {
                tool.reorder(&new_place);
            }
            if let Some(heat) = tool_heat {
                heat.reorder(&new_place);
            }
        }
        let first_new = particles.count();
        window.feed(particles, travel);
        self.ledger.initial_heat += particles.heat_of(first_new..particles.count());
        self.resize();
    }

    /// Memory of the arrays in bytes.
    pub(crate) fn memory(&self) -> usize {
        let each = size_of::<Frame<D>>() + size_of::<f64>() * exchange_width::<D>();
        self.tool_heat.as_ref().map_or(0, HeatedTool::memory)
            + self.window.as_ref().map_or(0, Window::memory)
            + self.particles.memory()
            + self.particles.count() * each
            + self.reference.list.memory()
            + self.reference.cells.memory()
            + self.conduction.tensor.capacity() * size_of::<Matrix<D>>()
            + self.new_place.capacity() * size_of::<u32>()
            + self.reference.bonds.capacity() * size_of::<(u64, u64)>()
    }
}
