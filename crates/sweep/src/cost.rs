//! What runs will cost.

use sphcut_scenario::Scenario;
use sphcut_sph::setup::Dimension;
use sphcut_sph::{Diverged, Estimate, Setup, Simulation};
use std::time::{Duration, Instant};

/// Most steps over those that the first step predicts. Particles that crowd in a chip shorten the step: 1.1 to 2.2 times as many in cuts measured
/// without shifting (version 3). With it (`shifting_distance`) they are 1.00 to 1.02 times in 42 plane cuts of Ti6Al4V and AISI 1045; cuts in
/// space were not measured.
fn most_steps(setup: &Setup) -> f64 {
    let is_shifted = setup.numerics.get("shifting_distance") > 0.0;
    match (setup.uncut_chip_thickness, setup.dimension) {
        (None, _) => 1.0,
        (Some(_), Dimension::Two) if is_shifted => 1.1,
        _ => 2.2,
    }
}

/// Steps that are not counted: the first ones warm caches and threads up.
const WARM_UP: u32 = 3;

/// What a run will take, from its first step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Particles.
    pub particles: usize,
    /// Steps if none were shorter than the first.
    pub steps: u64,
    /// Least steps over these: a run may end as soon as its forces are steady.
    pub fewer_steps: f64,
    /// Most steps over these.
    pub more_steps: f64,
    /// Memory of the solver's arrays in bytes.
    pub memory_bytes: u64,
}

impl Cost {
    /// Of a run of `scenario` with the first step `estimate`.
    #[must_use]
    pub fn new(scenario: &Scenario, estimate: &Estimate) -> Self {
        let stop = &scenario.stop;
        Self {
            fewer_steps: stop.steady.map_or(1.0, |steady| steady.minimum_travel / stop.travel),
            particles: estimate.particles,
            steps: estimate.steps,
            more_steps: most_steps(&scenario.setup),
            memory_bytes: estimate.memory_bytes,
        }
    }

    /// Steps times particles, if it goes to its last travel and no step is shorter than the first.
    #[must_use]
    pub fn updates(&self) -> f64 {
        self.steps as f64 * self.particles as f64
    }

    /// Seconds of one thread that makes `speed` updates per second: least and most.
    #[must_use]
    pub fn seconds(&self, speed: f64) -> [f64; 2] {
        [self.fewer_steps, self.more_steps].map(|share| share * self.updates() / speed)
    }
}

/// Particle updates per second in the first steps of `simulation`, measured for about `duration`.
///
/// # Errors
/// A simulation that diverges in its first steps.
pub fn measure(simulation: &mut Simulation, duration: Duration) -> Result<f64, Diverged> {
    for _ in 0..WARM_UP {
        simulation.step()?;
    }
    let (start, mut steps) = (Instant::now(), 0_u32);
    loop {
        simulation.step()?;
        steps += 1;
        if simulation.is_finished() || start.elapsed() >= duration {
            break;
        }
    }
    let updates = f64::from(steps) * simulation.particle_count() as f64;
    Ok(updates / start.elapsed().as_secs_f64())
}
