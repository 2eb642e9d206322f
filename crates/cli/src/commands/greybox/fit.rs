//! `sphcut greybox fit`.

use super::arguments::FitArguments;
use super::tables::{MODEL, method, refused, table};
use crate::failure::{ExitCode, Failure};
use crate::progress::ShareDisplay;
use crate::{files, loading, terminal, text};
use sphcut_greybox::regressor::Method;
use sphcut_greybox::{FitOptions, ForceFit, GreyBox, GreyBoxFit, fit_json, points_csv};
use sphcut_report::render_greybox;

const FILES: [&str; 4] = ["greybox.html", "greybox.json", "points.csv", MODEL];

/// Fits and writes page, numbers, points and models.
pub fn fit(arguments: &FitArguments) -> Result<ExitCode, Failure> {
    let out = &files::out(arguments.out.as_deref(), &arguments.measured, "_greybox");
    files::unless_there(FILES.map(|name| out.join(name)), arguments.force)?;
    let options =
        FitOptions { seed: arguments.seed, methods: methods(arguments)?, ..FitOptions::default() };
    let (simulated, measured) = (table(&arguments.simulated)?, table(&arguments.measured)?);
    let pool = loading::pool(loading::threads(arguments.threads))?;
    let display = ShareDisplay::new(arguments.quiet);
    let found = pool.install(|| {
        sphcut_greybox::fit(&simulated, &measured, &options, &|share, what| {
            display.update(share, what);
        })
    });
    display.finish();
    let found = found.map_err(|error| refused(&arguments.measured, &error))?;
    let texts = [
        render_greybox(&found),
        fit_json(&found),
        points_csv(&found),
        GreyBox::of(&found).to_json(),
    ];
    files::save_all(out, &FILES, &texts)?;
    if !arguments.quiet {
        say(&found);
        let next = format!(
            "`sphcut greybox predict --model {} --simulated FILE` corrects simulated forces of other cuts",
            out.display()
        );
        terminal::report(&out.join(FILES[0]), &next);
    }
    Ok(ExitCode::Done)
}

/// The regressors that are asked for, in their usual order.
fn methods(arguments: &FitArguments) -> Result<Vec<Method>, Failure> {
    if arguments.regressors.is_empty() {
        return Ok(Method::ALL.to_vec());
    }
    let mut asked = Vec::new();
    for key in &arguments.regressors {
        asked.extend(method(Some(key.trim()))?);
    }
    Ok(Method::ALL.into_iter().filter(|method| asked.contains(method)).collect())
}

fn say(found: &GreyBoxFit) {
    terminal::line(&format!(
        "{} rows, {} conditions; errors are those of conditions left out",
        found.pairs.rows.len(),
        found.pairs.conditions.len()
    ));
    found.forces.iter().for_each(|force| terminal::line(&line(force)));
    for (force, row) in
        found.forces.iter().flat_map(|force| force.outliers.iter().map(move |row| (force, row)))
    {
        terminal::note(&format!(
            "warning: {} of {} N at {} m/min, {} mm is {:.0} N from what the other rows predict, {:.0} times the usual error: check the record",
            force.force.symbol(),
            rounded(row.measured),
            rounded(60.0 * row.input[0]),
            rounded(1e3 * row.input[1]),
            row.error.abs(),
            row.ratio
        ));
    }
}

/// To a thousandth of its unit.
fn rounded(value: f64) -> String {
    text::number((value * 1e3).round() * 1e-3)
}

/// `F_c: simulation 63.2 N, corrected 2.95 N (-95.3 %), noise floor 2.1 N; use gaussian_process`.
fn line(force: &ForceFit) -> String {
    let (before, after) = (force.white_box.mae.value, force.procedure.mae.value);
    let floor = force
        .floor
        .map_or_else(String::new, |floor| format!(", noise floor {} N", rounded(floor.mae)));
    let change = if before > 0.0 {
        format!(" ({:+.1} %)", 100.0 * (after / before - 1.0))
    } else {
        String::new()
    };
    format!(
        "{}: mean absolute error of the simulation {} N, corrected {} N{change}{floor}; {}",
        force.force.symbol(),
        rounded(before),
        rounded(after),
        if force.pays() {
            format!("use {}", force.choice.method.key())
        } else {
            "use no correction: there is no pattern in the error".to_owned()
        }
    )
}
