//! The tool's heat in the time loop: who touches, when a step is due, what a checkpoint holds.

use super::{Exposure, Partner, ToolHeat};
use crate::engine::Engine;
use crate::error::SetupError;
use crate::setup::Vector as Vector3;
use crate::tensor::Vector;

/// Names of the arrays of a checkpoint.
const TEMPERATURE: &str = "tool_temperature";
const BOOKS: &str = "tool_heat_books";
const EXPOSURES: &str = "tool_exposures";

impl<const D: usize> Engine<D> {
    /// Particles at rest on the tool, for a run without mechanics.
    pub(crate) fn rest_on_tool(&mut self, duration: f64) {
        let (Some(tool), Some(heat)) = (&self.tool, &mut self.tool_heat) else { return };
        for particle in tool.resting(&self.position, self.time) {
            let position = &self.position[particle as usize];
            heat.touch(particle, &in_tool(position, &tool.displacement(self.time)), duration, 0.0);
        }
    }

    /// Lets the tool conduct and exchange heat once its own step is over.
    pub(crate) fn heat_tool_when_due(&mut self, elapsed: f64) {
        let Some(mut heat) = self.tool_heat.take() else { return };
        let speed = self.tool.as_ref().map_or(0.0, |tool| tool.path_speed(self.time));
        if heat.is_due_after(elapsed, speed) {
            let leaving = heat.step(|particle| {
                let i = particle as usize;
                let data = &self.materials[self.material[i] as usize];
                let temperature = self.point[i].temperature;
                let table = data.conductivity_table.as_ref();
                Partner {
                    temperature,
                    capacity: self.mass(i) * data.specific_heat_at(temperature),
                    conductivity: table.map_or(data.conductivity, |table| table.value(temperature)),
                }
            });
            for &(particle, amount) in leaving {
                let i = particle as usize;
                let data = &self.materials[self.material[i] as usize];
                self.point[i].temperature =
                    data.heated(self.point[i].temperature, -amount, self.volume[i]);
                self.account.heat_supplied -= amount;
            }
        }
        self.tool_heat = Some(heat);
    }
}

/// A particle's place in the frame of the tool.
pub(crate) fn in_tool<const D: usize>(position: &Vector<D>, displacement: &Vector3) -> Vector3 {
    std::array::from_fn(|k| if k < D { position[k] - displacement[k] } else { 0.0 })
}

impl ToolHeat {
    /// Follows a reordering of the particles: `new_place[old]`.
    pub(crate) fn reorder(&mut self, new_place: &[u32]) {
        for (particle, _) in &mut self.exposures {
            *particle = new_place[*particle as usize];
        }
        self.exposures.sort_unstable_by_key(|(particle, _)| *particle);
    }

    /// Particles that rub on the tool or touched it since its last step.
    pub(crate) fn exposed(&self) -> impl Iterator<Item = u32> + '_ {
        self.exposures.iter().map(|(particle, _)| *particle)
    }

    /// Named arrays with the whole state.
    pub(crate) fn checkpoint(&self) -> [(&'static str, Vec<f64>); 3] {
        let books = &self.books;
        let axes = self.body.place_axes();
        let exposures = self.exposures.iter().flat_map(|(particle, exposure)| {
            // Exact: fewer than 2^53 particles.
            [f64::from(*particle), exposure.duration, exposure.coverage]
                .into_iter()
                .chain(exposure.place[..axes].to_vec())
                .chain(exposure.drift[..axes].to_vec())
                .chain([exposure.friction])
        });
        [
            (TEMPERATURE, self.temperature.clone()),
            (BOOKS, vec![books.contact, books.friction, books.boundary, self.pending]),
            (EXPOSURES, exposures.collect()),
        ]
    }

    /// Takes the state of [`ToolHeat::checkpoint`]; `read` gives an array by name, `particles` is
    /// their number.
    ///
    /// # Errors
    /// An array that is missing or does not fit.
    pub(crate) fn restore<'a>(
        &mut self,
        read: impl Fn(&str) -> Option<&'a [f64]>,
        particles: usize,
    ) -> Result<(), SetupError> {
        let damaged = |name: &str| SetupError::Checkpoint {
            reason: format!("`{name}` is missing or does not fit the tool"),
        };
        let temperature = read(TEMPERATURE).filter(|values| values.len() == self.temperature.len());
        self.temperature = temperature.ok_or_else(|| damaged(TEMPERATURE))?.to_vec();
        let books = read(BOOKS).filter(|values| values.len() == 4);
        let books = books.ok_or_else(|| damaged(BOOKS))?;
        self.books.contact = books[0];
        self.books.friction = books[1];
        self.books.boundary = books[2];
        self.pending = books[3];
        let axes = self.body.place_axes();
        let rows = read(EXPOSURES).ok_or_else(|| damaged(EXPOSURES))?.chunks(4 + 2 * axes);
        let is_whole =
            |row: &[f64]| row.len() == 4 + 2 * axes && row[0] >= 0.0 && row[0] < particles as f64;
        if !rows.clone().all(is_whole) {
            return Err(damaged(EXPOSURES));
        }
        let vector = |row: &[f64], from: usize| {
            std::array::from_fn(|k| if k < axes { row[from + k] } else { 0.0 })
        };
        let exposure = |row: &[f64]| Exposure {
            duration: row[1],
            coverage: row[2],
            place: vector(row, 3),
            drift: vector(row, 3 + axes),
            friction: row[3 + 2 * axes],
        };
        self.exposures = rows.map(|row| (row[0] as u32, exposure(row))).collect();
        self.exposures.sort_unstable_by_key(|(particle, _)| *particle);
        Ok(())
    }

    /// Nodes moved by `displacement`, triangles and temperatures of the nodes, for a snapshot: in space the
    /// triangles are those of the surface.
    pub(crate) fn picture(&self, displacement: Vector3) -> (Vec<Vector3>, Vec<u32>, Vec<f64>) {
        let (nodes, triangles) = self.body.picture(displacement);
        (nodes, triangles, self.temperature.clone())
    }
}
