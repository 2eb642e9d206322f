//! Coulomb friction.

use super::{ContactState, FrictionEntry, FrictionLaw};
use crate::{Parameter, Quantity, Range};

/// `tau = mu p`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// mu.
    pub friction_coefficient: f64,
}

impl FrictionLaw for Coulomb {
    #[inline]
    fn shear_limit(&self, state: &ContactState) -> f64 {
        self.friction_coefficient * state.pressure
    }
}

pub(super) const FRICTION_COEFFICIENT: Parameter = Parameter {
    key: "friction_coefficient",
    symbol: "mu",
    quantity: Quantity::Dimensionless,
    range: Range::closed(0.0, 2.0),
    default: None,
    meaning: "ratio of friction to normal stress while sliding",
    source: "user",
};

pub(super) const ENTRY: FrictionEntry = FrictionEntry {
    key: "coulomb",
    title: "Coulomb",
    equation: "tau = mu p",
    source: "textbook",
    validity: "light contact; exceeds the shear strength of the chip at high pressure",
    parameters: &[FRICTION_COEFFICIENT],
    build: |values| Box::new(Coulomb { friction_coefficient: values.get("friction_coefficient") }),
};
