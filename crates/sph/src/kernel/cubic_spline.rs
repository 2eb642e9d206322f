//! The cubic B-spline (Monaghan and Lattanzio 1985).

use super::Kernel;
use std::f64::consts::PI;

/// `f = 1 - 3/2 q^2 + 3/4 q^3` for q < 1, `(2 - q)^3 / 4` for q < 2;
/// sigma = 10/(7 pi) in 2D and 1/pi in 3D.
#[derive(Debug, Clone, Copy)]
pub struct CubicSpline;

impl Kernel for CubicSpline {
    fn normalisation(dimension: usize) -> f64 {
        if dimension == 2 { 10.0 / (7.0 * PI) } else { 1.0 / PI }
    }

    fn shape(q: f64) -> f64 {
        if q < 1.0 {
            1.0 - 1.5 * q * q + 0.75 * q * q * q
        } else {
            0.25 * (2.0 - q).max(0.0).powi(3)
        }
    }

    fn slope_over_q(q: f64) -> f64 {
        if q < 1.0 { 3.0 - 2.25 * q } else { 0.75 * (2.0 - q).max(0.0).powi(2) / q }
    }
}
