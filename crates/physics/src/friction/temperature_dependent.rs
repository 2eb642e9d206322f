//! Friction that falls with the temperature of the contact.

use super::coulomb::FRICTION_COEFFICIENT;
use super::shear_capped_coulomb::SHEAR_FRICTION_FACTOR;
use super::{ContactState, FrictionEntry, FrictionLaw};
use crate::{Parameter, Quantity, Range};

/// ```text
/// tau = min(mu p, m_s k),   mu = mu_0 [1 - (T / T_m)^q_T],   k = sigma_y / sqrt(3)
/// ```
/// T is absolute; above the melting temperature T_m there is no friction (the bracket is not let
/// below 0). The temperature is that of the particle that touches: the thin layer at the interface
/// is hotter. A large q_T is Coulomb friction with its cap up to the melting temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TemperatureDependent {
    /// mu_0.
    pub friction_coefficient: f64,
    /// T_m in K.
    pub melting_temperature: f64,
    /// q_T.
    pub temperature_exponent: f64,
    /// m_s.
    pub shear_friction_factor: f64,
}

impl FrictionLaw for TemperatureDependent {
    #[inline]
    fn shear_limit(&self, state: &ContactState) -> f64 {
        let homologous = state.temperature / self.melting_temperature;
        let share = (1.0 - homologous.powf(self.temperature_exponent)).max(0.0);
        let shear_strength = state.flow_stress / 3.0_f64.sqrt();
        (self.friction_coefficient * share * state.pressure)
            .min(self.shear_friction_factor * shear_strength)
    }
}

pub(super) const ENTRY: FrictionEntry = FrictionEntry {
    key: "temperature_dependent",
    title: "Coulomb friction that falls with the temperature, capped",
    equation: "tau = min(mu p, m_s sigma_y / sqrt(3)), mu = mu_0 [1 - (T/T_m)^q_T] >= 0",
    source: "form: Moufki, Molinari and Dudzinski, J. Mech. Phys. Solids 46 (1998) 2103-2138; values \
             in the open SPH-FEM cutting code of ETH Zurich (2024): Ti6Al4V on carbide, mu_0 = \
             0.51, q_T = 5.76, T_m = 1836 K; their calibration is not stated there",
    validity: "sliding contact whose temperature is resolved; the particles do not resolve the \
               hottest layer",
    parameters: &[
        FRICTION_COEFFICIENT,
        Parameter {
            key: "melting_temperature",
            symbol: "T_m",
            quantity: Quantity::Temperature,
            range: Range::above(0.0, 10_000.0),
            default: None,
            meaning: "temperature at which friction vanishes",
            source: "user",
        },
        Parameter {
            key: "temperature_exponent",
            symbol: "q_T",
            quantity: Quantity::Dimensionless,
            range: Range::above(0.0, 100.0),
            default: None,
            meaning: "exponent of the softening: the larger, the later friction falls",
            source: "user",
        },
        SHEAR_FRICTION_FACTOR,
    ],
    build: |values| {
        Box::new(TemperatureDependent {
            friction_coefficient: values.get("friction_coefficient"),
            melting_temperature: values.get("melting_temperature"),
            temperature_exponent: values.get("temperature_exponent"),
            shear_friction_factor: values.get("shear_friction_factor"),
        })
    },
};

#[cfg(test)]
mod tests {
    use super::super::ShearCappedCoulomb;
    use super::*;

    fn titanium_on_carbide() -> TemperatureDependent {
        TemperatureDependent {
            friction_coefficient: 0.51,
            melting_temperature: 1836.0,
            temperature_exponent: 5.76,
            shear_friction_factor: 1.0,
        }
    }

    fn at(temperature: f64) -> ContactState {
        ContactState { pressure: 1e6, flow_stress: 1e9, sliding_speed: 1.0, temperature }
    }

    /// At half the melting temperature 0.5^5.76 = exp(-5.76 x 0.693147) = 0.018452:
    /// 0.51 x 0.981548 x 1 MPa = 0.50059 MPa.
    #[test]
    fn by_hand() {
        let found = titanium_on_carbide().shear_limit(&at(918.0));
        assert!((found - 0.500_59e6).abs() < 10.0, "{found}");
    }

    #[test]
    fn it_vanishes_at_the_melting_temperature() {
        let law = titanium_on_carbide();
        assert_eq!(law.shear_limit(&at(1836.0)), 0.0);
        assert_eq!(law.shear_limit(&at(2500.0)), 0.0);
        let falling = [300.0, 900.0, 1300.0, 1700.0].map(|t| law.shear_limit(&at(t)));
        assert!(falling.windows(2).all(|pair| pair[1] < pair[0]), "{falling:?}");
    }

    /// 0.8^100 = 2e-10.
    #[test]
    fn a_large_exponent_is_coulomb_below_the_melting_temperature() {
        let law = TemperatureDependent { temperature_exponent: 100.0, ..titanium_on_carbide() };
        let coulomb = ShearCappedCoulomb { friction_coefficient: 0.51, shear_friction_factor: 1.0 };
        for pressure in [1e6, 1e10] {
            let state = ContactState { pressure, ..at(0.8 * 1836.0) };
            let (found, limit) = (law.shear_limit(&state), coulomb.shear_limit(&state));
            assert!((found - limit).abs() < 3e-10 * limit, "{found} {limit}");
        }
    }
}
