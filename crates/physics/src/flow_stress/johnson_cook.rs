//! The Johnson-Cook flow stress.

use super::{FlowState, FlowStressEntry, FlowStressLaw};
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// sigma_y = (A + B eps_p^n) (1 + C ln max(eps_p_dot / eps_dot_0, 1)) (1 - T*^m)
/// T* = (T - T_ref) / (T_m - T_ref), clamped to [0, 1]
/// ```
/// Source: Johnson and Cook, 7th Int. Symp. on Ballistics (1983) 541-547.
///
/// Two clamps are modelling statements: no strength above the melting
/// temperature, and below the reference rate the rate term stays at its value
/// there. Neglected: history of rate and temperature, softening by
/// recrystallisation, dynamic strain ageing, coupling between the three factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JohnsonCook {
    /// A in Pa.
    pub initial_yield: f64,
    /// B in Pa.
    pub hardening_modulus: f64,
    /// n.
    pub hardening_exponent: f64,
    /// C.
    pub rate_coefficient: f64,
    /// m.
    pub softening_exponent: f64,
    /// eps_dot_0 in 1/s.
    pub reference_rate: f64,
    /// T_ref in K.
    pub reference_temperature: f64,
    /// T_m in K.
    pub melting_temperature: f64,
}

impl JohnsonCook {
    /// From checked values of [`PARAMETERS`] or of a table that starts with them.
    pub(super) fn from_values(values: &Values) -> Self {
        Self {
            initial_yield: values.get("initial_yield"),
            hardening_modulus: values.get("hardening_modulus"),
            hardening_exponent: values.get("hardening_exponent"),
            rate_coefficient: values.get("rate_coefficient"),
            softening_exponent: values.get("softening_exponent"),
            reference_rate: values.get("reference_rate"),
            reference_temperature: values.get("reference_temperature"),
            melting_temperature: values.get("melting_temperature"),
        }
    }

    /// A + B eps_p^n in Pa.
    #[inline]
    pub(super) fn hardening(&self, plastic_strain: f64) -> f64 {
        self.initial_yield
            + self.hardening_modulus * plastic_strain.max(0.0).powf(self.hardening_exponent)
    }

    /// 1 + C ln max(eps_p_dot / eps_dot_0, 1).
    #[inline]
    pub(super) fn rate_factor(&self, plastic_strain_rate: f64) -> f64 {
        1.0 + self.rate_coefficient * (plastic_strain_rate / self.reference_rate).max(1.0).ln()
    }

    /// 1 - T*^m with T* clamped to [0, 1].
    #[inline]
    pub(super) fn softening(&self, temperature: f64) -> f64 {
        let homologous = ((temperature - self.reference_temperature)
            / (self.melting_temperature - self.reference_temperature))
            .clamp(0.0, 1.0);
        // A linear law is frequent, and a power is dear.
        if self.softening_exponent == 1.0 {
            return 1.0 - homologous;
        }
        1.0 - homologous.powf(self.softening_exponent)
    }
}

impl FlowStressLaw for JohnsonCook {
    #[inline]
    fn flow_stress(&self, state: &FlowState) -> f64 {
        self.hardening(state.plastic_strain)
            * self.rate_factor(state.plastic_strain_rate)
            * self.softening(state.temperature)
    }

    #[inline]
    fn flow_stress_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let hardening = self.hardening(state.plastic_strain);
        let rate_factor = self.rate_factor(state.plastic_strain_rate);
        let softening = self.softening(state.temperature);
        // d(eps^n) = n eps^n d(eps) / eps; nothing where a clamp holds or a base is zero.
        let mut hardening_change = 0.0;
        if state.plastic_strain > 0.0 {
            hardening_change = self.hardening_exponent * (hardening - self.initial_yield)
                / state.plastic_strain
                * change.plastic_strain;
        }
        let mut rate_change = 0.0;
        if state.plastic_strain_rate > self.reference_rate {
            rate_change =
                self.rate_coefficient * change.plastic_strain_rate / state.plastic_strain_rate;
        }
        let mut softening_change = 0.0;
        let excess = state.temperature - self.reference_temperature;
        if excess > 0.0 && state.temperature < self.melting_temperature {
            softening_change =
                -self.softening_exponent * (1.0 - softening) / excess * change.temperature;
        }
        let slope = hardening_change * rate_factor * softening
            + hardening * rate_change * softening
            + hardening * rate_factor * softening_change;
        (hardening * rate_factor * softening, slope)
    }
}

/// The eight Johnson-Cook parameters.
pub(crate) const PARAMETERS: [Parameter; 8] = [
    Parameter {
        key: "initial_yield",
        symbol: "A",
        quantity: Quantity::Stress,
        range: Range::above(0.0, 1e10),
        default: None,
        meaning: "yield stress at reference rate and temperature",
        source: "material test",
    },
    Parameter {
        key: "hardening_modulus",
        symbol: "B",
        quantity: Quantity::Stress,
        range: Range::closed(0.0, 1e10),
        default: None,
        meaning: "strain hardening",
        source: "material test",
    },
    Parameter {
        key: "hardening_exponent",
        symbol: "n",
        quantity: Quantity::Dimensionless,
        range: Range::above(0.0, 2.0),
        default: None,
        meaning: "exponent of the strain hardening",
        source: "material test",
    },
    Parameter {
        key: "rate_coefficient",
        symbol: "C",
        quantity: Quantity::Dimensionless,
        range: Range::closed(0.0, 1.0),
        default: None,
        meaning: "growth of the flow stress per e-fold of the strain rate",
        source: "material test",
    },
    Parameter {
        key: "softening_exponent",
        symbol: "m",
        quantity: Quantity::Dimensionless,
        range: Range::above(0.0, 10.0),
        default: None,
        meaning: "exponent of the thermal softening",
        source: "material test",
    },
    Parameter {
        key: "reference_rate",
        symbol: "eps_dot_0",
        quantity: Quantity::Rate,
        range: Range::above(0.0, 1e9),
        default: Some(1.0),
        meaning: "strain rate at which the rate factor is 1",
        source: "1/s is the customary choice where a source prints none",
    },
    Parameter {
        key: "reference_temperature",
        symbol: "T_ref",
        quantity: Quantity::Temperature,
        range: Range::above(0.0, 5000.0),
        default: Some(293.15),
        meaning: "temperature at which the softening factor is 1",
        source: "room temperature",
    },
    Parameter {
        key: "melting_temperature",
        symbol: "T_m",
        quantity: Quantity::Temperature,
        range: Range::above(0.0, 10000.0),
        default: None,
        meaning: "temperature at which the strength is gone; must exceed the reference temperature",
        source: "material data",
    },
];

pub(super) const ENTRY: FlowStressEntry = FlowStressEntry {
    key: "johnson_cook",
    title: "Johnson-Cook",
    equation: "sigma_y = (A + B eps_p^n) (1 + C ln max(eps_p_dot/eps_dot_0, 1)) (1 - T*^m), \
               T* = clamp((T - T_ref)/(T_m - T_ref), 0, 1)",
    source: "Johnson and Cook, 7th Int. Symp. on Ballistics (1983) 541-547",
    validity: "metals below melting; neglects history, recrystallisation, strain ageing and \
               coupling between strain, rate and temperature",
    parameters: &PARAMETERS,
    table: None,
    build: |values| Box::new(JohnsonCook::from_values(values)),
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// AISI 1045 normalized, Table 5 of the grey-box paper; rate 1/s and 1733 K chosen.
    const STEEL: JohnsonCook = JohnsonCook {
        initial_yield: 331e6,
        hardening_modulus: 614e6,
        hardening_exponent: 0.26,
        rate_coefficient: 0.07,
        softening_exponent: 1.19,
        reference_rate: 1.0,
        reference_temperature: 293.15,
        melting_temperature: 1733.0,
    };

    fn at(plastic_strain: f64, plastic_strain_rate: f64, temperature: f64) -> f64 {
        STEEL.flow_stress(&FlowState { plastic_strain, plastic_strain_rate, temperature })
    }

    /// The derivative without this law's own formula.
    #[derive(Debug)]
    struct Plain(JohnsonCook);

    impl FlowStressLaw for Plain {
        fn flow_stress(&self, state: &FlowState) -> f64 {
            self.0.flow_stress(state)
        }
    }

    #[test]
    fn the_derivative_is_that_of_the_flow_stress() {
        let change = FlowState { plastic_strain: 1e-4, plastic_strain_rate: 2e3, temperature: 0.7 };
        for (strain, rate, temperature, exponent) in
            [(0.3, 2e4, 500.0, 1.0), (1.7, 0.5, 900.0, 0.8), (1e-3, 1e6, 250.0, 1.3)]
        {
            let law = JohnsonCook { softening_exponent: exponent, ..STEEL };
            let state =
                FlowState { plastic_strain: strain, plastic_strain_rate: rate, temperature };
            let (stress, slope) = law.flow_stress_along(&state, &change);
            let (plain_stress, plain_slope) = Plain(law).flow_stress_along(&state, &change);
            assert_eq!(stress, plain_stress);
            // A quotient over 1e-7 of numbers rounded to 1e-16 of the stress.
            assert!((slope - plain_slope).abs() < 1e-8 * stress, "{slope} {plain_slope}");
        }
    }

    #[test]
    fn one_value_by_hand() {
        // eps_p = 1: A + B = 945 MPa. Rate 1e5: 1 + 0.07 * 11.512925 = 1.80590478.
        // T = 1013.075 K: T* = 719.925/1439.85 = 0.5, 0.5^1.19 = 0.4382965, factor 0.5617034(5).
        // 945e6 * 1.80590478 * 0.561697 = 958.58 MPa
        let expected = 945e6 * (1.0 + 0.07 * 1e5_f64.ln()) * (1.0 - (1.19 * 0.5_f64.ln()).exp());
        assert_relative_eq!(at(1.0, 1e5, 1013.075), expected, max_relative = 1e-12);
        assert_relative_eq!(at(1.0, 1e5, 1013.075), 958.6e6, max_relative = 1e-3);
    }

    #[test]
    fn no_strength_above_melting_and_full_strength_below_reference() {
        assert_eq!(at(0.5, 1e3, 1733.0), 0.0);
        assert_eq!(at(0.5, 1e3, 2500.0), 0.0);
        assert_eq!(at(0.5, 1e3, 100.0), at(0.5, 1e3, 293.15));
    }

    #[test]
    fn below_the_reference_rate_the_rate_term_stays_one() {
        assert_eq!(at(0.1, 1e-9, 293.15), at(0.1, 1.0, 293.15));
        assert_eq!(at(0.1, 0.0, 293.15), at(0.1, 1.0, 293.15));
    }
}
