//! Friction laws: the largest shear stress or force that contact can transmit.
//!
//! A law is one file; [`LAWS`] is the only registration.

mod coulomb;
mod shear_capped_coulomb;

pub use coulomb::Coulomb;
pub use shear_capped_coulomb::ShearCappedCoulomb;

use crate::{Parameter, Values};
use std::fmt::Debug;

/// The state of a contact on which a friction limit depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Contact pressure in Pa, never negative.
    pub pressure: f64,
    /// Flow stress of the workpiece at the contact in Pa.
    pub flow_stress: f64,
    /// Magnitude of the sliding velocity in m/s.
    pub sliding_speed: f64,
    /// Temperature of the workpiece at the contact in K.
    pub temperature: f64,
}

/// A friction law: a pure function of the contact state.
pub trait FrictionLaw: Debug + Send + Sync {
    /// Largest tangential stress in Pa; never negative. Below it the contact sticks.
    fn shear_limit(&self, state: &ContactState) -> f64;
}

/// One law of the catalogue.
#[derive(Debug)]
pub struct FrictionEntry {
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
    /// Builds the law from checked values of `parameters`.
    pub build: fn(&Values) -> Box<dyn FrictionLaw>,
}

/// All friction laws.
pub const LAWS: &[&FrictionEntry] = &[&coulomb::ENTRY, &shear_capped_coulomb::ENTRY];

/// The law named `key`, if there is one.
#[must_use]
pub fn find(key: &str) -> Option<&'static FrictionEntry> {
    LAWS.iter().copied().find(|law| law.key == key)
}
