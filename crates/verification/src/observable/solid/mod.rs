//! Bodies without a tool: motion, waves, stress, balances.

pub(crate) mod amplitude_ratio;
pub(crate) mod angular_momentum_ratio;
pub(crate) mod body_extent;
pub(crate) mod compression;
pub(crate) mod contact_duration;
pub(crate) mod energy;
pub(crate) mod flow_stress_table;
pub(crate) mod fragments;
pub(crate) mod kernel;
pub(crate) mod momentum;
pub(crate) mod oscillation;
pub(crate) mod restitution;
pub(crate) mod shock;
pub(crate) mod stress;
