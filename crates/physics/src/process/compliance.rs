//! A tool holder that gives way: mass, spring and damper.

use super::ProcessEntry;
use crate::{Parameter, Quantity, Range, Values};
use std::f64::consts::TAU;

/// ```text
/// m u'' + 2 D sqrt(k m) u' + k u = F
/// ```
/// u: displacement of the tool from its prescribed path along one direction in m; F: force on the tool along
/// it in N. Under a constant force it comes to rest at `F / k`; it swings with `sqrt(k/m) / 2 pi`.
///
/// One degree of freedom for each direction, without coupling; the tool does not turn. Source: the
/// textbook model of machine-tool vibrations (Altintas, Manufacturing Automation, 2012, chapter 3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// k in N/m.
    pub stiffness: f64,
    /// m in kg: what moves with the tool.
    pub mass: f64,
    /// D, share of the critical damping.
    pub damping_ratio: f64,
}

impl Oscillator {
    /// From checked values of the table.
    #[must_use]
    pub fn from_values(values: &Values) -> Self {
        Self {
            stiffness: values.get("stiffness"),
            mass: values.get("moving_mass"),
            damping_ratio: values.get("damping_ratio"),
        }
    }

    /// u'' in m/s^2.
    #[must_use]
    pub fn acceleration(&self, deflection: f64, velocity: f64, force: f64) -> f64 {
        let damping = 2.0 * self.damping_ratio * (self.stiffness * self.mass).sqrt();
        (force - damping * velocity - self.stiffness * deflection) / self.mass
    }

    /// Natural frequency without damping in Hz.
    #[must_use]
    pub fn natural_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt() / TAU
    }
}

/// `[tool.compliance.cutting]` and `[tool.compliance.feed]`.
pub const COMPLIANCE: ProcessEntry = ProcessEntry {
    key: "compliance",
    title: "Compliance of machine and tool holder",
    equation: "m u'' + 2 D sqrt(k m) u' + k u = F, along the cutting and the feed direction",
    source: "Altintas, Manufacturing Automation, Cambridge 2012, chapter 3",
    validity: "one degree of freedom per direction, no coupling, no rotation of the tool; the workpiece is rigid",
    parameters: &[
        Parameter {
            key: "stiffness",
            symbol: "k",
            quantity: Quantity::Stiffness,
            range: Range::above(0.0, 1e12),
            default: None,
            meaning: "static stiffness of machine and holder along this direction",
            source: "user: a measured deflection under a known force; 10 to 100 N/um are usual",
        },
        Parameter {
            key: "moving_mass",
            symbol: "m",
            quantity: Quantity::Mass,
            range: Range::above(0.0, 1e5),
            default: None,
            meaning: "mass that moves with the tool: k over the square of the angular natural frequency",
            source: "user: a measured natural frequency",
        },
        Parameter {
            key: "damping_ratio",
            symbol: "D",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 10.0),
            default: Some(0.03),
            meaning: "damping in terms of the critical one",
            source: "a few per cent are usual for machine tools (Altintas 2012)",
        },
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spring_holds_the_force_at_rest() {
        let holder = Oscillator { stiffness: 20e6, mass: 2.0, damping_ratio: 0.03 };
        // 400 N / 20 N/um = 20 um.
        assert!(holder.acceleration(20e-6, 0.0, 400.0).abs() < 1e-12);
        // sqrt(20e6 / 2) / 2 pi = 3162.3 / 6.2832 = 503.29 Hz
        assert!((holder.natural_frequency() - 503.29).abs() < 0.01);
        // The damper resists: 2 x 0.03 sqrt(4e7) = 379.47 N s/m, on 2 kg at 0.1 m/s: -18.974 m/s^2
        assert!((holder.acceleration(0.0, 0.1, 0.0) + 18.974).abs() < 1e-3);
    }
}
