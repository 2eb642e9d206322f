//! `sphcut springback`: springback and residual stress of finished cuts, beside measurements.

use crate::failure::{ExitCode, Failure};
use crate::progress::ShareDisplay;
use crate::{files, loading, terminal, text};
use clap::Args;
use sphcut_postprocess::springback::{
    Measurement, Springback, SpringbackEntry, SpringbackError, measure, springback_csv,
    springback_json,
};
use sphcut_postprocess::{ProcessResult, evaluate};
use sphcut_record::Run;
use sphcut_report::{SpringbackRun, render_springback};
use sphcut_sweep::results_of;
use std::path::{Path, PathBuf};

const HELP: &str = "\
Examples:
  sphcut springback out/cut --out springback              one run
  sphcut springback out/v150 out/v300 out/v450 --measured turning.csv --out springback

What appears in the output folder:
  springback.html   one page: figures, error bars, residual stress, and what can be said in words
  springback.json   the same as numbers      springback.csv   one line per run

--measured is a table with a header: v_c [m/min],springback [um],uncertainty [um],F_c [N],F_n [N]
(other units and any order; the forces may be left out). Springback is a tenth of a particle
spacing: give the runs many snapshots ([output] snapshots = 200) and see docs/howto/springback.md.";

/// Arguments of `springback`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct SpringbackArguments {
    /// Folders of the runs, each with `run.h5` inside, or output folders of sweeps.
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Measured springback (CSV with units in the header).
    #[arg(long, value_name = "FILE")]
    pub measured: Option<PathBuf>,
    /// Output folder [default: out/RUN_springback, RUN being the first].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace an existing springback report.
    #[arg(long)]
    pub force: bool,
}

const FILES: [&str; 3] = ["springback.html", "springback.json", "springback.csv"];

/// Measures the runs and writes page, numbers and table into the output folder.
pub fn springback(arguments: &SpringbackArguments) -> Result<ExitCode, Failure> {
    let out = &files::out(arguments.out.as_deref(), &arguments.runs[0], "_springback");
    files::unless_there(FILES.map(|name| out.join(name)), arguments.force)?;
    // The table first: a mistake in it is told at once.
    let measurements = arguments.measured.as_deref().map(read).transpose()?.unwrap_or_default();
    let mut runs = Vec::new();
    let display = ShareDisplay::new(false);
    for (place, folder) in arguments.runs.iter().enumerate() {
        let share = |part: f64| (place as f64 + part) / arguments.runs.len() as f64;
        display.update(share(0.0), &folder.display().to_string());
        match sweep_in(folder)? {
            Some(results) => {
                let told = |part: f64, run: &str| display.update(share(part), run);
                runs.extend(measured_in_sweep(folder, &results, &told)?);
            }
            None => {
                let name = folder.display().to_string();
                let refused = |refused| Failure::input(format!("`{name}`: {refused}"));
                let run = Measured::load(&name, folder)?.map_err(refused)?;
                runs.push(Measured { page: link(out, &folder.join("report.html")), ..run });
            }
        }
    }
    display.finish();
    let entries: Vec<SpringbackEntry<'_>> = runs
        .iter()
        .map(|run| SpringbackEntry {
            name: &run.name,
            result: &run.result,
            springback: &run.springback,
        })
        .collect();
    let views: Vec<SpringbackRun<'_>> = runs
        .iter()
        .map(|run| SpringbackRun {
            name: &run.name,
            page: run.page.as_deref(),
            run: &run.run,
            result: &run.result,
            springback: &run.springback,
        })
        .collect();
    let texts = [
        render_springback(&views, &measurements),
        springback_json(&entries, &measurements),
        springback_csv(&entries, &measurements),
    ];
    files::save_all(out, &FILES, &texts)?;
    for run in &runs {
        terminal::line(&line(run));
    }
    terminal::report(
        &out.join(FILES[0]),
        "open the page; --measured FILE sets measured springback beside it",
    );
    Ok(ExitCode::Done)
}

/// The way from a page in `folder` to that at `page`, if it is there; a path from the root where one of them is given so.
fn link(folder: &Path, page: &Path) -> Option<String> {
    if !page.is_file() {
        return None;
    }
    let (up, page) = if folder.is_absolute() || page.is_absolute() {
        (0, files::absolute(page).ok()?)
    } else {
        (folder.components().count(), page.to_owned())
    };
    Some(format!("{}{}", "../".repeat(up), page.display()))
}

/// Name of the table of a sweep in its output folder.
const TABLE: &str = "table.csv";

/// Number and folder of every result, if `folder` is the output of a sweep.
fn sweep_in(folder: &Path) -> Result<Option<Vec<(String, PathBuf)>>, Failure> {
    let table = folder.join(TABLE);
    if folder.join("run.h5").exists() || !table.is_file() {
        return Ok(None);
    }
    let text = files::read(&table)?;
    results_of(&text)
        .map(Some)
        .ok_or_else(|| Failure::input(format!("`{}` is no table of a sweep", table.display())))
}

/// All runs of a sweep that have a springback; the others are named with the reason.
fn measured_in_sweep(
    folder: &Path,
    results: &[(String, PathBuf)],
    told: &dyn Fn(f64, &str),
) -> Result<Vec<Measured>, Failure> {
    let mut measured = Vec::new();
    for (place, (number, result)) in results.iter().enumerate() {
        told(place as f64 / results.len() as f64, &format!("run {number}"));
        match Measured::load(&format!("run {number}"), &folder.join(result))? {
            Ok(run) => measured.push(run),
            Err(refused) => terminal::note(&format!("run {number} is left out: {refused}")),
        }
    }
    if measured.is_empty() {
        let message = format!("no run of the sweep in `{}` has a springback", folder.display());
        return Err(Failure::input(message));
    }
    Ok(measured)
}

/// One run and what was measured in it.
struct Measured {
    name: String,
    /// Link to its page, if there is one.
    page: Option<String>,
    run: Run,
    result: ProcessResult,
    springback: Springback,
}

impl Measured {
    /// The inner error is that of a run without springback.
    fn load(name: &str, folder: &Path) -> Result<Result<Self, SpringbackError>, Failure> {
        let explain = |error| Failure::of_run(&error, folder);
        let run = loading::run(folder)?;
        let result = evaluate(&run).map_err(explain)?;
        match measure(&run, &result) {
            Ok(springback) => {
                Ok(Ok(Self { name: name.to_owned(), page: None, run, result, springback }))
            }
            Err(SpringbackError::Record(error)) => Err(explain(error)),
            Err(refused) => Ok(Err(refused)),
        }
    }
}

/// One run on the terminal.
fn line(run: &Measured) -> String {
    let um = |length: f64| text::number((length * 1e9).round() * 1e-3);
    let found = &run.springback;
    let speed = text::number((found.cutting_speed * 60.0 * 1e3).round() * 1e-3);
    let name = &run.name;
    let Some(mean) = found.mean else {
        return format!(
            "{name}: {speed} m/min, no particle was seen touching the tool's lowest part"
        );
    };
    let count = found.in_window();
    if !found.error.statistical.is_finite() {
        return format!(
            "{name}: {speed} m/min, springback {} um from {count} particles, too few for an interval",
            um(mean.mean)
        );
    }
    let resolved = if found.is_resolved() { "resolved" } else { "not resolved" };
    format!(
        "{name}: {speed} m/min, springback {} ± {} um ({resolved}, {count} particles)",
        um(mean.mean),
        um(found.error.total())
    )
}

fn read(path: &Path) -> Result<Vec<Measurement>, Failure> {
    let text = files::read(path)?;
    let rows = sphcut_input::read_measured_springback(&text)
        .map_err(|problem| Failure::input(format!("`{}`, {problem}", path.display())))?;
    Ok(rows
        .into_iter()
        .map(|row| Measurement {
            cutting_speed: row.cutting_speed,
            springback: row.springback,
            uncertainty: row.uncertainty,
            cutting_force: row.cutting_force,
            normal_force: row.normal_force,
        })
        .collect())
}
