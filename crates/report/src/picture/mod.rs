//! Pictures of the particles, the tool and the whole cut.

mod animation;
mod described;
mod distance;
mod field;
mod flaws;
mod layers;
mod plane;
mod raster;
mod run;
mod run_in_space;
mod space;
mod view;

pub(crate) use animation::{AnimatedField, Animation};
pub(crate) use described::{Picture, Pictures};
pub use field::ParticleField;
pub use layers::render_layers;
pub(crate) use plane::time_text;
pub use plane::{PictureOptions, render_snapshot};
pub use raster::Style;
pub(crate) use run::{draw_all, draw_setup, thumbnail, thumbnail_range, thumbnail_view};
pub use view::View;
