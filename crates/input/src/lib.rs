//! Text with units to checked values: tables of keys, the reader, mistakes with their places, and tables of measurements.
//!
//! A file is read against [`section::Section`]s, tables of keys with unit, range and meaning. Parser, error messages, JSON schema and
//! reference pages read the same tables. All mistakes of a file are reported in one go, each at its place.

pub mod columns;
pub mod document;
mod field_reader;
pub mod files;
pub mod findings;
pub mod problem;
pub mod reader;
pub mod record;
pub mod reference;
pub mod section;
pub mod spelling;
mod tables;
pub mod units;

pub use columns::TableProblem;
pub use files::OutsideFiles;
pub use findings::{Origin, ResolvedEntry};
pub use problem::{Colours, Mistake, Problem, SourceText};
pub use tables::{
    CutTableRow, ForceTableRow, MeasuredForceRow, MeasuredSpringback, SeriesRow,
    read_condition_table, read_cut_table, read_force_table, read_measured_forces,
    read_measured_springback, read_series_table,
};
pub use units::UnitError;
