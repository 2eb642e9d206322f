//! Heat: conduction, sources, the share of friction, heat that passes into the tool.

pub(crate) mod conduction;
pub(crate) mod source;
pub(crate) mod tool;
