//! Contact and friction.

pub(crate) mod compressed_strip;
pub(crate) mod friction;
pub(crate) mod hertz;
pub(crate) mod indented_surface;
pub(crate) mod pressed_cylinder;
pub(crate) mod rake_friction;
pub(crate) mod rough_plates;
pub(crate) mod slip_line;
pub(crate) mod upset_ring;
