//! A spindle that does not run true.

use super::ProcessEntry;
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// u(t) = a sin(n Omega t)
/// ```
/// u: displacement of the tool along the feed direction, into the machined surface where positive, in m; a: amplitude;
/// Omega: spindle speed in rad/s; n: periods per revolution (1: eccentricity, 2: ovality of the workpiece or of the
/// spindle). It begins at zero, so the tool starts at its place. Kinematics only: no inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunOut {
    /// a in m.
    pub amplitude: f64,
    /// n Omega in rad/s.
    pub angular_frequency: f64,
}

impl RunOut {
    /// From checked values of the table.
    #[must_use]
    pub fn from_values(values: &Values) -> Self {
        Self {
            amplitude: values.get("amplitude"),
            angular_frequency: values.get("periods_per_revolution") * values.get("spindle_speed"),
        }
    }

    /// u in m at `time` in s.
    #[must_use]
    pub fn displacement(&self, time: f64) -> f64 {
        self.amplitude * (self.angular_frequency * time).sin()
    }

    /// Largest velocity in m/s.
    #[must_use]
    pub fn largest_velocity(&self) -> f64 {
        self.amplitude * self.angular_frequency
    }
}

/// `[tool.run_out]`.
pub const RUN_OUT: ProcessEntry = ProcessEntry {
    key: "run_out",
    title: "Run-out of the spindle",
    equation: "u = a sin(n Omega t), along the feed direction",
    source: "kinematics of an eccentric rotation",
    validity: "small against the radius of the rotation: the tool moves straight, normal to the surface; no inertia",
    parameters: &[
        Parameter {
            key: "amplitude",
            symbol: "a",
            quantity: Quantity::Length,
            range: Range::closed(0.0, 1e-3),
            default: None,
            meaning: "amplitude of the displacement, half of the total indicated run-out",
            source: "user: a dial gauge",
        },
        Parameter {
            key: "spindle_speed",
            symbol: "Omega",
            quantity: Quantity::AngularSpeed,
            range: Range::above(0.0, 1e6),
            default: None,
            meaning: "rotational speed of the spindle",
            source: "user",
        },
        Parameter {
            key: "periods_per_revolution",
            symbol: "n",
            quantity: Quantity::Dimensionless,
            range: Range::above(0.0, 1e4),
            default: Some(1.0),
            meaning: "periods of the displacement per revolution",
            source: "1 is an eccentric spindle, 2 an oval one",
        },
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_is_a_sine_of_the_spindle() {
        // 5 um at 6000 rpm = 100 Hz: largest after a quarter of 10 ms.
        let values = Values::resolve(
            RUN_OUT.parameters,
            &[("amplitude", 5e-6), ("spindle_speed", 6000.0 / 60.0 * std::f64::consts::TAU)],
        )
        .unwrap();
        let path = RunOut::from_values(&values);
        assert_eq!(path.displacement(0.0), 0.0);
        assert!((path.displacement(2.5e-3) - 5e-6).abs() < 1e-18);
        assert!(path.displacement(5e-3).abs() < 1e-18);
        // 5 um x 628.32 rad/s = 3.1416 mm/s
        assert!((path.largest_velocity() - 3.1416e-3).abs() < 1e-7);
    }
}
