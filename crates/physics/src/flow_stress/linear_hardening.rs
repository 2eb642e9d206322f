//! Linear isotropic hardening, independent of rate and temperature.

use super::{FlowState, FlowStressEntry, FlowStressLaw};
use crate::{Parameter, Quantity, Range};

/// `sigma_y = sigma_0 + H eps_p`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearHardening {
    /// sigma_0 in Pa.
    pub initial_yield: f64,
    /// H in Pa.
    pub hardening_modulus: f64,
}

impl FlowStressLaw for LinearHardening {
    #[inline]
    fn flow_stress(&self, state: &FlowState) -> f64 {
        self.initial_yield + self.hardening_modulus * state.plastic_strain
    }
}

pub(super) const ENTRY: FlowStressEntry = FlowStressEntry {
    key: "linear_hardening",
    title: "Linear hardening",
    equation: "sigma_y = sigma_0 + H eps_p",
    source: "textbook; used for the copper Taylor bar (e.g. Zhu and Cescotto 1995)",
    validity: "small range of strain; neglects rate and temperature",
    parameters: &[
        Parameter {
            key: "initial_yield",
            symbol: "sigma_0",
            quantity: Quantity::Stress,
            range: Range::above(0.0, 1e11),
            default: None,
            meaning: "yield stress of the undeformed material",
            source: "user",
        },
        Parameter {
            key: "hardening_modulus",
            symbol: "H",
            quantity: Quantity::Stress,
            range: Range::closed(0.0, 1e11),
            default: Some(0.0),
            meaning: "slope of the yield stress over the plastic strain",
            source: "0 is perfect plasticity",
        },
    ],
    table: None,
    build: |values| {
        Box::new(LinearHardening {
            initial_yield: values.get("initial_yield"),
            hardening_modulus: values.get("hardening_modulus"),
        })
    },
};
