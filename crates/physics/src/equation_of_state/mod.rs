//! Equations of state: the pressure of a volume ratio and a temperature.
//!
//! A law is one file; [`LAWS`] is the only registration. The linear one is that of
//! [`crate::elasticity`] and needs no numbers beyond the elastic ones.

mod mie_gruneisen;
mod series;

pub use mie_gruneisen::MieGruneisen;

use crate::{Parameter, Values};

/// What an equation of state takes from the rest of the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceState {
    /// rho_0 in kg/m^3.
    pub density: f64,
    /// cp in J/(kg K) at the temperature of no stress.
    pub specific_heat: f64,
}

/// One law of the catalogue.
#[derive(Debug)]
pub struct EquationOfStateEntry {
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
    /// Builds the law from checked values of `parameters`; `None` where the elastic moduli say all.
    pub build: Option<fn(&Values, &ReferenceState) -> MieGruneisen>,
}

/// Linear in the density.
const LINEAR: EquationOfStateEntry = EquationOfStateEntry {
    key: "linear",
    title: "Linear equation of state",
    equation: "p = K (1/J - 1), J = V/V_0",
    source: "Hooke's law with the volume ratio",
    validity: "a few per cent of volume change; no thermal expansion, no heat of compression",
    parameters: &[],
    build: None,
};

/// All equations of state.
pub const LAWS: &[&EquationOfStateEntry] = &[&LINEAR, &mie_gruneisen::ENTRY];

/// The law named `key`, if there is one.
#[must_use]
pub fn find(key: &str) -> Option<&'static EquationOfStateEntry> {
    LAWS.iter().copied().find(|law| law.key == key)
}
