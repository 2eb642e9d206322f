//! The size effect: strain gradients in the primary shear zone raise the flow stress.

use super::{Action, Demand, EffectEntry, FlowStressFactor, scaled};
use crate::candidate::{self, Candidate, Family, Free, Runs};
use crate::flow_stress::FlowState;
use crate::{Parameter, Quantity, Range};

/// ```text
/// x sqrt(1 + l/L),   L = h / sin(phi)
/// ```
/// Taylor's hardening by statistically stored and geometrically necessary dislocations:
/// `sigma = sigma_base sqrt(1 + l eta)` with the strain gradient eta and an intrinsic length
/// `l = 18 a^2 (G/sigma_ref)^2 b` (Nix and Gao, J. Mech. Phys. Solids 46 (1998) 411-425; a about 0.5,
/// b Burgers vector; some 20 um for steel). Joshi and Melkote, J. Manuf. Sci. Eng. 126 (2004)
/// 679-684, take eta = 1/L in the primary shear zone, with L the length of the shear plane. Here
/// L follows from the uncut chip thickness h and a shear angle phi that is given.
///
/// Limits: one L for the whole workpiece, so the secondary zone and the ploughed layer are raised as
/// much as the primary zone; the shear angle is an input and does not follow the simulated chip; l is
/// a constant, whereas it would grow as the material softens. [`super::StrainGradient`] takes the local
/// gradient that the particles carry instead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeEffect {
    /// sqrt(1 + l/L).
    pub factor: f64,
}

impl SizeEffect {
    /// From the intrinsic length l in m, the shear angle phi in rad and the uncut chip thickness h
    /// in m.
    #[must_use]
    pub fn new(intrinsic_length: f64, shear_angle: f64, uncut_chip_thickness: f64) -> Self {
        let shear_plane = uncut_chip_thickness / shear_angle.sin();
        Self { factor: (1.0 + intrinsic_length / shear_plane).sqrt() }
    }
}

impl FlowStressFactor for SizeEffect {
    #[inline]
    fn factor(&self, _: &FlowState) -> f64 {
        self.factor
    }

    #[inline]
    fn factor_along(&self, _: &FlowState, _: &FlowState) -> (f64, f64) {
        (self.factor, 0.0)
    }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "size_effect",
    title: "Size effect by strain gradients in the shear zone",
    equation: "x sqrt(1 + l/L), L = h / sin(phi)",
    source: "Joshi and Melkote, J. Manuf. Sci. Eng. 126 (2004) 679-684; Nix and Gao, J. Mech. Phys. \
             Solids 46 (1998) 411-425",
    validity: "the gradient of the primary shear zone holds everywhere; the shear angle is given and \
               does not follow the chip",
    signature: "specific cutting force up at small uncut chip thickness",
    parameters: &[
        Parameter {
            key: "intrinsic_length",
            symbol: "l",
            quantity: Quantity::Length,
            range: Range::closed(0.0, 1e-3),
            default: None,
            meaning: "intrinsic material length, 18 a^2 (G/sigma_ref)^2 b",
            source: "Nix and Gao 1998; some 20 um for steel",
        },
        Parameter {
            key: "gradient_shear_angle",
            symbol: "phi",
            quantity: Quantity::Angle,
            // 5 to 60 degrees
            range: Range::closed(0.087_266_462_599_716_47, 1.047_197_551_196_597_6),
            default: Some(std::f64::consts::FRAC_PI_6),
            meaning: "shear angle from which the length of the shear plane follows",
            source: "of the order of measured chips: 30 degrees",
        },
    ],
    example: &[("intrinsic_length", 20e-6)],
    vanishing: &[("intrinsic_length", 0.0)],
    demands: &[Demand::UncutChipThickness],
    action: Action::FlowStress(|values, context, base| {
        // The demand is checked before a run is set up; without a cut there is no gradient to speak of.
        let thickness = context.uncut_chip_thickness.unwrap_or(f64::INFINITY);
        let (length, angle) = (values.get("intrinsic_length"), values.get("gradient_shear_angle"));
        scaled(base, SizeEffect::new(length, angle, thickness))
    }),
    candidate: Some(Candidate {
        title: "strain gradients raise the flow stress of thin chips",
        family: Family::RateSize,
        free: &[Free::linear("intrinsic_length", (1e-6, 50e-6), 0.0)],
        runs: Runs::At(&[&[30e-6]]),
        strength: candidate::first,
    }),
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn one_value_by_hand() {
        // h = 0.1 mm, phi = 30 degrees: L = 0.2 mm; l = 20 um: sqrt(1.1) = 1.0488088.
        let coarse = SizeEffect::new(20e-6, std::f64::consts::FRAC_PI_6, 0.1e-3);
        assert_relative_eq!(coarse.factor, 1.048_808_8, max_relative = 1e-7);
        // A quarter of h: sqrt(1.4) = 1.1832160.
        let fine = SizeEffect::new(20e-6, std::f64::consts::FRAC_PI_6, 0.025e-3);
        assert_relative_eq!(fine.factor, 1.183_216_0, max_relative = 1e-7);
    }
}
