//! The prescribed motion of the tool: a velocity that is constant between given times.
//!
//! ```text
//! u(t) = u_k + v_k (t - t_k)   for t_k <= t < t_(k+1),   u_0 = 0, t_0 = 0
//! ```
//! The displacement is exact at every time. Where a velocity is asked for a step that a change
//! falls into, it is the mean over the step: way and work of the step are then those of the motion.

use crate::setup::Tool;
use glam::DVec3;

/// A piece of constant velocity.
#[derive(Debug, Clone, Copy)]
struct Leg {
    start: f64,
    displacement: DVec3,
    velocity: DVec3,
}

/// The motion of a tool.
#[derive(Debug, Clone)]
pub(crate) struct ToolMotion {
    /// In the order of time; the first begins at 0.
    legs: Vec<Leg>,
}

impl ToolMotion {
    pub(crate) fn of(tool: &Tool) -> Self {
        let mut legs =
            vec![Leg { start: 0.0, displacement: DVec3::ZERO, velocity: tool.velocity.into() }];
        for change in &tool.velocity_changes {
            let before = legs[legs.len() - 1];
            legs.push(Leg {
                start: change.time,
                displacement: before.at(change.time),
                velocity: change.velocity.into(),
            });
        }
        Self { legs }
    }

    fn leg(&self, time: f64) -> usize {
        self.legs.iter().rposition(|leg| leg.start <= time).unwrap_or(0)
    }

    /// Displacement at `time`.
    pub(crate) fn displacement(&self, time: f64) -> DVec3 {
        self.legs[self.leg(time)].at(time)
    }

    /// The speeds in the order of time.
    pub(crate) fn speeds(&self) -> Vec<f64> {
        self.legs.iter().map(|leg| speed(leg.velocity)).collect()
    }

    /// Speed at `time`.
    pub(crate) fn speed(&self, time: f64) -> f64 {
        speed(self.legs[self.leg(time)].velocity)
    }

    /// Way from `start` to `end`.
    pub(crate) fn way(&self, start: f64, end: f64) -> DVec3 {
        let (first, last) = (self.leg(start), self.leg(end));
        if first == last {
            return self.legs[first].velocity * (end - start);
        }
        self.displacement(end) - self.displacement(start)
    }

    /// Mean velocity of the step of length `time_step` that begins at `start`.
    pub(crate) fn mean_velocity(&self, start: f64, time_step: f64) -> DVec3 {
        let (first, last) = (self.leg(start), self.leg(start + time_step));
        if first == last {
            return self.legs[first].velocity;
        }
        self.way(start, start + time_step) / time_step
    }
}

fn speed(velocity: DVec3) -> f64 {
    velocity.x.hypot(velocity.y).hypot(velocity.z)
}

impl Leg {
    fn at(&self, time: f64) -> DVec3 {
        self.displacement + self.velocity * (time - self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to_and_fro() -> ToolMotion {
        let leg = |start, displacement, velocity| Leg {
            start,
            displacement: DVec3::new(displacement, 0.0, 0.0),
            velocity: DVec3::new(velocity, 0.0, 0.0),
        };
        // 2 m/s for 3 s, back with 1 m/s for 2 s, then rest.
        ToolMotion { legs: vec![leg(0.0, 0.0, 2.0), leg(3.0, 6.0, -1.0), leg(5.0, 4.0, 0.0)] }
    }

    #[test]
    fn the_displacement_follows_the_legs() {
        let motion = to_and_fro();
        for (time, expected) in [(0.0, 0.0), (1.5, 3.0), (3.0, 6.0), (4.5, 4.5), (9.0, 4.0)] {
            assert_eq!(motion.displacement(time)[0], expected, "at {time} s");
        }
    }

    #[test]
    fn a_step_across_a_change_has_its_mean_velocity() {
        let motion = to_and_fro();
        assert_eq!(motion.mean_velocity(1.0, 0.5)[0], 2.0);
        // Half a second each: (1 - 0.5) m / 1 s.
        assert_eq!(motion.mean_velocity(2.5, 1.0)[0], 0.5);
        assert_eq!(motion.way(2.0, 6.0)[0], 0.0);
        assert_eq!(motion.mean_velocity(6.0, 1.0)[0], 0.0);
    }
}
