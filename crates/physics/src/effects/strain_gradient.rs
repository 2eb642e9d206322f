//! The size effect by the local gradient of the plastic strain.

use super::{Action, EffectEntry};
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// sigma = sqrt(sigma_base^2 + 18 a^2 G^2 b |grad eps_p|)
/// ```
/// Taylor's hardening by statistically stored and geometrically necessary dislocations (Nix and Gao, J.
/// Mech. Phys. Solids 46 (1998) 411-425): the density of the second is |grad eps_p|/b times Nye's factor, contained in
/// the 18 with the ratio of tensile to shear stress. Joshi and Melkote, J. Manuf. Sci. Eng. 126 (2004) 679-684, and Liu
/// and Melkote, Int. J. Mech. Sci. 49 (2007) 650-660, use it for cutting. [`super::SizeEffect`] is its value
/// with one gradient 1/L everywhere; here the gradient is that of the particles, so it is large where flow is
/// narrow, and follows the chip.
///
/// Limits: gradients within less than a spacing are not seen, and at the edge and in a shear band that
/// narrows with the mesh the gradient grows as the spacing is refined: compare at equal spacings, or at equal
/// spacings per uncut chip thickness. Only the magnitude of the gradient of the equivalent strain enters, not Nye's tensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainGradient {
    /// 18 a^2 G^2 b in Pa^2 m.
    pub coefficient: f64,
}

impl StrainGradient {
    /// From values of the effect's parameters.
    #[must_use]
    pub fn from_values(values: &Values) -> Self {
        let (taylor, modulus) = (values.get("taylor_coefficient"), values.get("obstacle_modulus"));
        let coefficient = 18.0 * (taylor * modulus).powi(2) * values.get("burgers_vector");
        Self { coefficient }
    }

    /// sigma/sigma_base for a gradient in 1/m and sigma_base in Pa; 1 for material that never yields or
    /// has no strength.
    #[must_use]
    #[inline]
    pub fn strength(&self, gradient: f64, base: f64) -> f64 {
        if base > 0.0 && base.is_finite() {
            (1.0 + self.coefficient * gradient / (base * base)).sqrt()
        } else {
            1.0
        }
    }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "strain_gradient",
    title: "Size effect by the local gradient of the plastic strain",
    equation: "sqrt(sigma^2 + 18 a^2 G^2 b |grad eps_p|)",
    source: "Nix and Gao, J. Mech. Phys. Solids 46 (1998) 411-425; Joshi and Melkote, J. Manuf. Sci. Eng. 126 \
             (2004) 679-684; Liu and Melkote, Int. J. Mech. Sci. 49 (2007) 650-660",
    validity: "gradients over a spacing and more; where the flow narrows with the mesh the gradient grows as the \
               spacing is refined: compare at equal particles per uncut chip thickness",
    signature: "specific cutting force up at small uncut chip thickness, most near the edge",
    parameters: &[
        Parameter {
            key: "taylor_coefficient",
            symbol: "a",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 1.0),
            default: Some(0.5),
            meaning: "Taylor's coefficient of dislocation hardening",
            source: "0.2 to 0.5, Nix and Gao 1998",
        },
        Parameter {
            key: "obstacle_modulus",
            symbol: "G",
            quantity: Quantity::Stress,
            range: Range::closed(0.0, 5e11),
            default: None,
            meaning: "shear modulus in the law of Taylor",
            source: "elastic constants; some 80 GPa for steel",
        },
        Parameter {
            key: "burgers_vector",
            symbol: "b",
            quantity: Quantity::Length,
            range: Range::closed(1e-10, 1e-9),
            default: None,
            meaning: "length of the Burgers vector",
            source: "crystal structure; 0.25 nm for iron, 0.29 nm for aluminium and titanium",
        },
    ],
    example: &[("obstacle_modulus", 80e9), ("burgers_vector", 2.5e-10)],
    vanishing: &[("taylor_coefficient", 0.0)],
    demands: &[],
    action: Action::StrainGradient(StrainGradient::from_values),
    candidate: None,
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn one_value_by_hand() {
        // 18 x 0.25 x (80e9)^2 x 2.5e-10 = 7.2e12 Pa^2 m; with 3e4 1/m and 1 GPa: sqrt(1.216) = 1.102724.
        let values = Values::resolve(ENTRY.parameters, ENTRY.example).unwrap();
        let effect = StrainGradient::from_values(&values);
        assert_relative_eq!(effect.coefficient, 7.2e12, max_relative = 1e-12);
        assert_relative_eq!(effect.strength(3e4, 1e9), 1.102_724, max_relative = 1e-6);
        assert_eq!(effect.strength(0.0, 1e9), 1.0);
        assert_eq!(effect.strength(3e4, f64::INFINITY), 1.0);
        assert_eq!(effect.strength(3e4, 0.0), 1.0);
    }
}
