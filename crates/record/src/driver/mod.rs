//! Steps a simulation from its beginning or its last checkpoint to its end and
//! keeps the record.

mod session;
mod start;
mod stepper;

pub use stepper::{Source, Stepper};

pub use crate::files::Export;
use crate::{Facts, Provenance, Run, RunError, Samples};
use std::path::PathBuf;
use std::time::Duration;

/// How to run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOptions {
    /// Folder of the result; created if it does not exist.
    pub out_dir: PathBuf,
    /// What to do with what is there already.
    pub start: Start,
    /// Number of snapshots, evenly spaced from the start to the end time, both included.
    /// One is always taken where the run ends; 0 takes none at all.
    pub snapshots: u32,
    /// Wall-clock time between checkpoints. It has no influence on the result.
    pub checkpoint_interval: Duration,
    /// Threads the solver may use, for the record; the caller sets up the pool.
    pub threads: usize,
    /// What is written beside the record.
    pub export: Export,
}

/// What to do with what is already in the result's folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Refuse to touch an existing result or an unfinished run.
    New,
    /// Replace what sphcut wrote there. Other files stay.
    Replace,
    /// Go on from the last checkpoint; start at the beginning if there is none; return the existing
    /// result if it is complete.
    Resume,
}

/// What the caller wants after having seen a [`Progress`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// The run has reached its goal: end it as [`crate::Outcome::Steady`]. Only heeded at
    /// [`Moment::Sample`], so that the result does not depend on the clock.
    Stop,
    /// Write a checkpoint and end it as [`crate::Outcome::Interrupted`].
    Interrupt,
}

/// Why the driver calls back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// A sample was added. These calls are the same in every run of the scenario.
    Sample,
    /// Some wall-clock time has passed. Whether and when is not reproducible.
    Clock,
}

/// Where the run is.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'run> {
    /// Why this call is made.
    pub moment: Moment,
    /// Steps since the start.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// Path of the tool in m.
    pub travel: f64,
    /// Simulated time at which the run ends in s.
    pub end_time: f64,
    /// Path of the tool at which the run ends in m.
    pub end_travel: f64,
    /// Number of particles.
    pub particles: usize,
    /// Numbers of the setup.
    pub facts: &'run Facts,
    /// All samples so far, the latest last; those before a resumption included.
    pub samples: &'run Samples,
    /// Particles times steps per second of wall-clock time since the process started stepping.
    pub updates_per_second: f64,
    /// Wall-clock time spent so far in s, earlier parts of a resumed run included.
    pub wall_seconds: f64,
    /// Wall-clock time still needed at the present speed in s; `None` at the very beginning.
    pub remaining_seconds: Option<f64>,
}

/// Runs `source` to its end, recording into `options.out_dir`: `run.h5`, `snapshots.vtkhdf`,
/// `forces.csv`. `control` is called after every sample and about ten times a second. Its
/// [`Control::Stop`] has to follow from the samples alone: after a resumption it is asked once more
/// about the latest sample.
///
/// A run that was interrupted is `Ok` with [`crate::Outcome::Interrupted`]: its checkpoint is
/// written and [`Start::Resume`] goes on with the same bits.
///
/// # Errors
/// See [`RunError`]. Whatever was saved before stays.
pub fn run<S: Source>(
    source: &S,
    provenance: &Provenance,
    options: &RunOptions,
    control: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Run, RunError> {
    match start::begin(source, provenance, options)? {
        start::Begin::Complete(run) => Ok(*run),
        start::Begin::Session(session) => session.run(control),
    }
}
