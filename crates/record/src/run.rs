//! A run as data: what `run.h5` holds.

use crate::{Facts, Provenance, Samples, Snapshots};
use sphcut_sph::{ChannelId, Diverged};

/// A run, finished or not, with where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Scenario, version, seed, effects.
    pub provenance: Provenance,
    /// Numbers of the setup.
    pub facts: Facts,
    /// The channels over time.
    pub samples: Samples,
    /// The particles at some instants.
    pub snapshots: Snapshots,
    /// What it took to compute.
    pub performance: Performance,
    /// How it ended.
    pub outcome: Outcome,
}

impl Run {
    /// What is recorded of the first pass of a run of several, as a run of one pass; `None` of any other run.
    #[must_use]
    pub fn first_pass(&self) -> Option<Self> {
        let first = self.facts.passes.first()?;
        let times = self.samples.channel(ChannelId::Time);
        let samples = times.partition_point(|time| first.ends_from(*time));
        let snapshots = self.snapshots.index().partition_point(|info| first.ends_from(info.time));
        Some(Self {
            facts: Facts { passes: Vec::new(), ..self.facts.clone() },
            samples: self.samples.first(samples),
            snapshots: self.snapshots.first(snapshots),
            provenance: self.provenance.clone(),
            performance: self.performance,
            outcome: self.outcome.clone(),
        })
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// It reached its end time.
    Finished,
    /// It was stopped early because a steady state was reached.
    Steady,
    /// It was interrupted and can be resumed.
    Interrupted,
    /// A quantity blew up; the record ends with the last good state.
    Diverged(Diverged),
}

/// What a run took to compute; times add up over its resumed parts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Performance {
    /// Number of particles.
    pub particles: usize,
    /// Time steps.
    pub steps: u64,
    /// Wall-clock time of the steps and the record in s.
    pub wall_seconds: f64,
    /// Processor time of all threads in s, where the platform tells it.
    pub cpu_seconds: Option<f64>,
    /// Highest resident memory in bytes, where the platform tells it.
    pub peak_memory_bytes: Option<u64>,
    /// Threads the solver was allowed to use.
    pub threads: usize,
}

impl Performance {
    /// Particles times steps per second of wall-clock time; 0 before the first.
    #[must_use]
    pub fn updates_per_second(&self) -> f64 {
        rate(self.updates(), self.wall_seconds)
    }

    /// Particles times steps per second of processor time.
    #[must_use]
    pub fn updates_per_cpu_second(&self) -> Option<f64> {
        self.cpu_seconds.map(|seconds| rate(self.updates(), seconds))
    }

    fn updates(&self) -> f64 {
        self.particles as f64 * self.steps as f64
    }
}

fn rate(count: f64, seconds: f64) -> f64 {
    if seconds > 0.0 { count / seconds } else { 0.0 }
}
