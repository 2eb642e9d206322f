//! What moves the tool off its prescribed path: compliance of the holder, run-out of the spindle.
//!
//! The holder is stepped with the particles, kick-drift-kick: for each direction
//! ```text
//! w_(n+1/2) = w_n + dt/2 a(u_n, w_n, F_n)
//! u_(n+1)   = u_n + dt w_(n+1/2)
//! w_(n+1)   = w_(n+1/2) + dt/2 a(u_(n+1), w_(n+1/2), F_(n+1))
//! ```
//! with F the contact force on the tool, times the width of cut in the plane. The velocity of the tool over
//! the step is that of its path plus `w_(n+1/2)`, so that its work is exact. The displacement by
//! run-out is that of the formula at every time; the velocity over a step is the mean of it.
//!
//! An explicit step: stable while it is shorter than the shortest swing of holder and contact together,
//! `2 sqrt(m / (k + k_contact))`, which is far longer than the step of the particles, because a holder
//! is far heavier than one of them.

use crate::setup::Setup;
use glam::DVec3;
use sphcut_physics::process::{Oscillator, RunOut};

/// One direction in which the tool gives way.
#[derive(Debug, Clone, Copy)]
struct Axis {
    oscillator: Oscillator,
    direction: DVec3,
    deflection: f64,
    velocity: f64,
    /// Deflection at the last reference update.
    reference: f64,
}

/// Holder and spindle of a tool.
#[derive(Debug, Clone, Default)]
pub(crate) struct ToolHolder {
    axes: Vec<Axis>,
    run_out: Option<(RunOut, DVec3)>,
    /// From the force of the solver to that on the holder: the width of cut in the plane.
    width: f64,
}

impl ToolHolder {
    pub(crate) fn of(setup: &Setup) -> Self {
        let machine = &setup.machine;
        let axis = |oscillator: Option<Oscillator>, direction: [f64; 3]| {
            oscillator.map(|oscillator| Axis {
                oscillator,
                direction: direction.into(),
                deflection: 0.0,
                velocity: 0.0,
                reference: 0.0,
            })
        };
        let plane = setup.dimension == crate::setup::Dimension::Two;
        Self {
            axes: [
                axis(machine.cutting, setup.frame.cutting),
                axis(machine.feed, setup.frame.feed),
            ]
            .into_iter()
            .flatten()
            .collect(),
            run_out: machine.run_out.map(|run_out| (run_out, setup.frame.feed.into())),
            width: if plane { setup.width_of_cut } else { 1.0 },
        }
    }

    /// Whether the tool can leave its path.
    pub(crate) fn acts(&self) -> bool {
        !self.axes.is_empty() || self.run_out.is_some()
    }

    /// Displacement from the prescribed path at `time`, with the present deflection.
    pub(crate) fn displacement(&self, time: f64) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for axis in &self.axes {
            sum += axis.deflection * axis.direction;
        }
        if let Some((run_out, direction)) = self.run_out {
            sum += run_out.displacement(time) * direction;
        }
        sum
    }

    /// Way off the path from the last reference update at `start` to `end`, which is now.
    pub(crate) fn way(&self, start: f64, end: f64) -> DVec3 {
        let mut before = self.clone();
        for axis in &mut before.axes {
            axis.deflection = axis.reference;
        }
        self.displacement(end) - before.displacement(start)
    }

    /// Mean velocity off the path over the step of length `time_step` that begins at `time`.
    pub(crate) fn velocity(&self, time: f64, time_step: f64) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for axis in &self.axes {
            sum += axis.velocity * axis.direction;
        }
        if let Some((run_out, direction)) = self.run_out
            && time_step > 0.0
        {
            let way = run_out.displacement(time + time_step) - run_out.displacement(time);
            sum += way / time_step * direction;
        }
        sum
    }

    /// First half of a kick, and the drift. `force`: of the tool on the particles.
    pub(crate) fn begin_step(&mut self, force: DVec3, time_step: f64) {
        self.kick(force, 0.5 * time_step);
        for axis in &mut self.axes {
            axis.deflection += time_step * axis.velocity;
        }
    }

    /// Second half of the kick.
    pub(crate) fn end_step(&mut self, force: DVec3, time_step: f64) {
        self.kick(force, 0.5 * time_step);
    }

    fn kick(&mut self, force: DVec3, duration: f64) {
        for axis in &mut self.axes {
            // The tool feels the opposite of what the particles feel.
            let load = -self.width * force.dot(axis.direction);
            axis.velocity +=
                duration * axis.oscillator.acceleration(axis.deflection, axis.velocity, load);
        }
    }

    /// The present deflection becomes that of the reference.
    pub(crate) fn update_reference(&mut self) {
        for axis in &mut self.axes {
            axis.reference = axis.deflection;
        }
    }

    /// All numbers, for the checkpoint; empty without compliance.
    pub(crate) fn to_vec(&self) -> Vec<f64> {
        self.axes.iter().flat_map(|a| [a.deflection, a.velocity, a.reference]).collect()
    }

    /// How many numbers that is.
    pub(crate) fn size(&self) -> usize {
        3 * self.axes.len()
    }

    /// The deflection of the last reference update, from the numbers of a checkpoint.
    pub(crate) fn set_reference(&mut self, values: &[f64]) {
        for (axis, stored) in self.axes.iter_mut().zip(values.chunks_exact(3)) {
            axis.deflection = stored[2];
        }
    }

    /// The state of a checkpoint.
    pub(crate) fn set(&mut self, values: &[f64]) {
        for (axis, stored) in self.axes.iter_mut().zip(values.chunks_exact(3)) {
            [axis.deflection, axis.velocity, axis.reference] = [stored[0], stored[1], stored[2]];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::Dimension;

    fn holder(damping_ratio: f64) -> ToolHolder {
        let mut setup = Setup::empty(Dimension::Two, 1e-5, 1.0);
        setup.width_of_cut = 2e-3;
        setup.machine.feed = Some(Oscillator { stiffness: 20e6, mass: 2.0, damping_ratio });
        ToolHolder::of(&setup)
    }

    /// Deflection along the feed direction after each step under `force` (N/m, of the tool on the work
    /// along y).
    fn swing(mut holder: ToolHolder, force: f64, step: f64, count: usize) -> Vec<f64> {
        (0..count)
            .map(|_| {
                holder.begin_step(DVec3::new(0.0, force, 0.0), step);
                holder.end_step(DVec3::new(0.0, force, 0.0), step);
                holder.axes[0].deflection
            })
            .collect()
    }

    #[test]
    fn a_known_force_leaves_its_static_deflection_and_swings_at_the_natural_frequency() {
        // The feed direction is -y. 200 kN/m on the work along -y, on 2 mm: 400 N push the tool out of it;
        // 400 N / 20 N/um = 20 um. Period 1 / 503.29 Hz = 1.98692 ms.
        let period = 1.0 / 503.2921;
        let free = swing(holder(0.0), -200e3, period / 1000.0, 1000);
        // u = -(F/k)(1 - cos w t): twice the static deflection after half a period, back after a whole one.
        assert!((free[499] + 40e-6).abs() < 1e-9, "{}", free[499]);
        assert!(free[999].abs() < 1e-9, "{}", free[999]);
        // Error of leap-frog (w dt)^2 / 24 in the phase: 1e-6.
        let damped = swing(holder(0.5), -200e3, period / 1000.0, 20_000);
        assert!((damped[19_999] + 20e-6).abs() < 1e-12);
    }

    #[test]
    fn run_out_is_exact_at_every_time_and_its_mean_velocity_too() {
        let mut setup = Setup::empty(Dimension::Two, 1e-5, 1.0);
        let run_out = RunOut { amplitude: 3e-6, angular_frequency: 1e4 };
        setup.machine.run_out = Some(run_out);
        let holder = ToolHolder::of(&setup);
        let (mut place, mut time) = (0.0, 0.0);
        for step in [1e-5, 3e-5, 2e-5, 7e-6] {
            place += step * holder.velocity(time, step)[1];
            time += step;
            // Into the surface is -y.
            assert!((place + run_out.displacement(time)).abs() < 1e-18);
            assert!((holder.displacement(time)[1] - place).abs() < 1e-18);
        }
        assert!(holder.acts() && !ToolHolder::of(&Setup::empty(Dimension::Two, 1e-5, 1.0)).acts());
    }
}
