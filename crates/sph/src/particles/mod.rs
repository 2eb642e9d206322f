//! The particles and who is near whom: lattice, motion, supports, window, reference update.

pub(crate) mod lattice;
pub(crate) mod motion;
pub(crate) mod reference_update;
pub(crate) mod supports;
pub(crate) mod window;
