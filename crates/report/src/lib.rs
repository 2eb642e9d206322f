//! Pictures and pages from the plain results of a run.

mod canvas;
mod picture;
mod ticks;

pub use picture::{Field, PictureOptions, View, render_snapshot};
