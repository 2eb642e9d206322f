//! Coulomb friction with the shear strength of the workpiece as upper limit.

use super::coulomb::FRICTION_COEFFICIENT;
use super::{ContactState, FrictionEntry, FrictionLaw};
use crate::{Parameter, Quantity, Range};

/// ```text
/// tau = min(mu p, m_s k),   k = sigma_y / sqrt(3)
/// ```
/// The interface cannot transmit more than the chip can bear in shear. This is
/// the friction of the springback paper (Coulomb with an upper limit) and,
/// with `m_s` = 1, of Zorev's sticking and sliding zones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearCappedCoulomb {
    /// mu.
    pub friction_coefficient: f64,
    /// m_s.
    pub shear_friction_factor: f64,
}

impl FrictionLaw for ShearCappedCoulomb {
    #[inline]
    fn shear_limit(&self, state: &ContactState) -> f64 {
        let shear_strength = state.flow_stress / 3.0_f64.sqrt();
        (self.friction_coefficient * state.pressure)
            .min(self.shear_friction_factor * shear_strength)
    }
}

/// m_s; laws that cap friction share it.
pub(super) const SHEAR_FRICTION_FACTOR: Parameter = Parameter {
    key: "shear_friction_factor",
    symbol: "m_s",
    quantity: Quantity::Dimensionless,
    range: Range::above(0.0, 1.0),
    default: Some(1.0),
    meaning: "share of the shear strength that sticking contact transmits",
    source: "1 in the sticking zone, grey-box paper section 2.4",
};

pub(super) const ENTRY: FrictionEntry = FrictionEntry {
    key: "shear_capped_coulomb",
    title: "Coulomb capped by the shear strength",
    equation: "tau = min(mu p, m_s sigma_y / sqrt(3))",
    source: "springback paper (2015), section 3.1; Zorev 1963",
    validity: "tool-chip contact; neglects speed and temperature dependence of mu",
    parameters: &[FRICTION_COEFFICIENT, SHEAR_FRICTION_FACTOR],
    build: |values| {
        Box::new(ShearCappedCoulomb {
            friction_coefficient: values.get("friction_coefficient"),
            shear_friction_factor: values.get("shear_friction_factor"),
        })
    },
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smaller_of_both_limits_rules() {
        let law = ShearCappedCoulomb { friction_coefficient: 0.5, shear_friction_factor: 1.0 };
        let at = |pressure| {
            law.shear_limit(&ContactState {
                pressure,
                flow_stress: 300e6,
                sliding_speed: 1.0,
                temperature: 300.0,
            })
        };
        assert_eq!(at(100e6), 50e6);
        // 300 MPa / sqrt(3) = 173.2 MPa
        assert!((at(1e9) - 173.205e6).abs() < 1e3);
    }
}
