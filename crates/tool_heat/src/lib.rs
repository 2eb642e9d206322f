//! Heat in the tool: conduction by finite elements, coupled to the particles that touch it.
//!
//! A particle covers its share A of the tool's surface (a length in the plane; in space taken as a square) about
//! its foot, and exchanges
//! ```text
//! q = h (T_particle - T_tool),   1/h = 1/h_c + dx / (2 k)
//! ```
//! with the tool there: h_c is the contact conductance, the second term the way from the
//! particle's centre to its surface through its own material, without which a good contact would have
//! its temperature half a spacing inside the workpiece. Of the heat of friction the tool takes the share
//! that the particle does not.
//!
//! The tool makes steps of its own, some tens of those of the particles. In between, times and places of
//! contact and the heat of friction are gathered for each particle; a step then solves the tool
//! implicitly in both its temperatures and those of the particles in contact,
//! ```text
//! Q = G c / (G + c) sum_a w_a (T_particle - T_a'),   G = h sum A dt
//! ```
//! (c: heat capacity of the particle, t: time in contact, w_a: share of node a in what is covered, T_a':
//! its temperature after the step), and moves exactly this heat from the particle to the nodes. It is
//! stable for any conductance, and the heat that leaves the workpiece is that which enters the tool, to
//! rounding. The error is of first order in the step, which `interval` bounds.
//!
//! Neglected: radiation, cooling of free surfaces, heat of the coating's interface with the substrate,
//! deformation of the tool.

mod body;
mod checkpoint;
mod conduction;
mod description;
mod heated_tool;
mod mesh;
mod octree;
mod outline;
mod rim;
mod skin;
mod solid;
mod stuffing;
#[cfg(test)]
mod tests;

pub use body::ToolMeshFacts;
pub use description::{Coating, OuterBoundary, ThermalMaterial, ToolHeat, ToolHeatError};
pub use heated_tool::{ContactPartner, HeatLedger, HeatedTool};
