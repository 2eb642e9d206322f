//! Friction of a contact: that of all its touches at once.
//!
//! A touch sticks where the friction that stops the slip of its surface point over the coming step is below the law's
//! limit, and slides at the limit against the slip elsewhere. Surface points move with common particles
//! ([`crate::contact::surface_point`]), so the friction of one moves the others:
//! ```text
//! v_a = v_a0 + dt sum_b W_ab f_b,   W_ab = sum_j p_aj p_bj / m_j,   |f_a| <= limit_a,   v_a = 0 where |f_a| < limit_a
//! ```
//! (p_aj: part of particle j in surface point a; v_a0: slip after the step without friction). W is
//! symmetric and positive, so the projected Gauss-Seidel method converges (Jourdan, Alart and Jean, Comput. Methods
//! Appl. Mech. Eng. 155 (1998) 31-47: the method of contact dynamics), and friction gives no energy back. A point that
//! sticks moves within the material from step to step, which gives back a millionth (`validation/tilted_plane`).
//!
//! **Limits.** Normal forces are those of the penalty and do not follow friction within a step. The inertia of
//! particles that a support holds is their own.

use crate::contact::surface::make_room;
use crate::contact::surface_point::SurfacePoints;
use crate::contact::touch::Touch;
use crate::particles::Particles;
use crate::tensor::{Vector, dot, minus, plus_scaled};

/// Ends the search: largest change of a friction force in terms of the largest one.
const SETTLED: f64 = 1e-9;
/// Sweeps over the touches at most.
const MOST_SWEEPS: usize = 100;

/// Finds friction forces; kept from step to step for its room.
#[derive(Debug, Default)]
pub(crate) struct ContactFriction<const D: usize> {
    /// Of each part of each surface point: velocity that a unit force on the point gives its particle over the step.
    yields: Vec<f64>,
    /// Mobility W_aa of each surface point in 1/kg (m/kg).
    mobilities: Vec<f64>,
    /// Velocity of the particles after the coming step in m/s; only where they have a part.
    velocity: Vec<Vector<D>>,
}

impl<const D: usize> ContactFriction<D> {
    /// Room for `touches` of `particles` that have so many `neighbours` at most.
    pub(crate) fn make_room(&mut self, particles: usize, touches: usize, neighbours: usize) {
        self.velocity.resize(particles, [0.0; D]);
        make_room(&mut self.yields, touches.next_power_of_two() * (neighbours + 1));
        make_room(&mut self.mobilities, touches);
    }

    /// Sets the friction of `touches` with these surface `points`, which is none as yet, within their `limits` in
    /// N (N/m in 2D).
    pub(crate) fn find(
        &mut self,
        touches: &mut [Touch<D>],
        points: &SurfacePoints<D>,
        limits: &[f64],
        tool_velocity: &Vector<D>,
        time_step: f64,
        particles: &Particles<D>,
    ) {
        self.lay(touches, points, time_step, particles);
        for _ in 0..MOST_SWEEPS {
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for (place, (touch, limit)) in touches.iter_mut().zip(limits).enumerate() {
                let slip = self.slip(&points.parts()[points.range(place)], touch, tool_velocity);
                let friction =
                    self.stick_or_slide(place, &touch.friction_force, &slip, *limit, time_step);
                let moved = minus(&friction, &touch.friction_force);
                self.push(place, points, &moved);
                touch.friction_force = friction;
                change = change.max(size(&moved));
                largest = largest.max(size(&friction));
            }
            if change <= SETTLED * largest {
                break;
            }
        }
    }

    /// Lays out what forces on the surface points do, and the velocities without friction.
    fn lay(
        &mut self,
        touches: &[Touch<D>],
        points: &SurfacePoints<D>,
        time_step: f64,
        particles: &Particles<D>,
    ) {
        self.yields.clear();
        self.mobilities.clear();
        for place in 0..touches.len() {
            let parts = &points.parts()[points.range(place)];
            let mobility = parts.iter().map(|(j, p)| p * p / particles.inertia(*j as usize)).sum();
            self.mobilities.push(mobility);
        }
        for &(j, part) in points.parts() {
            let j = j as usize;
            let inertia = particles.inertia(j);
            self.yields.push(part * time_step / inertia);
            self.velocity[j] = plus_scaled(
                particles.motion[j].velocity(),
                time_step / inertia,
                &particles.force[j],
            );
        }
        for (place, touch) in touches.iter().enumerate() {
            self.push(place, points, &touch.normal_force);
        }
    }

    /// Adds what `force` on a surface point does over the step.
    fn push(&mut self, place: usize, points: &SurfacePoints<D>, force: &Vector<D>) {
        let range = points.range(place);
        for ((j, _), share) in points.parts()[range.clone()].iter().zip(&self.yields[range]) {
            let velocity = &mut self.velocity[*j as usize];
            *velocity = plus_scaled(velocity, *share, force);
        }
    }

    /// Slip of the surface point of these `parts` after the step in m/s.
    fn slip(&self, parts: &[(u32, f64)], touch: &Touch<D>, tool_velocity: &Vector<D>) -> Vector<D> {
        let slip = parts.iter().fold(tool_velocity.map(|v| -v), |sum, (j, part)| {
            plus_scaled(&sum, *part, &self.velocity[*j as usize])
        });
        let normal = touch.normal();
        plus_scaled(&slip, -dot(&slip, &normal), &normal)
    }

    /// The friction that stops a touch whose friction is `now`, or its limit.
    fn stick_or_slide(
        &self,
        place: usize,
        now: &Vector<D>,
        slip: &Vector<D>,
        limit: f64,
        time_step: f64,
    ) -> Vector<D> {
        let mobility = self.mobilities[place];
        let sought = plus_scaled(now, -1.0 / (mobility * time_step), slip);
        let needed = size(&sought);
        if needed > limit { sought.map(|f| f / needed * limit) } else { sought }
    }
}

fn size<const D: usize>(x: &Vector<D>) -> f64 {
    dot(x, x).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface_point::tests::{around, block};
    use crate::engine::Engine;
    use crate::setup::{Dimension, Lattice};

    const TIME_STEP: f64 = 1e-6;

    /// A block whose particles move at random, and touches of its upper rows without normal force.
    fn touched() -> (Engine<2>, Vec<Touch<2>>) {
        let mut engine =
            Engine::<2>::new(&block(Dimension::Two, Lattice::Disordered, 1.0)).unwrap();
        for i in 0..engine.particles.motion.len() {
            let [x, y] = engine.particles.position[i];
            engine.particles.motion[i]
                .set_velocity([(9.0 * x).sin() + 0.3 * (40.0 * y).cos(), 0.1 * x]);
        }
        let touch = |i: usize| Touch {
            particle: i as u32,
            normal_force: [0.0; 2],
            friction_force: [0.0; 2],
            friction_use: 1.0,
            lever: [0.0, -0.05],
            area: 0.1,
            pressure: 0.0,
            shear_friction_factor: 0.0,
        };
        let upper = (0..engine.particles.position.len())
            .filter(|&i| engine.particles.position[i][1] > 1.45);
        let touches: Vec<Touch<2>> = upper.map(touch).collect();
        assert!(touches.len() > 15);
        (engine, touches)
    }

    /// Slip of every touch after the step, from the forces found.
    fn slips(engine: &Engine<2>, touches: &[Touch<2>], tool: f64) -> Vec<f64> {
        let mut moved: Vec<Vector<2>> = (0..engine.particles.motion.len())
            .map(|j| {
                let share = TIME_STEP / engine.particles.inertia(j);
                plus_scaled(
                    engine.particles.motion[j].velocity(),
                    share,
                    &engine.particles.force[j],
                )
            })
            .collect();
        for touch in touches {
            let i = touch.particle as usize;
            let mut own = 1.0;
            let mut add = |j: usize, part: f64| {
                let share = part * TIME_STEP / engine.particles.inertia(j);
                moved[j] = plus_scaled(&moved[j], share, &touch.friction_force);
            };
            let around = around(engine);
            for (j, part) in around.parts(i, &touch.lever, &around.inverse_moment(i)) {
                own += part;
                add(j, -part);
            }
            add(i, own);
        }
        let slip = |touch: &Touch<2>| {
            let i = touch.particle as usize;
            let (around, here) = (around(engine), moved[i][0]);
            let parts = around.parts(i, &touch.lever, &around.inverse_moment(i));
            parts.fold(here - tool, |sum, (j, part)| sum - part * (moved[j][0] - here))
        };
        touches.iter().map(slip).collect()
    }

    #[test]
    fn all_points_stick_at_once_where_nothing_limits_them() {
        let (engine, mut touches) = touched();
        let mut friction = ContactFriction::default();
        friction.make_room(engine.particles.motion.len(), touches.len(), 40);
        let mut points = SurfacePoints::default();
        points.lay(&touches, &around(&engine));
        let limits = vec![f64::INFINITY; touches.len()];
        let largest =
            |slips: Vec<f64>| slips.iter().fold(0.0_f64, |most, slip| most.max(slip.abs()));
        let before = largest(slips(&engine, &touches, 0.2));
        friction.find(&mut touches, &points, &limits, &[0.2, 0.0], TIME_STEP, &engine.particles);
        let after = largest(slips(&engine, &touches, 0.2));
        assert!(before > 0.5 && after < 1e-7 * before, "{before} {after}");
    }

    #[test]
    fn points_slide_at_their_limit_against_the_slip() {
        let (engine, mut touches) = touched();
        let mut friction = ContactFriction::default();
        friction.make_room(engine.particles.motion.len(), touches.len(), 40);
        let mut points = SurfacePoints::default();
        points.lay(&touches, &around(&engine));
        let free = slips(&engine, &touches, 0.2);
        // Half of what stops the fastest by itself: some slide, some stick.
        let limits = vec![0.2 * engine.particles.inertia(0) / TIME_STEP; touches.len()];
        friction.find(&mut touches, &points, &limits, &[0.2, 0.0], TIME_STEP, &engine.particles);
        let slips = slips(&engine, &touches, 0.2);
        let (mut sliding, mut sticking) = (0, 0);
        for ((touch, limit), (slip, free)) in touches.iter().zip(limits).zip(slips.iter().zip(free))
        {
            let force = touch.friction_force[0];
            assert!(force.abs() <= limit * (1.0 + 1e-12) && touch.friction_force[1].abs() < 1e-12);
            if force.abs() < limit * (1.0 - 1e-9) {
                sticking += 1;
                assert!(slip.abs() < 1e-6, "{slip}");
            } else {
                sliding += 1;
                assert!(force * slip <= 1e-9 * limit, "{force} {slip} {free}");
            }
        }
        assert!(sliding > 3 && sticking > 3, "{sliding} {sticking}");
    }
}
