//! What happens in a material point: elasticity, equation of state, stress update, memory, strain gradients.

pub(crate) mod equation_of_state;
pub(crate) mod history;
pub(crate) mod point;
pub(crate) mod strain_gradient;
pub(crate) mod thermoelasticity;
