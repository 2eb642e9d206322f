//! Flow-stress laws: the stress at which the material yields.
//!
//! A law is one file with its [`FlowStressLaw`] implementation and its
//! [`FlowStressEntry`]; [`LAWS`] is the only registration.

mod elastic;
pub(crate) mod johnson_cook;
mod law;
mod linear_hardening;
mod table;
mod tabulated;
mod tanh_calamaz;
pub(crate) mod tanh_johnson_cook;

pub use elastic::Elastic;
pub use johnson_cook::JohnsonCook;
pub use law::{FlowState, FlowStressLaw};
pub use linear_hardening::LinearHardening;
pub use table::{FlowStressTable, FlowStressTableError};
pub use tabulated::Tabulated;
pub use tanh_johnson_cook::{TanhJohnsonCook, TanhSoftening};

use crate::radial_return::RadialReturn;
use crate::{Parameter, Values};
use std::fmt::Debug;

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
