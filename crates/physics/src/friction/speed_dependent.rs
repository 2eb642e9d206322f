//! Friction that falls with the sliding speed.

use super::coulomb::FRICTION_COEFFICIENT;
use super::shear_capped_coulomb::SHEAR_FRICTION_FACTOR;
use super::{ContactState, FrictionEntry, FrictionLaw};
use crate::{Parameter, Quantity, Range};

/// ```text
/// tau = min(mu p, m_s k),   mu = mu_0 (v / v_0)^-q for v > v_0, mu_0 below;   k = sigma_y / sqrt(3)
/// ```
/// A power of the sliding speed is how tribometer tests at the pressures of cutting are usually
/// summed up. Below the lowest speed measured, v_0, the coefficient stays at mu_0: the power would
/// grow without bound at rest. With q = 0 this is Coulomb friction with its cap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedDependent {
    /// mu_0.
    pub friction_coefficient: f64,
    /// v_0 in m/s.
    pub reference_speed: f64,
    /// q.
    pub speed_exponent: f64,
    /// m_s.
    pub shear_friction_factor: f64,
}

impl FrictionLaw for SpeedDependent {
    #[inline]
    fn shear_limit(&self, state: &ContactState) -> f64 {
        let relative = (state.sliding_speed / self.reference_speed).max(1.0);
        let coefficient = self.friction_coefficient * relative.powf(-self.speed_exponent);
        let shear_strength = state.flow_stress / 3.0_f64.sqrt();
        (coefficient * state.pressure).min(self.shear_friction_factor * shear_strength)
    }
}

pub(super) const ENTRY: FrictionEntry = FrictionEntry {
    key: "speed_dependent",
    title: "Coulomb friction that falls with the sliding speed, capped",
    equation: "tau = min(mu p, m_s sigma_y / sqrt(3)), mu = mu_0 max(1, v/v_0)^-q",
    source: "power law in the open SPH-FEM cutting code of ETH Zurich (2024): Ti6Al4V on carbide, \
             mu = 0.627 v^-0.154 with v in m/min; its calibration is not stated there. Tests of \
             Rech et al. 2013 as tabulated by Ducobu, Pantale and Lauwers (CIRP 2022): Ti6Al4V on \
             TiN, 0.24 at 5 m/min to 0.17 at 40 m/min, which mu_0 = 0.24, v_0 = 5 m/min, q = 0.166 \
             meets within 0.005",
    validity: "speeds of the tests it was fitted to; temperature acts only through the speed at \
               which it was measured",
    parameters: &[
        FRICTION_COEFFICIENT,
        Parameter {
            key: "reference_speed",
            symbol: "v_0",
            quantity: Quantity::Speed,
            range: Range::above(0.0, 100.0),
            default: None,
            meaning: "lowest sliding speed measured: the coefficient is constant below",
            source: "user",
        },
        Parameter {
            key: "speed_exponent",
            symbol: "q",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 2.0),
            default: None,
            meaning: "exponent with which the coefficient falls above it",
            source: "user",
        },
        SHEAR_FRICTION_FACTOR,
    ],
    build: |values| {
        Box::new(SpeedDependent {
            friction_coefficient: values.get("friction_coefficient"),
            reference_speed: values.get("reference_speed"),
            speed_exponent: values.get("speed_exponent"),
            shear_friction_factor: values.get("shear_friction_factor"),
        })
    },
};

#[cfg(test)]
mod tests {
    use super::super::ShearCappedCoulomb;
    use super::*;

    fn titanium_on_coated_carbide() -> SpeedDependent {
        SpeedDependent {
            friction_coefficient: 0.24,
            reference_speed: 5.0 / 60.0,
            speed_exponent: 0.166,
            shear_friction_factor: 1.0,
        }
    }

    fn at(speed: f64) -> ContactState {
        ContactState { pressure: 1e6, flow_stress: 1e9, sliding_speed: speed, temperature: 300.0 }
    }

    /// Ducobu, Pantale, Lauwers, table 3 (after Rech et al. 2013): speed in m/min and coefficient.
    #[test]
    fn the_measured_coefficients_are_met() {
        let law = titanium_on_coated_carbide();
        for (speed, measured) in
            [(5.0, 0.24), (7.5, 0.22), (10.0, 0.21), (20.0, 0.19), (30.0, 0.18), (40.0, 0.17)]
        {
            let found = law.shear_limit(&at(speed / 60.0)) / 1e6;
            // The table has two digits: half a unit of the last one.
            assert!((found - measured).abs() < 0.005, "{found} at {speed} m/min: {measured}");
        }
    }

    /// mu = 0.24 x 8^-0.166 = 0.24 exp(-0.166 x 2.07944) = 0.16995 at 40 m/min, times 1 MPa.
    #[test]
    fn by_hand() {
        let found = titanium_on_coated_carbide().shear_limit(&at(40.0 / 60.0));
        assert!((found - 0.169_94e6).abs() < 20.0, "{found}");
    }

    #[test]
    fn at_rest_it_is_finite_and_without_exponent_it_is_coulomb() {
        let law = titanium_on_coated_carbide();
        assert_eq!(law.shear_limit(&at(0.0)), 0.24 * 1e6);
        let constant = SpeedDependent { speed_exponent: 0.0, ..law };
        let coulomb = ShearCappedCoulomb { friction_coefficient: 0.24, shear_friction_factor: 1.0 };
        for speed in [0.0, 0.01, 1.0, 100.0] {
            for pressure in [1e6, 1e10] {
                let state = ContactState { pressure, ..at(speed) };
                assert_eq!(constant.shear_limit(&state), coulomb.shear_limit(&state));
            }
        }
    }
}
