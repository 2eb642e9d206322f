//! What a sweep over speed and thickness says, in words.

use super::plots::{Point, levels, points, same};
use crate::text::{percent, three_digits};
use sphcut_sweep::Table;

const M_PER_MIN: f64 = 60.0;
const MM: f64 = 1e3;

/// One sentence each.
#[must_use]
pub fn sweep_words(table: &Table, measured: &[[f64; 4]]) -> Vec<String> {
    let mut words = Vec::new();
    for (index, symbol) in ["F_c", "F_f"].into_iter().enumerate() {
        let simulated = points(table, index);
        words.extend(over_thickness(&simulated, symbol, "simulated"));
        let real: Vec<Point> = measured
            .iter()
            .map(|row| Point { at: [row[0], row[1]], value: row[2 + index] })
            .collect();
        words.extend(over_thickness(&real, symbol, "measured"));
        words.extend(over_speed(&simulated, symbol, "simulated"));
        words.extend(over_speed(&real, symbol, "measured"));
    }
    let steady = |row: &&sphcut_sweep::Row| row.summary.get("steady.reached") == Some(&0.0);
    let unsteady = table.rows.iter().filter(steady).count();
    if unsteady > 0 {
        words.push(format!(
            "In {unsteady} runs the cutting force was not steady: their means are those of the travel they had."
        ));
    }
    if words.is_empty() {
        words.push("No cut with a result yet.".to_owned());
    }
    words
}

/// The value nearest to the middle of the range.
fn middle(levels: &[f64]) -> Option<f64> {
    levels.get(levels.len() / 2).copied()
}

/// `At 150 m/min F_c simulated rises by 8260 N per mm of h; a line misses its values by 1 % at most.`
fn over_thickness(points: &[Point], symbol: &str, what: &str) -> Option<String> {
    let speed = middle(&levels(points, 0))?;
    let slice: Vec<[f64; 2]> = points
        .iter()
        .filter(|point| same(point.at[0], speed))
        .map(|point| [point.at[1] * MM, point.value])
        .collect();
    if slice.len() < 3 {
        return None;
    }
    let (slope, offset) = line(&slice)?;
    let mean = slice.iter().map(|point| point[1]).sum::<f64>() / slice.len() as f64;
    let worst =
        slice.iter().map(|[x, y]| (y - offset - slope * x).abs()).fold(0.0, f64::max) / mean.abs();
    Some(format!(
        "At {} m/min the {what} {symbol} changes by {} N per mm of h (least squares); the line misses its values by \
         {} of their mean at most.",
        three_digits(speed * M_PER_MIN),
        three_digits(slope),
        percent(worst)
    ))
}

/// From the lowest to the highest speed at the middle thickness.
fn over_speed(points: &[Point], symbol: &str, what: &str) -> Option<String> {
    let thickness = middle(&levels(points, 1))?;
    let slice: Vec<&Point> = points.iter().filter(|point| same(point.at[1], thickness)).collect();
    let (first, last) = (slice.first()?, slice.last()?);
    if same(first.at[0], last.at[0]) {
        return None;
    }
    Some(format!(
        "At h = {} mm the {what} {symbol} goes from {} N at {} m/min to {} N at {} m/min ({} %).",
        three_digits(thickness * MM),
        three_digits(first.value),
        three_digits(first.at[0] * M_PER_MIN),
        three_digits(last.value),
        three_digits(last.at[0] * M_PER_MIN),
        three_digits(100.0 * (last.value / first.value - 1.0))
    ))
}

/// Slope and offset of the line of least squares.
fn line(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let spread: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    let slope = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum::<f64>() / spread;
    slope.is_finite().then_some((slope, y - slope * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_told() {
        let points: Vec<Point> = [0.06e-3, 0.1e-3, 0.15e-3]
            .into_iter()
            .map(|h| Point { at: [2.5, h], value: 100.0 + 8260.0 * h * 1e3 })
            .collect();
        let said = over_thickness(&points, "F_c", "simulated").unwrap();
        assert!(said.contains("At 150 m/min the simulated F_c changes by 8260 N per mm"), "{said}");
        assert!(over_speed(&points, "F_c", "simulated").is_none(), "one speed");
        let two =
            [Point { at: [2.0, 1e-4], value: 200.0 }, Point { at: [4.0, 1e-4], value: 190.0 }];
        let said = over_speed(&two, "F_c", "measured").unwrap();
        assert!(said.contains("from 200 N at 120 m/min to 190 N at 240 m/min"), "{said}");
    }
}
