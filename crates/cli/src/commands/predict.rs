//! `sphcut predict`: forces at new conditions with the correction of a diagnosis.

use super::diagnose::{CLOSED_FORM, DiagnoseArguments, NUMBERS, paired_model};
use crate::common_arguments::ScenarioArguments;
use crate::failure::{ExitCode, Failure};
use crate::progress::ShareDisplay;
use crate::{files, loading, terminal};
use clap::Args;
use sphcut_diagnose::{
    ClosedForm, DiagnoseError, Predictor, ProgressListener, closed_form_cut, diagnose_case_as,
    forecast, forecasts_csv,
};
use sphcut_input::read_condition_table;
use std::path::PathBuf;

const HELP: &str = "\
Example:
  sphcut diagnose scenarios/diagnosis/example.toml --out missing --closed-form
  sphcut predict --diagnosis missing --conditions new.csv --out new_forces.csv

The table of conditions: v_c [m/min],h [mm], and cut_length, rake, edge_radius as in the table of the diagnosis.

The table that is written has of every channel that was measured: as simulated, corrected, and the ends of the 95 % interval
of a single cut. The correction is what the diagnosis names, or the most probable of its set; without either, material and friction
recalibrated. What it leaves of the measured cuts is followed smoothly over speed and thickness. The diagnosis is made again from its
file, in some seconds; if it was made with paired runs of the particle solver, from these runs in their store, in some minutes.

See docs/howto/diagnose.md.";

/// Arguments of `predict`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct PredictForcesArguments {
    /// Folder that `sphcut diagnose` has written.
    #[arg(long, value_name = "DIR")]
    pub diagnosis: PathBuf,
    /// Conditions at which forces are asked for (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub conditions: PathBuf,
    /// Store of the paired runs, if the diagnosis was made with --store.
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
    /// The table that is written [default: out/NAME_forces.csv, NAME being that of the conditions].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Let the file of the diagnosis read files outside its own folder.
    #[arg(long)]
    pub allow_outside: bool,
    /// Replace an existing result.
    #[arg(long)]
    pub force: bool,
}

/// Makes the diagnosis again and asks it for the conditions.
pub fn predict(arguments: &PredictForcesArguments) -> Result<ExitCode, Failure> {
    let out = files::out(arguments.out.as_deref(), &arguments.conditions, "_forces.csv");
    files::unless_there([out.clone()], arguments.force)?;
    let numbers = arguments.diagnosis.join(NUMBERS);
    let damaged = |what: &str| Failure::input(format!("`{}` {what}", numbers.display()));
    let found: serde_json::Value = serde_json::from_str(&files::read(&numbers)?)
        .map_err(|error| damaged(&format!("is no result of sphcut diagnose: {error}")))?;
    let scenario = found["file"].as_str().map(PathBuf::from).filter(|file| file.is_file());
    let scenario = scenario.ok_or_else(|| {
        damaged(
            "names no file of a diagnosis that is there: go to the folder from which it was made",
        )
    })?;
    let scene = ScenarioArguments { scenario, allow_outside: arguments.allow_outside };
    let case = loading::diagnosis(&scene)?.case;
    let case = case.ok_or_else(|| damaged("is of forces over time alone"))?;
    let table = arguments.conditions.display();
    let rows = read_condition_table(&files::read(&arguments.conditions)?)
        .map_err(|problem| Failure::input(format!("`{table}`, {problem}")))?;
    let conditions: Vec<_> = rows.iter().map(|row| row.condition()).collect();
    let mistaken = |error: DiagnoseError| Failure::input(error.to_string());
    let closed;
    let paired;
    let model: &dyn Predictor = if found["model"] == CLOSED_FORM {
        closed = ClosedForm::new(closed_form_cut(&case.base).map_err(mistaken)?, &case.scatter());
        &closed
    } else {
        let own = DiagnoseArguments {
            scene,
            out: Some(arguments.diagnosis.clone()),
            closed_form: false,
            confirm: false,
            store: arguments.store.clone(),
            dry_run: false,
            list_runs: true,
            threads: None,
            force: false,
        };
        let Some(runs) = paired_model(&case, &own)? else {
            terminal::note(
                "the diagnosis was made with these runs: if they are kept elsewhere, name their store with --store",
            );
            return Ok(ExitCode::Interrupted);
        };
        paired = runs;
        &paired
    };
    let display = ShareDisplay::new(false);
    let told = |share: f64, what: &str| display.update(share, what);
    let again = diagnose_case_as(&case, model, ProgressListener(&told), |request| {
        (request.self_test, request.control, request.batch) = (0, 0, 0);
        request.held_out = false;
    });
    display.finish();
    let (recordings, diagnosis) = again.map_err(mistaken)?;
    if diagnosis.finding.verdict.key() != found["verdict"] {
        return Err(damaged(
            "is of other measurements or another version: make the diagnosis again",
        ));
    }
    let forecasts = forecast(&diagnosis, &recordings, model, &conditions).map_err(mistaken)?;
    files::save_alone(&out, forecasts_csv(&conditions, &forecasts).as_bytes())?;
    terminal::line(&format!("{} conditions  {}", conditions.len(), out.display()));
    terminal::next(
        "measure where the interval is widest, and add the cut to the table of the diagnosis",
    );
    Ok(ExitCode::Done)
}
