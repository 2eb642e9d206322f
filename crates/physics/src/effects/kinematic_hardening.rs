//! Kinematic hardening: a back stress that moves the yield surface.

use super::{Action, EffectEntry};
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// f = sqrt(3/2) |S - X| - sigma_y <= 0
/// dX = 2/3 C d(eps_p) - g X dp
/// ```
/// p: equivalent plastic strain. Armstrong and Frederick, CEGB report RD/B/N731 (1966), reprinted in
/// Mater. High Temp. 24 (2007) 1-26. Under monotonic load the equivalent back stress is
/// `C/g (1 - exp(-g p))`: it adds C/g to the strength at large strain, and a reversed load yields
/// twice that earlier than the isotropic law alone (Bauschinger effect). A law fitted to monotonic tests has to give
/// up C/g of its own strength for it.
///
/// The step is implicit: `X_1 = (X_0 + 2/3 C de_p) / (1 + g dp)`. Neglected: C and g that depend on
/// temperature (the back stress of hot material stays), several back stresses, ratchetting. The flow
/// stress that friction and hourglass control compare with is sigma_y, without the back stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinematicHardening {
    /// C in Pa.
    pub kinematic_modulus: f64,
    /// g.
    pub recall: f64,
}

impl KinematicHardening {
    pub(super) fn from_values(values: &Values) -> Self {
        Self { kinematic_modulus: values.get("kinematic_modulus"), recall: values.get("recall") }
    }

    /// 1 / (1 + g dp): what of a back stress a plastic increment leaves.
    #[inline]
    #[must_use]
    pub fn remaining(&self, plastic_increment: f64) -> f64 {
        1.0 / (1.0 + self.recall * plastic_increment)
    }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "kinematic_hardening",
    title: "Kinematic hardening (Armstrong-Frederick)",
    equation: "sqrt(3/2) |S - X| = sigma_y, dX = 2/3 C d(eps_p) - g X dp",
    source: "Armstrong and Frederick, CEGB report RD/B/N731 (1966); Mater. High Temp. 24 (2007) 1-26",
    validity: "one back stress, at all temperatures the same; the law below it has to be fitted \
               without the share C/g",
    signature: "springback and residual stress change; forces rise by the added hardening",
    parameters: &[
        Parameter {
            key: "kinematic_modulus",
            symbol: "C",
            quantity: Quantity::Stress,
            range: Range::closed(0.0, 1e12),
            default: None,
            meaning: "initial slope of the back stress over plastic strain",
            source: "cyclic test",
        },
        Parameter {
            key: "recall",
            symbol: "g",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 1e4),
            default: None,
            meaning: "rate at which plastic strain recalls the back stress; it saturates at C/g",
            source: "cyclic test",
        },
    ],
    example: &[("kinematic_modulus", 2e9), ("recall", 20.0)],
    vanishing: &[("kinematic_modulus", 0.0)],
    demands: &[],
    action: Action::KinematicHardening(KinematicHardening::from_values),
    candidate: None,
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_back_stress_saturates_at_modulus_over_recall() {
        let law = KinematicHardening { kinematic_modulus: 2e9, recall: 20.0 };
        // Uniaxial: X_1 = (X_0 + C dp)/(1 + g dp); dX/dp = C - g X gives C/g (1 - exp(-g p)).
        let steps = 100_000;
        let increment = 0.1 / f64::from(steps);
        let mut back_stress = 0.0;
        for _ in 0..steps {
            back_stress =
                (back_stress + law.kinematic_modulus * increment) * law.remaining(increment);
        }
        // 100 MPa (1 - exp(-2)) = 86.4665 MPa; the implicit step errs by g dp/2 = 1e-5 of a slope.
        assert_relative_eq!(back_stress, 86.4665e6, max_relative = 1e-4);
    }
}
