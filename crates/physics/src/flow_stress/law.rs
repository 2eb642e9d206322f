//! What every flow-stress law is.

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
