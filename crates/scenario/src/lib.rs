//! Scenario files: TOML text to a validated [`sphcut_sph::Setup`] in SI units.
//!
//! Every section is a table of keys ([`reference`] prints them all); parser,
//! error messages, JSON schema and reference page read the same tables, and
//! the keys of laws and options come from the parameter tables of the laws.
//! All mistakes of a file are reported in one go, each at its place.

mod bodies;
mod columns;
mod cut;
mod cut_table;
mod diagnosis;
mod document;
mod effects;
mod ending;
mod equation_of_state;
mod field_reader;
mod files;
mod findings;
mod flow_stress_table;
mod force_table;
mod friction_heat;
mod heat_source;
mod identification;
mod inertia;
mod library;
mod machine;
mod material;
mod measured;
mod mesh;
mod outline;
mod passes;
mod patch;
mod placement;
mod problem;
mod reader;
mod record;
mod recordings;
mod reference;
mod scenario;
mod schema;
mod section;
mod sections;
mod series_table;
mod shared;
mod silhouette;
mod spacing;
mod spelling;
mod sweep;
mod tool;
mod tool_geometry;
mod tool_heat;
mod tool_shapes;
mod turning_insert;
mod turning_tool;
mod units;
mod wall;
mod warnings;
mod window;

pub use files::OutsideFiles;
pub use findings::{Origin, ResolvedEntry};
pub use problem::{Colours, Mistake, Problem};

pub use columns::TableProblem;
pub use cut_table::{CutTableRow, MEASURED, read_cut_table};
pub use diagnosis::{
    AirRecord, DiagnosisCase, DiagnosisFile, PairedRunsPlan, ReferenceCuts, SeriesPlan,
    load_diagnosis, load_diagnosis_file,
};
pub use force_table::{ForceTableRow, read_force_table};
pub use measured::{
    MeasuredForces, MeasuredSpringback, read_measured_forces, read_measured_springback,
};
pub use patch::{PatchError, ScenarioPatch, with_value};
pub use series_table::{SeriesRow, read_series_table};

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
pub use units::UnitError;

use findings::Findings;
use problem::Source;
use std::ops::Range;
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

/// Syntax errors of the TOML parser as problems.
fn report_syntax(findings: &mut Findings, source: &Arc<Source>, errors: &[toml::de::Error]) {
    for error in errors.iter().take(MOST_SYNTAX_ERRORS) {
        let message = error.message().replace('\n', "; ");
        // The first half says it all; the parser's second guess would mislead.
        let message = message.replace("must be quoted, expected literal string", "must be quoted");
        let span = error.span().unwrap_or(0..0);
        findings.problem(source, span, Mistake::Syntax { message });
    }
}

/// More would bury the first one, from which the others usually follow.
const MOST_SYNTAX_ERRORS: usize = 10;

/// The first line that is neither empty nor a comment: the place of what concerns the whole file.
fn first_line(text: &str) -> Range<usize> {
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let content = line.trim();
        if !content.is_empty() && !content.starts_with('#') {
            return start..start + line.trim_end().len();
        }
        start += line.len();
    }
    0..text.find('\n').unwrap_or(text.len())
}
