//! Temperature around a moving heat source.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments};
use sphcut_sph::setup::{HeatSourceForm, Vector};
use std::f64::consts::TAU;

/// Deviation from the superposition of instantaneous sources.
pub(crate) const MOVING_SOURCE_ERROR: Observable = Observable {
    name: "moving_source_error",
    unit: "",
    meaning: "root mean square deviation from the temperature around the first heat source \
              (Gaussian) in an infinite plane of the first material, in terms of the highest \
              exact rise",
    arguments: &[],
    evaluate: moving_source_error,
};

/// A Gaussian source that has moved over an infinite plane since t = 0.
///
/// Every instant leaves a Gaussian that spreads (Carslaw and Jaeger 1959, section 10.3):
/// ```text
/// T - T_0 = int_0^t P / (rho cp 2 pi s(u)^2) exp(-|x - c(t - u)|^2 / (2 s(u)^2)) du
/// s(u)^2 = s_0^2 + 2 a u,   c(t) = c_0 + v t
/// ```
/// For t to infinity and s_0 to zero this is Rosenthal's P/(2 pi k) exp(-v xi / 2a) K_0(v r / 2a),
/// xi the distance ahead of the source.
struct Track {
    /// P / (rho cp) in K m^2/s.
    strength: f64,
    /// a in m^2/s.
    diffusivity: f64,
    /// s_0 in m.
    width: f64,
    centre: Vector,
    velocity: Vector,
}

/// Steps of the quadrature over the shortest of its time scales: Simpson's rule is then 1e-6 off.
const RESOLUTION: f64 = 10.0;

impl Track {
    /// Rise of the temperature at `position` and `time` in K.
    fn rise(&self, position: &Vector, time: f64) -> f64 {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        let scale =
            (self.width * self.width / (2.0 * self.diffusivity)).min(self.width / speed).min(time);
        let pairs = (RESOLUTION * time / scale).ceil() as usize;
        let step = time / (2 * pairs) as f64;
        let instant = |index: usize| {
            let age = step * index as f64;
            let spread = self.width * self.width + 2.0 * self.diffusivity * age;
            let square: f64 = (0..2)
                .map(|k| (position[k] - self.centre[k] - self.velocity[k] * (time - age)).powi(2))
                .sum();
            self.strength / (TAU * spread) * (-0.5 * square / spread).exp()
        };
        let inner: f64 = (1..2 * pairs)
            .map(|index| if index % 2 == 1 { 4.0 } else { 2.0 } * instant(index))
            .sum();
        step / 3.0 * (instant(0) + inner + instant(2 * pairs))
    }
}

fn moving_source_error(evidence: &Evidence, _: &ObservableArguments) -> Result<f64, String> {
    let source = evidence.setup.heat_sources.first().ok_or("the case needs a heat source")?;
    let HeatSourceForm::Gaussian { centre, standard_deviation } = &source.form else {
        return Err("the heat source has to be Gaussian".to_owned());
    };
    let body = evidence.setup.bodies.first().ok_or("the case needs a body")?;
    let material = &evidence.setup.materials[body.material];
    let capacity = material.density * material.specific_heat;
    let track = Track {
        strength: source.power / capacity,
        diffusivity: material.thermal_conductivity / capacity,
        width: *standard_deviation,
        centre: *centre,
        velocity: source.velocity,
    };
    let last = evidence.last()?;
    let (mut squares, mut highest) = (0.0, 0.0_f64);
    for (position, temperature) in last.position.iter().zip(&last.temperature) {
        let exact = track.rise(position, last.time);
        squares += (temperature - body.temperature - exact).powi(2);
        highest = highest.max(exact);
    }
    Ok((squares / last.position.len() as f64).sqrt() / highest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// K_0(x) = int_0^inf exp(-x cosh t) dt by the trapezoidal rule, which converges
    /// exponentially here (Abramowitz and Stegun 9.6.24).
    fn bessel_k0(x: f64) -> f64 {
        let step = 0.05;
        let sum: f64 = (1..200).map(|i| (-x * (step * f64::from(i)).cosh()).exp()).sum();
        step * (0.5 * (-x).exp() + sum)
    }

    #[test]
    fn the_bessel_function_has_its_tabulated_values() {
        // Abramowitz and Stegun, table 9.8.
        for (x, value) in [(0.1, 2.427_069_024_7), (1.0, 0.421_024_438_2), (2.0, 0.113_893_872_7)] {
            assert_relative_eq!(bessel_k0(x), value, max_relative = 1e-9);
        }
    }

    #[test]
    fn a_narrow_source_that_moved_for_long_is_rosenthals() {
        let (diffusivity, speed): (f64, f64) = (1e-5, 0.04);
        let track = Track {
            strength: 1.0,
            diffusivity,
            width: 2e-5,
            centre: [0.0; 3],
            velocity: [speed, 0.0, 0.0],
        };
        // The time scale of the wake is 4 a / v^2 = 25 ms; after 1 s the rest is below exp(-40).
        let time = 1.0;
        for (ahead, beside) in [(0.3e-3, 0.0), (0.0, 0.5e-3), (-1.0e-3, 0.2e-3), (-2e-3, 0.0)] {
            let found = track.rise(&[speed * time + ahead, beside, 0.0], time);
            let radius = f64::hypot(ahead, beside);
            let peclet = 0.5 * speed / diffusivity;
            let exact =
                1.0 / (TAU * diffusivity) * (-peclet * ahead).exp() * bessel_k0(peclet * radius);
            // The finite width counts with s^2/2 (v/a)^2 = 0.32 % ahead, less elsewhere.
            assert_relative_eq!(found, exact, max_relative = 5e-3);
        }
    }
}
