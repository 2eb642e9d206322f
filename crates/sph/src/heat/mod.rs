//! Heat in the particles: conduction and sources.

pub(crate) mod conduction;
pub(crate) mod source;
