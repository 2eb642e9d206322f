//! Strain softening of hot material: the tanh factor of Sima and Ozel on any flow-stress law.

use super::{Action, Demand, EffectEntry, FlowStressFactor, scaled};
use crate::candidate::{self, Candidate, Family, Free, Runs};
use crate::flow_stress::tanh_johnson_cook::SOFTENING;
use crate::flow_stress::{FlowState, TanhSoftening, johnson_cook};

/// The factor of the law `tanh_johnson_cook` alone, without its damping of the hardening.
impl FlowStressFactor for TanhSoftening {
    #[inline]
    fn factor(&self, state: &FlowState) -> f64 {
        self.factor(state)
    }

    #[inline]
    fn factor_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        self.factor_along(state, change)
    }
}

pub(super) const ENTRY: EffectEntry = EffectEntry {
    key: "tanh_softening",
    title: "Strain softening of hot material (tanh)",
    equation: "x [D + (1 - D) tanh((eps_p + p)^-r)^s], D = 1 - (T/T_m)^d, p = (T/T_m)^b",
    source: "Sima and Ozel, Int. J. Mach. Tools Manuf. 50 (2010) 943-960; the idea: Calamaz, Coupard \
             and Girot, Int. J. Mach. Tools Manuf. 48 (2008) 275-288",
    validity: "stands for dynamic recovery and recrystallisation at large strain above half the \
               melting temperature; fitted to titanium; strains of 1 and more must be resolved",
    signature: "forces down, most where the chip is hot; serrated chips",
    parameters: &[
        johnson_cook::PARAMETERS[7],
        SOFTENING[0],
        SOFTENING[1],
        SOFTENING[2],
        SOFTENING[3],
    ],
    example: &[("melting_temperature", 1733.0), ("tanh_exponent", 1.0)],
    vanishing: &[("tanh_exponent", 0.0)],
    demands: &[Demand::OtherLawThan("tanh_johnson_cook"), Demand::OtherLawThan("tanh_calamaz")],
    action: Action::FlowStress(|values, _, base| scaled(base, TanhSoftening::from_values(values))),
    candidate: Some(Candidate {
        title: "hot material softens at large strain",
        family: Family::RateSize,
        free: &[Free::logarithmic("tanh_exponent", (0.02, 1.0), 0.0)],
        runs: Runs::At(&[&[0.1], &[0.5]]),
        strength: candidate::first,
    }),
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Values;
    use approx::assert_relative_eq;

    #[test]
    fn one_value_by_hand() {
        let values = Values::resolve(ENTRY.parameters, &[("melting_temperature", 1878.0)]).unwrap();
        let softening = TanhSoftening::from_values(&values);
        // T = 1000 K, eps_p = 3, s = 0.05: the factor of the law's own example, 0.943835.
        let state =
            FlowState { plastic_strain: 3.0, plastic_strain_rate: 1e4, temperature: 1000.0 };
        assert_relative_eq!(softening.factor(&state), 0.943_835, max_relative = 1e-5);
        let cold = FlowState { plastic_strain: 0.0, temperature: 300.0, ..state };
        assert_eq!(softening.factor(&cold), 1.0);
    }
}
