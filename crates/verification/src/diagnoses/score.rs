//! What a diagnosis said against what was concealed from it: after the fact, and only where the concealed columns are.

use super::{Diagnoses, JudgedDiagnosis};
use crate::error::CaseError;
use crate::head::CaseHead;
use crate::table::ReferenceTable;
use sphcut_diagnose::{Amount, Predictor};
use std::fmt::Write;
use std::path::Path;

/// Tests of the series that `validation/diagnosis_klippel` holds, and its least uncut chip thickness in mm.
const FIRST_TEST: &str = "V0301";
const THINNEST: f64 = 0.015;
/// Radius with which the tool is modelled there, in m.
const SHARP: f64 = 5e-6;
/// Length of a segment of `validation/diagnosis_wear` in s.
const SEGMENT: f64 = 5.0;

/// The edge radius that `validation/diagnosis_klippel` says, against those measured on its tests.
///
/// # Errors
/// A diagnosis that cannot be made, a table that cannot be read.
pub fn score_edge_radius(
    (head, case): (&CaseHead, &Diagnoses),
    data: &Path,
) -> Result<String, CaseError> {
    let cut = ReferenceTable::read(&data.join("klippel_ti6al4v_forces.csv"))?;
    let concealed_at = data.join("klippel_ti6al4v_concealed_columns.csv");
    let concealed = ReferenceTable::read(&concealed_at)?;
    let invalid = |reason: String| CaseError::invalid(&concealed_at, reason);
    let thickness = cut.numbers("f_mm_per_rev_uncut_chip_thickness_mm").map_err(&invalid)?;
    let used: Vec<&str> = cut
        .texts("test_id")
        .map_err(&invalid)?
        .into_iter()
        .zip(&thickness)
        .filter(|(test, h)| *test >= FIRST_TEST && **h >= THINNEST)
        .map(|(test, _)| test)
        .collect();
    let tests = concealed.texts("test_id").map_err(&invalid)?;
    let radii = concealed.texts("edge_radius_um").map_err(&invalid)?;
    // Some tests have none.
    let radii: Vec<f64> = tests
        .iter()
        .zip(radii)
        .filter(|(test, _)| used.contains(test))
        .filter_map(|(_, radius)| radius.parse().ok())
        .collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let deviation = radii.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / radii.len() as f64;
    let mut text = format!(
        "edge radius: {} of {} tests have one, mean {mean:.1} um, deviation {:.1} um\n",
        radii.len(),
        used.len(),
        deviation.sqrt()
    );
    for one in case.diagnosed(head)? {
        let said = said(&one).map_or_else(
            || "says no radius".to_owned(),
            |[value, low, high]| {
                let covered = if (low..=high).contains(&mean) { "covers" } else { "misses" };
                format!(
                    "says {value:.1} um ({low:.1} to {high:.1}): {covered} the mean, {:+.0} % off",
                    100.0 * (value / mean - 1.0)
                )
            },
        );
        let _ = writeln!(text, "{}: {said}", one.name);
    }
    Ok(text)
}

/// The whole edge radius in um with its interval, if the repair has one.
fn said(one: &JudgedDiagnosis) -> Option<[f64; 3]> {
    let fit = &one.found.fits[one.found.repair?];
    let effect = one.model.effects().iter().position(|effect| effect.key == "edge_radius")?;
    let all = one.found.estimates(&one.model, fit);
    let found = all.iter().find(|estimate| estimate.effect == effect)?;
    let [low, high] = found.interval;
    Some([found.value, low, high].map(|added| (SHARP + added) * 1e6))
}

/// The wear that `validation/diagnosis_wear` says on tools left out, against that measured.
///
/// # Errors
/// A table that cannot be read or has too little.
pub fn score_wear((head, case): (&CaseHead, &Diagnoses), data: &Path) -> Result<String, CaseError> {
    let path = data.join("vicomtech_turning_concealed_wear.csv");
    let table = ReferenceTable::read(&path)?;
    let invalid = |reason: String| CaseError::invalid(&path, reason);
    let [tools, seconds, wear] = ["tool", "segment_in_tool_1s", "Vb_um_unit_not_stated"];
    let tools = table.numbers(tools).map_err(&invalid)?;
    let seconds = table.numbers(seconds).map_err(&invalid)?;
    let wear = table.numbers(wear).map_err(&invalid)?;
    let measured = |amount: &Amount| {
        let is_in = |k: &usize| {
            tools[*k].to_string() == amount.segment.tool
                && (seconds[*k] + 0.5 - amount.segment.time).abs() < 0.5 * SEGMENT
        };
        let own: Vec<f64> = (0..tools.len()).filter(is_in).map(|k| wear[k]).collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    let mut text = String::new();
    for (name, found) in case.grown(head)? {
        for tool in &found.left_out {
            let against = |of: fn(&Amount) -> f64| {
                let own: Vec<(f64, f64)> =
                    tool.amounts.iter().map(|amount| (of(amount), measured(amount))).collect();
                rank_correlation(&own)
            };
            let last = tool.amounts.last().map_or(f64::NAN, measured);
            let _ = writeln!(
                text,
                "{name}, tool {} left out: rank correlation {:.3}, of the course that never falls {:.3}, over {} segments, wear at the end {last:.0}",
                tool.tool,
                against(|a| a.force),
                against(|a| a.never_falling),
                tool.amounts.len()
            );
        }
        // Whatever rises over a life has a high rank correlation there: what counts is between tools, and against these.
        let beside = |of: fn(&Amount) -> f64| {
            let amounts = found.left_out.iter().flat_map(|tool| &tool.amounts);
            rank_correlation(&amounts.map(|a| (of(a), measured(a))).collect::<Vec<_>>())
        };
        let _ = writeln!(
            text,
            "{name}, all tools together: {:.3}, of the courses that never fall {:.3}; time in cut alone {:.3}, F_f alone {:.3}, F_c alone {:.3}",
            beside(|a| a.force),
            beside(|a| a.never_falling),
            beside(|a| a.segment.time),
            beside(|a| a.segment.forces[1]),
            beside(|a| a.segment.forces[0])
        );
    }
    Ok(text)
}

/// Spearman's rank correlation; equal values share their mean rank.
fn rank_correlation(pairs: &[(f64, f64)]) -> f64 {
    let ranks = |of: &dyn Fn(&(f64, f64)) -> f64| -> Vec<f64> {
        let values: Vec<f64> = pairs.iter().map(of).collect();
        let rank = |x: &f64| {
            let below = values.iter().filter(|y| *y < x).count() as f64;
            let equal = values.iter().filter(|y| *y == x).count() as f64;
            below + 0.5 * (equal - 1.0)
        };
        values.iter().map(rank).collect()
    };
    let (a, b) = (ranks(&|pair| pair.0), ranks(&|pair| pair.1));
    let middle = 0.5 * (pairs.len() as f64 - 1.0);
    let product = |x: &[f64], y: &[f64]| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - middle) * (y - middle)).sum()
    };
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 - 6 sum d^2 / (n (n^2 - 1)) without ties: d = 1, 1, 0, 0 and n = 4: 1 - 12 / 60 = 0.8.
    #[test]
    fn rank_correlation_by_hand() {
        let found = rank_correlation(&[(1.0, 2.0), (2.0, 1.0), (3.0, 30.0), (4.0, 400.0)]);
        assert!((found - 0.8).abs() < 1e-12, "{found}");
        assert!((rank_correlation(&[(1.0, 3.0), (2.0, 2.0), (9.0, 1.0)]) + 1.0).abs() < 1e-12);
        // Ties: ranks 0.5, 0.5, 2 against 0, 1, 2: 1.5 / sqrt(1.5 * 2).
        let tied = rank_correlation(&[(1.0, 1.0), (1.0, 2.0), (5.0, 3.0)]);
        assert!((tied - 1.5 / 3.0_f64.sqrt()).abs() < 1e-12, "{tied}");
    }
}
