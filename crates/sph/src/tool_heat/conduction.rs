//! Heat conduction by linear triangles, implicit in time.
//!
//! ```text
//! C_i dT_i/dt = sum_j K_ij (T_j - T_i) + Q_i,   K_ij = -sum_e k_e A_e grad phi_i . grad phi_j
//! C_i = sum_e rho cp(T_i) A_e / 3               (lumped, per metre of width)
//! ```
//! One step solves the backward Euler equations with C and k of its beginning for the change of
//! temperature, by conjugate gradients; then the heat of each pair of nodes, computed from the
//! solution, is moved from node to node and every node takes the temperature of its heat content.
//! - Heat is conserved to rounding, however far the iteration went: what one node gives, another gets.
//! - In a Delaunay mesh `K_ij >= 0` inside: with the lumped capacity and backward Euler temperatures
//!   stay between their neighbours' for any step. A consistent capacity, or Crank-Nicolson, would
//!   undershoot under the sudden flux of a particle that comes into contact.
//! - First order in time, second in the element length.

use super::mesh::{Layer, ToolMesh};
use super::outline::double_area;
use crate::setup::{ThermalMaterial, ToolHeat};
use sphcut_physics::TemperatureTable;

/// Residual, over that of no change at all, at which the iteration ends.
const TOLERANCE: f64 = 1e-9;
/// Most iterations of a step: beyond, the step still conserves heat.
const MOST_ITERATIONS: usize = 500;

/// Heat capacity of a node in J/K, per metre of width.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Capacity {
    Constant(f64),
    Table(TemperatureTable),
}

/// Nodes of one side of elements with the elements' shares.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    nodes: [u32; 2],
    /// W/K per metre of width.
    conductance: f64,
}

/// The equations of one mesh.
#[derive(Debug)]
pub(crate) struct Conduction {
    capacity: Vec<Capacity>,
    edges: Vec<Edge>,
    elements: Vec<[u32; 3]>,
    /// Of each element: its edges and their geometric weights `cot(opposite angle) / 2`.
    weights: Vec<[(u32, f64); 3]>,
    /// Index into `conductivity`.
    material: Vec<u8>,
    conductivity: Vec<TemperatureTable>,
}

/// What acts on the nodes during a step, per metre of width.
#[derive(Debug, Default)]
pub(crate) struct Load {
    /// Duration in s.
    pub(crate) duration: f64,
    /// Heat supplied in J.
    pub(crate) supply: Vec<f64>,
    /// Exchange with surroundings in J/K: heat `exchange (outside - T)`, T of the end of the step.
    pub(crate) exchange: Vec<f64>,
    /// Sum of exchange times temperature of the surroundings in J.
    pub(crate) exchange_heat: Vec<f64>,
    /// Nodes whose temperature does not change.
    pub(crate) is_fixed: Vec<bool>,
}

/// What a step did.
#[derive(Debug)]
pub(crate) struct Flow {
    /// Heat that each node received in J: fixed nodes pass theirs on.
    pub(crate) heat: Vec<f64>,
    /// Temperatures that the exchange with the surroundings was computed with.
    pub(crate) end_temperature: Vec<f64>,
}

impl Load {
    pub(crate) fn none(nodes: usize, duration: f64) -> Self {
        Self {
            duration,
            supply: vec![0.0; nodes],
            exchange: vec![0.0; nodes],
            exchange_heat: vec![0.0; nodes],
            is_fixed: vec![false; nodes],
        }
    }
}

impl Capacity {
    /// The sum of materials `(rho V in kg, cp)`.
    fn of(parts: &[(f64, &TemperatureTable)]) -> Self {
        let mass = |part: &(f64, &TemperatureTable)| part.0 > 0.0;
        let parts: Vec<_> = parts.iter().filter(|part| mass(part)).collect();
        let constant: Option<f64> =
            parts.iter().map(|(mass, table)| Some(mass * table.constant()?)).sum();
        if let Some(constant) = constant {
            return Self::Constant(constant);
        }
        let mut knots: Vec<f64> =
            parts.iter().flat_map(|(_, table)| table.pairs().map(|pair| pair.0)).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        let sum = |t: f64| parts.iter().map(|(mass, table)| mass * table.value(t)).sum();
        let pairs: Vec<(f64, f64)> = knots.into_iter().map(|t| (t, sum(t))).collect();
        Self::Table(TemperatureTable::new(&pairs).expect("a sum of positive tables is a table"))
    }

    pub(crate) fn at(&self, temperature: f64) -> f64 {
        match self {
            Self::Constant(capacity) => *capacity,
            Self::Table(table) => table.value(temperature),
        }
    }

    fn heated(&self, temperature: f64, heat: f64) -> f64 {
        match self {
            Self::Constant(capacity) => temperature + heat / capacity,
            Self::Table(table) => table.heated(temperature, heat),
        }
    }

    pub(crate) fn heat_between(&self, from: f64, to: f64) -> f64 {
        match self {
            Self::Constant(capacity) => capacity * (to - from),
            Self::Table(table) => table.integral(to) - table.integral(from),
        }
    }
}

impl Conduction {
    pub(crate) fn new(mesh: &ToolMesh, heat: &ToolHeat) -> Self {
        let materials: Vec<&ThermalMaterial> = std::iter::once(&heat.substrate)
            .chain(heat.coating.as_ref().map(|coating| &coating.material))
            .collect();
        let place = |layer: &Layer| usize::from(*layer == Layer::Coating);
        let mut mass = vec![[0.0; 2]; mesh.nodes.len()];
        let mut sides: Vec<([u32; 2], usize, usize)> = Vec::new();
        let mut weights = vec![[(0, 0.0); 3]; mesh.elements.len()];
        for (index, (element, layer)) in mesh.elements.iter().zip(&mesh.layer).enumerate() {
            let corners = element.map(|node| mesh.nodes[node as usize]);
            let area = 0.5 * double_area(corners[0], corners[1], corners[2]);
            for k in 0..3 {
                mass[element[k] as usize][place(layer)] +=
                    materials[place(layer)].density * area / 3.0;
                let (apex, from, to) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
                let dot = (from[0] - apex[0]) * (to[0] - apex[0])
                    + (from[1] - apex[1]) * (to[1] - apex[1]);
                weights[index][k].1 = 0.5 * dot / (2.0 * area);
                let (a, b) = (element[(k + 1) % 3], element[(k + 2) % 3]);
                sides.push(([a.min(b), a.max(b)], index, k));
            }
        }
        sides.sort_unstable();
        let mut edges: Vec<Edge> = Vec::new();
        for (nodes, element, k) in sides {
            if edges.last().is_none_or(|edge| edge.nodes != nodes) {
                edges.push(Edge { nodes, conductance: 0.0 });
            }
            weights[element][k].0 = (edges.len() - 1) as u32;
        }
        let capacity = mass.iter().map(|masses| {
            let parts: Vec<_> = masses
                .iter()
                .zip(&materials)
                .map(|(mass, material)| (*mass, &material.specific_heat))
                .collect();
            Capacity::of(&parts)
        });
        let mut conduction = Self {
            capacity: capacity.collect(),
            edges,
            elements: mesh.elements.clone(),
            weights,
            material: mesh.layer.iter().map(|layer| place(layer) as u8).collect(),
            conductivity: materials.iter().map(|m| m.thermal_conductivity.clone()).collect(),
        };
        conduction.renew_conductances(&vec![heat.temperature; mesh.nodes.len()]);
        conduction
    }

    pub(crate) fn capacity(&self, node: usize) -> &Capacity {
        &self.capacity[node]
    }

    /// Smallest conductance of a pair of nodes over the largest; negative where heat would flow from
    /// cold to hot.
    #[cfg(test)]
    pub(crate) fn smallest_conductance(&self) -> f64 {
        let all = || self.edges.iter().map(|edge| edge.conductance);
        all().fold(f64::INFINITY, f64::min) / all().fold(0.0, f64::max)
    }

    /// Bytes of the arrays.
    pub(crate) fn memory(&self) -> usize {
        self.capacity.len() * size_of::<Capacity>()
            + self.edges.len() * size_of::<Edge>()
            + self.elements.len() * (size_of::<[u32; 3]>() + size_of::<[(u32, f64); 3]>() + 1)
    }

    fn renew_conductances(&mut self, temperature: &[f64]) {
        for edge in &mut self.edges {
            edge.conductance = 0.0;
        }
        for (index, element) in self.elements.iter().enumerate() {
            let [a, b, c] = element.map(|node| temperature[node as usize]);
            let table = &self.conductivity[self.material[index] as usize];
            let conductivity = table.value((a + b + c) / 3.0);
            for (edge, weight) in self.weights[index] {
                self.edges[edge as usize].conductance += conductivity * weight;
            }
        }
    }

    /// One step.
    pub(crate) fn step(&mut self, temperature: &mut [f64], load: &Load) -> Flow {
        if self.conductivity.iter().any(|table| table.constant().is_none()) {
            self.renew_conductances(temperature);
        }
        let change = self.solve(temperature, load);
        let mut heat = load.supply.clone();
        let after: Vec<f64> = temperature.iter().zip(&change).map(|(t, d)| t + d).collect();
        for edge in &self.edges {
            let [a, b] = edge.nodes.map(|node| node as usize);
            let flow = load.duration * edge.conductance * (after[b] - after[a]);
            heat[a] += flow;
            heat[b] -= flow;
        }
        for node in 0..heat.len() {
            heat[node] += load.exchange_heat[node] - load.exchange[node] * after[node];
            if !load.is_fixed[node] {
                temperature[node] = self.capacity[node].heated(temperature[node], heat[node]);
            }
        }
        Flow { heat, end_temperature: after }
    }

    /// The change of temperature over the step.
    fn solve(&self, temperature: &[f64], load: &Load) -> Vec<f64> {
        let nodes = temperature.len();
        let mut diagonal: Vec<f64> = (0..nodes)
            .map(|node| self.capacity[node].at(temperature[node]) + load.exchange[node])
            .collect();
        let mut residual: Vec<f64> = (0..nodes)
            .map(|node| {
                load.supply[node] + load.exchange_heat[node]
                    - load.exchange[node] * temperature[node]
            })
            .collect();
        let alone = diagonal.clone();
        for edge in &self.edges {
            let [a, b] = edge.nodes.map(|node| node as usize);
            let conductance = load.duration * edge.conductance;
            diagonal[a] += conductance;
            diagonal[b] += conductance;
            let flow = conductance * (temperature[b] - temperature[a]);
            residual[a] += flow;
            residual[b] -= flow;
        }
        let project = |values: &mut [f64]| {
            for (value, fixed) in values.iter_mut().zip(&load.is_fixed) {
                if *fixed {
                    *value = 0.0;
                }
            }
        };
        project(&mut residual);
        let conditioned = |residual: &[f64]| -> Vec<f64> {
            residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect()
        };
        let product =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() };
        let mut change = vec![0.0; nodes];
        let mut direction = conditioned(&residual);
        let mut size = product(&residual, &direction);
        let enough = TOLERANCE * TOLERANCE * size;
        for _ in 0..MOST_ITERATIONS {
            if size <= enough {
                break;
            }
            let mut image: Vec<f64> = direction.iter().zip(&alone).map(|(x, d)| x * d).collect();
            for edge in &self.edges {
                let [a, b] = edge.nodes.map(|node| node as usize);
                let flow = load.duration * edge.conductance * (direction[a] - direction[b]);
                image[a] += flow;
                image[b] -= flow;
            }
            project(&mut image);
            let step = size / product(&direction, &image);
            for node in 0..nodes {
                change[node] += step * direction[node];
                residual[node] -= step * image[node];
            }
            let next = conditioned(&residual);
            let next_size = product(&residual, &next);
            let turn = next_size / size;
            for (value, fresh) in direction.iter_mut().zip(&next) {
                *value = fresh + turn * *value;
            }
            size = next_size;
        }
        change
    }
}
