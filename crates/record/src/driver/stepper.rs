//! What the driver needs of a simulation.

use crate::Facts;
use sphcut_sph::{CheckpointState, Diverged, Setup, SetupError, Simulation, Snapshot, StepReport};

/// A simulation in progress.
pub trait Stepper {
    /// Advances by one time step.
    ///
    /// # Errors
    /// A quantity that blew up; the stepper is then of no further use.
    fn step(&mut self) -> Result<StepReport, Diverged>;
    /// Whether the end time is reached.
    fn is_finished(&self) -> bool;
    /// Simulated time in s.
    fn time(&self) -> f64;
    /// Steps since the start.
    fn steps(&self) -> u64;
    /// Number of particles.
    fn particle_count(&self) -> usize;
    /// The particles now.
    fn snapshot(&self) -> Snapshot;
    /// The complete state.
    fn checkpoint(&self) -> CheckpointState;
}

/// Where a simulation comes from: from its beginning, or from a stored state.
pub trait Source {
    /// The simulation.
    type Stepper: Stepper;

    /// The simulation at its beginning.
    ///
    /// # Errors
    /// A setup that cannot be built.
    fn start(&self) -> Result<Self::Stepper, SetupError>;

    /// The simulation at a stored state.
    ///
    /// # Errors
    /// A setup that cannot be built, or a state that does not fit it.
    fn restore(&self, state: &CheckpointState) -> Result<Self::Stepper, SetupError>;

    /// The numbers of its setup.
    fn facts(&self) -> Facts;
}

impl Source for Setup {
    type Stepper = Simulation;

    fn start(&self) -> Result<Simulation, SetupError> {
        Simulation::new(self.clone())
    }

    fn restore(&self, state: &CheckpointState) -> Result<Simulation, SetupError> {
        Simulation::restore(self.clone(), state)
    }

    fn facts(&self) -> Facts {
        Facts::of(self)
    }
}

impl Stepper for Simulation {
    fn step(&mut self) -> Result<StepReport, Diverged> {
        Simulation::step(self)
    }

    fn is_finished(&self) -> bool {
        Simulation::is_finished(self)
    }

    fn time(&self) -> f64 {
        Simulation::time(self)
    }

    fn steps(&self) -> u64 {
        Simulation::steps(self)
    }

    fn particle_count(&self) -> usize {
        Simulation::particle_count(self)
    }

    fn snapshot(&self) -> Snapshot {
        Simulation::snapshot(self)
    }

    fn checkpoint(&self) -> CheckpointState {
        Simulation::checkpoint(self)
    }
}
