//! A material that never yields.

use super::{FlowState, FlowStressEntry, FlowStressLaw};

/// `sigma_y = infinity`: linear elasticity only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic;

impl FlowStressLaw for Elastic {
    #[inline]
    fn flow_stress(&self, _state: &FlowState) -> f64 {
        f64::INFINITY
    }
}

pub(super) const ENTRY: FlowStressEntry = FlowStressEntry {
    key: "elastic",
    title: "Elastic, no yielding",
    equation: "sigma_y = infinity",
    source: "definition",
    validity: "verification cases and bodies that stay elastic",
    parameters: &[],
    table: None,
    build: |_| Box::new(Elastic),
};
