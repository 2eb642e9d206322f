//! The Wendland C2 kernel.

use super::Kernel;
use std::f64::consts::PI;

/// `f = (1 - q/2)^4 (1 + 2 q)` for q < 2; sigma = 7/(4 pi) in 2D and 21/(16 pi) in 3D
/// (Wendland 1995; Dehnen and Aly 2012: no pairing instability).
#[derive(Debug, Clone, Copy)]
pub struct WendlandC2;

impl Kernel for WendlandC2 {
    fn normalisation(dimension: usize) -> f64 {
        if dimension == 2 { 7.0 / (4.0 * PI) } else { 21.0 / (16.0 * PI) }
    }

    fn shape(q: f64) -> f64 {
        (1.0 - 0.5 * q).max(0.0).powi(4) * (1.0 + 2.0 * q)
    }

    /// f' = -5 q (1 - q/2)^3.
    fn slope_over_q(q: f64) -> f64 {
        5.0 * (1.0 - 0.5 * q).max(0.0).powi(3)
    }
}
