//! The noise floor: what the scatter of repeats leaves to a perfect model.

use crate::pairing::{ForceKind, Pairs};
use crate::samples::mean;
use serde::{Deserialize, Serialize};

/// Errors that a model without error of its own would have.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NoiseFloor {
    /// Mean absolute error in N.
    pub mae: f64,
    /// Mean squared error in N^2.
    pub mse: f64,
    /// Rows or degrees of freedom it was found with.
    pub weight: f64,
    /// Where it comes from.
    pub source: FloorSource,
}

/// Where a noise floor comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FloorSource {
    /// Scatter of the rows of one condition.
    Repeats,
    /// The standard deviations of the table, over the square root of the numbers of measurements.
    Deviations,
}

/// The floor of a force; `None` if the table has neither repeats nor standard deviations.
#[must_use]
pub fn noise_floor(pairs: &Pairs, force: ForceKind) -> Option<NoiseFloor> {
    from_repeats(pairs, force).or_else(|| from_deviations(pairs, force))
}

/// sum (y - mean)^2 / sum (n - 1), and the mean of |y - mean| sqrt(n / (n - 1)), which has the
/// expectation of |y - truth| for normal noise.
fn from_repeats(pairs: &Pairs, force: ForceKind) -> Option<NoiseFloor> {
    let mut cells: Vec<Vec<f64>> = vec![Vec::new(); pairs.conditions.len()];
    for row in &pairs.rows {
        cells[row.condition].push(row.measured.forces[force.index()]);
    }
    let (mut squares, mut freedom, mut absolute, mut rows) = (0.0, 0.0, 0.0, 0.0);
    for cell in cells.iter().filter(|cell| cell.len() > 1) {
        let (centre, count) = (mean(cell), cell.len() as f64);
        squares += cell.iter().map(|y| (y - centre).powi(2)).sum::<f64>();
        let stretch = (count / (count - 1.0)).sqrt();
        absolute += stretch * cell.iter().map(|y| (y - centre).abs()).sum::<f64>();
        freedom += count - 1.0;
        rows += count;
    }
    (freedom > 0.0).then(|| NoiseFloor {
        mae: absolute / rows,
        mse: squares / freedom,
        weight: freedom,
        source: FloorSource::Repeats,
    })
}

/// A row is the mean of n measurements with the standard deviation s: it scatters by s / sqrt(n). The
/// expectation of s is c_4(n) sigma for normal noise, which the mean absolute error is corrected for.
fn from_deviations(pairs: &Pairs, force: ForceKind) -> Option<NoiseFloor> {
    let (mut squares, mut absolute) = (Vec::new(), Vec::new());
    for row in &pairs.rows {
        let Some(deviation) = row.measured.deviations[force.index()] else { continue };
        let count = row.measured.count.unwrap_or(1.0).max(1.0);
        let scatter = deviation / count.sqrt();
        squares.push(scatter * scatter);
        absolute.push(scatter / shrinkage(count) * (2.0 / std::f64::consts::PI).sqrt());
    }
    (!squares.is_empty()).then(|| NoiseFloor {
        mae: mean(&absolute),
        mse: mean(&squares),
        weight: squares.len() as f64,
        source: FloorSource::Deviations,
    })
}

/// c_4(n), by c_4(n) c_4(n + 1) = sqrt((n - 1) / n) from c_4(2) = sqrt(2 / pi); 1 for a deviation that is
/// stated for a single measurement, and within 1 % of 1 from 30.
fn shrinkage(count: f64) -> f64 {
    if !(2.0..30.0).contains(&count) {
        return 1.0;
    }
    let (mut found, mut reached) = ((2.0 / std::f64::consts::PI).sqrt(), 2.0);
    while reached + 0.5 < count {
        found = ((reached - 1.0) / reached).sqrt() / found;
        reached += 1.0;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pairing::{ForceRow, pair};
    use crate::random::Random;

    fn rows(repeats: usize, scatter: f64, deviation: Option<f64>) -> Vec<ForceRow> {
        let mut random = Random::new(2, &[]);
        (0..100 * repeats)
            .map(|k| {
                let cell = (k / repeats) as f64;
                let force = 100.0 + cell + scatter * random.normal();
                ForceRow {
                    cutting_speed: 1.0 + (cell / 10.0).floor(),
                    uncut_chip_thickness: 1e-4 * (1.0 + cell % 10.0),
                    forces: [force; 2],
                    deviations: [deviation; 2],
                    count: Some(4.0),
                }
            })
            .collect()
    }

    #[test]
    fn repeats_give_back_the_noise_they_were_made_with() {
        let simulated = rows(1, 0.0, None);
        let pairs = pair(&simulated, &rows(11, 5.0, Some(1.0))).unwrap();
        let floor = noise_floor(&pairs, ForceKind::Cutting).unwrap();
        // 1000 degrees of freedom: a variance to 4.5 %, taken three times. sqrt(2 / pi) 5 = 3.99.
        assert!((floor.mse / 25.0 - 1.0).abs() < 0.135, "{floor:?}");
        assert!((floor.mae / 3.99 - 1.0).abs() < 0.07, "{floor:?}");
        assert_eq!((floor.weight, floor.source), (1000.0, FloorSource::Repeats));
    }

    #[test]
    fn deviations_of_means_are_divided_by_the_root_of_their_number() {
        let simulated = rows(1, 0.0, None);
        let pairs = pair(&simulated, &rows(1, 0.0, Some(6.0))).unwrap();
        let floor = noise_floor(&pairs, ForceKind::Feed).unwrap();
        // c_4(3) = sqrt(pi) / 2, c_4(4) = sqrt(2 / 3) / c_4(3) = 0.9213.
        let expected = 3.0 / 0.921_317_7 * (2.0 / std::f64::consts::PI).sqrt();
        assert!((floor.mae - expected).abs() < 1e-6, "{floor:?}");
        assert!((floor.mse - 9.0).abs() < 1e-12 && floor.source == FloorSource::Deviations);
        assert_eq!(noise_floor(&pair(&simulated, &simulated).unwrap(), ForceKind::Feed), None);
    }
}
