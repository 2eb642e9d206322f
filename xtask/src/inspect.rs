//! `cargo xtask inspect DIR`: whether a finished run has everything it should
//! and whether its balances close. Used by `.ci/run` after a real cut.

use serde_json::Value;
use std::path::Path;

/// Files of a result.
const FILES: [&str; 5] =
    ["run.h5", "forces.csv", "summary.json", "report.html", "snapshots.vtkhdf"];

/// Numbers that must be there and finite, with the range they must lie in.
const NUMBERS: [(&str, f64, f64); 11] = [
    // A steel of 331 MPa initial yield needs more than 331/sqrt(3) MPa over h = 0.1 mm, that is
    // 19 N/mm, and less than ten times a specific force of 3 GPa.
    ("/forces/cutting/mean_n_per_mm", 19.0, 3000.0),
    ("/forces/feed/mean_n_per_mm", 0.0, 3000.0),
    // Warmer than the surroundings, and not above what melts.
    ("/temperature/max_k", 300.0, 1733.0),
    // A chip is thicker than h and far thinner than the workpiece is long.
    ("/chip/thickness_mm", 0.1, 1.0),
    ("/contact/length_mm", 0.0, 2.0),
    // The bars of the balances: energy 1 % of the tool's work, momentum 0.5 %, draft 15 %.
    ("/balances/energy_closure", -0.01, 0.01),
    ("/balances/numerical_dissipation", 0.0, 0.15),
    ("/balances/momentum_closure", -0.005, 0.005),
    ("/performance/particles", 100.0, 1e9),
    ("/performance/steps", 100.0, 1e12),
    ("/performance/updates_per_second", 1.0, 1e12),
];

/// Checks the result in `folder`.
pub fn inspect(folder: &Path) -> Result<(), String> {
    for name in FILES {
        let size = std::fs::metadata(folder.join(name)).map_or(0, |data| data.len());
        if size == 0 {
            return Err(format!("{}: missing or empty", folder.join(name).display()));
        }
    }
    let path = folder.join("summary.json");
    let text = std::fs::read_to_string(&path).map_err(|error| error.to_string())?;
    let summary: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let problems = problems(&summary);
    if problems.is_empty() {
        println!("{}: complete, balances closed", folder.display());
        return Ok(());
    }
    Err(format!("{}:\n  {}", path.display(), problems.join("\n  ")))
}

fn problems(summary: &Value) -> Vec<String> {
    let mut problems = Vec::new();
    for (key, min, max) in NUMBERS {
        match summary.pointer(key).and_then(Value::as_f64) {
            None => problems.push(format!("{key} is not a number")),
            Some(value) if !(min..=max).contains(&value) => {
                problems.push(format!("{key} = {value} lies outside [{min}, {max}]"));
            }
            Some(_) => {}
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_missing_and_what_is_wrong_is_named() {
        let summary = json!({ "balances": { "energy_closure": 0.2 } });
        let problems = problems(&summary);
        assert_eq!(problems.len(), NUMBERS.len());
        assert!(problems.iter().any(|p| p.contains("energy_closure = 0.2")), "{problems:?}");
        assert!(problems.iter().any(|p| p.contains("steps is not a number")), "{problems:?}");
    }
}
