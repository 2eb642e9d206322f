//! Dynamic strain ageing: a bump of the flow stress over temperature (blue brittleness of steel).

use super::{Action, EffectEntry, FlowStressFactor, scaled};
use crate::candidate::{self, Candidate, Family, Free, Runs};
use crate::flow_stress::FlowState;
use crate::{Parameter, Quantity, Range};
use std::f64::consts::LN_10;

/// ```text
/// x [1 + a exp(-((T - T_b)/w)^2)],   T_b = T_0 + s log10(max(r/r_0, 1))
/// ```
/// Solute atoms that diffuse as fast as dislocations move pin them: the flow stress of ferritic steel
/// rises again over a band of temperature, which shifts upwards with the strain rate because
/// diffusion has to be faster. Nemat-Nasser and Guo, Mech. Mater. 35 (2003) 1023-1047, compressed
/// DH-36 and found the peak at about 600 K for 1e-3/s, 650 K for 0.1/s and 800 K for 3000/s; the
/// defaults T_0 = 600 K and s = 31 K per decade are the straight line through the first and the last.
///
/// The bump is a Gaussian for want of theory, and its height is the same at all strains and rates.
/// Beyond 3000/s the shift is extrapolated. Where T < T_b the flow stress may fall with rising rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainAgeing {
    /// a.
    pub bump_height: f64,
    /// T_0 in K.
    pub bump_temperature: f64,
    /// s in K.
    pub shift_per_decade: f64,
    /// w in K.
    pub bump_width: f64,
    /// r_0 in 1/s.
    pub ageing_rate: f64,
}

impl StrainAgeing {
    /// T_b in K.
    #[inline]
    #[must_use]
    pub fn peak(&self, plastic_strain_rate: f64) -> f64 {
        let decades = (plastic_strain_rate / self.ageing_rate).max(1.0).log10();
        self.bump_temperature + self.shift_per_decade * decades
    }
}

impl FlowStressFactor for StrainAgeing {
    #[inline]
    fn factor(&self, state: &FlowState) -> f64 {
        let off_peak = (state.temperature - self.peak(state.plastic_strain_rate)) / self.bump_width;
        1.0 + self.bump_height * (-off_peak * off_peak).exp()
    }

    #[inline]
    fn factor_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let off_peak = (state.temperature - self.peak(state.plastic_strain_rate)) / self.bump_width;
        let bump = self.bump_height * (-off_peak * off_peak).exp();
        let mut shift = 0.0;
        if state.plastic_strain_rate > self.ageing_rate {
            shift = self.shift_per_decade * change.plastic_strain_rate
                / (state.plastic_strain_rate * LN_10);
        }
        let moved = (change.temperature - shift) / self.bump_width;
        (1.0 + bump, -2.0 * off_peak * bump * moved)
    }
}

const fn kelvin(
    key: &'static str,
    symbol: &'static str,
    range: Range,
    default: Option<f64>,
    meaning: &'static str,
) -> Parameter {
    let quantity = Quantity::TemperatureDifference;
    let source = "Nemat-Nasser and Guo 2003, DH-36";
    Parameter { key, symbol, quantity, range, default, meaning, source }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "strain_ageing",
    title: "Dynamic strain ageing: a bump of the flow stress over temperature",
    equation: "x [1 + a exp(-((T - T_b)/w)^2)], T_b = T_0 + s log10(max(r/r_0, 1))",
    source: "Nemat-Nasser and Guo, Mech. Mater. 35 (2003) 1023-1047 for the shift of the peak",
    validity: "ferritic steels; the Gaussian and its height are fitted, the shift is extrapolated \
               above 3000/s",
    signature: "forces up in a band of cutting speed and uncut chip thickness",
    parameters: &[
        Parameter {
            key: "bump_height",
            symbol: "a",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 3.0),
            default: None,
            meaning: "height of the bump relative to the flow stress without it",
            source: "user",
        },
        Parameter {
            key: "bump_temperature",
            symbol: "T_0",
            quantity: Quantity::Temperature,
            range: Range::above(0.0, 3000.0),
            default: Some(600.0),
            meaning: "temperature of the peak at the rate r_0 and below",
            source: "Nemat-Nasser and Guo 2003, DH-36",
        },
        kelvin(
            "shift_per_decade",
            "s",
            Range::closed(0.0, 500.0),
            Some(31.0),
            "shift of the peak for a tenfold strain rate",
        ),
        kelvin(
            "bump_width",
            "w",
            Range::above(0.0, 2000.0),
            Some(150.0),
            "distance from the peak at which the bump has fallen to 1/e",
        ),
        Parameter {
            key: "ageing_rate",
            symbol: "r_0",
            quantity: Quantity::Rate,
            range: Range::above(0.0, 1e6),
            default: Some(1e-3),
            meaning: "strain rate at and below which the peak lies at T_0",
            source: "Nemat-Nasser and Guo 2003, DH-36",
        },
    ],
    example: &[("bump_height", 0.3)],
    vanishing: &[("bump_height", 0.0)],
    demands: &[],
    action: Action::FlowStress(|values, _, base| {
        scaled(
            base,
            StrainAgeing {
                bump_height: values.get("bump_height"),
                bump_temperature: values.get("bump_temperature"),
                shift_per_decade: values.get("shift_per_decade"),
                bump_width: values.get("bump_width"),
                ageing_rate: values.get("ageing_rate"),
            },
        )
    }),
    candidate: Some(Candidate {
        title: "dynamic strain ageing raises the flow stress in a band of temperature",
        family: Family::RateSize,
        free: &[
            Free::linear("bump_height", (0.03, 0.6), 0.0),
            Free::shape("bump_temperature", (300.0, 650.0)),
        ],
        runs: Runs::At(&[&[0.4, 350.0], &[0.4, 500.0], &[0.4, 640.0]]),
        strength: candidate::first,
    }),
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const STEEL: StrainAgeing = StrainAgeing {
        bump_height: 0.3,
        bump_temperature: 600.0,
        shift_per_decade: 31.0,
        bump_width: 150.0,
        ageing_rate: 1e-3,
    };

    #[test]
    fn the_peak_moves_as_measured() {
        // 600 + 31 * log10(3e6) = 600 + 31 * 6.477121 = 800.79 K; measured about 800 K.
        assert_relative_eq!(STEEL.peak(3000.0), 800.79, max_relative = 1e-5);
        // 600 + 31 * 2 = 662 K; measured about 650 K.
        assert_relative_eq!(STEEL.peak(0.1), 662.0, max_relative = 1e-12);
        assert_eq!(STEEL.peak(0.0), 600.0);
    }

    #[test]
    fn one_value_by_hand() {
        // 1e2/s: T_b = 600 + 31 * 5 = 755 K. At 605 K: 1 + 0.3 exp(-1) = 1.1103638.
        let state = FlowState { plastic_strain: 0.2, plastic_strain_rate: 1e2, temperature: 605.0 };
        assert_relative_eq!(STEEL.factor(&state), 1.110_363_8, max_relative = 1e-7);
    }
}
