//! `springback.json` and `springback.csv`; `docs/springback.md` describes both.

use super::compare::{Agreement, Measurement};
use super::result::Springback;
use crate::forces::Force;
use crate::result::ProcessResult;
use serde_json::{Value, json};
use sphcut_physics::csv;
use std::fmt::Write;

/// Version of the schema of `springback.json`.
pub const SCHEMA_VERSION: &str = "1.4";

const UM: f64 = 1e6;
const MM: f64 = 1e3;
const MPA: f64 = 1e-6;
const M_PER_MIN: f64 = 60.0;

/// One run of a springback report.
#[derive(Debug, Clone, Copy)]
pub struct SpringbackEntry<'a> {
    /// What the user calls the run.
    pub name: &'a str,
    /// Its evaluation.
    pub result: &'a ProcessResult,
    /// Its springback.
    pub springback: &'a Springback,
}

/// The text of `springback.json`.
#[must_use]
pub fn springback_json(entries: &[SpringbackEntry<'_>], measurements: &[Measurement]) -> String {
    let runs: Vec<Value> = entries.iter().map(|entry| run(entry, measurements)).collect();
    let page = json!({ "schema_version": SCHEMA_VERSION, "runs": runs });
    let mut text =
        serde_json::to_string_pretty(&page).expect("plain numbers and texts have a JSON form");
    text.push('\n');
    text
}

fn run(entry: &SpringbackEntry<'_>, measurements: &[Measurement]) -> Value {
    let found = entry.springback;
    let force = |force: &Force| json!({ "mean_n": force.mean, "ci95_n": force.ci95 });
    let comparison = found.compare(measurements).map(|comparison| {
        json!({
            "measured_um": comparison.measured.springback * UM,
            "uncertainty_um": comparison.measured.uncertainty * UM,
            "difference_um": comparison.difference * UM,
            "agreement": agreement(comparison.agreement),
            "measured_cutting_force_n": comparison.measured.cutting_force,
            "measured_normal_force_n": comparison.measured.normal_force,
        })
    });
    let touched = found.touched.iter().map(|touch| {
        json!({ "distance_mm": touch.distance * MM, "springback_um": touch.springback * UM })
    });
    let recovery = found.recovery.iter().map(|bin| {
        json!({
            "behind_um": bin.behind * UM,
            "height_um": bin.height * UM,
            "deviation_um": bin.deviation * UM,
            "count": bin.count,
        })
    });
    let stress = found.stress.iter().map(|bin| {
        json!({
            "depth_um": bin.depth * UM,
            "cutting_mpa": bin.cutting * MPA,
            "cutting_ci95_mpa": bin.cutting_ci95 * MPA,
            "across_mpa": bin.across * MPA,
            "across_ci95_mpa": bin.across_ci95 * MPA,
            "normal_mpa": bin.normal * MPA,
            "normal_ci95_mpa": bin.normal_ci95 * MPA,
            "layer_mpa": bin.layer.map(|stress| stress * MPA),
            "count": bin.count,
        })
    });
    json!({
        "name": entry.name,
        "cutting_speed_m_per_min": found.cutting_speed * M_PER_MIN,
        "particle_spacing_um": found.particle_spacing * UM,
        "springback_um": found.mean.map(|mean| mean.mean * UM),
        "median_um": found.median.map(|median| median.median * UM),
        "median_ci95_um": found.median.map(|median| median.bounds.map(|bound| bound * UM)),
        "ci95_um": found.error.statistical * UM,
        "contact_overlap_um": found.overlap.half_width.is_finite().then_some(found.overlap.mean * UM),
        "overlap_um": found.error.overlap * UM,
        "resolution_um": found.error.resolution * UM,
        "error_um": found.error.total() * UM,
        "resolved": found.is_resolved(),
        "averaged_from_mm": found.averaged_from * MM,
        "window_mm": found.window.map(|distance| distance * MM),
        "clear_distance_um": found.clear_distance * UM,
        "torn": found.torn,
        "snapshots": found.snapshots,
        "strips": {
            "mean_um": found.strips.mean * UM,
            "median_um": found.strips.median * UM,
            "roughness_um": found.strips.roughness * UM,
        },
        "steady": entry.result.steady.reached,
        "cutting_force": force(&entry.result.forces.cutting),
        "feed_force": force(&entry.result.forces.feed),
        "normal_force": force(&found.normal_force),
        "comparison": comparison,
        "touched": touched.collect::<Vec<Value>>(),
        "recovery": recovery.collect::<Vec<Value>>(),
        "residual_stress": stress.collect::<Vec<Value>>(),
    })
}

/// The word for a verdict in files.
fn agreement(agreement: Agreement) -> &'static str {
    match agreement {
        Agreement::Within => "within",
        Agreement::Undecided => "undecided",
        Agreement::Outside => "outside",
    }
}

/// The text of `springback.csv`: one line per run; what is not known is empty.
#[must_use]
pub fn springback_csv(entries: &[SpringbackEntry<'_>], measurements: &[Measurement]) -> String {
    let mut text = "run,v_c [m/min],springback [um],ci95 [um],error [um],F_c [N],F_c ci95 [N],\
                    F_n [N],F_n ci95 [N],measured springback [um],uncertainty [um],agreement\n"
        .to_owned();
    for entry in entries {
        let (found, forces) = (entry.springback, &entry.result.forces);
        let comparison = found.compare(measurements);
        let numbers = [
            Some(found.cutting_speed * M_PER_MIN),
            found.mean.map(|mean| mean.mean * UM),
            Some(found.error.statistical * UM),
            Some(found.error.total() * UM),
            Some(forces.cutting.mean),
            Some(forces.cutting.ci95),
            Some(found.normal_force.mean),
            Some(found.normal_force.ci95),
            comparison.map(|c| c.measured.springback * UM),
            comparison.map(|c| c.measured.uncertainty * UM),
        ];
        // A name is quoted: it may hold a comma.
        write!(text, "\"{}\"", csv::shown(entry.name).replace('"', "\"\""))
            .expect("a string can be written");
        for number in numbers {
            let cell = number.filter(|n| n.is_finite()).map(|n| n.to_string()).unwrap_or_default();
            write!(text, ",{cell}").expect("a string can be written");
        }
        let word = comparison.map_or("", |c| agreement(c.agreement));
        writeln!(text, ",{word}").expect("a string can be written");
    }
    text
}
