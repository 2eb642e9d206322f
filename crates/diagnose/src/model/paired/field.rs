//! A quantity over cutting speed and uncut chip thickness, smoothed through scattered values at a few of them.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use sphcut_physics::CuttingCondition;

/// Length over which a bend changes, in shares of the support.
const LENGTH: f64 = 0.7;
/// How far beyond the support a change goes on along its slope, in shares of it.
const BEYOND: f64 = 0.25;

/// The support in ln v_c and ln h.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RunSupport {
    low: [f64; 2],
    span: [f64; 2],
}

impl RunSupport {
    pub fn of(conditions: impl Iterator<Item = CuttingCondition>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for condition in conditions {
            for (axis, value) in raw(&condition).into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        let span = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-9));
        Self { low, span }
    }

    /// From -1/2 to 1/2 within the support.
    pub fn place(&self, condition: &CuttingCondition) -> [f64; 2] {
        let raw = raw(condition);
        [0, 1].map(|axis| (raw[axis] - self.low[axis]) / self.span[axis] - 0.5)
    }

    /// The same, at most a little beyond the support.
    pub fn near(&self, condition: &CuttingCondition) -> [f64; 2] {
        self.place(condition).map(|z| z.clamp(-0.5 - BEYOND, 0.5 + BEYOND))
    }
}

fn raw(condition: &CuttingCondition) -> [f64; 2] {
    [condition.cutting_speed.ln(), condition.uncut_chip_thickness.ln()]
}

/// Standard deviations of the parts of a field before its values are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FieldPrior {
    pub constant: f64,
    pub slope: f64,
    pub bend: f64,
}

impl FieldPrior {
    fn covariance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let apart: f64 = (0..2).map(|k| (a[k] - b[k]).powi(2)).sum();
        self.constant.powi(2)
            + self.slope.powi(2) * (a[0] * b[0] + a[1] * b[1])
            + self.bend.powi(2) * (-0.5 * apart / (LENGTH * LENGTH)).exp()
    }
}

/// A normal process with constant, slopes and bends through noisy values (Rasmussen and Williams 2006, chapter 2); of several
/// laws that of the greatest evidence.
#[derive(Debug, Clone)]
pub(crate) struct ChannelField {
    places: Vec<[f64; 2]>,
    law: FieldPrior,
    known: Cholesky<f64, Dyn>,
    weights: DVector<f64>,
    mean: f64,
}

impl ChannelField {
    /// Through `values` with their `variances`; `None` without values or with one that is not a number.
    pub fn through(
        places: &[[f64; 2]],
        (values, variances): (&[f64], &[f64]),
        mean: f64,
        laws: &[FieldPrior],
    ) -> Option<Self> {
        if places.is_empty() || values.iter().chain(variances).any(|x| !x.is_finite()) {
            return None;
        }
        let deviation = DVector::from_iterator(values.len(), values.iter().map(|y| y - mean));
        let of = |law: FieldPrior| {
            let covariance = DMatrix::from_fn(places.len(), places.len(), |i, j| {
                law.covariance(places[i], places[j]) + if i == j { variances[i] } else { 0.0 }
            });
            let known = covariance.cholesky()?;
            let weights = known.solve(&deviation);
            // But for a constant.
            let spread: f64 = known.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
            let evidence = -0.5 * (deviation.dot(&weights) + spread);
            Some((evidence, Self { places: places.to_vec(), law, known, weights, mean }))
        };
        let best = laws.iter().filter_map(|&law| of(law)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(best.1)
    }

    fn toward(&self, place: [f64; 2]) -> DVector<f64> {
        let all = self.places.iter().map(|&known| self.law.covariance(known, place));
        DVector::from_iterator(self.places.len(), all)
    }

    /// Its expectation.
    pub fn value(&self, place: [f64; 2]) -> f64 {
        self.mean + self.toward(place).dot(&self.weights)
    }

    /// The covariance of what is not known of it.
    pub fn uncertainty(&self, places: &[[f64; 2]]) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = places.iter().map(|&place| self.toward(place)).collect();
        let toward = DMatrix::from_columns(&columns);
        let told = toward.tr_mul(&self.known.solve(&toward));
        DMatrix::from_fn(places.len(), places.len(), |i, j| {
            self.law.covariance(places[i], places[j]) - told[(i, j)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Vec<[f64; 2]> {
        (0..9).map(|k| [0.5 * f64::from(k % 3) - 0.5, 0.5 * f64::from(k / 3) - 0.5]).collect()
    }

    const LAWS: [FieldPrior; 4] = [
        FieldPrior { constant: 0.3, slope: 0.1, bend: 0.005 },
        FieldPrior { constant: 0.01, slope: 0.01, bend: 0.0025 },
        FieldPrior { constant: 0.1, slope: 0.1, bend: 0.025 },
        FieldPrior { constant: 1.0, slope: 1.0, bend: 0.25 },
    ];

    #[test]
    fn a_plane_with_small_noise_is_found_and_known_well() {
        let plane = |z: [f64; 2]| 0.2 + 0.3 * z[0] - 0.1 * z[1];
        let values: Vec<f64> = grid().into_iter().map(plane).collect();
        let field = ChannelField::through(&grid(), (&values, &[1e-8; 9]), 0.0, &LAWS).unwrap();
        for place in [[0.1, 0.2], [-0.4, 0.45], [0.7, -0.7]] {
            assert!((field.value(place) - plane(place)).abs() < 0.01, "{place:?}");
        }
        let inside = field.uncertainty(&[[0.1, 0.2]])[(0, 0)].sqrt();
        let outside = field.uncertainty(&[[1.5, 1.5]])[(0, 0)].sqrt();
        assert!(inside < 0.005 && outside > 10.0 * inside, "{inside} {outside}");
    }

    /// What is small beside its scatter is taken for nearly nothing, and the mean of nine is known three times better than one.
    #[test]
    fn noise_is_smoothed() {
        let noise = [0.03, -0.02, 0.01, -0.03, 0.02, -0.01, 0.0, 0.02, -0.02];
        let field = ChannelField::through(&grid(), (&noise, &[4e-4; 9]), 0.0, &LAWS).unwrap();
        assert_eq!(field.law, LAWS[1]);
        assert!(field.value([0.0, 0.0]).abs() < 0.005);
        let level: Vec<f64> = noise.iter().map(|e| 0.5 + e).collect();
        let field = ChannelField::through(&grid(), (&level, &[4e-4; 9]), 0.0, &LAWS).unwrap();
        let sure = field.uncertainty(&[[0.0, 0.0]])[(0, 0)].sqrt();
        assert!((0.005..0.015).contains(&sure), "{sure}");
    }

    #[test]
    fn places_are_scaled_by_the_support() {
        let at = |v: f64, h: f64| CuttingCondition::new(v, h);
        let support = RunSupport::of([at(1.0, 1e-5), at(4.0, 4e-5)].into_iter());
        let [x, y] = support.place(&at(2.0, 2e-5));
        assert!(x.abs() < 1e-12 && y.abs() < 1e-12);
        assert!((support.near(&at(100.0, 1e-5))[0] - 0.75).abs() < 1e-12);
    }
}
