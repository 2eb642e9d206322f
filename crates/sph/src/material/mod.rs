//! What happens in a material point: elasticity, equation of state, stress update, memory.

pub(crate) mod data;
pub(crate) mod equation_of_state;
pub(crate) mod history;
pub(crate) mod point;
pub(crate) mod return_mapping;
pub(crate) mod return_with_memory;
pub(crate) mod thermoelasticity;
pub(crate) mod update;
