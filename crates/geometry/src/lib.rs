//! The shape of tools: cross-sections from angles, outlines, indexable inserts, STL and Gmsh meshes, silhouettes,
//! and the surface of a tool with the point of it that is nearest.
//!
//! Lengths are in m, angles in rad. Files are given as text or bytes; nothing is read here.

pub mod insert;
pub mod mesh;
pub mod outline;
pub mod silhouette;
pub mod tool_section;
pub mod tool_surface;
