//! `calibration.json` and `calibration.csv`; `docs/calibration.md` describes both.

use super::{Calibration, Standing, Trial};
use serde_json::{Value, json};
use std::fmt::Write;

/// Version of the schema of `calibration.json`.
pub const SCHEMA_VERSION: &str = "1.0";

const M_PER_MIN: f64 = 60.0;

/// The text of `calibration.json`.
#[must_use]
pub fn calibration_json(calibration: &Calibration) -> String {
    let scan = &calibration.scan;
    let page = json!({
        "schema_version": SCHEMA_VERSION,
        "scenario": calibration.scenario,
        "version": calibration.version,
        "friction_law": calibration.law,
        "friction_coefficient": scan.best().coefficient,
        "indistinct_range": scan.range(),
        "standing": standing(scan.standing()),
        "cutting_speed_m_per_min": scan.best().measured.cutting_speed * M_PER_MIN,
        "scan": scan.trials().iter().map(trial).collect::<Vec<Value>>(),
        "predictions": calibration.predictions.iter().map(trial).collect::<Vec<Value>>(),
    });
    let mut text =
        serde_json::to_string_pretty(&page).expect("plain numbers and texts have a JSON form");
    text.push('\n');
    text
}

fn trial(trial: &Trial) -> Value {
    let misfit = trial.misfit();
    let [cutting, feed] = trial.deviations();
    json!({
        "run": trial.name,
        "friction_coefficient": trial.coefficient,
        "cutting_speed_m_per_min": trial.measured.cutting_speed * M_PER_MIN,
        "cutting_force": { "mean_n": trial.cutting.mean, "ci95_n": trial.cutting.ci95 },
        "feed_force": { "mean_n": trial.feed.mean, "ci95_n": trial.feed.ci95 },
        "measured_cutting_force_n": trial.measured.cutting_force,
        "measured_normal_force_n": trial.measured.normal_force,
        "cutting_force_deviation": cutting,
        "feed_force_deviation": feed,
        "error": misfit.error,
        "error_half_width": misfit.half_width,
        "steady": trial.steady,
    })
}

/// The word for a standing in files.
fn standing(standing: Standing) -> &'static str {
    match standing {
        Standing::Enclosed => "enclosed",
        Standing::AtBorder => "at_border",
        Standing::ReachesBorder => "reaches_border",
        Standing::Saturated => "saturated",
        Standing::Undetermined => "undetermined",
    }
}

/// The text of `calibration.csv`: one line per run, those of the scan first; what is not known is
/// empty.
#[must_use]
pub fn calibration_csv(calibration: &Calibration) -> String {
    let mut text =
        "part,friction coefficient,v_c [m/min],F_c [N],F_c ci95 [N],F_f [N],F_f ci95 [N],\
                    measured F_c [N],measured F_n [N],error,error half width\n"
            .to_owned();
    let scan = calibration.scan.trials().iter().map(|trial| ("scan", trial));
    let predictions = calibration.predictions.iter().map(|trial| ("prediction", trial));
    for (part, trial) in scan.chain(predictions) {
        let misfit = trial.misfit();
        let numbers = [
            trial.coefficient,
            trial.measured.cutting_speed * M_PER_MIN,
            trial.cutting.mean,
            trial.cutting.ci95,
            trial.feed.mean,
            trial.feed.ci95,
            trial.measured.cutting_force,
            trial.measured.normal_force,
            misfit.error,
            misfit.half_width,
        ];
        text.push_str(part);
        for number in numbers {
            let cell = if number.is_finite() { number.to_string() } else { String::new() };
            write!(text, ",{cell}").expect("a string can be written");
        }
        text.push('\n');
    }
    text
}
