//! The state of a tool as named arrays, its picture, and who follows whom when particles change their order.

use crate::heated_tool::{Exposure, HeatedTool};
use glam::DVec3;

/// Names of the arrays of a checkpoint.
const TEMPERATURE: &str = "tool_temperature";
const LEDGER: &str = "tool_heat_books";
const EXPOSURES: &str = "tool_exposures";

impl HeatedTool {
    /// Follows a reordering of the particles: `new_place[old]`.
    pub fn reorder(&mut self, new_place: &[u32]) {
        for (particle, _) in &mut self.exposures {
            *particle = new_place[*particle as usize];
        }
        self.exposures.sort_unstable_by_key(|(particle, _)| *particle);
    }

    /// Particles that rub on the tool or touched it since its last step.
    pub fn exposed(&self) -> impl Iterator<Item = u32> + '_ {
        self.exposures.iter().map(|(particle, _)| *particle)
    }

    /// Named arrays with the whole state.
    pub fn checkpoint(&self) -> [(&'static str, Vec<f64>); 3] {
        let ledger = &self.ledger;
        let axes = self.body.place_axes();
        let exposures = self.exposures.iter().flat_map(|(particle, exposure)| {
            // Exact: fewer than 2^53 particles.
            [f64::from(*particle), exposure.duration, exposure.coverage]
                .into_iter()
                .chain(exposure.place.to_array().into_iter().take(axes))
                .chain(exposure.drift.to_array().into_iter().take(axes))
                .chain([exposure.friction])
        });
        [
            (TEMPERATURE, self.temperature.clone()),
            (LEDGER, vec![ledger.contact, ledger.friction, ledger.boundary, self.pending]),
            (EXPOSURES, exposures.collect()),
        ]
    }

    /// Takes the state of [`HeatedTool::checkpoint`]; `read` gives an array by name, `particles` is
    /// their number.
    ///
    /// # Errors
    /// The name of an array that is missing or does not fit.
    pub fn restore<'a>(
        &mut self,
        read: impl Fn(&str) -> Option<&'a [f64]>,
        particles: usize,
    ) -> Result<(), &'static str> {
        let temperature = read(TEMPERATURE).filter(|values| values.len() == self.temperature.len());
        self.temperature = temperature.ok_or(TEMPERATURE)?.to_vec();
        let ledger = read(LEDGER).filter(|values| values.len() == 4);
        let ledger = ledger.ok_or(LEDGER)?;
        self.ledger.contact = ledger[0];
        self.ledger.friction = ledger[1];
        self.ledger.boundary = ledger[2];
        self.pending = ledger[3];
        let axes = self.body.place_axes();
        let rows = read(EXPOSURES).ok_or(EXPOSURES)?.chunks(4 + 2 * axes);
        let is_whole =
            |row: &[f64]| row.len() == 4 + 2 * axes && row[0] >= 0.0 && row[0] < particles as f64;
        if !rows.clone().all(is_whole) {
            return Err(EXPOSURES);
        }
        let vector = |row: &[f64], from: usize| {
            DVec3::from_array(std::array::from_fn(|k| if k < axes { row[from + k] } else { 0.0 }))
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
    pub fn picture(&self, displacement: DVec3) -> (Vec<[f64; 3]>, Vec<u32>, Vec<f64>) {
        let (nodes, triangles) = self.body.picture(displacement);
        (nodes, triangles, self.temperature.clone())
    }
}
