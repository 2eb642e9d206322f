//! What runs will cost.

use sphcut_sph::{Diverged, Estimate, Setup, Simulation};
use std::time::{Duration, Instant};

/// Most steps of a cut over those that the first step predicts, as particles crowd in the chip: 1.1 to 2.2 in
/// the cuts measured.
pub const CROWDING: f64 = 2.2;
/// Steps that are not counted: the first ones warm caches and threads up.
const WARM_UP: u32 = 3;

/// What a run will take, from its first step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Particles.
    pub particles: usize,
    /// Steps if none were shorter than the first.
    pub steps: u64,
    /// Most steps over these.
    pub crowding: f64,
    /// Memory of the solver's arrays in bytes.
    pub memory_bytes: u64,
}

impl Cost {
    /// Of a run with `setup` and the first step `estimate`.
    #[must_use]
    pub fn new(setup: &Setup, estimate: &Estimate) -> Self {
        Self {
            particles: estimate.particles,
            steps: estimate.steps,
            crowding: if setup.uncut_chip_thickness.is_some() { CROWDING } else { 1.0 },
            memory_bytes: estimate.memory_bytes,
        }
    }

    /// Steps times particles, the least.
    #[must_use]
    pub fn updates(&self) -> f64 {
        self.steps as f64 * self.particles as f64
    }

    /// Seconds of one thread that makes `speed` updates per second: least and most.
    #[must_use]
    pub fn seconds(&self, speed: f64) -> [f64; 2] {
        [self.updates() / speed, self.crowding * self.updates() / speed]
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
