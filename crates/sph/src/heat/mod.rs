//! Heat: conduction, sources, the share of friction.

pub(crate) mod conduction;
pub(crate) mod source;
