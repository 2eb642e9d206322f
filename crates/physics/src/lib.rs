//! The laws of metal cutting as pure functions of numbers.
//!
//! Every law is one file that states its equation, its source and its limits,
//! and lists its parameters once, as data ([`Parameter`]). The scenario parser,
//! the error messages, the JSON schema, the catalogue and the generic tests
//! read that table. All numbers are SI.
//!
//! This crate does no I/O and knows no file format, clock or environment.

pub mod candidate;
pub mod catalogue;
mod channel;
mod constant_spread;
pub mod csv;
mod cutting_condition;
pub mod effects;
pub mod elasticity;
pub mod equation_of_state;
pub mod flow_stress;
pub mod friction;
pub mod heat;
pub mod parameter;
pub mod process;
pub mod quantity;
pub mod radial_return;
pub mod shear_plane;
pub mod temperature_table;

pub use channel::Channel;
pub use constant_spread::{BATCH_SCATTER, PUBLISHED_SPREAD};
pub use cutting_condition::{CuttingCondition, ToolGeometry};
pub use parameter::{Parameter, ParameterError, Range, Values};
pub use quantity::Quantity;
pub use temperature_table::{ROOM_TEMPERATURE, TemperatureTable};
