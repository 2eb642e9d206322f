//! The tool's heat in the time loop: who touches, and when a step is due.

use crate::engine::Engine;
use crate::setup::Vector as Vector3;
use crate::tensor::Vector;
use sphcut_tool_heat::ContactPartner;

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
                ContactPartner {
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
