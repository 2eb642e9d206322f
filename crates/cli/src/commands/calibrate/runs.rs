//! The cuts of a calibration as runs of the particle solver, through a store like any sweep.

use super::CutCalibrationArguments;
use crate::commands::diagnose::refused;
use crate::commands::sweep::listed::{self, ListedRuns, RunPlace};
use crate::commands::sweep::{dry_run, local};
use crate::failure::Failure;
use crate::loading;
use sphcut_calibrate::{CutEvaluator, CutValues, FreeConstant, RunPoint};
use sphcut_diagnose::PairedScenario;
use sphcut_scenario::Scenario;
use sphcut_sweep::Sweep;

/// Scatter of the logarithm of a mean without an interval, where a run was too short for one.
const UNKNOWN: f64 = 0.02;

/// Runs the cuts.
pub struct ParticleRuns<'a> {
    arguments: &'a CutCalibrationArguments,
    scenario: &'a Scenario,
    constants: &'a [FreeConstant],
    paired: PairedScenario,
}

/// Why runs ended early.
pub enum Stopped {
    /// The user stopped them, or computes them elsewhere.
    Interrupted,
    /// Something is wrong.
    Failed(Box<Failure>),
}

impl From<Failure> for Stopped {
    fn from(failure: Failure) -> Self {
        Self::Failed(Box::new(failure))
    }
}

impl<'a> ParticleRuns<'a> {
    /// Of a scenario that runs can be made of.
    pub fn new(
        arguments: &'a CutCalibrationArguments,
        scenario: &'a Scenario,
        constants: &'a [FreeConstant],
    ) -> Result<Self, Failure> {
        let paired = PairedScenario::of(scenario, arguments.travel).map_err(refused)?.alike();
        Ok(Self { arguments, scenario, constants, paired })
    }

    fn sweep(&self, round: &str, points: &[RunPoint]) -> Result<Sweep, Failure> {
        let values: Result<Vec<Vec<String>>, Failure> = points
            .iter()
            .map(|point| {
                let change = FreeConstant::change(self.constants, &point.t);
                self.paired.values(&point.condition, &change, false).map_err(refused)
            })
            .collect();
        Sweep::listed(
            (&format!("Calibration: {round}"), &round.replace(' ', "_")),
            (self.scenario, &self.arguments.scene.file.scenario),
            &loading::options(&self.arguments.scene.file),
            (&self.paired.keys(false), &values?),
        )
        .map_err(Failure::input)
    }

    /// What runs would cost.
    pub fn cost(&self, points: &[RunPoint]) -> Result<String, Failure> {
        let sweep = self.sweep("all rounds", points)?;
        let threads = loading::threads(self.arguments.threads);
        let plan = local::planned(&sweep, threads)?;
        let speed = local::speed(&sweep, &plan)?;
        let total = dry_run::total(&plan, Some(speed), threads);
        Ok(format!("{}{}", total.trim_start(), dry_run::warnings(&plan)))
    }
}

impl CutEvaluator for ParticleRuns<'_> {
    type Error = Stopped;

    fn evaluate(&mut self, round: &str, points: &[RunPoint]) -> Result<Vec<CutValues>, Stopped> {
        let sweep = self.sweep(round, points)?;
        let folder = self.arguments.folder().join("runs");
        let place = RunPlace {
            store: self.arguments.store.clone().unwrap_or_else(|| folder.join("store")),
            folder: folder.join(&sweep.name),
            threads: loading::threads(self.arguments.threads),
            only_list: self.arguments.list_runs,
            patch: self.arguments.scene.patch.clone(),
        };
        let ListedRuns::Finished(rows) = listed::compute(&sweep, &place)? else {
            return Err(Stopped::Interrupted);
        };
        let mut found = vec![CutValues::default(); points.len()];
        for row in &rows {
            found[row.number - 1] = listed::means(row).map(|mean| {
                let (mean, deviation) = mean.filter(|(mean, _)| *mean > 0.0)?;
                let share = deviation.map_or(UNKNOWN, |deviation| deviation / mean);
                Some((mean.ln(), share * share))
            });
        }
        Ok(found)
    }
}
