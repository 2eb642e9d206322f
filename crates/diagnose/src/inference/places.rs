//! Where cuts lie among each other: the coordinates of everything smooth over the conditions.

use crate::inference::problem::RegressionProblem;

/// Of a cut: log v_c, log h, cut length, rake angle, edge radius.
pub(crate) const AXES: usize = 5;
/// Those of the tool among them.
pub(crate) const TOOL_AXES: std::ops::Range<usize> = 3..AXES;

/// The place of each row along [`AXES`], from 0 to 1 over all rows; 0 along an axis where all are at the same place.
pub(crate) fn scaled_places(problem: &RegressionProblem) -> Vec<[f64; AXES]> {
    let raw: Vec<[f64; AXES]> = (0..problem.rows.len())
        .map(|row| {
            let condition = problem.condition(row);
            let [rake, edge] = condition.tool.parts().map(|part| part.unwrap_or(0.0));
            [
                condition.cutting_speed.ln(),
                condition.uncut_chip_thickness.ln(),
                condition.cut_length,
                rake,
                edge,
            ]
        })
        .collect();
    let mut scaled = raw.clone();
    for axis in 0..AXES {
        // Rows that are asked for and not measured do not change the range.
        let measured = || {
            let all = raw.iter().zip(&problem.rows);
            all.filter(|(_, row)| row.variance.is_finite()).map(|(place, _)| place[axis])
        };
        let low = measured().fold(f64::INFINITY, f64::min);
        let high = measured().fold(f64::NEG_INFINITY, f64::max);
        for (to, from) in scaled.iter_mut().zip(&raw) {
            to[axis] = if high > low { (from[axis] - low) / (high - low) } else { 0.0 };
        }
    }
    scaled
}

/// Axes of the tool along which the recordings differ.
pub(crate) fn tool_axes(places: &[[f64; AXES]]) -> Vec<usize> {
    TOOL_AXES.filter(|&axis| places.iter().any(|place| place[axis] > 0.0)).collect()
}
