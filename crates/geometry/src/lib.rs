//! The shape of tools: cross-sections from angles, outlines, indexable inserts, STL and Gmsh meshes, silhouettes.
//!
//! Lengths are in m, angles in rad. Files are given as text or bytes; nothing is read here.

pub mod insert;
pub mod mesh;
pub mod outline;
pub mod silhouette;
pub mod tool_section;
