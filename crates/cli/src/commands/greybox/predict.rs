//! `sphcut greybox predict`.

use super::arguments::PredictArguments;
use super::tables::{method, model, refused, table};
use crate::failure::{ExitCode, Failure};
use crate::{files, terminal};
use sphcut_greybox::{ForceKind, TableKind, predictions_csv};

/// Corrects a table of simulated forces.
pub fn predict(arguments: &PredictArguments) -> Result<ExitCode, Failure> {
    let out = files::out(arguments.out.as_deref(), &arguments.simulated, "_corrected.csv");
    files::unless_there([out.clone()], arguments.force)?;
    let method = method(arguments.regressor.as_deref())?;
    let (model, simulated) = (model(&arguments.model)?, table(&arguments.simulated)?);
    let notes = model
        .guard(&simulated, TableKind::Simulated)
        .map_err(|error| refused(&arguments.simulated, &error))?;
    notes.iter().for_each(|note| terminal::note(&format!("warning: {note}")));
    let mut rows = Vec::with_capacity(simulated.rows.len());
    for row in &simulated.rows {
        let input = [row.cutting_speed, row.uncut_chip_thickness];
        let of = |force: ForceKind| {
            model
                .predict(force, method, input, row.forces[force.index()])
                .map_err(|error| Failure::input(error.to_string()))
        };
        rows.push((input, [of(ForceKind::Cutting)?, of(ForceKind::Feed)?]));
    }
    let outside = rows.iter().filter(|(_, predictions)| !predictions[0].inside).count();
    if outside > 0 {
        terminal::note(&format!(
            "warning: {outside} of {} conditions lie outside the hull of the measured ones: the correction \
             extrapolates there (column `inside` is 0)",
            rows.len()
        ));
    }
    files::save_alone(&out, predictions_csv(&rows).as_bytes())?;
    terminal::line(&format!("{} conditions  {}", rows.len(), out.display()));
    terminal::next("measure one of them: `sphcut greybox compare` tests the correction");
    Ok(ExitCode::Done)
}
