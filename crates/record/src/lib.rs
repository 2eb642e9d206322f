//! The record of a run: plain types ([`Run`]), their form on disk (`run.h5`,
//! `snapshots.vtkhdf`, `forces.csv`), checkpoints, and the [`driver`] that steps
//! a simulation and keeps the record.
//!
//! Three promises, each with a test: nothing that was saved is lost by a crash;
//! a resumed run has the same bits as an uninterrupted one; a result never
//! exists without its [`Provenance`].

pub mod driver;
mod error;
mod facts;
mod files;
mod provenance;
mod resources;
mod run;
mod samples;
mod snapshots;

pub use error::RunError;
pub use facts::{Facts, MaterialFacts};
pub use files::{
    Column, ColumnH5, FactH5, GroupH5, MOST_VALUES, PARTICLE_FIELDS, RunFiles, SnapshotField,
    TOOL_FIELDS, Verified, Wanted, create_anew, export_vtkhdf, has_checksums, open_lock,
    read_columns_h5, read_named_columns_h5, recover, stored_unit, verify_h5, verify_run,
    write_columns_h5,
};
pub use provenance::{Provenance, Setting, TemperatureUnit, ZERO_CELSIUS};
pub use run::{Outcome, Performance, Run};
pub use samples::Samples;
pub use snapshots::{SnapshotInfo, Snapshots};
