//! Dynamic recovery: strain hardening that saturates at large strain.

use super::{Action, EffectEntry};
use crate::flow_stress::{FlowState, FlowStressLaw, FlowStressModel};
use crate::{Parameter, Quantity, Range};

/// ```text
/// sigma_y(eps_h, r, T),   d eps_h = (1 - w eps_h) d eps_p,   so   eps_h = (1 - exp(-w eps_p))/w
/// ```
/// Dislocations that meet annihilate: the more there are, the less a further strain adds. The flow-stress law is
/// asked at a strain eps_h of hardening, which every increment of strain raises and recovery lowers in proportion to what is
/// there, as in the law of Voce (J. Inst. Met. 74 (1948) 537-562); physics: Kocks and Mecking, Prog. Mater. Sci. 48
/// (2003) 171-273. It ends at 1/w. A power law of hardening is fitted to strains below 1 and rises without end, whereas chips are strained
/// to 2 and more.
///
/// Limits: w is the same at all temperatures and rates, although recovery is faster in the hot and the slow; no
/// recrystallisation, and nothing recovers with time alone. The rate of a law that depends on the strain rate is not touched.
#[derive(Debug)]
pub struct DynamicRecovery {
    base: Box<dyn FlowStressModel>,
    /// w, above 0.
    recovery_rate: f64,
}

impl DynamicRecovery {
    /// The state at which the law is asked.
    #[inline]
    fn recovered(&self, state: &FlowState) -> FlowState {
        let hardening = -(-self.recovery_rate * state.plastic_strain).exp_m1() / self.recovery_rate;
        FlowState { plastic_strain: hardening, ..*state }
    }
}

impl FlowStressLaw for DynamicRecovery {
    #[inline]
    fn flow_stress(&self, state: &FlowState) -> f64 {
        self.base.flow_stress(&self.recovered(state))
    }

    #[inline]
    fn flow_stress_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let left = (-self.recovery_rate * state.plastic_strain).exp();
        let change = FlowState { plastic_strain: left * change.plastic_strain, ..*change };
        self.base.flow_stress_along(&self.recovered(state), &change)
    }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "dynamic_recovery",
    title: "Dynamic recovery: strain hardening that saturates",
    equation: "sigma_y(eps_h, r, T), eps_h = (1 - exp(-w eps_p))/w",
    source: "Voce, J. Inst. Met. 74 (1948) 537-562; Kocks and Mecking, Prog. Mater. Sci. 48 (2003) \
             171-273",
    validity: "laws of hardening fitted to small strains; one rate of recovery at all temperatures and \
               strain rates; no recrystallisation",
    signature: "forces down where the chip is strained most: thick chips, negative rake",
    parameters: &[Parameter {
        key: "recovery_rate",
        symbol: "w",
        quantity: Quantity::Dimensionless,
        range: Range::closed(0.0, 100.0),
        default: None,
        meaning: "share of the hardening strain that recovers per strain; hardening ends at the strain 1/w",
        source: "user",
    }],
    example: &[("recovery_rate", 1.0)],
    vanishing: &[("recovery_rate", 0.0)],
    demands: &[],
    action: Action::FlowStress(|values, _, base| match values.get("recovery_rate") {
        0.0 => base,
        recovery_rate => Box::new(DynamicRecovery { base, recovery_rate }),
    }),
    // From cut to cut the strain of the chip hardly changes: it is not distinguishable from the hardening that every diagnosis fits.
    candidate: None,
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::tests::{STEEL, on};
    use approx::assert_relative_eq;

    fn cold(plastic_strain: f64) -> FlowState {
        FlowState { plastic_strain, plastic_strain_rate: 1.0, temperature: 293.15 }
    }

    #[test]
    fn one_value_by_hand() {
        // w = 1, eps_p = 2: eps_h = 1 - exp(-2) = 0.8646647, and 331 + 614 * 0.8646647^0.26 = 922.22 MPa;
        // without recovery 331 + 614 * 2^0.26 = 1066.25 MPa.
        let law = on(&ENTRY, &[]);
        assert_relative_eq!(law.flow_stress(&cold(2.0)), 922.22e6, max_relative = 1e-5);
        assert_relative_eq!(STEEL.flow_stress(&cold(2.0)), 1066.25e6, max_relative = 1e-5);
    }

    #[test]
    fn hardening_is_kept_at_small_strain_and_ends_at_large() {
        let law = on(&ENTRY, &[("recovery_rate", 2.0)]);
        // eps_h = eps_p (1 - w eps_p/2) for w eps_p << 1.
        let (small, base) = (law.flow_stress(&cold(1e-6)), STEEL.flow_stress(&cold(1e-6)));
        assert_relative_eq!(small, base, max_relative = 1e-6);
        // eps_h = 1/2.
        let end = STEEL.flow_stress(&cold(0.5));
        assert_relative_eq!(law.flow_stress(&cold(50.0)), end, max_relative = 1e-12);
    }

    #[test]
    fn more_recovery_is_never_stronger() {
        for strain in [0.0, 0.1, 1.0, 4.0] {
            let at = |w: f64| on(&ENTRY, &[("recovery_rate", w)]).flow_stress(&cold(strain));
            assert!(at(0.0) >= at(0.5) && at(0.5) >= at(2.0), "{strain}");
        }
    }
}
