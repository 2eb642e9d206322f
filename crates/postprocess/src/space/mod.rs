//! Cuts in space by plane sections.

mod along_edge;
mod section;

pub(crate) use along_edge::measure;
pub(crate) use section::Axes;
