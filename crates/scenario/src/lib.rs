//! Scenario files: TOML text to a validated [`sphcut_sph::Setup`] in SI units.
//!
//! Every section is a table of keys ([`reference`] prints them all); parser,
//! error messages, JSON schema and reference page read the same tables, and
//! the keys of laws and options come from the parameter tables of the laws.
//! All mistakes of a file are reported in one go, each at its place.

mod bodies;
mod cut;
mod diagnosis;
mod effects;
mod ending;
mod equation_of_state;
mod flow_stress_table;
mod friction_heat;
mod heat_source;
mod identification;
mod inertia;
mod library;
mod machine;
mod material;
mod mesh;
mod outline;
mod passes;
mod patch;
mod placement;
mod recordings;
mod reference;
mod scenario;
mod schema;
mod sections;
mod shared;
mod silhouette;
mod spacing;
mod sweep;
mod tool;
mod tool_geometry;
mod tool_heat;
mod tool_shapes;
mod turning_insert;
mod turning_tool;
mod wall;
mod warnings;
mod window;

pub use diagnosis::{
    AirRecord, DiagnosisCase, DiagnosisFile, PairedRunsPlan, ReferenceCuts, SeriesPlan,
    load_diagnosis, load_diagnosis_file,
};
pub use patch::{PatchError, ScenarioPatch, with_value};

pub use ending::{Output, Steady, Stop};
pub use identification::{Identification, StatedMaterial, TestCurve, load_identification};
pub use recordings::{
    RecordingChannel, RecordingCut, RecordingFile, Recordings, ResponseLine, load_recordings,
};
pub use reference::{
    diagnosis_reference, identification_reference, recordings_reference, reference, sweep_reference,
};
pub use scenario::{Scenario, load, parse};
pub use schema::{schema, taplo};
pub use sweep::{Axis, Design, Held, KeyPath, Levels, Sweep, Unfit, load_sweep, multiple};

use sphcut_input::OutsideFiles;
use std::sync::Arc;

/// How a scenario is loaded.
#[derive(Debug, Clone, Default)]
pub struct LoadOptions {
    /// Whether it may name files outside its own directory.
    pub outside_files: OutsideFiles,
    /// What is changed in the scenario that is loaded, or that is the base of a sweep.
    pub patch: Option<Arc<ScenarioPatch>>,
}

/// Name and text of every shipped material.
#[must_use]
pub fn shipped_materials() -> &'static [(&'static str, &'static str)] {
    library::MATERIALS
}
