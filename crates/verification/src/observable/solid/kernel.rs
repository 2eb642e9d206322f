//! The smoothing kernel of a scenario.

use crate::evidence::Evidence;
use crate::observable::Observable;
use sphcut_sph::setup::Dimension;
use std::f64::consts::PI;

/// Integral over its support by the midpoint rule.
pub(crate) const KERNEL_INTEGRAL: Observable = Observable {
    name: "kernel_integral",
    unit: "",
    meaning: "integral of the kernel over its support (midpoint rule, 20,000 shells)",
    arguments: &[],
    evaluate: |evidence, _| Ok(integral(evidence)),
};

/// Analytic against numerical derivative.
pub(crate) const KERNEL_DERIVATIVE_ERROR: Observable = Observable {
    name: "kernel_derivative_error",
    unit: "",
    meaning: "largest deviation of the kernel's slope from a central difference, in terms of the \
              largest slope",
    arguments: &[],
    evaluate: |evidence, _| Ok(derivative_error(evidence)),
};

/// What is left outside of the support.
pub(crate) const KERNEL_OUTSIDE: Observable = Observable {
    name: "kernel_outside",
    unit: "",
    meaning: "sum of |W| and |W'|/r at 1 to 3 support radii",
    arguments: &[],
    evaluate: |evidence, _| {
        let (kernel, dimension) = (evidence.setup.discretisation.kernel, dimension(evidence));
        let outside = (0..=100).map(|index| 2.0 + 0.04 * f64::from(index));
        Ok(outside
            .map(|distance| {
                kernel.value(distance, 1.0, dimension).abs()
                    + kernel.weight(distance, 1.0, dimension).abs()
            })
            .sum())
    },
};

fn dimension(evidence: &Evidence) -> usize {
    match evidence.setup.dimension {
        Dimension::Two => 2,
        Dimension::Three => 3,
    }
}

fn integral(evidence: &Evidence) -> f64 {
    let (kernel, dimension) = (evidence.setup.discretisation.kernel, dimension(evidence));
    let (count, smoothing_length) = (20_000, evidence.setup.particle_spacing);
    let step = 2.0 * smoothing_length / f64::from(count);
    (0..count)
        .map(|index| {
            let radius = (f64::from(index) + 0.5) * step;
            let shell = if dimension == 2 { 2.0 * PI * radius } else { 4.0 * PI * radius.powi(2) };
            shell * kernel.value(radius, smoothing_length, dimension) * step
        })
        .sum()
}

fn derivative_error(evidence: &Evidence) -> f64 {
    let (kernel, dimension) = (evidence.setup.discretisation.kernel, dimension(evidence));
    let step = 1e-5;
    let (mut largest_slope, mut largest_error) = (0.0_f64, 0.0_f64);
    for index in 1..200 {
        let radius = 0.01 * f64::from(index);
        let slope = -radius * kernel.weight(radius, 1.0, dimension);
        let difference = (kernel.value(radius + step, 1.0, dimension)
            - kernel.value(radius - step, 1.0, dimension))
            / (2.0 * step);
        largest_slope = largest_slope.max(slope.abs());
        largest_error = largest_error.max((slope - difference).abs());
    }
    largest_error / largest_slope
}
