//! Where the residual is more than chance.

use crate::inference::places::{AXES, scaled_places};
use crate::inference::problem::RegressionProblem;
use crate::inference::templates::Templates;
use nalgebra::DVector;
use sphcut_physics::Channel;
use statrs::distribution::{ContinuousCDF, Normal};

/// Expected share of false discoveries.
const FALSE_SHARE: f64 = 0.05;
/// Points of the map along log v_c and log h.
const MAP: [usize; 2] = [24, 18];
/// Width of the window of the map in shares of the ranges.
const WINDOW: f64 = 0.15;

/// A pattern of residuals that was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Contrast {
    /// The channel.
    pub channel: Channel,
    /// The pattern: `v`, `h`, `v^2`, `v h`, `h^2`, a corner, `order`, `cut length`, `rake`, `edge radius`, `v rake` and so on.
    pub pattern: &'static str,
    /// Standard deviations from 0; positive where the measured value lies above the model.
    pub score: f64,
    /// Probability of as much by chance.
    pub chance: f64,
    /// Whether it survives Benjamini and Hochberg.
    pub discovered: bool,
}

/// The residual around a condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// Standard deviations from 0.
    pub score: f64,
}

/// Where model and measurement differ.
#[derive(Debug, Clone, PartialEq)]
pub struct Location {
    /// All patterns, the strongest first.
    pub contrasts: Vec<Contrast>,
    /// Map of each channel, v_c changing fastest.
    pub maps: Vec<(Channel, Vec<MapPoint>)>,
    /// Points of a map along v_c and h.
    pub shape: [usize; 2],
}

/// Which of `chances` are discoveries when a share q of the discoveries may be false: with the chances in rising order
/// all up to the last k with p_k <= q k / m (Benjamini and Hochberg, J. R. Stat. Soc. B 57 (1995) 289-300).
#[must_use]
pub fn benjamini_hochberg(chances: &[f64], q: f64) -> Vec<bool> {
    let mut sorted = chances.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = chances.len() as f64;
    let limit = sorted
        .iter()
        .enumerate()
        .filter(|(k, p)| **p <= q * (*k as f64 + 1.0) / count)
        .map(|(_, p)| *p)
        .fold(f64::NEG_INFINITY, f64::max);
    chances.iter().map(|p| *p <= limit).collect()
}

/// Scores each contrast c of the deviation d from the model at the means of its nuisances, V = Sigma + G G':
///
/// ```text
/// z = c' V^-1 d / sqrt(c' V^-1 c)
/// ```
///
/// which is standard normal if nothing is missing. V lets the nuisances take what they can explain, and V^-1 d is
/// Sigma^-1 times the residual of the null fit. A place is evidence, never an explanation: the fit of the nuisances moves
/// an effect that lives at small h to where they cannot follow.
#[must_use]
pub fn locate(
    problem: &RegressionProblem,
    templates: &Templates,
    signal: &DVector<f64>,
) -> Location {
    let places = scaled_places(problem);
    let normal = Normal::new(0.0, 1.0).expect("a standard deviation of 1");
    let score = |contrast: DVector<f64>| {
        let white = templates.whiten(&contrast);
        let norm = white.norm();
        if norm > 0.0 { white.dot(signal) / norm } else { 0.0 }
    };
    let mut contrasts = Vec::new();
    let channels = problem.channels();
    for &channel in &channels {
        for (pattern, contrast) in patterns(problem, &places, channel) {
            let score = score(contrast);
            let chance = 2.0 * normal.cdf(-score.abs());
            contrasts.push(Contrast { channel, pattern, score, chance, discovered: false });
        }
    }
    let chances: Vec<f64> = contrasts.iter().map(|contrast| contrast.chance).collect();
    for (contrast, found) in contrasts.iter_mut().zip(benjamini_hochberg(&chances, FALSE_SHARE)) {
        contrast.discovered = found;
    }
    contrasts.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()));
    let maps =
        channels.iter().map(|&channel| (channel, map(problem, &places, channel, &score))).collect();
    Location { contrasts, maps, shape: MAP }
}

fn is_of(problem: &RegressionProblem, row: usize, channel: Channel) -> bool {
    problem.rows[row].channel == channel && problem.is_diagnosed(row)
}

type Value<'a> = &'a dyn Fn(usize) -> f64;

/// The patterns that the design of a channel can show.
fn patterns(
    problem: &RegressionProblem,
    places: &[[f64; AXES]],
    channel: Channel,
) -> Vec<(&'static str, DVector<f64>)> {
    let centred = |row: usize, axis: usize| 2.0 * places[row][axis] - 1.0;
    let (v, h) = (|row| centred(row, 0), |row| centred(row, 1));
    // A corner is the outer third of both ranges.
    let corner = |row: usize, signs: [f64; 2]| {
        f64::from(signs[0] * v(row) > 1.0 / 3.0 && signs[1] * h(row) > 1.0 / 3.0)
    };
    let (rake, edge) = (|row| centred(row, 3), |row| centred(row, 4));
    let wanted: [(&'static str, Value<'_>); 17] = [
        ("v", &v),
        ("h", &h),
        ("v^2", &|row| v(row) * v(row)),
        ("v h", &|row| v(row) * h(row)),
        ("h^2", &|row| h(row) * h(row)),
        ("low v, low h", &|row| corner(row, [-1.0, -1.0])),
        ("high v, low h", &|row| corner(row, [1.0, -1.0])),
        ("low v, high h", &|row| corner(row, [-1.0, 1.0])),
        ("high v, high h", &|row| corner(row, [1.0, 1.0])),
        ("order", &|row| problem.rows[row].order),
        ("cut length", &|row| places[row][2]),
        ("rake", &rake),
        ("v rake", &|row| v(row) * rake(row)),
        ("h rake", &|row| h(row) * rake(row)),
        ("edge radius", &edge),
        ("v edge radius", &|row| v(row) * edge(row)),
        ("h edge radius", &|row| h(row) * edge(row)),
    ];
    let rows: Vec<usize> =
        (0..problem.rows.len()).filter(|&row| is_of(problem, row, channel)).collect();
    let mut shown: Vec<(&'static str, DVector<f64>)> = Vec::new();
    for (pattern, value) in wanted {
        let mean = rows.iter().map(|&row| value(row)).sum::<f64>() / rows.len() as f64;
        let mut contrast = DVector::zeros(problem.rows.len());
        rows.iter().for_each(|&row| contrast[row] = value(row) - mean);
        if contrast.amax() > 1e-9 && !shown.iter().any(|(_, other)| is_parallel(&contrast, other)) {
            shown.push((pattern, contrast));
        }
    }
    shown
}

/// Whether two patterns ask the same: with one thickness a twist over speed and thickness is a slope over the speed.
fn is_parallel(a: &DVector<f64>, b: &DVector<f64>) -> bool {
    a.dot(b).abs() > (1.0 - 1e-9) * a.norm() * b.norm()
}

/// The score of a window around each point of the map.
fn map(
    problem: &RegressionProblem,
    places: &[[f64; AXES]],
    channel: Channel,
    score: &dyn Fn(DVector<f64>) -> f64,
) -> Vec<MapPoint> {
    let rows: Vec<usize> =
        (0..problem.rows.len()).filter(|&row| is_of(problem, row, channel)).collect();
    let range = |value: &dyn Fn(usize) -> f64| {
        (0..problem.rows.len())
            .map(value)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let speeds = range(&|row| problem.condition(row).cutting_speed.ln());
    let sizes = range(&|row| problem.condition(row).uncut_chip_thickness.ln());
    let mut points = Vec::with_capacity(MAP[0] * MAP[1]);
    for j in 0..MAP[1] {
        for i in 0..MAP[0] {
            let at = [i as f64 / (MAP[0] - 1) as f64, j as f64 / (MAP[1] - 1) as f64];
            let mut window = DVector::zeros(problem.rows.len());
            for &row in &rows {
                let square = (places[row][0] - at[0]).powi(2) + (places[row][1] - at[1]).powi(2);
                window[row] = (-0.5 * square / (WINDOW * WINDOW)).exp();
            }
            let value = |(low, high): (f64, f64), share: f64| (low + share * (high - low)).exp();
            points.push(MapPoint {
                cutting_speed: value(speeds, at[0]),
                uncut_chip_thickness: value(sizes, at[1]),
                score: score(window),
            });
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the paper (Section 4.1): 15 comparisons of thrombolysis; four are discoveries at q = 0.05, the
    /// last of them at 0.0095 < 0.05 4 / 15 = 0.0133.
    #[test]
    fn the_worked_example_of_benjamini_and_hochberg() {
        let chances = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262,
            0.5719, 0.6528, 0.7590, 1.0,
        ];
        let found = benjamini_hochberg(&chances, 0.05);
        assert_eq!(found.iter().filter(|f| **f).count(), 4);
        assert!(found[..4].iter().all(|f| *f));
        let mut shuffled = chances;
        shuffled.reverse();
        assert!(benjamini_hochberg(&shuffled, 0.05)[11..].iter().all(|f| *f));
        assert!(benjamini_hochberg(&[], 0.05).is_empty());
    }
}
