//! One run of a calibration: computed, gone on with, or used again.

use super::CalibrateArguments;
use crate::commands::run;
use crate::failure::{ExitCode, Failure};
use crate::progress::OutputStyle;
use crate::terminal::note;
use crate::{loading, results, text};
use sphcut_postprocess::calibration::{MeasuredForces, Trial};
use sphcut_postprocess::evaluate;
use sphcut_record::driver::{Export, RunOptions, Start};
use sphcut_record::{Outcome, Provenance, Run, RunFiles};
use sphcut_scenario::{PatchError, Scenario};
use std::path::Path;
use std::time::Duration;

/// Where the coefficient stands in a scenario.
pub const COEFFICIENT: [&str; 3] = ["tool", "friction", "friction_coefficient"];
const SPEED: [&str; 2] = ["process", "cutting_speed"];

/// Makes runs from one scenario.
pub struct Workbench<'a> {
    pub arguments: &'a CalibrateArguments,
    pub scenario: &'a Scenario,
    pub style: OutputStyle,
}

impl Workbench<'_> {
    /// The run with `coefficient` at the measured speed; `None` if it was interrupted.
    pub fn trial(
        &self,
        coefficient: f64,
        measured: MeasuredForces,
    ) -> Result<Option<Trial>, Failure> {
        let scenario = self.varied(coefficient, measured.cutting_speed)?;
        let name = run_name(coefficient, measured.cutting_speed);
        let folder = self.arguments.folder().join("runs").join(&name);
        let run = match kept(&folder, &loading::provenance(&scenario)) {
            Some(run) => {
                self.tell(&format!("{name}: used again"));
                run
            }
            None => {
                self.tell(&format!("{name}: computed"));
                self.compute(&scenario, &folder)?
            }
        };
        if run.outcome == Outcome::Interrupted {
            return Ok(None);
        }
        let result = evaluate(&run).map_err(|error| Failure::of_run(&error, &folder))?;
        Ok(Some(Trial::new(format!("runs/{name}"), coefficient, measured, &result)))
    }

    fn tell(&self, text: &str) {
        if self.style == OutputStyle::Human {
            note(text);
        }
    }

    /// The scenario with another coefficient and speed.
    fn varied(&self, coefficient: f64, cutting_speed: f64) -> Result<Scenario, Failure> {
        let speed = format!("\"{} m/min\"", text::number(metres_per_minute(cutting_speed)));
        let varied = with_coefficient(&self.scenario.text, coefficient)
            .and_then(|text| sphcut_scenario::with_value(&text, &SPEED, &speed))
            .map_err(|error| not_varied(&self.arguments.scenario.file.scenario, &error))?;
        loading::varied(&self.arguments.scenario.file, &varied)
    }

    /// Starts the run or goes on with it; with `--force` over one whose scenario has changed.
    fn compute(&self, scenario: &Scenario, folder: &Path) -> Result<Run, Failure> {
        let options = |start| RunOptions {
            out_dir: folder.to_owned(),
            start,
            snapshots: scenario.output.snapshots,
            checkpoint_interval: Duration::from_secs_f64(scenario.output.checkpoint_seconds),
            threads: loading::threads(self.arguments.threads),
            export: Export::Vtkhdf,
        };
        let run = match run::compute(scenario, &options(Start::Resume), None, self.style) {
            Err(failure) if self.arguments.force && failure.exit_code() == ExitCode::BadInput => {
                run::compute(scenario, &options(Start::Replace), None, self.style)
            }
            run => run,
        }?;
        if run.outcome != Outcome::Interrupted {
            results::write(&run, folder)?;
        }
        Ok(run)
    }
}

/// The text of a scenario with another coefficient.
pub fn with_coefficient(text: &str, coefficient: f64) -> Result<String, PatchError> {
    sphcut_scenario::with_value(text, &COEFFICIENT, &text::number(coefficient))
}

/// Why a scenario cannot be varied, and what it needs.
pub fn not_varied(path: &Path, error: &PatchError) -> Failure {
    Failure::input(format!("`{}`: {error}", path.display())).advise(
        "a calibration needs a cut with `cutting_speed` in [process] and `friction_coefficient` in \
         [tool.friction]",
    )
}

/// v_c in m/min to six decimals, as it is written into a scenario.
fn metres_per_minute(speed: f64) -> f64 {
    (speed * 60.0 * 1e6).round() / 1e6
}

/// Folder of a run.
fn run_name(coefficient: f64, cutting_speed: f64) -> String {
    let speed = text::number(metres_per_minute(cutting_speed));
    format!("v{speed}_mu{}", text::number(coefficient))
}

/// A finished run in `folder` that resolves to the same values; comments and the layout of the
/// scenario's text do not matter.
fn kept(folder: &Path, now: &Provenance) -> Option<Run> {
    let record = RunFiles::in_dir(folder).record();
    let run = record.exists().then(|| Run::load(&record).ok())??;
    let complete = matches!(run.outcome, Outcome::Finished | Outcome::Steady);
    let stored = Provenance { scenario_text: now.scenario_text.clone(), ..run.provenance.clone() };
    (complete && now.difference(&stored).is_none()).then_some(run)
}
