//! Scenario files: TOML text to a validated [`sphcut_sph::Setup`] in SI units.
//!
//! Every section is a table of keys ([`reference`] prints them all); parser,
//! error messages, JSON schema and reference page read the same tables, and
//! the keys of laws and options come from the parameter tables of the laws.
//! All mistakes of a file are reported in one go, each at its place.

mod bodies;
mod cut;
mod ending;
mod friction_heat;
mod heat_source;
mod key;
mod material;
mod patch;
mod placement;
mod process;
mod reference;
mod scenario;
mod schema;
mod sections;
mod shared;
mod spacing;
mod tool;
mod wall;
mod warnings;

pub use key::KeyPath;
pub use patch::{PatchError, ScenarioPatch, with_value};

pub use ending::{Output, Steady, Stop};
pub use reference::reference;
pub use scenario::{Scenario, load, parse};
pub use schema::{schema, taplo};

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
    material::library::MATERIALS
}
