//! Heat in the tool: conduction by finite elements, coupled to the particles that touch it.
//!
//! A particle covers its share A of the tool's surface ([`crate::contact::surface`]: a length in the plane; in space
//! taken as a square) about its foot, and exchanges
//! ```text
//! q = h (T_particle - T_tool),   1/h = 1/h_c + dx / (2 k)
//! ```
//! with the tool there: h_c is the contact conductance, the second term the way from the
//! particle's centre to its surface through its own material, without which a good contact would have
//! its temperature half a spacing inside the workpiece. Of the heat of friction the tool takes the share
//! that the particle does not.
//!
//! The tool makes steps of its own, some tens of those of the particles. In between, times and places of
//! contact and the heat of friction are gathered for each particle; a step then solves the tool
//! implicitly in both its temperatures and those of the particles in contact,
//! ```text
//! Q = G c / (G + c) sum_a w_a (T_particle - T_a'),   G = h sum A dt
//! ```
//! (c: heat capacity of the particle, t: time in contact, w_a: share of node a in what is covered, T_a':
//! its temperature after the step), and moves exactly this heat from the particle to the nodes. It is
//! stable for any conductance, and the heat that leaves the workpiece is that which enters the tool, to
//! rounding. The error is of first order in the step, which `interval` bounds.
//!
//! Neglected: radiation, cooling of free surfaces, heat of the coating's interface with the substrate,
//! deformation of the tool.

mod body;
mod conduction;
mod coupling;
mod mesh;
mod octree;
mod outline;
mod rim;
mod skin;
mod solid;
#[cfg(test)]
mod space_tests;
mod stuffing;
#[cfg(test)]
mod tests;

pub(crate) use coupling::in_tool;

use crate::contact::tool_motion::speed;
use crate::error::SetupError;
use crate::setup::{OuterBoundary, Tool, ToolHeat as Description, Vector};
use body::{Body, Made};
use conduction::{Conduction, Flow, Load};

/// Way of a particle along the tool in one step of the tool, in spacings.
const LONGEST_WAY: f64 = 0.1;
/// Step of the tool in terms of `dx^2 / a`, a the diffusivity of its best conducting layer: the heat of
/// a particle spreads by no more than a third of its width.
const LONGEST_DIFFUSION: f64 = 0.1;

/// Least width of the share of a particle that heats the tool, in spacings.
const LEAST_WIDTH: f64 = 0.1;

/// What a particle did at the surface since the last step of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Exposure {
    /// Time in contact in s.
    duration: f64,
    /// Sum of time and area in m^2 s (m s in 2D).
    coverage: f64,
    /// Where it was first: see [`Body::place`].
    place: Vector,
    /// Sum of time and way from there, in m s.
    drift: Vector,
    /// Heat of friction for the tool in J (J/m in 2D).
    friction: f64,
}

/// A particle as the tool sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Partner {
    pub(crate) temperature: f64,
    /// J/K (J/(m K) in 2D).
    pub(crate) capacity: f64,
    /// W/(m K).
    pub(crate) conductivity: f64,
}

/// Heat since the start in J (J/m in 2D).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Books {
    /// Through the contact from the particles.
    pub(crate) contact: f64,
    /// Of friction.
    pub(crate) friction: f64,
    /// Through the outer boundary, negative where it leaves.
    pub(crate) boundary: f64,
}

/// What the mesh is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolMeshFacts {
    /// 2 or 3.
    pub dimension: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of triangles; in space of tetrahedra and of prisms of the coating.
    pub elements: usize,
    /// Those of the coating.
    pub coating_elements: usize,
    /// Layers of elements across the coating; 0 without one.
    pub coating_layers: usize,
    /// Thickness of the coating in m; 0 without one.
    pub coating_thickness: f64,
    /// Their area in m^2, or volume in m^3.
    pub extent: f64,
    /// Time step of the tool in s.
    pub time_step: f64,
}

/// A particle's exchange during a step of the tool.
#[derive(Debug, Clone, Copy)]
struct Exchange {
    particle: u32,
    /// J/K (J/(m K) in 2D).
    exchange: f64,
    temperature: f64,
    /// End of its nodes in the list of shares.
    end: usize,
}

/// The tool as a body that conducts heat.
#[derive(Debug)]
pub(crate) struct ToolHeat {
    body: Body,
    conduction: Conduction,
    temperature: Vec<f64>,
    /// Its initial value.
    start: Vec<f64>,
    description: Description,
    /// Length (2D) or area of outer sides at each node in m or m^2.
    outer: Vec<f64>,
    /// Shortest step over the whole path in s.
    pub(crate) interval: f64,
    /// Step at the start of the path in s.
    first_interval: f64,
    /// Longest step by the diffusion of a particle's heat in s.
    longest_interval: f64,
    /// Width that a particle of a resting lattice covers in m.
    width: f64,
    /// Time since the last step in s.
    pending: f64,
    /// By particle, rising.
    exposures: Vec<(u32, Exposure)>,
    pub(crate) books: Books,
    load: Load,
    flow: Flow,
    partners: Vec<Exchange>,
    shares: Vec<(u32, f64)>,
    leaving: Vec<(u32, f64)>,
}

impl ToolHeat {
    /// The tool at its initial temperature, for particles of `spacing`.
    ///
    /// # Errors
    /// A half space; a mesh that cannot be made.
    pub(crate) fn new(tool: &Tool, heat: &Description, spacing: f64) -> Result<Self, SetupError> {
        let Made { body, conduction, outer } = Body::make(tool, heat)?;
        let longest_interval = longest_interval(heat, spacing);
        let changes = tool.velocity_changes.iter().map(|change| speed(&change.velocity));
        let interval = |speed: f64| longest_way(speed, spacing).min(longest_interval);
        let mut temperature = vec![heat.temperature; body.nodes()];
        if let OuterBoundary::Fixed(fixed) = heat.outer {
            for (value, extent) in temperature.iter_mut().zip(&outer) {
                if *extent > 0.0 {
                    *value = fixed;
                }
            }
        }
        Ok(Self {
            interval: interval(changes.fold(speed(&tool.velocity), f64::max)),
            first_interval: interval(speed(&tool.velocity)),
            longest_interval,
            body,
            conduction,
            start: temperature.clone(),
            temperature,
            outer,
            width: spacing,
            pending: 0.0,
            exposures: Vec::new(),
            books: Books::default(),
            description: heat.clone(),
            load: Load::default(),
            flow: Flow::default(),
            partners: Vec::new(),
            shares: Vec::new(),
            leaving: Vec::new(),
        })
    }

    /// What the mesh is like.
    pub(crate) fn facts(&self) -> ToolMeshFacts {
        ToolMeshFacts { time_step: self.first_interval, ..self.body.facts(&self.description) }
    }

    /// Bytes of the arrays.
    pub(crate) fn memory(&self) -> usize {
        self.conduction.memory() + self.body.memory()
    }

    /// Notes that `particle` of a resting lattice touches at `position` (tool frame) for `duration` and rubs
    /// `friction` of heat into the tool.
    pub(crate) fn touch(&mut self, particle: u32, position: &Vector, duration: f64, friction: f64) {
        self.touch_on(self.body.patch(self.width), particle, position, duration, friction);
    }

    /// The same of one that covers `area`.
    pub(crate) fn touch_on(
        &mut self,
        area: f64,
        particle: u32,
        position: &Vector,
        duration: f64,
        friction: f64,
    ) {
        let place = self.body.place(position);
        let index = match self.exposures.binary_search_by_key(&particle, |known| known.0) {
            Ok(index) => index,
            Err(index) => {
                let fresh = Exposure {
                    duration: 0.0,
                    coverage: 0.0,
                    place,
                    drift: [0.0; 3],
                    friction: 0.0,
                };
                self.exposures.insert(index, (particle, fresh));
                index
            }
        };
        let exposure = &mut self.exposures[index].1;
        exposure.duration += duration;
        exposure.coverage += duration * area;
        let way = self.body.way(&exposure.place, &place);
        for (drift, way) in exposure.drift.iter_mut().zip(way) {
            *drift += duration * way;
        }
        exposure.friction += friction;
        self.books.friction += friction;
    }

    /// Whether a step is due after another `elapsed` of time at `speed` of the tool.
    pub(crate) fn is_due_after(&mut self, elapsed: f64, speed: f64) -> bool {
        self.pending += elapsed;
        // A step in space costs more than one in the plane: a tool that returns touches nothing.
        let is_idle = self.exposures.is_empty() && self.body.place_axes() == 3;
        let by_way = if is_idle { f64::INFINITY } else { longest_way(speed, self.width) };
        // Half a step of tolerance, as for the conduction between particles.
        self.pending + 0.5 * elapsed >= by_way.min(self.longest_interval)
    }

    /// A step of the tool over the time pending; `look` tells about a particle. Returns the heat
    /// that leaves each particle in J (J/m in 2D).
    pub(crate) fn step(&mut self, look: impl Fn(u32) -> Partner) -> &[(u32, f64)] {
        let duration = std::mem::take(&mut self.pending);
        self.load.clear(self.body.nodes(), duration);
        self.bound();
        self.gather(look);
        self.conduction.step(&mut self.temperature, &self.load, &mut self.flow);
        let end = &self.flow.end_temperature;
        let mut first = 0;
        self.leaving.clear();
        for partner in &self.partners {
            let heat = |(node, share): &(u32, f64)| {
                share * partner.exchange * (partner.temperature - end[*node as usize])
            };
            let left = self.shares[first..partner.end].iter().map(heat).sum();
            self.leaving.push((partner.particle, left));
            first = partner.end;
        }
        self.books.contact += self.leaving.iter().map(|(_, heat)| heat).sum::<f64>();
        self.books.boundary += self.boundary_heat();
        &self.leaving
    }

    /// Puts the contacts since the last step on the nodes.
    fn gather(&mut self, look: impl Fn(u32) -> Partner) {
        self.partners.clear();
        self.shares.clear();
        let load = &mut self.load;
        for (particle, exposure) in &self.exposures {
            let partner = look(*particle);
            let resistance = 1.0 / self.description.contact_conductance
                + 0.5 * self.width / partner.conductivity;
            let whole = exposure.coverage / resistance;
            let exchange = whole * partner.capacity / (whole + partner.capacity);
            let middle =
                std::array::from_fn(|k| exposure.place[k] + exposure.drift[k] / exposure.duration);
            let first = self.shares.len();
            let width = self.body.width(exposure.coverage / exposure.duration);
            let width = width.max(LEAST_WIDTH * self.width);
            self.body.footprint(&middle, width, &mut self.shares);
            for &(node, share) in &self.shares[first..] {
                let node = node as usize;
                load.supply[node] += share * exposure.friction;
                load.exchange[node] += share * exchange;
                load.exchange_heat[node] += share * exchange * partner.temperature;
            }
            self.partners.push(Exchange {
                particle: *particle,
                exchange,
                temperature: partner.temperature,
                end: self.shares.len(),
            });
        }
        self.exposures.clear();
    }

    /// Adds what holds on the outer boundary.
    fn bound(&mut self) {
        let load = &mut self.load;
        match self.description.outer {
            OuterBoundary::Adiabatic => {}
            OuterBoundary::Fixed(_) => {
                for (fixed, extent) in load.is_fixed.iter_mut().zip(&self.outer) {
                    *fixed = *extent > 0.0;
                }
            }
            OuterBoundary::Convective { film_coefficient, ambient } => {
                for (node, extent) in self.outer.iter().enumerate() {
                    let exchange = film_coefficient * extent * load.duration;
                    load.exchange[node] += exchange;
                    load.exchange_heat[node] += exchange * ambient;
                }
            }
        }
    }

    /// Heat through the outer boundary into the tool during a step.
    fn boundary_heat(&self) -> f64 {
        let (load, flow) = (&self.load, &self.flow);
        match self.description.outer {
            OuterBoundary::Adiabatic => 0.0,
            // A node at a fixed temperature gives away what it receives.
            OuterBoundary::Fixed(_) => {
                let fixed = flow.heat.iter().zip(&load.is_fixed).filter(|(_, fixed)| **fixed);
                -fixed.map(|(heat, _)| heat).sum::<f64>()
            }
            OuterBoundary::Convective { film_coefficient, ambient } => self
                .outer
                .iter()
                .zip(&flow.end_temperature)
                .map(|(extent, end)| film_coefficient * extent * load.duration * (ambient - end))
                .sum(),
        }
    }

    /// Heat above the initial state in J (J/m in 2D), with the heat of friction that waits for the next
    /// step.
    pub(crate) fn content(&self) -> f64 {
        let stored: f64 = self
            .temperature
            .iter()
            .zip(&self.start)
            .enumerate()
            .map(|(node, (now, start))| self.conduction.capacity(node).heat_between(*start, *now))
            .sum();
        stored + self.exposures.iter().map(|(_, exposure)| exposure.friction).sum::<f64>()
    }

    /// Largest change of temperature at the outer sides in K.
    pub(crate) fn outer_rise(&self) -> f64 {
        let changes =
            self.temperature.iter().zip(&self.start).map(|(now, start)| (now - start).abs());
        let outer = changes.zip(&self.outer).filter(|(_, extent)| **extent > 0.0);
        outer.map(|(change, _)| change).fold(0.0, f64::max)
    }

    /// Highest temperature in K.
    pub(crate) fn hottest(&self) -> f64 {
        self.temperature.iter().copied().fold(0.0, f64::max)
    }
}

/// Longest step by the way of a particle along the tool.
fn longest_way(speed: f64, spacing: f64) -> f64 {
    if speed > 0.0 { LONGEST_WAY * spacing / speed } else { f64::INFINITY }
}

/// Longest step by the diffusion of its heat.
fn longest_interval(heat: &Description, spacing: f64) -> f64 {
    let materials = std::iter::once(&heat.substrate)
        .chain(heat.coating.as_ref().map(|coating| &coating.material));
    let diffusivity = materials
        .map(|m| m.thermal_conductivity.max() / (m.density * m.specific_heat.min()))
        .fold(0.0, f64::max);
    LONGEST_DIFFUSION * spacing * spacing / diffusivity
}
