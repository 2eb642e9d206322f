//! The upturn of the flow stress at high strain rates: viscous drag.

use super::{Action, EffectEntry};
use crate::candidate::{self, Candidate, Family, Free, Runs};
use crate::flow_stress::{FlowState, FlowStressLaw, FlowStressModel};
use crate::{Parameter, Quantity, Range};

/// ```text
/// sigma_y = sigma_base(eps_p, r, T) + D (r/r_d)^k sigma_base(eps_p, 0, T)
/// ```
/// On Johnson-Cook, whose rate factor is 1 at and below the reference rate, this is
/// `(A + B eps_p^n) (1 + C ln(r/r_0) + D (r/r_d)^k) (1 - T*^m)`: the form of Couque, Phil. Trans. R.
/// Soc. A 372 (2014) 20130218. Above some 1e3 to 1e4/s dislocations no longer wait for thermal
/// activation at their obstacles; their speed, and with it the stress beyond the logarithm, is
/// limited by the drag of phonons and electrons (review: Follansbee and Kocks, Acta Metall. 36
/// (1988) 81-93, who attribute part of the upturn to faster hardening).
///
/// The share D is taken at the rate r_d = 1e5/s, of the order met in a shear zone, and the exponent
/// 1/2 is a choice between the logarithm and linear drag (k = 1). Neglected: drag grows with
/// temperature, here it softens with the base law; the upturn through faster hardening.
#[derive(Debug)]
pub struct ViscousDrag {
    base: Box<dyn FlowStressModel>,
    /// D.
    drag_coefficient: f64,
    /// r_d in 1/s.
    drag_rate: f64,
    /// k.
    drag_exponent: f64,
}

impl ViscousDrag {
    /// D (r/r_d)^k.
    #[inline]
    fn drag(&self, plastic_strain_rate: f64) -> f64 {
        self.drag_coefficient
            * (plastic_strain_rate.max(0.0) / self.drag_rate).powf(self.drag_exponent)
    }
}

/// The state without rate.
fn at_rest(state: &FlowState) -> FlowState {
    FlowState { plastic_strain_rate: 0.0, ..*state }
}

impl FlowStressLaw for ViscousDrag {
    fn flow_stress(&self, state: &FlowState) -> f64 {
        let drag = self.drag(state.plastic_strain_rate);
        if drag == 0.0 {
            return self.base.flow_stress(state);
        }
        self.base.flow_stress(state) + drag * self.base.flow_stress(&at_rest(state))
    }

    fn flow_stress_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let (stress, slope) = self.base.flow_stress_along(state, change);
        let drag = self.drag(state.plastic_strain_rate);
        if drag == 0.0 {
            return (stress, slope);
        }
        let (resting, resting_slope) =
            self.base.flow_stress_along(&at_rest(state), &at_rest(change));
        let growth =
            self.drag_exponent * drag * change.plastic_strain_rate / state.plastic_strain_rate;
        (stress + drag * resting, slope + drag * resting_slope + growth * resting)
    }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "viscous_drag",
    title: "Upturn of the flow stress at high strain rates",
    equation: "sigma_y = sigma_base(eps_p, r, T) + D (r/r_d)^k sigma_base(eps_p, 0, T); on Johnson-Cook \
               the rate factor becomes 1 + C ln(r/r_0) + D (r/r_d)^k",
    source: "Couque, Phil. Trans. R. Soc. A 372 (2014) 20130218; r_d and k as a choice",
    validity: "rates above some 1e3/s, where the logarithm of the base law is too weak; the drag \
               softens with temperature as the base law does",
    signature: "cutting force up, most at high speed and small uncut chip thickness",
    parameters: &[
        Parameter {
            key: "drag_coefficient",
            symbol: "D",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 10.0),
            default: None,
            meaning: "share of the strength without rate that drag adds at the drag rate",
            source: "user",
        },
        Parameter {
            key: "drag_rate",
            symbol: "r_d",
            quantity: Quantity::Rate,
            range: Range::closed(1.0, 1e9),
            default: Some(1e5),
            meaning: "strain rate at which the drag adds the share D",
            source: "order of the rate in a primary shear zone",
        },
        Parameter {
            key: "drag_exponent",
            symbol: "k",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.1, 1.0),
            default: Some(0.5),
            meaning: "exponent of the drag: 1 is linear in the rate",
            source: "choice between the logarithm and linear drag",
        },
    ],
    example: &[("drag_coefficient", 0.3)],
    vanishing: &[("drag_coefficient", 0.0)],
    demands: &[],
    action: Action::FlowStress(|values, _, base| {
        Box::new(ViscousDrag {
            base,
            drag_coefficient: values.get("drag_coefficient"),
            drag_rate: values.get("drag_rate"),
            drag_exponent: values.get("drag_exponent"),
        })
    }),
    candidate: Some(Candidate {
        title: "the flow stress turns up at high strain rates",
        family: Family::RateSize,
        free: &[Free::linear("drag_coefficient", (0.02, 0.5), 0.0)],
        runs: Runs::At(&[&[0.3]]),
        strength: candidate::first,
    }),
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::tests::{STEEL, on};
    use approx::assert_relative_eq;

    #[test]
    fn on_johnson_cook_the_drag_joins_the_rate_factor() {
        let law = on(&ENTRY, &[("drag_coefficient", 0.3)]);
        let at = |plastic_strain_rate| FlowState {
            plastic_strain: 1.0,
            plastic_strain_rate,
            temperature: 293.15,
        };
        // eps_p = 1: A + B = 945 MPa, cold. Rate 4e5: 1 + 0.07 * 12.899220 + 0.3 * 2 = 2.5029454;
        // 945e6 * 2.5029454 = 2365.28 MPa.
        assert_relative_eq!(law.flow_stress(&at(4e5)), 2365.28e6, max_relative = 1e-5);
        // At rest nothing drags.
        assert_eq!(law.flow_stress(&at(0.0)), STEEL.flow_stress(&at(0.0)));
    }
}
