//! Heat conduction by linear triangles or tetrahedra, implicit in time.
//!
//! ```text
//! C_i dT_i/dt = sum_j K_ij (T_j - T_i) + Q_i,   K_ij = -sum_e k_e A_e grad phi_i . grad phi_j
//! C_i = sum_e rho cp(T_i) A_e / 3               (lumped, per metre of width)
//! ```
//! In space A_e is the volume of a tetrahedron and C_i has a quarter of it. A triangle has the conductivity at
//! its mean temperature; in space, where there are six times as many elements as pairs of nodes to store, a pair has that at
//! its own mean.
//! One step solves the backward Euler equations with C and k of its beginning for the change of
//! temperature, by conjugate gradients; then the heat of each pair of nodes, computed from the
//! solution, is moved from node to node and every node takes the temperature of its heat content.
//! - Heat is conserved to rounding, however far the iteration went: what one node gives, another gets.
//! - In a Delaunay mesh `K_ij >= 0` inside: with the lumped capacity and backward Euler temperatures
//!   stay between their neighbours' for any step. A consistent capacity, or Crank-Nicolson, would
//!   undershoot under the sudden flux of a particle that comes into contact.
//! - First order in time, second in the element length.

use crate::description::ToolHeat;
use crate::mesh::{Layer, PlaneMesh};
use crate::outline::double_area;
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

/// A pair of nodes that conducts within one material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    /// Rising.
    pub(crate) nodes: [u32; 2],
    /// Conductance for a conductivity of one, in m.
    pub(crate) weight: f64,
    /// 0 substrate, 1 coating.
    material: u8,
}

impl Link {
    pub(crate) fn new([a, b]: [u32; 2], weight: f64, material: u8) -> Self {
        Self { nodes: [a.min(b), a.max(b)], weight, material }
    }
}

/// From conductivity and geometry to the conductances of the edges.
#[derive(Debug)]
enum Shape {
    Triangles {
        elements: Vec<[u32; 3]>,
        /// Of each element: its edges and their geometric weights `cot(opposite angle) / 2`.
        weights: Vec<[(u32, f64); 3]>,
        /// Index into `conductivity`.
        material: Vec<u8>,
    },
    /// Weight and material of each edge.
    Links(Vec<(f64, u8)>),
}

/// The equations of one mesh.
#[derive(Debug)]
pub(crate) struct Conduction {
    capacity: Vec<Capacity>,
    edges: Vec<Edge>,
    shape: Shape,
    conductivity: Vec<TemperatureTable>,
    work: Work,
}

/// Vectors of a solution, one number for each node.
#[derive(Debug, Default)]
struct Work {
    alone: Vec<f64>,
    diagonal: Vec<f64>,
    residual: Vec<f64>,
    conditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    change: Vec<f64>,
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
#[derive(Debug, Default)]
pub(crate) struct Flow {
    /// Heat that each node received in J: fixed nodes pass theirs on.
    pub(crate) heat: Vec<f64>,
    /// Temperatures that the exchange with the surroundings was computed with.
    pub(crate) end_temperature: Vec<f64>,
}

impl Load {
    /// Takes everything off.
    pub(crate) fn clear(&mut self, nodes: usize, duration: f64) {
        self.duration = duration;
        for values in [&mut self.supply, &mut self.exchange, &mut self.exchange_heat] {
            refill(values, std::iter::repeat_n(0.0, nodes));
        }
        refill(&mut self.is_fixed, std::iter::repeat_n(false, nodes));
    }
}

/// Other values in the same place of memory.
fn refill<T>(values: &mut Vec<T>, fresh: impl IntoIterator<Item = T>) {
    values.clear();
    values.extend(fresh);
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
    /// Of triangles.
    pub(crate) fn new(mesh: &PlaneMesh, heat: &ToolHeat) -> Self {
        let materials = heat.materials();
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
                weights[index][k].1 = 0.5 * (from - apex).dot(to - apex) / (2.0 * area);
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
        let shape = Shape::Triangles {
            elements: mesh.elements.clone(),
            weights,
            material: mesh.layer.iter().map(|layer| place(layer) as u8).collect(),
        };
        Self::of(edges, shape, &mass, heat)
    }

    /// From pairs of nodes, each once, and the masses of substrate and coating at each node.
    pub(crate) fn of_links(links: Vec<Link>, mass: &[[f64; 2]], heat: &ToolHeat) -> Self {
        let edges = links.iter().map(|link| Edge { nodes: link.nodes, conductance: 0.0 });
        let edges = edges.collect();
        let shape = Shape::Links(links.iter().map(|link| (link.weight, link.material)).collect());
        Self::of(edges, shape, mass, heat)
    }

    fn of(edges: Vec<Edge>, shape: Shape, mass: &[[f64; 2]], heat: &ToolHeat) -> Self {
        let materials = heat.materials();
        let capacity = mass.iter().map(|masses| {
            let parts: Vec<_> = masses
                .iter()
                .zip(&materials)
                .map(|(mass, material)| (*mass * heat.capacity_scaling, &material.specific_heat))
                .collect();
            Capacity::of(&parts)
        });
        let mut conduction = Self {
            capacity: capacity.collect(),
            edges,
            shape,
            conductivity: materials.iter().map(|m| m.thermal_conductivity.clone()).collect(),
            work: Work::default(),
        };
        conduction.renew_conductances(&vec![heat.temperature; mass.len()]);
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
        let shape = match &self.shape {
            Shape::Triangles { elements, .. } => {
                elements.len() * (size_of::<[u32; 3]>() + size_of::<[(u32, f64); 3]>() + 1)
            }
            Shape::Links(links) => links.len() * size_of::<(f64, u8)>(),
        };
        shape
            + self.capacity.len() * (size_of::<Capacity>() + size_of::<[f64; 7]>())
            + self.edges.len() * size_of::<Edge>()
    }

    fn renew_conductances(&mut self, temperature: &[f64]) {
        match &self.shape {
            Shape::Triangles { elements, weights, material } => {
                for edge in &mut self.edges {
                    edge.conductance = 0.0;
                }
                for (index, element) in elements.iter().enumerate() {
                    let [a, b, c] = element.map(|node| temperature[node as usize]);
                    let table = &self.conductivity[material[index] as usize];
                    let conductivity = table.value((a + b + c) / 3.0);
                    for (edge, weight) in weights[index] {
                        self.edges[edge as usize].conductance += conductivity * weight;
                    }
                }
            }
            Shape::Links(links) => {
                for (edge, (weight, material)) in self.edges.iter_mut().zip(links) {
                    let [a, b] = edge.nodes.map(|node| temperature[node as usize]);
                    let table = &self.conductivity[*material as usize];
                    edge.conductance = table.value(0.5 * (a + b)) * weight;
                }
            }
        }
    }

    /// One step; `flow` tells what it did.
    pub(crate) fn step(&mut self, temperature: &mut [f64], load: &Load, flow: &mut Flow) {
        if self.conductivity.iter().any(|table| table.constant().is_none()) {
            self.renew_conductances(temperature);
        }
        self.solve(temperature, load);
        let Flow { heat, end_temperature: after } = flow;
        refill(heat, load.supply.iter().copied());
        refill(after, temperature.iter().zip(&self.work.change).map(|(t, d)| t + d));
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
    }

    /// The change of temperature over the step, in `work.change`.
    fn solve(&mut self, temperature: &[f64], load: &Load) {
        let nodes = temperature.len();
        let Work { alone, diagonal, residual, conditioned, direction, image, change } =
            &mut self.work;
        refill(
            alone,
            (0..nodes).map(|node| self.capacity[node].at(temperature[node]) + load.exchange[node]),
        );
        refill(
            residual,
            (0..nodes).map(|node| {
                load.supply[node] + load.exchange_heat[node]
                    - load.exchange[node] * temperature[node]
            }),
        );
        refill(diagonal, alone.iter().copied());
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
        project(residual);
        let product =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() };
        refill(change, std::iter::repeat_n(0.0, nodes));
        refill(direction, residual.iter().zip(&*diagonal).map(|(r, d)| r / d));
        let mut size = product(residual, direction);
        let enough = TOLERANCE * TOLERANCE * size;
        for _ in 0..MOST_ITERATIONS {
            if size <= enough {
                break;
            }
            refill(image, direction.iter().zip(&*alone).map(|(x, d)| x * d));
            for edge in &self.edges {
                let [a, b] = edge.nodes.map(|node| node as usize);
                let flow = load.duration * edge.conductance * (direction[a] - direction[b]);
                image[a] += flow;
                image[b] -= flow;
            }
            project(image);
            let step = size / product(direction, image);
            for node in 0..nodes {
                change[node] += step * direction[node];
                residual[node] -= step * image[node];
            }
            refill(conditioned, residual.iter().zip(&*diagonal).map(|(r, d)| r / d));
            let next_size = product(residual, conditioned);
            let turn = next_size / size;
            for (value, fresh) in direction.iter_mut().zip(&*conditioned) {
                *value = fresh + turn * *value;
            }
            size = next_size;
        }
    }
}
