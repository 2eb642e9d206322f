//! Smoothing kernels. A kernel is one file; [`KernelChoice`] is the only registration.
//!
//! Every kernel has the support radius `2 h_s` and is normalised in 2D and 3D.

mod cubic_spline;
mod wendland_c2;

pub use cubic_spline::CubicSpline;
pub use wendland_c2::WendlandC2;

/// A radially symmetric kernel `W(r, h) = sigma_D / h^D f(q)`, `q = r / h`, zero for `q >= 2`.
pub trait Kernel {
    /// sigma_D: normalisation in `dimension` 2 or 3.
    fn normalisation(dimension: usize) -> f64;
    /// f(q).
    fn shape(q: f64) -> f64;
    /// -f'(q) / q, finite at q = 0: never divides by the distance.
    fn slope_over_q(q: f64) -> f64;
}

/// The kernels by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KernelChoice {
    /// [`CubicSpline`].
    CubicSpline,
    /// [`WendlandC2`].
    WendlandC2,
}

impl KernelChoice {
    /// All kernels with the name used in scenario files.
    pub const ALL: &[(&'static str, Self)] =
        &[("cubic_spline", Self::CubicSpline), ("wendland_c2", Self::WendlandC2)];

    /// W(r, h) in 1/m^D.
    #[must_use]
    pub fn value(self, distance: f64, smoothing_length: f64, dimension: usize) -> f64 {
        match self {
            Self::CubicSpline => value::<CubicSpline>(distance, smoothing_length, dimension),
            Self::WendlandC2 => value::<WendlandC2>(distance, smoothing_length, dimension),
        }
    }

    /// Puts the weights of pairs, [`KernelChoice::weight`], in the place of their squared distances in m^2; `lengths`: the
    /// smoothing length of each in m.
    #[inline(always)]
    pub(crate) fn weigh(self, squares: &mut [f64], lengths: &[f64], dimension: usize) {
        match self {
            Self::CubicSpline => weigh::<CubicSpline>(squares, lengths, dimension),
            Self::WendlandC2 => weigh::<WendlandC2>(squares, lengths, dimension),
        }
    }

    /// -W'(r, h) / r in 1/m^(D+2): the weight of a pair; finite at r = 0.
    #[must_use]
    pub fn weight(self, distance: f64, smoothing_length: f64, dimension: usize) -> f64 {
        match self {
            Self::CubicSpline => weight::<CubicSpline>(distance, smoothing_length, dimension),
            Self::WendlandC2 => weight::<WendlandC2>(distance, smoothing_length, dimension),
        }
    }
}

/// A kernel with its smoothing length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothing {
    pub(crate) kernel: KernelChoice,
    pub(crate) length: f64,
}

impl Smoothing {
    /// Radius of a round support in m.
    pub(crate) fn support(&self) -> f64 {
        2.0 * self.length
    }
}

fn value<K: Kernel>(distance: f64, smoothing_length: f64, dimension: usize) -> f64 {
    let volume = smoothing_length.powi(i32::try_from(dimension).expect("2 or 3"));
    K::normalisation(dimension) / volume * K::shape(distance / smoothing_length)
}

#[inline(always)]
fn weigh<K: Kernel>(squares: &mut [f64], lengths: &[f64], dimension: usize) {
    for (square, length) in squares.iter_mut().zip(lengths) {
        *square = weight::<K>(square.sqrt(), *length, dimension);
    }
}

#[inline(always)]
fn weight<K: Kernel>(distance: f64, smoothing_length: f64, dimension: usize) -> f64 {
    let volume = smoothing_length.powi(i32::try_from(dimension).expect("2 or 3"));
    K::normalisation(dimension) / (volume * smoothing_length * smoothing_length)
        * K::slope_over_q(distance / smoothing_length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    /// Radial integral by the midpoint rule: error of order (2/N)^2.
    fn integral(kernel: KernelChoice, dimension: usize) -> f64 {
        let (count, smoothing_length) = (20_000, 0.7);
        let step = 2.0 * smoothing_length / f64::from(count);
        (0..count)
            .map(|index| {
                let radius = (f64::from(index) + 0.5) * step;
                let shell =
                    if dimension == 2 { 2.0 * PI * radius } else { 4.0 * PI * radius * radius };
                shell * kernel.value(radius, smoothing_length, dimension) * step
            })
            .sum()
    }

    #[test]
    fn every_kernel_integrates_to_one() {
        for (name, kernel) in KernelChoice::ALL {
            for dimension in [2, 3] {
                let found = integral(*kernel, dimension);
                assert!((found - 1.0).abs() < 1e-7, "{name} in {dimension}D: {found}");
            }
        }
    }

    #[test]
    fn the_weight_is_minus_the_slope_over_the_distance() {
        let (smoothing_length, step) = (0.7, 1e-6);
        for (_, kernel) in KernelChoice::ALL {
            for dimension in [2, 3] {
                for radius in [0.05, 0.3, 0.69, 0.9, 1.3] {
                    let slope = (kernel.value(radius + step, smoothing_length, dimension)
                        - kernel.value(radius - step, smoothing_length, dimension))
                        / (2.0 * step);
                    let weight = kernel.weight(radius, smoothing_length, dimension);
                    // Central difference: truncation of order step^2, rounding of order 1e-16/step.
                    assert_relative_eq!(
                        weight,
                        -slope / radius,
                        max_relative = 1e-6,
                        epsilon = 1e-8
                    );
                }
            }
        }
    }

    #[test]
    fn support_is_compact_and_the_centre_is_finite() {
        for (_, kernel) in KernelChoice::ALL {
            assert_eq!(kernel.value(2.0, 1.0, 2), 0.0);
            assert_eq!(kernel.weight(2.5, 1.0, 3), 0.0);
            assert!(kernel.weight(0.0, 1.0, 2).is_finite());
        }
    }
}
