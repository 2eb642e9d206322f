//! What forces over cutting speed and uncut chip thickness say: slopes and exponents with their intervals.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A force in N at a cutting speed in m/s and an uncut chip thickness in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcePoint {
    /// Cutting speed and uncut chip thickness.
    pub at: [f64; 2],
    /// The force.
    pub force: f64,
}

/// A number with the half width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrendEstimate {
    /// The number.
    pub value: f64,
    /// Student's t on the scatter about the fit; infinite where no degree of freedom is left.
    pub half_width: f64,
}

/// `force = offset + slope h` at one cutting speed, by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThicknessLine {
    /// In N/m.
    pub slope: TrendEstimate,
    /// In N.
    pub offset: TrendEstimate,
    /// Largest distance of a point from the line over the mean of the points.
    pub worst: f64,
}

/// `ln force = ln c + p ln v_c + q ln h` over all conditions, by least squares: p and q are the shares by which the force
/// grows when speed or thickness grows by a small share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// ln c, with force, speed and thickness in the units of the points.
    pub constant: TrendEstimate,
    /// p; `None` at a single speed.
    pub speed: Option<TrendEstimate>,
    /// q; `None` at a single thickness.
    pub thickness: Option<TrendEstimate>,
    /// Root of the mean square of what the law misses of the logarithms.
    pub spread: f64,
}

/// Speeds or thicknesses closer than this share are one.
const SAME: f64 = 1e-6;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// The line over h at `cutting_speed`; `None` with fewer than three thicknesses.
#[must_use]
pub fn line_over_thickness(points: &[ForcePoint], cutting_speed: f64) -> Option<ThicknessLine> {
    let there: Vec<&ForcePoint> =
        points.iter().filter(|point| same(point.at[0], cutting_speed)).collect();
    let rows: Vec<Vec<f64>> = there.iter().map(|point| vec![1.0, point.at[1]]).collect();
    let values: Vec<f64> = there.iter().map(|point| point.force).collect();
    let fit = (there.len() > 2).then(|| least_squares(&rows, &values)).flatten()?;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let worst = fit.residuals.iter().fold(0.0_f64, |worst, miss| worst.max(miss.abs()));
    Some(ThicknessLine {
        offset: fit.estimates[0],
        slope: fit.estimates[1],
        worst: worst / mean.abs(),
    })
}

/// The power law of all `points`; `None` if a force is not positive or there are too few.
#[must_use]
pub fn power_law(points: &[ForcePoint]) -> Option<PowerLaw> {
    let first = points.first()?;
    let varies = |k: usize| points.iter().any(|point| !same(point.at[k], first.at[k]));
    let used: Vec<usize> = (0..2).filter(|k| varies(*k)).collect();
    if used.is_empty() || points.iter().any(|point| point.force <= 0.0) {
        return None;
    }
    let row = |point: &ForcePoint| {
        std::iter::once(1.0).chain(used.iter().map(|k| point.at[*k].ln())).collect()
    };
    let rows: Vec<Vec<f64>> = points.iter().map(row).collect();
    let values: Vec<f64> = points.iter().map(|point| point.force.ln()).collect();
    let fit = (points.len() > used.len() + 1).then(|| least_squares(&rows, &values)).flatten()?;
    let of = |k: usize| used.iter().position(|other| *other == k).map(|at| fit.estimates[at + 1]);
    let square: f64 = fit.residuals.iter().map(|miss| miss * miss).sum();
    let spread = (square / points.len() as f64).sqrt();
    Some(PowerLaw { constant: fit.estimates[0], speed: of(0), thickness: of(1), spread })
}

struct Fit {
    estimates: Vec<TrendEstimate>,
    residuals: Vec<f64>,
}

/// Ordinary least squares with `s^2 (X' X)^-1` as the covariance; `None` if the columns do not tell the coefficients apart.
fn least_squares(rows: &[Vec<f64>], values: &[f64]) -> Option<Fit> {
    let (n, p) = (rows.len(), rows.first()?.len());
    // Columns of like size: thicknesses are 1e-4.
    let sizes: Vec<f64> =
        (0..p).map(|k| rows.iter().fold(0.0_f64, |size, row| size.max(row[k].abs()))).collect();
    if sizes.contains(&0.0) {
        return None;
    }
    let matrix = DMatrix::from_fn(n, p, |i, k| rows[i][k] / sizes[k]);
    let right = DVector::from_column_slice(values);
    let normal = (matrix.transpose() * &matrix).try_inverse()?;
    let solution = &normal * matrix.transpose() * &right;
    let residuals = &right - &matrix * &solution;
    let freedom = n - p;
    let factor = if freedom > 0 {
        StudentsT::new(0.0, 1.0, freedom as f64).ok()?.inverse_cdf(0.975)
            * (residuals.norm_squared() / freedom as f64).sqrt()
    } else {
        f64::INFINITY
    };
    let estimates = (0..p).map(|k| TrendEstimate {
        value: solution[k] / sizes[k],
        half_width: factor * normal[(k, k)].sqrt() / sizes[k],
    });
    Some(Fit { estimates: estimates.collect(), residuals: residuals.iter().copied().collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(force: impl Fn(f64, f64) -> f64) -> Vec<ForcePoint> {
        let at = [2.0, 2.5, 3.0].into_iter().flat_map(|v| [0.6e-4, 1e-4, 1.5e-4].map(|h| [v, h]));
        at.map(|at| ForcePoint { at, force: force(at[0], at[1]) }).collect()
    }

    #[test]
    fn a_plane_and_a_power_law_are_found_exactly() {
        let line = line_over_thickness(&grid(|_, h| 100.0 + 8.26e6 * h), 2.5).unwrap();
        assert!((line.slope.value / 8.26e6 - 1.0).abs() < 1e-12 && line.worst < 1e-12, "{line:?}");
        assert!(line.slope.half_width < 1e-3, "{line:?}");
        let law = power_law(&grid(|v, h| 5e6 * v.powf(-0.1) * h.powf(0.8))).unwrap();
        assert!((law.speed.unwrap().value + 0.1).abs() < 1e-10, "{law:?}");
        assert!((law.thickness.unwrap().value - 0.8).abs() < 1e-10, "{law:?}");
        assert!(line_over_thickness(&grid(|_, h| h), 7.0).is_none());
        let one_speed: Vec<ForcePoint> = grid(|_, h| h)[..3].to_vec();
        assert_eq!(power_law(&one_speed).unwrap().speed, None);
        assert!(power_law(&grid(|_, _| -1.0)).is_none());
    }

    /// By hand: x = 0, 1, 2 and y = 0, 2, 1 have slope 1/2, residuals -1/2, 1, -1/2, s^2 = 3/2, a variance of the slope of
    /// 3/4, and t(0.975, 1) is 12.7062.
    #[test]
    fn the_interval_of_a_slope_is_that_of_student() {
        let at = |h: f64, force: f64| ForcePoint { at: [1.0, h], force };
        let line = line_over_thickness(&[at(0.0, 0.0), at(1.0, 2.0), at(2.0, 1.0)], 1.0).unwrap();
        assert!((line.slope.value - 0.5).abs() < 1e-12);
        assert!((line.slope.half_width - 12.7062 * 0.75_f64.sqrt()).abs() < 1e-4, "{line:?}");
        assert!((line.worst - 1.0).abs() < 1e-12);
    }
}
