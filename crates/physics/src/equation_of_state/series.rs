//! How far the energy of the isentrope lies below that of the Hugoniot.
//!
//! With the compression `x = 1 - V/V_0`, the Hugoniot `p_H = K x/(1 - s x)^2`, its energy
//! `E_H = p_H x/2` per undeformed volume and a Gruneisen parameter `Gamma_0 V/V_0`, the isentrope
//! through the undeformed state obeys
//! ```text
//! dE_S/dx = p_S = p_H - Gamma_0 (E_H - E_S),   E_S(0) = 0
//! ```
//! The excess `D = E_H - E_S` then obeys
//! ```text
//! dD/dx = Gamma_0 D + K s x^2/(1 - s x)^3,     D(0) = 0
//! ```
//! which is of third order in x. Its power series `D = K sum d_n x^n`,
//! ```text
//! (n + 1) d_(n+1) = Gamma_0 d_n + s n (n - 1)/2 s^(n-2)
//! ```
//! has only positive terms and the radius of convergence 1/s.

/// Enough terms for rounding up to `s x` = [`LARGEST`].
const TERMS: usize = 160;
/// Where terms no longer change a sum.
const NEGLIGIBLE: f64 = 1e-17;
/// Largest s x of the series. The shock speed is then 2.5 times that of sound (Hugoniot pressures
/// above K/s, hundreds of GPa for a metal).
pub(super) const LARGEST: f64 = 0.6;

/// D/K of one material.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Excess {
    /// d_3, d_4, ...
    coefficients: Vec<f64>,
}

impl Excess {
    /// For the slope s of the shock speed and the Gruneisen parameter at rest.
    pub(super) fn new(slope: f64, gruneisen: f64) -> Self {
        let mut coefficients = Vec::with_capacity(TERMS);
        let (mut last, mut power) = (0.0, 1.0);
        for n in 2..2 + TERMS {
            let n = n as f64;
            last = (gruneisen * last + slope * 0.5 * n * (n - 1.0) * power) / (n + 1.0);
            power *= slope;
            coefficients.push(last);
        }
        Self { coefficients }
    }

    /// D/K at a compression from 0 to [`LARGEST`]/s.
    #[inline]
    pub(super) fn value(&self, compression: f64) -> f64 {
        let (mut sum, mut power) = (0.0, compression * compression * compression);
        for coefficient in &self.coefficients {
            let term = coefficient * power;
            sum += term;
            if term <= NEGLIGIBLE * sum {
                break;
            }
            power *= compression;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_series_solves_its_equation() {
        // D = K s e^(G x) int_0^x e^(-G y) y^2/(1 - s y)^3 dy, by Simpson's rule with 20000 intervals:
        // its error is below 1e-13 for these integrands (h^4 f''''/180).
        for (slope, gruneisen) in [(1.49, 1.67), (1.028, 1.23), (0.0, 2.0), (1.4, 0.0)] {
            let excess = Excess::new(slope, gruneisen);
            for compression in [1e-4, 0.01, 0.1, 0.3, LARGEST / 1.49] {
                let integrand = |y: f64| {
                    (gruneisen * (compression - y)).exp() * slope * y * y
                        / (1.0 - slope * y).powi(3)
                };
                let step = compression / 20_000.0;
                let sum: f64 = (0..10_000)
                    .map(|k| {
                        let left = 2.0 * f64::from(k) * step;
                        integrand(left)
                            + 4.0 * integrand(left + step)
                            + integrand(left + 2.0 * step)
                    })
                    .sum();
                let expected = sum * step / 3.0;
                assert_relative_eq!(excess.value(compression), expected, max_relative = 1e-11);
            }
        }
    }

    #[test]
    fn to_third_order_it_is_s_x_cubed_over_three() {
        let excess = Excess::new(1.5, 2.0);
        // d_4 = (Gamma d_3 + 3 s^2)/4 = (2 x 0.5 + 6.75)/4 = 1.9375
        let expected = 0.5e-9 + 1.9375e-12;
        assert_relative_eq!(excess.value(1e-3), expected, max_relative = 2e-5);
    }
}
