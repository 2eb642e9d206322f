//! The discrete operators: neighbours, reference configuration, gradients and forces, Laplacian, support shapes, density
//! diffusion, particle shifting.

pub(crate) mod candidates;
pub(crate) mod cells;
pub(crate) mod density_diffusion;
pub(crate) mod kinship;
pub(crate) mod laplacian;
pub(crate) mod neighbours;
pub(crate) mod pairing;
pub(crate) mod reference;
pub(crate) mod shifting;
pub(crate) mod strain_gradient;
pub(crate) mod support_shape;
pub(crate) mod sweeps;
