//! `sphcut greybox compare`.

use super::arguments::CompareArguments;
use super::tables::{method, model, refused, table};
use crate::failure::{ExitCode, Failure};
use crate::{files, terminal, text};
use sphcut_greybox::{comparison_json, predictions_csv};
use sphcut_report::render_comparison;

const FILES: [&str; 3] = ["comparison.html", "comparison.json", "predictions.csv"];
/// Resamples of the bootstrap.
const RESAMPLES: usize = 1000;

/// Compares a stored correction with measurements.
pub fn compare(arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    let out = &files::out(arguments.out.as_deref(), &arguments.measured, "_comparison");
    files::unless_there(FILES.map(|name| out.join(name)), arguments.force)?;
    let method = method(arguments.regressor.as_deref())?;
    let model = model(&arguments.model)?;
    let (simulated, measured) = (table(&arguments.simulated)?, table(&arguments.measured)?);
    let found = sphcut_greybox::compare(&model, method, &simulated, &measured, RESAMPLES)
        .map_err(|error| refused(&arguments.measured, &error))?;
    let inputs = found.pairs.inputs();
    let rows: Vec<_> = inputs
        .into_iter()
        .enumerate()
        .map(|(row, input)| (input, found.forces.each_ref().map(|force| force.predictions[row])))
        .collect();
    let texts =
        [render_comparison(&model, &found), comparison_json(&found), predictions_csv(&rows)];
    files::save_all(out, &FILES, &texts)?;
    found.notes.iter().for_each(|note| terminal::note(&format!("warning: {note}")));
    if found.seen > 0 {
        terminal::note(&format!(
            "warning: {} measured rows are left out: the correction was fitted to them",
            found.seen
        ));
    }
    let newton = |value: f64| text::number((value * 1e3).round() * 1e-3);
    for force in &found.forces {
        terminal::line(&format!(
            "{}: mean absolute error of the simulation {} N, corrected {} N; {:.0} % inside the 95 % intervals",
            force.force.symbol(),
            newton(force.white_box.mae.value),
            newton(force.grey_box.mae.value),
            100.0 * force.coverage
        ));
    }
    let next = "open the page: it says whether the correction may be used at such cuts";
    terminal::report(&out.join(FILES[0]), next);
    Ok(ExitCode::Done)
}
