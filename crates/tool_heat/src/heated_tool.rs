//! The tool as a body that conducts heat, step by step.

use crate::body::{Made, MeshedTool, ToolMeshFacts};
use crate::conduction::{Conduction, Flow, Load};
use crate::description::{OuterBoundary, ToolHeat, ToolHeatError};
use glam::DVec3;
use sphcut_geometry::tool_surface::ToolSurface;

/// Way of a particle along the tool in one step of the tool, in spacings.
const LONGEST_WAY: f64 = 0.1;
/// Step of the tool in terms of `dx^2 / a`, a the diffusivity of its best conducting layer: the heat of
/// a particle spreads by no more than a third of its width.
const LONGEST_DIFFUSION: f64 = 0.1;

/// Least width of the share of a particle that heats the tool, in spacings.
const LEAST_WIDTH: f64 = 0.1;

/// What a particle did at the surface since the last step of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Exposure {
    /// Time in contact in s.
    pub(crate) duration: f64,
    /// Sum of time and area in m^2 s (m s in 2D).
    pub(crate) coverage: f64,
    /// Where it was first: see [`MeshedTool::place`].
    pub(crate) place: DVec3,
    /// Sum of time and way from there, in m s.
    pub(crate) drift: DVec3,
    /// Heat of friction for the tool in J (J/m in 2D).
    pub(crate) friction: f64,
}

/// A particle as the tool sees it.
#[derive(Debug, Clone, Copy)]
pub struct ContactPartner {
    /// In K.
    pub temperature: f64,
    /// Heat capacity in J/K (J/(m K) in 2D).
    pub capacity: f64,
    /// In W/(m K).
    pub conductivity: f64,
}

/// Heat since the start in J (J/m in 2D).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HeatLedger {
    /// Through the contact from the particles.
    pub contact: f64,
    /// Of friction.
    pub friction: f64,
    /// Through the outer boundary, negative where it leaves.
    pub boundary: f64,
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
pub struct HeatedTool {
    pub(crate) body: MeshedTool,
    pub(crate) conduction: Conduction,
    pub(crate) temperature: Vec<f64>,
    /// Its initial value.
    start: Vec<f64>,
    description: ToolHeat,
    /// Length (2D) or area of outer sides at each node in m or m^2.
    pub(crate) outer: Vec<f64>,
    /// Shortest step over the whole path in s.
    pub interval: f64,
    /// Step at the start of the path in s.
    first_interval: f64,
    /// Longest step by the diffusion of a particle's heat in s.
    longest_interval: f64,
    /// Width that a particle of a resting lattice covers in m.
    width: f64,
    /// Time since the last step in s.
    pub(crate) pending: f64,
    /// By particle, rising.
    pub(crate) exposures: Vec<(u32, Exposure)>,
    /// What passed since the start.
    pub ledger: HeatLedger,
    load: Load,
    flow: Flow,
    partners: Vec<Exchange>,
    shares: Vec<(u32, f64)>,
    leaving: Vec<(u32, f64)>,
}

impl HeatedTool {
    /// The tool at its initial temperature, for particles of `spacing`; `speeds` are those of its path, the first at the
    /// start.
    ///
    /// # Errors
    /// A half space; a mesh that cannot be made.
    pub fn new(
        surface: &ToolSurface,
        heat: &ToolHeat,
        speeds: &[f64],
        spacing: f64,
    ) -> Result<Self, ToolHeatError> {
        let Made { body, conduction, outer } = MeshedTool::make(surface, heat)?;
        let longest_interval = longest_interval(heat, spacing);
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
            interval: interval(speeds.iter().copied().fold(0.0, f64::max)),
            first_interval: interval(speeds.first().copied().unwrap_or(0.0)),
            longest_interval,
            body,
            conduction,
            start: temperature.clone(),
            temperature,
            outer,
            width: spacing,
            pending: 0.0,
            exposures: Vec::new(),
            ledger: HeatLedger::default(),
            description: heat.clone(),
            load: Load::default(),
            flow: Flow::default(),
            partners: Vec::new(),
            shares: Vec::new(),
            leaving: Vec::new(),
        })
    }

    /// What the mesh is like.
    pub fn facts(&self) -> ToolMeshFacts {
        ToolMeshFacts { time_step: self.first_interval, ..self.body.facts(&self.description) }
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        self.conduction.memory() + self.body.memory()
    }

    /// Notes that `particle` of a resting lattice touches at `position` (tool frame) for `duration` and rubs
    /// `friction` of heat into the tool.
    pub fn touch(&mut self, particle: u32, position: DVec3, duration: f64, friction: f64) {
        self.touch_on(self.body.patch(self.width), particle, position, duration, friction);
    }

    /// The same of one that covers `area`.
    pub fn touch_on(
        &mut self,
        area: f64,
        particle: u32,
        position: DVec3,
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
                    drift: DVec3::ZERO,
                    friction: 0.0,
                };
                self.exposures.insert(index, (particle, fresh));
                index
            }
        };
        let exposure = &mut self.exposures[index].1;
        exposure.duration += duration;
        exposure.coverage += duration * area;
        exposure.drift += duration * self.body.way(exposure.place, place);
        exposure.friction += friction;
        self.ledger.friction += friction;
    }

    /// Whether a step is due after another `elapsed` of time at `speed` of the tool.
    pub fn is_due_after(&mut self, elapsed: f64, speed: f64) -> bool {
        self.pending += elapsed;
        // A step in space costs more than one in the plane: a tool that returns touches nothing.
        let is_idle = self.exposures.is_empty() && self.body.place_axes() == 3;
        let by_way = if is_idle { f64::INFINITY } else { longest_way(speed, self.width) };
        // Half a step of tolerance, as for the conduction between particles.
        self.pending + 0.5 * elapsed >= by_way.min(self.longest_interval)
    }

    /// A step of the tool over the time pending; `look` tells about a particle. Returns the heat
    /// that leaves each particle in J (J/m in 2D).
    pub fn step(&mut self, look: impl Fn(u32) -> ContactPartner) -> &[(u32, f64)] {
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
        self.ledger.contact += self.leaving.iter().map(|(_, heat)| heat).sum::<f64>();
        self.ledger.boundary += self.boundary_heat();
        &self.leaving
    }

    /// Puts the contacts since the last step on the nodes.
    fn gather(&mut self, look: impl Fn(u32) -> ContactPartner) {
        self.partners.clear();
        self.shares.clear();
        let load = &mut self.load;
        for (particle, exposure) in &self.exposures {
            let partner = look(*particle);
            let resistance = 1.0 / self.description.contact_conductance
                + 0.5 * self.width / partner.conductivity;
            let whole = exposure.coverage / resistance;
            let exchange = whole * partner.capacity / (whole + partner.capacity);
            let middle = exposure.place + exposure.drift / exposure.duration;
            let first = self.shares.len();
            let width = self.body.width(exposure.coverage / exposure.duration);
            let width = width.max(LEAST_WIDTH * self.width);
            self.body.footprint(middle, width, &mut self.shares);
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
    pub fn content(&self) -> f64 {
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
    pub fn outer_rise(&self) -> f64 {
        let changes =
            self.temperature.iter().zip(&self.start).map(|(now, start)| (now - start).abs());
        let outer = changes.zip(&self.outer).filter(|(_, extent)| **extent > 0.0);
        outer.map(|(change, _)| change).fold(0.0, f64::max)
    }

    /// Highest temperature in K.
    pub fn hottest(&self) -> f64 {
        self.temperature.iter().copied().fold(0.0, f64::max)
    }
}

/// Longest step by the way of a particle along the tool.
fn longest_way(speed: f64, spacing: f64) -> f64 {
    if speed > 0.0 { LONGEST_WAY * spacing / speed } else { f64::INFINITY }
}

/// Longest step by the diffusion of its heat.
fn longest_interval(heat: &ToolHeat, spacing: f64) -> f64 {
    let diffusivity = heat
        .materials()
        .into_iter()
        .map(|m| m.thermal_conductivity.max() / (m.density * m.specific_heat.min()))
        .fold(0.0, f64::max);
    LONGEST_DIFFUSION * spacing * spacing / diffusivity
}
