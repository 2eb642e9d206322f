//! Orthogonal cutting in closed form: forces, temperatures, chip thickness and contact length.
//!
//! A continuous chip in plane strain: Oxley's parallel-sided shear zone, Oxley's or Zorev's contact on
//! the rake face, temperatures by fits or closed solutions of steady conduction, and forces of the cutting edge added to
//! those of the chip. The flow stress, friction and heat shares are those of `sphcut-physics`, so an effect of
//! the catalogue acts here through the same code as in the particle solver. One condition takes microseconds.
//!
//! What it is for: teaching, tests of whatever reasons about forces, and a cutting physics other than that of the
//! particle solver to test such reasoning with. It is no substitute for the solver: it knows no springback, no residual stress, no serrated
//! chip, no transient.
//!
//! ```
//! use sphcut_analytic::{ActiveEffect, OrthogonalCut, predict};
//! use sphcut_physics::CuttingCondition;
//! let cut = OrthogonalCut::aisi_1045();
//! let condition = CuttingCondition::new(2.5, 0.1e-3);
//! let plain = predict(&cut, &condition, &[])?;
//! let worn = ActiveEffect::new("viscous_drag", &[("drag_coefficient", 0.2)])?;
//! let changed = predict(&cut, &condition, &[worn])?;
//! assert!(changed.cutting_force > plain.cutting_force);
//! # Ok::<(), sphcut_analytic::Error>(())
//! ```
//!
//! All numbers are SI. No file, clock or environment is touched.

mod contact;
mod cut;
pub mod edge;
mod effects;
mod error;
pub mod heat;
mod physics;
mod predict;
mod root;
mod shear_zone;
mod solve;

pub use contact::RakeContact;
pub use cut::{CuttingTool, FlowStress, Linear, Observables, OrthogonalCut, WorkpieceMaterial};
pub use effects::{ActiveEffect, EFFECTS, Effect, REFERENCE_SPEED, THERMAL_SPAN, find};
pub use error::Error;
pub use physics::{
    Closure, FrictionSpeed, HeatPartition, Physics, Ploughing, RateConstant, RelationErrors,
    SecondaryLayer, ShearAngle,
};
pub use predict::{predict, solution};
pub use shear_zone::ParallelShearZone;
pub use solve::Solution;
pub use sphcut_physics::candidate::{Candidate, Family, Free, Runs, Scale};
