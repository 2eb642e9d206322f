//! Temperature and heat.

pub(crate) mod contact_temperature;
pub(crate) mod moving_source;
pub(crate) mod temperature_profile;
pub(crate) mod thermal;
pub(crate) mod tool_heat;
