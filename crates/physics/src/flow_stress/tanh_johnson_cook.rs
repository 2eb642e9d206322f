//! Johnson-Cook with tanh strain softening (Sima and Ozel).

use super::johnson_cook::{self, JohnsonCook};
use super::{FlowState, FlowStressEntry, FlowStressLaw};
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// sigma_y = (A + B eps_p^n / exp(eps_p^a)) (1 + C ln max(eps_p_dot/eps_dot_0, 1)) (1 - T*^m)
///           (D + (1 - D) tanh(1 / (eps_p + p)^r)^s)
/// D = 1 - (T/T_m)^d,   p = (T/T_m)^b
/// ```
/// Source: Sima and Ozel, Int. J. Mach. Tools Manuf. 50 (2010) 943-960, model 3
/// with the exponents a, b, r (printed c or r), d, s. T and T_m are absolute.
/// The softening factor tends to 1 for cold material and small strain, and to D
/// for large strain: it stands for dynamic recovery and recrystallisation
/// in Ti6Al4V above about half the melting temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TanhJohnsonCook {
    /// The underlying Johnson-Cook law.
    pub johnson_cook: JohnsonCook,
    /// a: damping of the hardening at large strain.
    pub hardening_damping: f64,
    /// The last factor.
    pub softening: TanhSoftening,
}

/// The factor of strain softening.
/// ```text
/// D + (1 - D) tanh(1 / (eps_p + p)^r)^s,   D = 1 - (T/T_m)^d,   p = (T/T_m)^b
/// ```
/// With s = 0 it is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TanhSoftening {
    /// T_m in K.
    pub melting_temperature: f64,
    /// b: temperature exponent of the strain offset p.
    pub offset_exponent: f64,
    /// r: strain exponent inside tanh.
    pub strain_exponent: f64,
    /// d: temperature exponent of D.
    pub floor_exponent: f64,
    /// s: exponent of tanh.
    pub tanh_exponent: f64,
}

impl TanhSoftening {
    /// From values of a table with [`SOFTENING`] and the melting temperature.
    pub(crate) fn from_values(values: &Values) -> Self {
        Self {
            melting_temperature: values.get("melting_temperature"),
            offset_exponent: values.get("offset_exponent"),
            strain_exponent: values.get("strain_exponent"),
            floor_exponent: values.get("floor_exponent"),
            tanh_exponent: values.get("tanh_exponent"),
        }
    }

    /// The factor.
    #[inline]
    #[must_use]
    pub fn factor(&self, state: &FlowState) -> f64 {
        let strain = state.plastic_strain.max(0.0);
        let relative_temperature = (state.temperature / self.melting_temperature).clamp(0.0, 1.0);
        let floor = 1.0 - relative_temperature.powf(self.floor_exponent);
        let offset = relative_temperature.powf(self.offset_exponent);
        // (eps + p)^-r grows without bound for cold, undeformed material; tanh of it is then 1.
        let argument = (strain + offset).powf(-self.strain_exponent);
        floor + (1.0 - floor) * argument.tanh().powf(self.tanh_exponent)
    }

    /// The factor and its derivative along `change`, as [`FlowStressLaw::flow_stress_along`].
    #[inline]
    #[must_use]
    pub fn factor_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let strain = state.plastic_strain.max(0.0);
        let relative_temperature = (state.temperature / self.melting_temperature).clamp(0.0, 1.0);
        let heating = if relative_temperature > 0.0 && relative_temperature < 1.0 {
            change.temperature / state.temperature
        } else {
            0.0
        };
        let depth = relative_temperature.powf(self.floor_exponent);
        let offset = relative_temperature.powf(self.offset_exponent);
        let argument = (strain + offset).powf(-self.strain_exponent);
        let tanh = argument.tanh();
        let power = tanh.powf(self.tanh_exponent);
        // d(ln argument) = -r d(eps + p)/(eps + p); where tanh is 1 to rounding it does not matter.
        let mut growth = 0.0;
        if tanh < 1.0 {
            let widening = change.plastic_strain + self.offset_exponent * offset * heating;
            let argument_growth = -self.strain_exponent * widening / (strain + offset);
            growth = self.tanh_exponent * (1.0 - tanh * tanh) * argument / tanh * argument_growth;
        }
        let slope = depth * (self.floor_exponent * heating * (power - 1.0) + power * growth);
        (self.factor(state), slope)
    }
}

impl FlowStressLaw for TanhJohnsonCook {
    #[inline]
    fn flow_stress(&self, state: &FlowState) -> f64 {
        let base = &self.johnson_cook;
        let strain = state.plastic_strain.max(0.0);
        let hardening = base.initial_yield
            + base.hardening_modulus * strain.powf(base.hardening_exponent)
                / strain.powf(self.hardening_damping).exp();
        hardening
            * base.rate_factor(state.plastic_strain_rate)
            * base.softening(state.temperature)
            * self.softening.factor(state)
    }
}

const fn exponent(
    key: &'static str,
    symbol: &'static str,
    default: f64,
    meaning: &'static str,
) -> Parameter {
    Parameter {
        key,
        symbol,
        quantity: Quantity::Dimensionless,
        range: Range::closed(0.0, 20.0),
        default: Some(default),
        meaning,
        source: "Sima and Ozel 2010, Ti6Al4V",
    }
}

/// b, r, d and s.
pub(crate) const SOFTENING: [Parameter; 4] = [
    exponent("offset_exponent", "b", 5.0, "temperature exponent of the strain offset"),
    exponent("strain_exponent", "r", 2.0, "strain exponent inside tanh"),
    exponent("floor_exponent", "d", 1.0, "temperature exponent of the softened level"),
    exponent("tanh_exponent", "s", 0.05, "exponent of tanh"),
];

const PARAMETERS: [Parameter; 13] = [
    johnson_cook::PARAMETERS[0],
    johnson_cook::PARAMETERS[1],
    johnson_cook::PARAMETERS[2],
    johnson_cook::PARAMETERS[3],
    johnson_cook::PARAMETERS[4],
    johnson_cook::PARAMETERS[5],
    johnson_cook::PARAMETERS[6],
    johnson_cook::PARAMETERS[7],
    exponent("hardening_damping", "a", 2.0, "damps the hardening at large strain"),
    SOFTENING[0],
    SOFTENING[1],
    SOFTENING[2],
    SOFTENING[3],
];

pub(super) const ENTRY: FlowStressEntry = FlowStressEntry {
    key: "tanh_johnson_cook",
    title: "Johnson-Cook with tanh strain softening (Sima-Ozel)",
    equation: "sigma_y = (A + B eps_p^n / exp(eps_p^a)) (1 + C ln max(eps_p_dot/eps_dot_0, 1)) \
               (1 - T*^m) (D + (1 - D) tanh((eps_p + p)^-r)^s), D = 1 - (T/T_m)^d, p = (T/T_m)^b",
    source: "Sima and Ozel, Int. J. Mach. Tools Manuf. 50 (2010) 943-960",
    validity: "titanium alloys with strain softening at high temperature; exponents are fitted",
    parameters: &PARAMETERS,
    table: None,
    build: |values| {
        Box::new(TanhJohnsonCook {
            johnson_cook: JohnsonCook::from_values(values),
            hardening_damping: values.get("hardening_damping"),
            softening: TanhSoftening::from_values(values),
        })
    },
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn titanium() -> Box<dyn super::super::FlowStressModel> {
        let values = Values::resolve(
            &PARAMETERS,
            &[
                ("initial_yield", 724.7e6),
                ("hardening_modulus", 683.1e6),
                ("hardening_exponent", 0.47),
                ("rate_coefficient", 0.035),
                ("softening_exponent", 1.0),
                ("reference_temperature", 298.0),
                ("melting_temperature", 1878.0),
            ],
        )
        .unwrap();
        (ENTRY.build)(&values)
    }

    #[test]
    fn undeformed_at_reference_is_the_initial_yield() {
        // p = (298/1878)^5 = 1.0e-4, p^-2 = 1e8: tanh = 1, so the factor is 1.
        let state = FlowState { plastic_strain: 0.0, plastic_strain_rate: 1.0, temperature: 298.0 };
        assert_relative_eq!(titanium().flow_stress(&state), 724.7e6, max_relative = 1e-12);
    }

    #[test]
    fn softens_at_large_strain_when_hot() {
        let law = titanium();
        let at = |plastic_strain| {
            law.flow_stress(&FlowState {
                plastic_strain,
                plastic_strain_rate: 1e4,
                temperature: 1000.0,
            })
        };
        assert!(at(3.0) < at(0.7));
        // By hand at eps_p = 3: hardening 724.7e6 + 683.1e6*3^0.47/exp(9) = 724.841e6 Pa;
        // rate 1 + 0.035 ln 1e4 = 1.3223619; thermal 1 - 702/1580 = 0.5556962;
        // D = 0.4675186, p = 0.0428056, tanh(3.0428056^-2) = 0.1075881, ^0.05 = 0.8945227,
        // softening 0.4675186 + 0.5324814*0.8945227 = 0.943835.
        assert_relative_eq!(at(3.0), 502.74e6, max_relative = 1e-3);
    }
}
