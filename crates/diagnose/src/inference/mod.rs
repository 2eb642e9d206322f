//! From residuals to posterior probabilities: rows, fits, candidate effects, what may be claimed.

pub(crate) mod attribute;
pub(crate) mod change_error;
pub(crate) mod commissioning;
pub(crate) mod fit;
pub(crate) mod gaussian;
pub(crate) mod law;
pub(crate) mod locate;
pub(crate) mod monotone;
pub(crate) mod null;
pub(crate) mod places;
pub(crate) mod problem;
pub(crate) mod setups;
pub(crate) mod templates;
pub(crate) mod verdict;
