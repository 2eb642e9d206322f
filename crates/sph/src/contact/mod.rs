//! Contact: of particles with the tool, and of particles that do not belong together with each other.

pub(crate) mod friction;
pub(crate) mod repulsion;
pub(crate) mod self_contact;
pub(crate) mod surface;
pub(crate) mod surface_point;
pub(crate) mod tool_contact;
pub(crate) mod tool_holder;
pub(crate) mod tool_motion;
pub(crate) mod touch;
