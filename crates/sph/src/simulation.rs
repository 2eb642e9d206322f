//! The simulation: a setup turned into particles, stepped in time.

use crate::error::{Diverged, SetupError};
use crate::observation::{CheckpointState, Sample, Snapshot};
use crate::setup::Setup;

/// What one step tells its caller.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// Steps since the start, this one included.
    pub step: u64,
    /// Simulated time after the step in s.
    pub time: f64,
    /// The channels, if the step closed a sampling interval.
    pub sample: Option<Sample>,
}

/// What a run will need, known before it starts.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Number of particles.
    pub particles: usize,
    /// Mean number of neighbours at the start.
    pub mean_neighbours: f64,
    /// First time step in s.
    pub time_step: f64,
    /// Expected number of steps.
    pub steps: u64,
    /// Expected memory of the solver in bytes.
    pub memory_bytes: u64,
}

/// A run in progress, in two or three dimensions.
#[derive(Debug)]
pub struct Simulation {
    setup: Setup,
}

impl Simulation {
    /// Builds the particles and checks the start.
    ///
    /// # Errors
    /// An empty body, an unusable tool surface, a tool that overlaps the workpiece.
    pub fn new(setup: Setup) -> Result<Self, SetupError> {
        Ok(Self { setup })
    }

    /// Goes on from a stored state of the same setup, with the same bits as without interruption.
    ///
    /// # Errors
    /// As [`Simulation::new`]; and a state that does not fit the setup.
    pub fn restore(setup: Setup, state: &CheckpointState) -> Result<Self, SetupError> {
        let _ = state;
        Self::new(setup)
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// A quantity that is not finite or left its physical range.
    pub fn step(&mut self) -> Result<StepReport, Diverged> {
        todo!()
    }

    /// Whether the end time is reached.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.time() >= self.setup.end_time
    }

    /// Simulated time in s.
    #[must_use]
    pub fn time(&self) -> f64 {
        0.0
    }

    /// Steps since the start.
    #[must_use]
    pub fn steps(&self) -> u64 {
        0
    }

    /// Number of particles.
    #[must_use]
    pub fn particle_count(&self) -> usize {
        0
    }

    /// The setup this run was built from.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// What the whole run will need.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        todo!()
    }

    /// The particles now, in the order of their identifiers.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        todo!()
    }

    /// The complete state for [`Simulation::restore`].
    #[must_use]
    pub fn checkpoint(&self) -> CheckpointState {
        todo!()
    }
}
