//! What a run leaves for the observables.

use crate::table::ReferenceTable;
use serde::Deserialize;
use sphcut_postprocess::springback::{Springback, measure};
use sphcut_postprocess::{ProcessResult, evaluate};
use sphcut_record::{Facts, Outcome, Performance, Provenance, Run, Samples, Snapshots};
use sphcut_sph::setup::{Dimension, Vector};
use sphcut_sph::{ChannelId, Sample, Setup, Simulation, Snapshot};
use std::sync::{Arc, OnceLock};

/// Whether a run is stepped to its end or only set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunMode {
    /// Stepped to its end.
    #[default]
    Simulate,
    /// Only set up: for laws and kernels.
    Setup,
}

/// A finished run: its setup, its channels and its snapshots.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// What was run.
    pub setup: Setup,
    /// The channels, one sample per interval.
    pub samples: Vec<Sample>,
    /// The particles, at the start, at the end and evenly between.
    pub snapshots: Vec<Arc<Snapshot>>,
    /// Number of time steps.
    pub steps: u64,
    /// The case's `reference.csv`; empty if there is none.
    pub reference: ReferenceTable,
    /// What evaluating it gave: once for all observables.
    pub(crate) evaluated: Evaluated,
}

/// A run evaluated as one on disk, when first asked for.
#[derive(Debug, Clone, Default)]
pub(crate) struct Evaluated {
    result: OnceLock<Result<ProcessResult, String>>,
    springback: OnceLock<Result<Springback, String>>,
}

impl Evidence {
    /// Sets `setup` up and steps it to its end, keeping about `snapshots` snapshots.
    ///
    /// # Errors
    /// A setup that cannot be built, a run that diverges.
    pub fn collect(
        setup: Setup,
        mode: RunMode,
        snapshots: u32,
        reference: ReferenceTable,
        progress: &dyn Fn(f64),
    ) -> Result<Self, String> {
        let mut evidence = Self {
            setup,
            samples: Vec::new(),
            snapshots: Vec::new(),
            steps: 0,
            reference,
            evaluated: Evaluated::default(),
        };
        if mode == RunMode::Setup {
            return Ok(evidence);
        }
        let mut simulation =
            Simulation::new(evidence.setup.clone()).map_err(|error| error.to_string())?;
        evidence.snapshots.push(simulation.snapshot().into());
        let interval = evidence.setup.end_time / f64::from(snapshots.max(1));
        let mut due = interval;
        while !simulation.is_finished() {
            let report = simulation.step().map_err(|error| error.to_string())?;
            evidence.steps = report.step;
            let closed = report.sample.is_some();
            evidence.samples.extend(report.sample);
            if closed {
                progress(report.time / evidence.setup.end_time);
            }
            if report.time >= due && !simulation.is_finished() {
                evidence.snapshots.push(simulation.snapshot().into());
                due = (report.time / interval).floor() * interval + interval;
            }
        }
        evidence.snapshots.push(simulation.snapshot().into());
        Ok(evidence)
    }

    /// What `sphcut run` reports of it.
    pub(crate) fn result(&self) -> Result<&ProcessResult, String> {
        let evaluated = self
            .evaluated
            .result
            .get_or_init(|| evaluate(&self.as_run()).map_err(|error| error.to_string()));
        evaluated.as_ref().map_err(Clone::clone)
    }

    /// What `sphcut springback` reports of it.
    pub(crate) fn springback(&self) -> Result<&Springback, String> {
        let measured = self.evaluated.springback.get_or_init(|| {
            measure(&self.as_run(), self.result()?).map_err(|error| error.to_string())
        });
        measured.as_ref().map_err(Clone::clone)
    }

    /// The same as a run on disk, for what evaluates those.
    fn as_run(&self) -> Run {
        let mut samples = Samples::default();
        self.samples.iter().for_each(|sample| samples.push(sample));
        Run {
            provenance: Provenance::default(),
            facts: Facts::of(&self.setup),
            samples,
            snapshots: Snapshots::in_memory(self.snapshots.clone()),
            performance: Performance::default(),
            outcome: Outcome::Finished,
        }
    }

    /// The particles over time.
    pub(crate) fn snapshots(&self) -> impl DoubleEndedIterator<Item = &Snapshot> {
        self.snapshots.iter().map(AsRef::as_ref)
    }

    /// The particles at the start.
    pub(crate) fn first(&self) -> Result<&Snapshot, String> {
        self.snapshots
            .first()
            .map(AsRef::as_ref)
            .ok_or_else(|| "the run was not stepped".to_owned())
    }

    /// The particles at the end.
    pub(crate) fn last(&self) -> Result<&Snapshot, String> {
        self.snapshots.last().map(AsRef::as_ref).ok_or_else(|| "the run was not stepped".to_owned())
    }

    /// The channels at the end.
    pub(crate) fn last_sample(&self) -> Result<&Sample, String> {
        self.samples.last().ok_or_else(|| "the run closed no sampling interval".to_owned())
    }

    /// One channel over time.
    pub(crate) fn series(&self, channel: ChannelId) -> Vec<f64> {
        self.samples.iter().map(|sample| sample.get(channel)).collect()
    }

    /// Mass of a particle of each body in kg (kg/m in 2D): density times spacing to the
    /// dimension. Only ratios of sums over particles are formed with it.
    pub(crate) fn particle_mass(&self, body: u32) -> f64 {
        let material = self.setup.bodies[body as usize].material;
        let exponent = match self.setup.dimension {
            Dimension::Two => 2,
            Dimension::Three => 3,
        };
        self.setup.materials[material].density * self.setup.particle_spacing.powi(exponent)
    }

    /// Index of the particle that is closest to `point` at the start.
    pub(crate) fn nearest(&self, point: Vector) -> Result<usize, String> {
        let positions = &self.first()?.position;
        let distance = |index: &usize| {
            (0..3).map(|axis| (positions[*index][axis] - point[axis]).powi(2)).sum::<f64>()
        };
        (0..positions.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .ok_or_else(|| "there are no particles".to_owned())
    }
}
