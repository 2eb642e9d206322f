//! Tables of measurements: a line with the columns and their units, a row per cut.

mod cut;
mod force;
mod measured;
mod series;

pub use cut::{CutTableRow, read_condition_table, read_cut_table};
pub use force::{ForceTableRow, read_force_table};
pub use measured::{
    MeasuredForceRow, MeasuredSpringback, read_measured_forces, read_measured_springback,
};
pub use series::{SeriesRow, read_series_table};
