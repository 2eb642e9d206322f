//! Heat in the tool: conduction by finite elements, coupled to the particles that touch it.
//!
//! A particle of spacing dx covers the length dx of the outline about its foot and exchanges
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
//! Q = G c / (G + c) sum_a w_a (T_particle - T_a'),   G = h dx t
//! ```
//! (c: heat capacity of the particle, t: time in contact, w_a: share of node a in the length covered, T_a':
//! its temperature after the step), and moves exactly this heat from the particle to the nodes. It is
//! stable for any conductance, and the heat that leaves the workpiece is that which enters the tool, to
//! rounding. The error is of first order in the step, which `interval` bounds.
//!
//! Neglected: radiation, cooling of free surfaces, heat of the coating's interface with the substrate,
//! deformation of the tool.

mod conduction;
mod coupling;
mod mesh;
mod outline;
mod rim;
#[cfg(test)]
mod tests;

pub(crate) use coupling::in_tool;

use crate::error::SetupError;
use crate::setup::{OuterBoundary, Tool, ToolHeat as Description, ToolSurface};
use conduction::{Conduction, Flow, Load};
use mesh::ToolMesh;
use outline::{Point, double_area};
use rim::Rim;
use std::collections::BTreeMap;

/// Way of a particle along the tool in one step of the tool, in spacings.
const LONGEST_WAY: f64 = 0.1;
/// Step of the tool in terms of `dx^2 / a`, a the diffusivity of its best conducting layer: the heat of
/// a particle spreads by no more than a third of its width.
const LONGEST_DIFFUSION: f64 = 0.1;

/// What a particle did at the surface since the last step of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Exposure {
    /// Time in contact in s.
    duration: f64,
    /// Where along the outline it was first, in m.
    place: f64,
    /// Sum of time and way from there, in m s.
    drift: f64,
    /// Heat of friction for the tool in J, per metre of width.
    friction: f64,
}

/// A particle as the tool sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Partner {
    pub(crate) temperature: f64,
    /// J/K, per metre of width.
    pub(crate) capacity: f64,
    /// W/(m K).
    pub(crate) conductivity: f64,
}

/// Heat since the start in J, per metre of width.
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
    /// Number of nodes.
    pub nodes: usize,
    /// Number of triangles.
    pub elements: usize,
    /// Those of the coating.
    pub coating_elements: usize,
    /// Layers of elements across the coating; 0 without one.
    pub coating_layers: usize,
    /// Thickness of the coating in m; 0 without one.
    pub coating_thickness: f64,
    /// Area of the triangles in m^2.
    pub area: f64,
    /// Time step of the tool in s.
    pub time_step: f64,
}

/// The tool as a body that conducts heat.
#[derive(Debug)]
pub(crate) struct ToolHeat {
    mesh: ToolMesh,
    rim: Rim,
    conduction: Conduction,
    temperature: Vec<f64>,
    /// Its initial value.
    start: Vec<f64>,
    description: Description,
    /// Length of outer sides at each node in m.
    outer_length: Vec<f64>,
    /// Length of a step in s.
    pub(crate) interval: f64,
    /// Width that a particle covers in m.
    width: f64,
    /// Time since the last step in s.
    pending: f64,
    exposures: BTreeMap<u32, Exposure>,
    pub(crate) books: Books,
}

impl ToolHeat {
    /// The tool at its initial temperature, for particles of `spacing`.
    ///
    /// # Errors
    /// A surface that is no polygon; a mesh that cannot be made.
    pub(crate) fn new(tool: &Tool, heat: &Description, spacing: f64) -> Result<Self, SetupError> {
        let ToolSurface::Polygon(corners) = &tool.surface else {
            let reason =
                "it needs a plane tool with an outline: not in three dimensions, and not in \
                          a half space"
                    .to_owned();
            return Err(SetupError::ToolHeat { reason });
        };
        let mesh = ToolMesh::new(corners, heat)?;
        let conduction = Conduction::new(&mesh, heat);
        let rim = Rim::new(&mesh);
        let outer_length = rim.lengths(&mesh.rim_is_outer, mesh.nodes.len());
        let mut temperature = vec![heat.temperature; mesh.nodes.len()];
        if let OuterBoundary::Fixed(fixed) = heat.outer {
            for (value, length) in temperature.iter_mut().zip(&outer_length) {
                if *length > 0.0 {
                    *value = fixed;
                }
            }
        }
        Ok(Self {
            rim,
            conduction,
            start: temperature.clone(),
            temperature,
            outer_length,
            interval: interval(tool, heat, spacing),
            width: spacing,
            pending: 0.0,
            exposures: BTreeMap::new(),
            books: Books::default(),
            description: heat.clone(),
            mesh,
        })
    }

    /// What the mesh is like.
    pub(crate) fn facts(&self) -> ToolMeshFacts {
        let coated = self.mesh.layer.iter().filter(|l| **l == mesh::Layer::Coating).count();
        ToolMeshFacts {
            nodes: self.mesh.nodes.len(),
            elements: self.mesh.elements.len(),
            coating_elements: coated,
            coating_thickness: self.description.coating.as_ref().map_or(0.0, |c| c.thickness),
            coating_layers: if coated > 0 { mesh::COATING_LAYERS } else { 0 },
            area: self
                .mesh
                .elements
                .iter()
                .map(|element| {
                    let [a, b, c] = element.map(|node| self.mesh.nodes[node as usize]);
                    0.5 * double_area(a, b, c)
                })
                .sum(),
            time_step: self.interval,
        }
    }

    /// Bytes of the arrays.
    pub(crate) fn memory(&self) -> usize {
        self.conduction.memory() + self.mesh.nodes.len() * 4 * size_of::<Point>()
    }

    /// Notes that `particle` touches at `position` (tool frame) for `duration` and rubs `friction` of
    /// heat into the tool.
    pub(crate) fn touch(&mut self, particle: u32, position: Point, duration: f64, friction: f64) {
        let place = self.rim.foot(position);
        let exposure = self.exposures.entry(particle).or_insert(Exposure {
            duration: 0.0,
            place,
            drift: 0.0,
            friction: 0.0,
        });
        exposure.duration += duration;
        exposure.drift += duration * self.rim.way(exposure.place, place);
        exposure.friction += friction;
        self.books.friction += friction;
    }

    /// Whether a step is due after another `elapsed` of time.
    pub(crate) fn is_due_after(&mut self, elapsed: f64) -> bool {
        self.pending += elapsed;
        // Half a step of tolerance, as for the conduction between particles.
        self.pending + 0.5 * elapsed >= self.interval
    }

    /// A step of the tool over the time pending; `look` tells about a particle. Returns the heat
    /// that leaves each particle in J, per metre of width.
    pub(crate) fn step(&mut self, look: impl Fn(u32) -> Partner) -> Vec<(u32, f64)> {
        let duration = std::mem::take(&mut self.pending);
        let nodes = self.mesh.nodes.len();
        let mut load = Load::none(nodes, duration);
        self.bound(&mut load);
        // Of each particle: its number, its exchange in J/K, its temperature and the nodes it covers.
        let mut partners = Vec::with_capacity(self.exposures.len());
        for (particle, exposure) in std::mem::take(&mut self.exposures) {
            let partner = look(particle);
            let resistance = 1.0 / self.description.contact_conductance
                + 0.5 * self.width / partner.conductivity;
            let whole = self.width * exposure.duration / resistance;
            let exchange = whole * partner.capacity / (whole + partner.capacity);
            let middle = exposure.place + exposure.drift / exposure.duration;
            let shares = self.rim.footprint(middle, self.width);
            for &(node, share) in &shares {
                let node = node as usize;
                load.supply[node] += share * exposure.friction;
                load.exchange[node] += share * exchange;
                load.exchange_heat[node] += share * exchange * partner.temperature;
            }
            partners.push((particle, exchange, partner.temperature, shares));
        }
        let flow = self.conduction.step(&mut self.temperature, &load);
        let end = &flow.end_temperature;
        let leaving: Vec<(u32, f64)> = partners
            .into_iter()
            .map(|(particle, exchange, temperature, shares)| {
                let heat = |(node, share): (u32, f64)| {
                    share * exchange * (temperature - end[node as usize])
                };
                (particle, shares.into_iter().map(heat).sum())
            })
            .collect();
        self.books.contact += leaving.iter().map(|(_, heat)| heat).sum::<f64>();
        self.books.boundary += self.boundary_heat(&load, &flow);
        leaving
    }

    /// Adds what holds on the outer boundary.
    fn bound(&self, load: &mut Load) {
        match self.description.outer {
            OuterBoundary::Adiabatic => {}
            OuterBoundary::Fixed(_) => {
                for (fixed, length) in load.is_fixed.iter_mut().zip(&self.outer_length) {
                    *fixed = *length > 0.0;
                }
            }
            OuterBoundary::Convective { film_coefficient, ambient } => {
                for (node, length) in self.outer_length.iter().enumerate() {
                    let exchange = film_coefficient * length * load.duration;
                    load.exchange[node] += exchange;
                    load.exchange_heat[node] += exchange * ambient;
                }
            }
        }
    }

    /// Heat through the outer boundary into the tool during a step.
    fn boundary_heat(&self, load: &Load, flow: &Flow) -> f64 {
        match self.description.outer {
            OuterBoundary::Adiabatic => 0.0,
            // A node at a fixed temperature gives away what it receives.
            OuterBoundary::Fixed(_) => {
                let fixed = flow.heat.iter().zip(&load.is_fixed).filter(|(_, fixed)| **fixed);
                -fixed.map(|(heat, _)| heat).sum::<f64>()
            }
            OuterBoundary::Convective { film_coefficient, ambient } => self
                .outer_length
                .iter()
                .zip(&flow.end_temperature)
                .map(|(length, end)| film_coefficient * length * load.duration * (ambient - end))
                .sum(),
        }
    }

    /// Heat above the initial state in J, per metre of width; with the heat of friction that waits
    /// for the next step.
    pub(crate) fn content(&self) -> f64 {
        let stored: f64 = self
            .temperature
            .iter()
            .zip(&self.start)
            .enumerate()
            .map(|(node, (now, start))| self.conduction.capacity(node).heat_between(*start, *now))
            .sum();
        stored + self.exposures.values().map(|exposure| exposure.friction).sum::<f64>()
    }

    /// Highest temperature in K.
    pub(crate) fn hottest(&self) -> f64 {
        self.temperature.iter().copied().fold(0.0, f64::max)
    }
}

fn interval(tool: &Tool, heat: &Description, spacing: f64) -> f64 {
    let speed = |v: &[f64; 3]| v[0].hypot(v[1]).hypot(v[2]);
    let fastest = tool
        .velocity_changes
        .iter()
        .map(|change| speed(&change.velocity))
        .fold(speed(&tool.velocity), f64::max);
    let materials = std::iter::once(&heat.substrate)
        .chain(heat.coating.as_ref().map(|coating| &coating.material));
    let diffusivity = materials
        .map(|m| m.thermal_conductivity.max() / (m.density * m.specific_heat.min()))
        .fold(0.0, f64::max);
    let by_way = if fastest > 0.0 { LONGEST_WAY * spacing / fastest } else { f64::INFINITY };
    by_way.min(LONGEST_DIFFUSION * spacing * spacing / diffusivity)
}
