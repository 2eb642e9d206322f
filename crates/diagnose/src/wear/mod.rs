//! What grows while a tool cuts.

pub(crate) mod files;
pub(crate) mod growth;
pub(crate) mod land;
