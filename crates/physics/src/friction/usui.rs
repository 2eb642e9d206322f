//! Friction whose coefficient falls with the pressure, towards the shear strength.

use super::coulomb::FRICTION_COEFFICIENT;
use super::shear_capped_coulomb::SHEAR_FRICTION_FACTOR;
use super::{ContactState, FrictionEntry, FrictionLaw};
use crate::{Parameter, Quantity, Range};

/// ```text
/// tau = m_s k {1 - exp[-(mu p / (m_s k))^n]}^(1/n),   k = sigma_y / sqrt(3)
/// ```
/// One smooth curve through the sliding and the sticking part of the contact: at low pressure the
/// slope is mu, at high pressure the interface transmits m_s k, and `tau / p`, the apparent
/// coefficient, falls in between because the real area of contact cannot exceed the apparent one.
/// n = 1 is Usui and Shirakashi's law; a larger n makes the bend sharper, and n to infinity
/// is Coulomb friction with its cap. A strong chip (m_s k far above mu p) leaves plain Coulomb
/// friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Usui {
    /// mu.
    pub friction_coefficient: f64,
    /// m_s.
    pub shear_friction_factor: f64,
    /// n.
    pub transition_exponent: f64,
}

impl FrictionLaw for Usui {
    #[inline]
    fn shear_limit(&self, state: &ContactState) -> f64 {
        let most = self.shear_friction_factor * state.flow_stress / 3.0_f64.sqrt();
        let sliding = self.friction_coefficient * state.pressure;
        if most <= 0.0 || sliding <= 0.0 {
            return 0.0;
        }
        let power = (sliding / most).powf(self.transition_exponent);
        // Where the power underflows, 1 - exp(-power) is the power itself: Coulomb.
        if power < f64::MIN_POSITIVE {
            return sliding;
        }
        most * (-(-power).exp_m1()).powf(self.transition_exponent.recip())
    }
}

pub(super) const ENTRY: FrictionEntry = FrictionEntry {
    key: "usui",
    title: "Friction that falls with the pressure (Usui and Shirakashi, Childs)",
    equation: "tau = m_s k {1 - exp[-(mu p / (m_s k))^n]}^(1/n), k = sigma_y / sqrt(3)",
    source: "Usui and Shirakashi, ASME PED 7 (1982) 13-35; with m_s and n: Dirikolu, Childs and \
             Maekawa, Int. J. Mech. Sci. 43 (2001) 2699-2713, and Childs, Wear 260 (2006) 310-318. \
             Values of mu and n are the user's",
    validity: "tool-chip contact; neglects speed, and temperature except through the flow stress",
    parameters: &[
        FRICTION_COEFFICIENT,
        SHEAR_FRICTION_FACTOR,
        Parameter {
            key: "transition_exponent",
            symbol: "n",
            quantity: Quantity::Dimensionless,
            range: Range::closed(1.0, 50.0),
            default: Some(1.0),
            meaning: "sharpness of the bend between sliding and sticking",
            source: "1: Usui and Shirakashi",
        },
    ],
    build: |values| {
        Box::new(Usui {
            friction_coefficient: values.get("friction_coefficient"),
            shear_friction_factor: values.get("shear_friction_factor"),
            transition_exponent: values.get("transition_exponent"),
        })
    },
};

#[cfg(test)]
mod tests {
    use super::super::ShearCappedCoulomb;
    use super::*;

    const LAW: Usui =
        Usui { friction_coefficient: 0.5, shear_friction_factor: 1.0, transition_exponent: 1.0 };

    fn at(pressure: f64) -> ContactState {
        let flow_stress = 3.0_f64.sqrt() * 400e6;
        ContactState { pressure, flow_stress, sliding_speed: 1.0, temperature: 300.0 }
    }

    /// k = 400 MPa, mu p = 400 MPa at 800 MPa: tau = 400 (1 - 1/e) = 252.848 MPa. With n = 2 the
    /// root of 1 - 1/e = 0.795060, 318.024 MPa.
    #[test]
    fn by_hand() {
        assert!((LAW.shear_limit(&at(800e6)) - 252.848e6).abs() < 1e3);
        let sharper = Usui { transition_exponent: 2.0, ..LAW };
        assert!((sharper.shear_limit(&at(800e6)) - 318.024e6).abs() < 1e3);
    }

    #[test]
    fn the_apparent_coefficient_falls_with_pressure() {
        let apparent: Vec<f64> =
            [1e6, 1e8, 5e8, 1e9, 5e9].iter().map(|p| LAW.shear_limit(&at(*p)) / p).collect();
        assert!(apparent.windows(2).all(|pair| pair[1] < pair[0]), "{apparent:?}");
    }

    #[test]
    fn light_pressure_is_coulomb_and_a_sharp_bend_is_its_cap() {
        for exponent in [1.0, 3.0, 50.0] {
            let law = Usui { transition_exponent: exponent, ..LAW };
            // To first order tau = mu p (1 - (mu p / k)^n / 2n): 1e-8 at most.
            let found = law.shear_limit(&at(1.0));
            assert!((found - 0.5).abs() < 1e-8, "{found} for {exponent}");
        }
        let sharp = Usui { transition_exponent: 50.0, ..LAW };
        let capped = ShearCappedCoulomb { friction_coefficient: 0.5, shear_friction_factor: 1.0 };
        for pressure in [1e8, 5e8, 1.2e9, 5e9] {
            let (found, limit) =
                (sharp.shear_limit(&at(pressure)), capped.shear_limit(&at(pressure)));
            assert!((found - limit).abs() < 1e-3 * limit, "{found} {limit}");
        }
    }
}
