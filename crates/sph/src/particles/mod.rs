//! The particles: what is known of each, what they are made of, and how they move.

pub(crate) mod lattice;
pub(crate) mod lattice_cell;
pub(crate) mod motion;
pub(crate) mod row_pairs;
pub(crate) mod supports;
pub(crate) mod window;

use crate::ledger::Ledger;
use crate::material::data::MaterialData;
use crate::material::history::History;
use crate::material::point::MaterialPoint;
use crate::numerics::Numerics;
use crate::parallel::CHUNK;
use crate::setup::Setup;
use crate::tensor::{Matrix, Vector, dot, identity, plus_scaled, reduced};
use lattice::Seed;
use lattice_cell::LatticeCell;
use motion::Motion;
use rayon::prelude::*;
use supports::{FREE, Hold};

/// A slower motion in m/s is none. In front of a wave velocities fall without end, and numbers below 1e-308, as their
/// squares are from 1e-154 on, take a processor a hundred times as long as others.
const STILL: f64 = 1e-100;

/// All particles, one array for each quantity, in storage order.
#[derive(Debug)]
pub(crate) struct Particles<const D: usize> {
    pub(crate) id: Vec<u64>,
    pub(crate) body: Vec<u32>,
    /// Index into `materials`: of what and how large.
    pub(crate) material: Vec<u8>,
    /// Index into `holds`, or [`FREE`].
    pub(crate) hold: Vec<u8>,
    pub(crate) position: Vec<Vector<D>>,
    /// Position in the undeformed state.
    pub(crate) origin: Vec<Vector<D>>,
    pub(crate) motion: Vec<Motion<D>>,
    /// Shape H of each support, see `support_shape.rs`; empty while supports are round.
    pub(crate) shape: Vec<Matrix<D>>,
    /// Volume in the undeformed state in m^3 (m^2).
    pub(crate) volume: Vec<f64>,
    pub(crate) point: Vec<MaterialPoint<D>>,
    /// What effects with memory know of each particle; empty without such effects.
    pub(crate) history: Vec<History<D>>,
    /// Total force except the reaction of supports.
    pub(crate) force: Vec<Vector<D>>,
    pub(crate) materials: Vec<MaterialData>,
    /// Of how many classes of rows each material is there, one after the other.
    row_classes: u8,
    pub(crate) holds: Vec<Hold<D>>,
    /// Cells of the lattice, by body.
    cells_of_bodies: Vec<LatticeCell<D>>,
    /// Factor on the inertia.
    mass_scaling: f64,
    /// Room for reordering, kept from one to the next.
    marks: Vec<bool>,
}

/// A particle that is not followed yet.
#[derive(Debug, Clone)]
pub(crate) struct Rest<const D: usize> {
    pub(crate) id: u64,
    pub(crate) body: u32,
    pub(crate) material: u8,
    pub(crate) hold: u8,
    pub(crate) position: Vector<D>,
    pub(crate) velocity: Vector<D>,
    pub(crate) volume: f64,
    pub(crate) temperature: f64,
}

impl<const D: usize> Particles<D> {
    /// None yet, of the materials and supports of a setup.
    pub(crate) fn none(setup: &Setup, numerics: &Numerics) -> Self {
        let materials = MaterialData::all(setup, numerics.smoothing.length);
        Self {
            id: Vec::new(),
            body: Vec::new(),
            material: Vec::new(),
            hold: Vec::new(),
            position: Vec::new(),
            origin: Vec::new(),
            motion: Vec::new(),
            shape: Vec::new(),
            volume: Vec::new(),
            point: Vec::new(),
            history: Vec::new(),
            force: Vec::new(),
            row_classes: u8::try_from(materials.len() / setup.materials.len().max(1))
                .expect("fewer than 256 materials"),
            materials,
            holds: Hold::all(setup),
            cells_of_bodies: LatticeCell::all(setup),
            mass_scaling: numerics.mass_scaling,
            marks: Vec::new(),
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.id.len()
    }

    /// What particle `i` is made of.
    #[inline]
    pub(crate) fn data(&self, i: usize) -> &MaterialData {
        &self.materials[self.material[i] as usize]
    }

    /// Spacing of particle `i` over the particle spacing.
    #[inline]
    pub(crate) fn size(&self, i: usize) -> f64 {
        self.data(i).size
    }

    /// The sizes of all particles and the classes of their rows, or none where all are the same.
    pub(crate) fn sizes_and_classes(&self) -> (Vec<f64>, Vec<u8>) {
        let count = if self.row_classes > 1 { self.count() } else { 0 };
        (0..count).map(|i| (self.size(i), self.material[i] % self.row_classes)).unzip()
    }

    /// Mass of a particle in kg (kg/m).
    pub(crate) fn mass(&self, i: usize) -> f64 {
        self.data(i).density * self.volume[i]
    }

    /// Inertia of a particle in kg (kg/m).
    pub(crate) fn inertia(&self, i: usize) -> f64 {
        self.mass_scaling * self.mass(i)
    }

    /// Heats particle `i` by `heat` in J (J/m in 2D).
    pub(crate) fn heat(&mut self, i: usize, heat: f64) {
        let data = &self.materials[self.material[i] as usize];
        let point = &mut self.point[i];
        point.temperature = data.heated(point.temperature, heat, self.volume[i]);
    }

    /// A particle before anything happens to it.
    pub(crate) fn rest(&self, setup: &Setup, id: usize, seed: &Seed) -> Rest<D> {
        let hold = Hold::<D>::of(setup, &seed.position);
        let mut velocity: Vector<D> = reduced(&seed.velocity);
        let mut temperature = seed.temperature;
        if hold != FREE {
            let support = &self.holds[hold as usize];
            velocity = support.constrained(&velocity);
            temperature = support.temperature.unwrap_or(temperature);
        }
        let classes = usize::from(self.row_classes);
        let material = setup.bodies[seed.body as usize].material * classes + seed.class;
        Rest {
            id: id as u64,
            body: seed.body,
            material: u8::try_from(material).expect("fewer than 256 materials"),
            hold,
            position: reduced(&seed.position),
            velocity,
            volume: seed.volume,
            temperature,
        }
    }

    /// Appends a particle in its undeformed state.
    pub(crate) fn follow(&mut self, rest: &Rest<D>) {
        self.id.push(rest.id);
        self.body.push(rest.body);
        self.material.push(rest.material);
        self.hold.push(rest.hold);
        self.position.push(rest.position);
        self.origin.push(rest.position);
        self.motion.push(Motion::new(rest.position, rest.velocity));
        self.volume.push(rest.volume);
        self.point.push(MaterialPoint::at_rest(rest.temperature));
    }

    /// Gives every particle its place in the arrays that [`Particles::follow`] leaves; supports stretch up to
    /// `support_stretch`.
    pub(crate) fn resize(&mut self, support_stretch: f64) {
        let count = self.position.len();
        if support_stretch > 1.0 {
            self.shape.resize(count, identity());
        }
        if self.materials.iter().any(|data| data.memory.is_needed()) {
            self.history.resize(count, History::default());
        }
        self.force.resize(count, [0.0; D]);
    }

    /// Leaves the particles that do not stay.
    fn keep(&mut self, stays: &[bool]) {
        fn keep<T>(values: &mut Vec<T>, stays: &[bool]) {
            let mut next = stays.iter();
            values.retain(|_| next.next().copied().unwrap_or(true));
        }
        keep(&mut self.id, stays);
        keep(&mut self.body, stays);
        keep(&mut self.material, stays);
        keep(&mut self.hold, stays);
        keep(&mut self.position, stays);
        keep(&mut self.origin, stays);
        keep(&mut self.motion, stays);
        keep(&mut self.shape, stays);
        keep(&mut self.volume, stays);
        keep(&mut self.point, stays);
        keep(&mut self.history, stays);
        keep(&mut self.force, stays);
    }

    /// Stores the particles in `order`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        self.marks.resize(order.len(), false);
        let done = &mut self.marks;
        permute(&mut self.id, order, done);
        permute(&mut self.body, order, done);
        permute(&mut self.material, order, done);
        permute(&mut self.hold, order, done);
        permute(&mut self.position, order, done);
        permute(&mut self.origin, order, done);
        permute(&mut self.shape, order, done);
        permute(&mut self.history, order, done);
        permute(&mut self.motion, order, done);
        permute(&mut self.volume, order, done);
        permute(&mut self.point, order, done);
        permute(&mut self.force, order, done);
    }

    /// v += a dt, then x += v `drift`; supports prescribe their components of the velocity.
    pub(crate) fn kick_and_drift(&mut self, kick: f64, drift: f64) {
        let (materials, scaling, holds) = (&self.materials, self.mass_scaling, &self.holds);
        self.motion
            .par_chunks_mut(CHUNK)
            .zip(self.position.par_chunks_mut(CHUNK))
            .zip(self.force.par_chunks(CHUNK))
            .zip(self.material.par_chunks(CHUNK))
            .zip(self.hold.par_chunks(CHUNK))
            .zip(self.volume.par_chunks(CHUNK))
            .for_each(|(((((motion, position), force), material), hold), volume)| {
                for (k, motion) in motion.iter_mut().enumerate() {
                    let inertia = scaling * materials[material[k] as usize].density * volume[k];
                    let mut velocity = plus_scaled(motion.velocity(), kick / inertia, &force[k])
                        .map(|speed| if speed.abs() < STILL { 0.0 } else { speed });
                    if hold[k] != FREE {
                        velocity = holds[hold[k] as usize].constrained(&velocity);
                    }
                    motion.set_velocity(velocity);
                    if drift > 0.0 {
                        position[k] = plus_scaled(&position[k], drift, &velocity);
                    }
                }
            });
    }

    /// Particles that are held, with what holds them.
    fn held(&self) -> impl Iterator<Item = (usize, &Hold<D>)> {
        let held = self.hold.iter().enumerate().filter(|(_, hold)| **hold != FREE);
        held.map(|(i, hold)| (i, &self.holds[*hold as usize]))
    }

    /// Work and impulse of the supports' reactions over a kick.
    pub(crate) fn book_reactions(&self, kick: f64, ledger: &mut Ledger) {
        for (i, support) in self.held() {
            let reaction = support.reaction(&self.force[i]);
            ledger.support_work += kick * dot(&reaction, self.motion[i].velocity());
            for k in 0..D {
                ledger.reaction_impulse[k] += kick * reaction[k];
            }
        }
    }

    /// Resets the particles of fixed-temperature supports and books the heat that takes.
    pub(crate) fn hold_temperatures(&mut self, ledger: &mut Ledger) {
        if self.holds.iter().all(|support| support.temperature.is_none()) {
            return;
        }
        for i in 0..self.hold.len() {
            if self.hold[i] == FREE {
                continue;
            }
            let Some(fixed) = self.holds[self.hold[i] as usize].temperature else { continue };
            let now = self.point[i].temperature;
            ledger.heat_supplied += self.data(i).heat_between(now, fixed, self.volume[i]);
            self.point[i].temperature = fixed;
        }
    }

    /// Kinetic energy with the inertia as scaled.
    pub(crate) fn kinetic_energy(&self) -> f64 {
        let energy = |(i, motion): (usize, &Motion<D>)| {
            0.5 * self.inertia(i) * dot(motion.velocity(), motion.velocity())
        };
        self.motion.iter().enumerate().map(energy).sum()
    }

    /// Stored elastic energy of one particle.
    fn elastic_energy_of(&self, i: usize) -> f64 {
        self.volume[i] * self.point[i].elastic_energy(&self.data(i).elasticity)
    }

    /// Stored elastic energy.
    pub(crate) fn elastic_energy(&self) -> f64 {
        (0..self.point.len()).map(|i| self.elastic_energy_of(i)).sum()
    }

    /// Thermal energy above 0 K, less what an equation of state counts as stored energy.
    pub(crate) fn heat_content(&self) -> f64 {
        self.heat_of(0..self.point.len())
    }

    /// [`Particles::heat_content`] of some particles.
    pub(crate) fn heat_of(&self, particles: std::ops::Range<usize>) -> f64 {
        particles
            .map(|i| {
                let (data, point) = (self.data(i), &self.point[i]);
                let heat = match &data.heat_table {
                    None => self.mass(i) * data.specific_heat * point.temperature,
                    Some(table) => self.mass(i) * table.integral(point.temperature),
                };
                heat - self.volume[i] * data.isentrope_heat(point.volume_ratio)
            })
            .sum()
    }

    /// Adds the momentum of all to `sum`.
    pub(crate) fn add_momentum(&self, sum: &mut Vector<3>) {
        for i in 0..self.motion.len() {
            for k in 0..D {
                sum[k] += self.inertia(i) * self.motion[i].velocity()[k];
            }
        }
    }

    /// The half thickness of particle `i` along the normal of the tool that was near it, or else that of its lattice along
    /// `normal`.
    pub(crate) fn half_thickness(&self, i: usize, normal: &Vector<D>) -> f64 {
        let followed = self.point[i].half_thickness;
        let lattice = |i: usize| self.undisturbed(self.body[i], self.material[i], normal);
        if followed > 0.0 { followed } else { lattice(i) }
    }

    /// The half thickness along `normal` of the cell that a particle of a body and a material has in its lattice.
    pub(crate) fn undisturbed(&self, body: u32, material: u8, normal: &Vector<D>) -> f64 {
        let size = self.materials[material as usize].size;
        size * self.cells_of_bodies[body as usize].half_thickness(normal)
    }

    /// Memory of the arrays in bytes.
    pub(crate) fn memory(&self) -> usize {
        let each = size_of::<u64>()
            + size_of::<u32>()
            + 2
            + 5 * size_of::<Vector<D>>()
            + 2 * size_of::<f64>()
            + size_of::<MaterialPoint<D>>();
        self.id.len() * each
            + self.shape.len() * size_of::<Matrix<D>>()
            + self.history.len() * size_of::<History<D>>()
            + self.marks.capacity()
    }
}

/// Puts `values[order[k]]` at place k, cycle by cycle: a second copy of the particles would double the
/// memory at its peak. `done` is room for one mark per value. Nothing to do where there are no values.
fn permute<T: Copy>(values: &mut [T], order: &[u32], done: &mut [bool]) {
    done.fill(false);
    for first in 0..values.len() {
        if done[first] {
            continue;
        }
        let displaced = values[first];
        let mut place = first;
        loop {
            done[place] = true;
            let source = order[place] as usize;
            if source == first {
                break;
            }
            values[place] = values[source];
            place = source;
        }
        values[place] = displaced;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_put_in_order_in_place() {
        // A cycle of four, a pair that changes places and one that stays.
        let order = [2, 1, 5, 4, 3, 6, 0];
        let mut values = [10, 11, 12, 13, 14, 15, 16];
        permute(&mut values, &order, &mut [true; 7]);
        assert_eq!(values, [12, 11, 15, 14, 13, 16, 10]);
    }
}
