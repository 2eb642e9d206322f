//! A cut: forces, chip, machined surface, springback.

pub(crate) mod chip;
pub(crate) mod force_history;
pub(crate) mod machined_surface;
pub(crate) mod mean_force;
pub(crate) mod springback;
