//! SweepTable and page of a sweep.

use crate::failure::{ExitCode, Failure};
use crate::{files, results};
use serde_json::Value;
use sphcut_postprocess::{SCHEMA_VERSION, evaluate, summary_json};
use sphcut_record::{Run, RunFiles};
use sphcut_report::{SweepPage, render_sweep};
use sphcut_sweep::{
    State, Store, Sweep, SweepPlan, SweepTable, coefficients_csv, coefficients_json,
    force_coefficients,
};
use std::path::{Path, PathBuf};

/// Forces of all cuts.
const SIMULATED: &str = "simulated.csv";

/// v_c in m/s, h in m, F_c and F_f in N of the measured cuts; none without `--measured`.
pub fn measured(path: Option<&Path>) -> Result<Vec<[f64; 4]>, Failure> {
    let Some(path) = path else { return Ok(Vec::new()) };
    let text = files::read(path)?;
    let rows = sphcut_input::read_force_table(&text)
        .map_err(|problem| Failure::input(format!("`{}`, {problem}", path.display())))?;
    let row = |row: &sphcut_input::ForceTableRow| {
        [row.cutting_speed, row.uncut_chip_thickness, row.cutting_force, row.feed_force]
    };
    Ok(rows.iter().map(row).collect())
}

/// Writes them into `out`; the path of the page.
pub fn write(
    out: &Path,
    sweep: &Sweep,
    plan: &SweepPlan,
    store: &Store,
    (states, measured): (&[State], &[[f64; 4]]),
) -> Result<PathBuf, Failure> {
    let table = SweepTable::new(sweep, plan, store, states, &summary);
    files::save(&out.join("table.csv"), table.csv(out).as_bytes())?;
    let version = env!("CARGO_PKG_VERSION");
    table
        .write_h5(&out.join("table.h5"), &sweep.text, version)
        .map_err(|error| Failure::new(ExitCode::InputOutput, error.to_string()))?;
    if let Some(simulated) = table.simulated_csv() {
        files::save(&out.join(SIMULATED), simulated.as_bytes())?;
    }
    let coefficients = force_coefficients(&table);
    if !coefficients.is_empty() {
        files::save(&out.join("coefficients.csv"), coefficients_csv(&coefficients).as_bytes())?;
        files::save(&out.join("coefficients.json"), coefficients_json(&coefficients).as_bytes())?;
    }
    let page = SweepPage {
        table: &table,
        left_out: &plan.left_out,
        measured,
        text: &sweep.text,
        version,
        folder: out,
    };
    let text = render_sweep(&page)
        .map_err(|error| Failure::new(ExitCode::InputOutput, error.to_string()))?;
    let path = out.join("sweep.html");
    files::save(&path, text.as_bytes())?;
    Ok(path)
}

/// What can be done with the output of a sweep in `out`.
pub fn next(out: &Path) -> String {
    let simulated = out.join(SIMULATED);
    if simulated.is_file() {
        let simulated = simulated.display();
        format!(
            "`sphcut greybox fit --simulated {simulated} --measured FILE` compares with measured forces"
        )
    } else {
        "open the page".to_owned()
    }
}

/// The summary of the run in `folder`: the stored one, or one made from the record if that is of an earlier
/// version.
pub fn summary(folder: &Path) -> Option<Value> {
    let text = std::fs::read_to_string(folder.join(results::SUMMARY)).ok();
    let stored: Option<Value> = text.and_then(|text| serde_json::from_str(&text).ok());
    if let Some(stored) = stored.filter(|stored| stored["schema_version"] == SCHEMA_VERSION) {
        return Some(stored);
    }
    let run = Run::load(&RunFiles::in_dir(folder).record()).ok()?;
    serde_json::from_str(&summary_json(&evaluate(&run).ok()?)).ok()
}
