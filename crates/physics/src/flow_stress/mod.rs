//! Flow-stress laws: the stress at which the material yields.
//!
//! A law is one file with its [`FlowStressLaw`] implementation and its
//! [`FlowStressEntry`]; [`LAWS`] is the only registration.

mod elastic;
pub(crate) mod johnson_cook;
mod linear_hardening;
mod tabulated;
mod tanh_calamaz;
pub(crate) mod tanh_johnson_cook;

pub use elastic::Elastic;
pub use johnson_cook::JohnsonCook;
pub use linear_hardening::LinearHardening;
pub use tabulated::{FlowStressTable, TableError, Tabulated};
pub use tanh_johnson_cook::{TanhJohnsonCook, TanhSoftening};

use crate::radial_return::RadialReturn;
use crate::{Parameter, Values};
use std::fmt::Debug;

/// The state on which a flow stress depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowState {
    /// Equivalent plastic strain, dimensionless.
    pub plastic_strain: f64,
    /// Equivalent plastic strain rate in 1/s.
    pub plastic_strain_rate: f64,
    /// Absolute temperature in K.
    pub temperature: f64,
}

/// A flow-stress law: a pure function of the state.
pub trait FlowStressLaw: Debug + Send + Sync {
    /// Flow stress sigma_y in Pa; never negative, `f64::INFINITY` for a material that never yields.
    fn flow_stress(&self, state: &FlowState) -> f64;

    /// The flow stress and its derivative along `change`, in Pa: what the flow stress gains if the
    /// state moves by a small share of `change`, divided by that share.
    ///
    /// By a difference quotient of [`DIFFERENCE`]; a law that is evaluated in the time loop may
    /// give its own.
    fn flow_stress_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let moved = FlowState {
            plastic_strain: state.plastic_strain + DIFFERENCE * change.plastic_strain,
            plastic_strain_rate: state.plastic_strain_rate
                + DIFFERENCE * change.plastic_strain_rate,
            temperature: state.temperature + DIFFERENCE * change.temperature,
        };
        let here = self.flow_stress(state);
        (here, (self.flow_stress(&moved) - here) / DIFFERENCE)
    }
}

/// Share of the change over which the derivative of a flow stress is taken: the square root of the
/// rounding error, to the next power of ten.
const DIFFERENCE: f64 = 1e-7;

/// A law as the solver holds it: decided once per run, inlined below.
pub trait FlowStressModel: FlowStressLaw + RadialReturn {}
impl<Law: FlowStressLaw + RadialReturn> FlowStressModel for Law {}

/// One law of the catalogue.
#[derive(Debug)]
pub struct FlowStressEntry {
    /// Name in the scenario file.
    pub key: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The equation in one line of text.
    pub equation: &'static str,
    /// Where the law comes from.
    pub source: &'static str,
    /// Where it holds and what it neglects.
    pub validity: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// What the file of its table holds, for a law that has one ([`FlowStressTable`]).
    pub table: Option<&'static str>,
    /// Builds the law from checked values of `parameters`, and of its table if it has one.
    pub build: fn(&Values) -> Box<dyn FlowStressModel>,
}

/// All flow-stress laws.
pub const LAWS: &[&FlowStressEntry] = &[
    &elastic::ENTRY,
    &linear_hardening::ENTRY,
    &johnson_cook::ENTRY,
    &tanh_johnson_cook::ENTRY,
    &tanh_calamaz::ENTRY,
    &tabulated::ENTRY,
];

/// The law named `key`, if there is one.
#[must_use]
pub fn find(key: &str) -> Option<&'static FlowStressEntry> {
    LAWS.iter().copied().find(|law| law.key == key)
}
