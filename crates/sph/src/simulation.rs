//! The simulation: a setup turned into particles, stepped in time.

use crate::engine::Engine;
use crate::error::{Diverged, SetupError};
use crate::output::observation::{CheckpointState, Sample, Snapshot};
use crate::particles::lattice;
use crate::particles::window::Window;
use crate::setup::{Dimension, Setup};
use crate::stage::Stage;
use sphcut_tool_heat::{HeatedTool, ToolMeshFacts};

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
    /// Number of particles; with a moving window how many it holds once it is full.
    pub particles: usize,
    /// Mean number of neighbours at the start.
    pub mean_neighbours: f64,
    /// First time step in s.
    pub time_step: f64,
    /// Expected number of steps.
    pub steps: u64,
    /// Memory of the solver's arrays in bytes.
    pub memory_bytes: u64,
    /// That of what waits in front of a moving window, contained in `memory_bytes`.
    pub waiting_bytes: u64,
    /// The mesh of a tool that conducts heat.
    pub tool_mesh: Option<ToolMeshFacts>,
}

#[derive(Debug)]
enum AnyEngine {
    Two(Box<Engine<2>>),
    Three(Box<Engine<3>>),
}

macro_rules! with_engine {
    ($any:expr, $engine:ident => $body:expr) => {
        match $any {
            AnyEngine::Two($engine) => $body,
            AnyEngine::Three($engine) => $body,
        }
    };
}

/// A run in progress, in two or three dimensions.
#[derive(Debug)]
pub struct Simulation {
    setup: Setup,
    engine: AnyEngine,
}

impl Simulation {
    /// Builds the particles and checks the start.
    ///
    /// # Errors
    /// An empty body, an unusable tool surface, a tool that overlaps the workpiece.
    pub fn new(setup: Setup) -> Result<Self, SetupError> {
        let engine = match setup.dimension {
            Dimension::Two => AnyEngine::Two(Box::new(Engine::new(&setup)?)),
            Dimension::Three => AnyEngine::Three(Box::new(Engine::new(&setup)?)),
        };
        Ok(Self { setup, engine })
    }

    /// Goes on from a stored state of the same setup, with the same bits as without interruption.
    ///
    /// # Errors
    /// As [`Simulation::new`]; and a state that does not fit the setup.
    pub fn restore(setup: Setup, state: &CheckpointState) -> Result<Self, SetupError> {
        let engine = match setup.dimension {
            Dimension::Two => AnyEngine::Two(Box::new(Engine::restore(&setup, state)?)),
            Dimension::Three => AnyEngine::Three(Box::new(Engine::restore(&setup, state)?)),
        };
        Ok(Self { setup, engine })
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// A quantity that is not finite or left its physical range; the simulation is then of no
    /// further use, and the last checkpoint is the last good state.
    pub fn step(&mut self) -> Result<StepReport, Diverged> {
        self.step_observed(&mut |_| {})
    }

    /// [`Simulation::step`] that calls `passed` after each stage; a stage may pass more than once.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step_observed(&mut self, passed: &mut dyn FnMut(Stage)) -> Result<StepReport, Diverged> {
        let setup = &self.setup;
        with_engine!(&mut self.engine, engine => {
            engine.advance(passed)?;
            let interval = setup.sampling_interval;
            let due = engine.clock.time >= engine.ledger.interval_start + interval
                || engine.clock.time >= setup.end_time;
            let sample = due.then(|| engine.sample(setup));
            Ok(StepReport { step: engine.clock.step, time: engine.clock.time, sample })
        })
    }

    /// Whether the end time is reached.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.time() >= self.setup.end_time
    }

    /// Simulated time in s.
    #[must_use]
    pub fn time(&self) -> f64 {
        with_engine!(&self.engine, engine => engine.clock.time)
    }

    /// Steps since the start.
    #[must_use]
    pub fn steps(&self) -> u64 {
        with_engine!(&self.engine, engine => engine.clock.step)
    }

    /// Particles of all bodies of a setup, from their shapes alone: those of a cylinder about.
    #[must_use]
    pub fn count(setup: &Setup) -> f64 {
        setup.bodies.iter().map(|body| lattice::count(setup, body)).sum()
    }

    /// Number of particles that are followed now.
    #[must_use]
    pub fn particle_count(&self) -> usize {
        with_engine!(&self.engine, engine => engine.particles.count())
    }

    /// Number of neighbour pairs, each counted from both sides.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        with_engine!(&self.engine, engine => engine.reference.list.pairs())
    }

    /// The setup this run was built from.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// What the whole run will need.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        with_engine!(&self.engine, engine => Estimate {
            particles: engine.expected_count(),
            mean_neighbours: engine.reference.list.pairs() as f64 / engine.particles.count() as f64,
            time_step: engine.clock.time_step,
            // Exact while the time step keeps its first value; particles that crowd together shorten it later.
            steps: (self.setup.end_time / engine.clock.time_step).ceil() as u64,
            memory_bytes: engine.memory() as u64,
            waiting_bytes: engine.window.as_ref().map_or(0, Window::memory) as u64,
            tool_mesh: engine.tool_heat.as_ref().map(HeatedTool::facts),
        })
    }

    /// The particles now, in the order of their identifiers.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        with_engine!(&self.engine, engine => engine.snapshot(&self.setup))
    }

    /// The complete state for [`Simulation::restore`].
    #[must_use]
    pub fn checkpoint(&self) -> CheckpointState {
        with_engine!(&self.engine, engine => engine.checkpoint())
    }
}
