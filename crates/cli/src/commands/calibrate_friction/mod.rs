//! `sphcut calibrate-friction`: a friction coefficient from measured forces.

mod scan;
mod trials;

use crate::common_arguments::{PatchableArguments, ToldArguments};
use crate::failure::{ExitCode, Failure};
use crate::progress::{OutputStyle, emit};
use crate::{files, interrupt, loading, outcome, terminal, text};
use clap::Args;
use scan::Grid;
use serde_json::json;
use sphcut_physics::friction::FrictionEntry;
use sphcut_postprocess::calibration::{
    Calibration, MeasuredForces, Scan, Trial, calibration_csv, calibration_json,
};
use sphcut_report::{calibration_words, render_calibration};
use sphcut_scenario::{LoadOptions, Scenario};
use sphcut_sph::setup::Dimension;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::Path;
use std::path::PathBuf;
use trials::Workbench;

const HELP: &str = "\
The coefficient of the scenario's friction law is varied at the highest cutting speed of the measured
table; the one with the least error of F_c and F_f is then fixed and run at the other speeds.

Examples:
  sphcut calibrate-friction cut.toml --measured turning.csv --out mu
  sphcut calibrate-friction cut.toml --measured turning.csv --out mu --points 4 --refine 3

What appears in the output folder:
  calibration.html   one page: errors, forces, predictions, and what can be said in words
  calibration.json   the same as numbers      calibration.csv   one line per run
  calibrated.toml    the scenario with the coefficient found
  runs/              every run; they are used again, and an interrupted scan goes on with the same command

--measured is a table with a header: v_c [m/min],F_c [N],F_n [N], or F_f in a plane cut (other units and any
order). Tables of `sphcut recordings` and `sphcut springback` can be given as they are. See
docs/howto/calibrate-friction.md.";

/// Arguments of `calibrate-friction`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct CalibrateArguments {
    /// The scenario.
    #[command(flatten)]
    pub scenario: PatchableArguments,
    /// Measured forces (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub measured: PathBuf,
    /// Output folder [default: out/NAME_friction, NAME being that of the scenario].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Smallest coefficient.
    #[arg(long, value_name = "MU", default_value_t = 0.1)]
    pub from: f64,
    /// Largest coefficient.
    #[arg(long, value_name = "MU", default_value_t = 1.0)]
    pub to: f64,
    /// Coefficients of the scan, evenly spaced.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub points: u32,
    /// Times the step is halved around the best coefficient.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=8))]
    pub refine: u32,
    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Replace the pages of an earlier calibration, and runs whose scenario has changed.
    #[arg(long)]
    pub force: bool,
    /// What is told.
    #[command(flatten)]
    pub told: ToldArguments,
}

impl CalibrateArguments {
    /// Output folder.
    fn folder(&self) -> PathBuf {
        files::out(self.out.as_deref(), &self.scenario.file.scenario, "_friction")
    }
}

/// Widths of cut that differ by a smaller share are the same.
const SAME_WIDTH: f64 = 0.01;
const FILES: [&str; 4] =
    ["calibration.html", "calibration.json", "calibration.csv", "calibrated.toml"];

/// Scans, predicts and writes pages, numbers and the scenario with the coefficient found.
pub fn calibrate(arguments: &CalibrateArguments) -> Result<ExitCode, Failure> {
    let style = arguments.told.style();
    let result = follow(arguments, style);
    if let (Err(failure), OutputStyle::Json) = (&result, style) {
        outcome::emit_error(failure);
    }
    result
}

fn follow(arguments: &CalibrateArguments, style: OutputStyle) -> Result<ExitCode, Failure> {
    let out = &arguments.folder();
    files::unless_there(FILES.map(|name| out.join(name)), arguments.force)
        .map_err(|failure| failure.advise("finished runs are used again"))?;
    let scenario = loading::scenario(&arguments.scenario)?;
    let law = friction_law(&scenario)?;
    let grid = grid(arguments, &scenario, law)?;
    let mut rows = read(&arguments.measured, &scenario)?;
    rows.sort_by(|a, b| b.cutting_speed.total_cmp(&a.cutting_speed));
    interrupt::install();
    let bench = Workbench { arguments, scenario: &scenario, style };
    let Some(scan) = scan(&bench, &grid, arguments.refine, rows[0])? else {
        return Ok(interrupted(style));
    };
    let coefficient = scan.best().coefficient;
    let mut predictions = Vec::new();
    for row in &rows[1..] {
        let Some(trial) = bench.trial(coefficient, *row)? else { return Ok(interrupted(style)) };
        tell(&trial, style);
        predictions.push(trial);
    }
    let calibration = Calibration {
        scenario: scenario.title.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        law: law.key.to_owned(),
        scan,
        predictions,
    };
    write(&calibration, &scenario, arguments, style)?;
    Ok(ExitCode::Done)
}

fn friction_law(scenario: &Scenario) -> Result<&'static FrictionEntry, Failure> {
    let none = || Failure::input("the scenario has no tool: there is no friction to calibrate");
    scenario.setup.tool.as_ref().map(|tool| tool.friction).ok_or_else(none)
}

/// The coefficients to run, within the range of the law. A scenario that cannot be varied is told
/// before anything is run.
fn grid(
    arguments: &CalibrateArguments,
    scenario: &Scenario,
    law: &FrictionEntry,
) -> Result<Grid, Failure> {
    let (from, to) = (arguments.from, arguments.to);
    trials::with_coefficient(&scenario.text, from)
        .map_err(|error| trials::not_varied(&arguments.scenario.file.scenario, &error))?;
    let range = law.parameters.iter().find(|p| p.key == trials::COEFFICIENT[2]).map(|p| p.range);
    for (name, value) in [("--from", from), ("--to", to)] {
        if !value.is_finite() || range.is_some_and(|range| !range.contains(value)) {
            let allowed = range.map_or_else(String::new, |r| format!(", {} to {}", r.min, r.max));
            let message = format!("{name} {value}: outside the range of `{}`{allowed}", law.key);
            return Err(Failure::input(message));
        }
    }
    if from >= to {
        return Err(Failure::input(format!("--from {from} is not below --to {to}")));
    }
    Ok(Grid::new(from, to, arguments.points, arguments.refine))
}

/// Runs the scan and its halvings; `None` if it was interrupted.
fn scan(
    bench: &Workbench<'_>,
    grid: &Grid,
    refine: u32,
    measured: MeasuredForces,
) -> Result<Option<Scan>, Failure> {
    let mut found: BTreeMap<u32, Trial> = BTreeMap::new();
    for halving in 0..=refine {
        let due = match halving {
            0 => grid.scan(),
            _ => grid.around(best_index(&found)?, halving),
        };
        for index in due {
            let Some(trial) = bench.trial(grid.coefficient(index), measured)? else {
                return Ok(None);
            };
            tell(&trial, bench.style);
            found.insert(index, trial);
        }
    }
    Scan::new(found.into_values().collect()).map(Some).ok_or_else(no_forces)
}

fn no_forces() -> Failure {
    Failure::new(ExitCode::InputOutput, "no run of the scan has mean forces")
}

fn best_index(found: &BTreeMap<u32, Trial>) -> Result<u32, Failure> {
    let error = |trial: &Trial| trial.misfit().error;
    found
        .iter()
        .filter(|(_, trial)| error(trial).is_finite())
        .min_by(|a, b| error(a.1).total_cmp(&error(b.1)))
        .map(|(index, _)| *index)
        .ok_or_else(no_forces)
}

fn interrupted(style: OutputStyle) -> ExitCode {
    match style {
        OutputStyle::Json => emit(&json!({ "event": "interrupted" })),
        _ => terminal::note("interrupted: a checkpoint is written; the same command goes on"),
    }
    ExitCode::Interrupted
}

/// One finished run.
fn tell(trial: &Trial, style: OutputStyle) {
    let (misfit, [cutting, feed]) = (trial.misfit(), trial.deviations());
    match style {
        OutputStyle::Json => emit(&json!({
            "event": "run",
            "run": trial.name,
            "friction_coefficient": trial.coefficient,
            "cutting_speed_m_per_s": trial.measured.cutting_speed,
            "cutting_force_n": trial.cutting.mean,
            "feed_force_n": trial.feed.mean,
            "error": misfit.error,
            "error_half_width": misfit.half_width,
        })),
        OutputStyle::Human => terminal::line(&format!(
            "{}: F_c {:.1} N ({:+.1} %), F_f {:.1} N ({:+.1} %), error {:.1} %",
            trial.name,
            trial.cutting.mean,
            100.0 * cutting,
            trial.feed.mean,
            100.0 * feed,
            100.0 * misfit.error
        )),
        OutputStyle::Quiet => {}
    }
}

fn write(
    calibration: &Calibration,
    scenario: &Scenario,
    arguments: &CalibrateArguments,
    style: OutputStyle,
) -> Result<(), Failure> {
    let coefficient = calibration.scan.best().coefficient;
    let patched = trials::with_coefficient(&scenario.text, coefficient)
        .map_err(|error| trials::not_varied(&arguments.scenario.file.scenario, &error))?;
    let texts = [
        render_calibration(calibration),
        calibration_json(calibration),
        calibration_csv(calibration),
        patched,
    ];
    let out = &arguments.folder();
    files::save_all(out, &FILES, &texts)?;
    if style != OutputStyle::Json {
        warn_of_files(&out.join(FILES[3]));
    }
    let page = out.join(FILES[0]);
    match style {
        OutputStyle::Json => emit(&json!({
            "event": "done",
            "report": page.display().to_string(),
            "friction_coefficient": coefficient,
            "indistinct_range": calibration.scan.range(),
        })),
        OutputStyle::Human => {
            calibration_words(calibration).iter().for_each(|words| terminal::line(words));
            let found = text::number(coefficient);
            terminal::line(&format!("friction_coefficient = {found}"));
            let next = format!("`sphcut run {}` cuts with it", out.join(FILES[3]).display());
            terminal::report(&page, &next);
        }
        OutputStyle::Quiet => {}
    }
    Ok(())
}

/// A scenario that names files by relative paths does not work in another folder.
fn warn_of_files(path: &Path) {
    if sphcut_scenario::load(path, &LoadOptions::default()).is_err() {
        terminal::note(&format!(
            "warning: `{}` names files beside the original scenario: move it there",
            path.display()
        ));
    }
}

/// The measured forces at the uncut chip thickness of the scenario, if it is a plane cut.
fn read(path: &Path, scenario: &Scenario) -> Result<Vec<MeasuredForces>, Failure> {
    let text = files::read(path)?;
    let setup = &scenario.setup;
    let wrong = |problem: &dyn std::fmt::Display| {
        Failure::input(format!("`{}`, {problem}", path.display()))
    };
    let thickness = setup.uncut_chip_thickness.filter(|_| setup.dimension == Dimension::Two);
    let rows =
        sphcut_input::read_measured_forces(&text, thickness).map_err(|found| wrong(&found))?;
    let is_other = |width: f64| (width / setup.width_of_cut - 1.0).abs() > SAME_WIDTH;
    if let Some(width) =
        rows.iter().filter_map(|row| row.width_of_cut).find(|width| is_other(*width))
    {
        let (measured, simulated) = (width * 1e3, setup.width_of_cut * 1e3);
        return Err(wrong(&format!(
            "its cuts are {measured:.4} mm wide, that of the scenario {simulated:.4} mm: change `width_of_cut`"
        )));
    }
    Ok(rows
        .into_iter()
        .map(|row| MeasuredForces {
            cutting_speed: row.cutting_speed,
            cutting_force: row.cutting_force,
            normal_force: row.normal_force,
        })
        .collect())
}
