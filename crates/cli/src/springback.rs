//! `sphcut springback`: springback and residual stress of finished cuts, beside measurements.

use crate::arguments::SpringbackArguments;
use crate::failure::{ExitCode, Failure};
use crate::{outcome, results, terminal, text};
use sphcut_postprocess::springback::{
    Entry, Measurement, Springback, SpringbackError, measure, springback_csv, springback_json,
};
use sphcut_postprocess::{ProcessResult, evaluate};
use sphcut_record::{Run, RunFiles};
use sphcut_report::{SpringbackRun, render_springback};
use std::path::Path;

const FILES: [&str; 3] = ["springback.html", "springback.json", "springback.csv"];

/// Measures the runs and writes page, numbers and table into the output folder.
pub fn springback(arguments: &SpringbackArguments) -> Result<ExitCode, Failure> {
    let out = &arguments.out;
    if let Some(old) = FILES.iter().map(|name| out.join(name)).find(|path| path.exists())
        && !arguments.force
    {
        let message = format!("`{}` exists: use --force to replace it", old.display());
        return Err(Failure::input(message));
    }
    // The table first: a mistake in it is told at once.
    let measurements = arguments.measured.as_deref().map(read).transpose()?.unwrap_or_default();
    let runs: Vec<Measured> =
        arguments.runs.iter().map(|folder| Measured::load(folder)).collect::<Result<_, _>>()?;
    std::fs::create_dir_all(out)
        .map_err(|error| Failure::output(format!("cannot create `{}`", out.display()), &error))?;
    let entries: Vec<Entry<'_>> = runs
        .iter()
        .map(|run| Entry { name: &run.name, result: &run.result, springback: &run.springback })
        .collect();
    let views: Vec<SpringbackRun<'_>> = runs
        .iter()
        .map(|run| SpringbackRun {
            name: &run.name,
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
    for (name, content) in FILES.iter().zip(&texts) {
        results::save(&out.join(name), content.as_bytes())?;
    }
    for run in &runs {
        terminal::line(&line(run));
    }
    terminal::line(&format!("report             {}", out.join(FILES[0]).display()));
    Ok(ExitCode::Done)
}

/// One run and what was measured in it.
struct Measured {
    name: String,
    run: Run,
    result: ProcessResult,
    springback: Springback,
}

impl Measured {
    fn load(folder: &Path) -> Result<Self, Failure> {
        let explain = |error| outcome::failed(&error, folder);
        let run = Run::load(&RunFiles::in_dir(folder).record()).map_err(explain)?;
        let result = evaluate(&run).map_err(explain)?;
        let springback = measure(&run, &result).map_err(|error| match error {
            SpringbackError::Record(error) => explain(error),
            refused => Failure::input(format!("`{}`: {refused}", folder.display())),
        })?;
        Ok(Self { name: folder.display().to_string(), run, result, springback })
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
            "{name}: {speed} m/min, springback {} um from {count} particles in the window, too few for an interval",
            um(mean.mean)
        );
    }
    let resolved = if found.is_resolved() { "resolved" } else { "not resolved" };
    format!(
        "{name}: {speed} m/min, springback {} +- {} um ({resolved}, {count} particles in the window)",
        um(mean.mean),
        um(found.error.total())
    )
}

fn read(path: &Path) -> Result<Vec<Measurement>, Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::output(format!("cannot read `{}`", path.display()), &error))?;
    let rows = sphcut_scenario::read_measured_springback(&text)
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
