//! Johnson-Cook with the tanh strain softening of Calamaz, Coupard and Girot.

use super::FlowStressEntry;
use super::johnson_cook::{self, JohnsonCook};
use super::tanh_johnson_cook::{TanhJohnsonCook, TanhSoftening};
use crate::{Parameter, Quantity, Range};

/// Softening with tanh itself, not a power of it.
const TANH_EXPONENT: f64 = 1.0;

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
        source: "Calamaz, Coupard and Girot 2008, Ti6Al4V",
    }
}

const PARAMETERS: [Parameter; 12] = [
    johnson_cook::PARAMETERS[0],
    johnson_cook::PARAMETERS[1],
    johnson_cook::PARAMETERS[2],
    johnson_cook::PARAMETERS[3],
    johnson_cook::PARAMETERS[4],
    johnson_cook::PARAMETERS[5],
    johnson_cook::PARAMETERS[6],
    johnson_cook::PARAMETERS[7],
    exponent("hardening_damping", "a", 1.6, "damps the hardening at large strain"),
    exponent("offset_exponent", "b", 0.4, "temperature exponent of the strain offset"),
    exponent("strain_exponent", "c", 6.0, "strain exponent inside tanh"),
    exponent("floor_exponent", "d", 1.0, "temperature exponent of the softened level"),
];

/// ```text
/// sigma_y = (A + B eps_p^n / exp(eps_p^a)) (1 + C ln max(eps_p_dot/eps_dot_0, 1)) (1 - T*^m)
///           (D + (1 - D) tanh(1 / (eps_p + S)^c))
/// D = 1 - (T/T_m)^d,   S = (T/T_m)^b
/// ```
/// Source: Calamaz, Coupard and Girot, Int. J. Mach. Tools Manuf. 48 (2008) 275-288. T and T_m are absolute. The
/// law of Sima and Ozel (`tanh_johnson_cook`) raises tanh to a power s; with s = 1 both are the same.
pub(super) const ENTRY: FlowStressEntry = FlowStressEntry {
    key: "tanh_calamaz",
    title: "Johnson-Cook with tanh strain softening (Calamaz)",
    equation: "sigma_y = (A + B eps_p^n / exp(eps_p^a)) (1 + C ln max(eps_p_dot/eps_dot_0, 1)) \
               (1 - T*^m) (D + (1 - D) tanh((eps_p + S)^-c)), D = 1 - (T/T_m)^d, S = (T/T_m)^b",
    source: "Calamaz, Coupard and Girot, Int. J. Mach. Tools Manuf. 48 (2008) 275-288",
    validity: "titanium alloys with strain softening at high temperature; exponents are fitted to the chip, and a \
               falling flow stress localises to the particle spacing",
    parameters: &PARAMETERS,
    table: None,
    build: |values| {
        Box::new(TanhJohnsonCook {
            johnson_cook: JohnsonCook::from_values(values),
            hardening_damping: values.get("hardening_damping"),
            softening: TanhSoftening {
                melting_temperature: values.get("melting_temperature"),
                offset_exponent: values.get("offset_exponent"),
                strain_exponent: values.get("strain_exponent"),
                floor_exponent: values.get("floor_exponent"),
                tanh_exponent: TANH_EXPONENT,
            },
        })
    },
};

#[cfg(test)]
mod tests {
    use super::super::{FlowState, FlowStressModel, find};
    use super::*;
    use crate::Values;
    use approx::assert_relative_eq;

    const CONSTANTS: [(&str, f64); 8] = [
        ("initial_yield", 968e6),
        ("hardening_modulus", 380e6),
        ("hardening_exponent", 0.421),
        ("rate_coefficient", 0.0197),
        ("softening_exponent", 0.577),
        ("reference_rate", 0.1),
        ("reference_temperature", 298.0),
        ("melting_temperature", 1878.0),
    ];

    fn titanium() -> Box<dyn FlowStressModel> {
        (ENTRY.build)(&Values::resolve(&PARAMETERS, &CONSTANTS).unwrap())
    }

    fn state(plastic_strain: f64, temperature: f64) -> FlowState {
        FlowState { plastic_strain, plastic_strain_rate: 1e4, temperature }
    }

    #[test]
    fn hot_material_softens_with_strain_by_hand() {
        // eps_p = 1, T = 1000 K: hardening 968e6 + 380e6/e = 1107.794e6; rate 1 + 0.0197 ln 1e5 = 1.226805;
        // T* = 702/1580 = 0.444304, ^0.577 = 0.626198: 0.373802; D = 1 - 1000/1878 = 0.467519;
        // S = 0.532481^0.4 = 0.777180, 1.777180^-6 = 0.031740, tanh = 0.031730: 0.484414.
        let found = titanium().flow_stress(&state(1.0, 1000.0));
        assert_relative_eq!(
            found,
            1107.794e6 * 1.226805 * 0.373802 * 0.484414,
            max_relative = 1e-5
        );
        assert!(found < 0.6 * titanium().flow_stress(&state(0.1, 1000.0)));
    }

    #[test]
    fn cold_undeformed_material_does_not_soften() {
        // S = (298/1878)^0.4 = 0.479, S^-6 = 83: tanh is 1 to rounding.
        let at_rest =
            FlowState { plastic_strain: 0.0, plastic_strain_rate: 0.1, temperature: 298.0 };
        assert_relative_eq!(titanium().flow_stress(&at_rest), 968e6, max_relative = 1e-12);
    }

    #[test]
    fn it_is_the_law_of_sima_and_ozel_without_their_power() {
        let other = find("tanh_johnson_cook").unwrap();
        let mut values = CONSTANTS.to_vec();
        values.extend([
            ("hardening_damping", 1.6),
            ("offset_exponent", 0.4),
            ("strain_exponent", 6.0),
            ("floor_exponent", 1.0),
            ("tanh_exponent", 1.0),
        ]);
        let other = (other.build)(&Values::resolve(other.parameters, &values).unwrap());
        for strain in [0.0, 0.2, 1.0, 5.0] {
            for temperature in [250.0, 600.0, 1200.0, 1900.0] {
                let state = state(strain, temperature);
                assert_eq!(titanium().flow_stress(&state), other.flow_stress(&state));
            }
        }
    }
}
