//! What passes between particles and tool in the time loop: work, friction, heat.

use crate::engine::Engine;
use crate::tensor::{Vector, dot, extended, minus, reduced};
use glam::DVec3;
use sphcut_tool_heat::ContactPartner;

impl<const D: usize> Engine<D> {
    /// Impulse, tool work and friction of the present contacts over half a step, with the
    /// velocities of the middle of the step; friction heats the particle at once.
    ///
    /// Tool work = work on particles + friction + contact energy, exactly.
    pub(super) fn book_contact(&mut self, duration: f64) {
        let Self { tool, tool_heat, particles, ledger, clock, friction_heat_share, .. } = self;
        let Some(tool) = tool else { return };
        let tool_velocity: Vector<D> = reduced(tool.velocity.as_ref());
        for (place, touch) in tool.touches.iter().enumerate() {
            let i = touch.particle as usize;
            let moving = tool.points.velocity(place, &particles.motion);
            let slip = minus(&tool_velocity, &moving);
            let friction = duration * dot(&touch.friction_force, &slip);
            ledger.friction += friction;
            ledger.contact += duration * dot(&touch.normal_force, &slip);
            for k in 0..D {
                let impulse = duration * (touch.normal_force[k] + touch.friction_force[k]);
                ledger.tool_impulse[k] += impulse;
                ledger.tool_work += impulse * tool_velocity[k];
            }
            let mut rubbed = 0.0;
            if let Some(share) = friction_heat_share {
                let heat = *share * friction;
                particles.heat(i, heat);
                ledger.heat_supplied += heat;
                rubbed = friction - heat;
            }
            if let Some(heat) = tool_heat {
                let place = in_tool(&particles.position[i], tool.displacement(clock.time));
                heat.touch_on(touch.area, touch.particle, place, duration, rubbed);
            }
        }
    }

    /// Particles at rest on the tool, for a run without mechanics.
    pub(super) fn rest_on_tool(&mut self, duration: f64) {
        let (Some(tool), Some(heat)) = (&self.tool, &mut self.tool_heat) else { return };
        for particle in tool.resting(&self.particles, self.clock.time) {
            let position = &self.particles.position[particle as usize];
            let place = in_tool(position, tool.displacement(self.clock.time));
            heat.touch(particle, place, duration, 0.0);
        }
    }

    /// Lets the tool conduct and exchange heat once its own step is over.
    pub(super) fn heat_tool_when_due(&mut self, elapsed: f64) {
        let Self { tool, tool_heat: Some(heat), particles, ledger, clock, .. } = self else {
            return;
        };
        let speed = tool.as_ref().map_or(0.0, |tool| tool.path_speed(clock.time));
        if !heat.is_due_after(elapsed, speed) {
            return;
        }
        let leaving = heat.step(|particle| {
            let i = particle as usize;
            let (data, temperature) = (particles.data(i), particles.point[i].temperature);
            ContactPartner {
                temperature,
                capacity: particles.mass(i) * data.specific_heat_at(temperature),
                conductivity: data.conductivity_at(temperature),
            }
        });
        for &(particle, amount) in leaving {
            particles.heat(particle as usize, -amount);
            ledger.heat_supplied -= amount;
        }
    }
}

/// A particle's place in the frame of the tool.
fn in_tool<const D: usize>(position: &Vector<D>, displacement: DVec3) -> DVec3 {
    extended(&minus(position, &reduced(displacement.as_ref()))).into()
}
