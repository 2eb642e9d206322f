//! What a run means: steady state, forces with their uncertainty, chip, balances.
//!
//! [`evaluate`] turns a [`sphcut_record::Run`] into a [`ProcessResult`], [`summary_json`] turns
//! that into `summary.json`, whose schema `docs/summary_json.md` describes.

mod balances;
pub mod calibration;
mod checks;
mod chip;
mod cloud;
mod contact;
mod forces;
mod geometry;
mod interface;
mod known;
mod missing;
mod outline;
mod process;
mod result;
mod segments;
mod shear_zone;
mod space;
pub mod springback;
pub mod statistics;
pub mod steady;
mod summary;
mod surface;
mod temperature;
mod warnings;

/// Test support of this crate and of others, which the linker leaves out of the program. Behind a feature it would have whatever
/// rests on this crate compiled once with and once without it.
#[path = "../tests/synthetic/mod.rs"]
pub mod synthetic;

pub use balances::{
    ENERGY_TERMS, EnergyBalance, EnergyTerm, HeatBalance, MomentumBalance, MomentumBalances,
    TermKind, ToolHeatBalance,
};
pub use forces::{Force, Forces, SteadyWindow};
pub use geometry::{AlongEdge, Chip, ContactLengths, EdgeSection, Geometry};
pub use interface::{Interface, InterfaceBin};
pub use known::KnownForce;
pub use missing::Missing;
pub use process::{evaluate, evaluate_with};
pub use result::{Extremes, ParticleResolution, PassResult, ProcessResult, StressBin};
pub use segments::Segments;
pub use shear_zone::ShearZone;
pub use summary::{SCHEMA_VERSION, Summary, summary_json};
pub use surface::MachinedSurface;
pub use temperature::{InterfaceTemperature, Temperatures};
pub use warnings::Warning;
