//! The tool from a mesh file: STL (binary, ASCII) and Gmsh MSH (2.2 and 4.1, ASCII).
//!
//! ```text
//! bytes --stl, gmsh--> Mesh --surface--> closed triangle surface
//!                           --plane----> plane cross-section: one polygon
//! ```
//! Neither format carries a unit: coordinates stay in that of the file until [`Mesh::scaled`].
//! A file is from a stranger: its size bounds the memory, no count in it is believed.

mod error;
mod gmsh;
mod intersection;
mod plane;
mod stl;
mod surface;
mod vector;

pub use error::MeshError;
pub use vector::triangle_distance;

use error::Name;
use glam::DVec3;
use plane::CrossSection;
use std::collections::HashMap;

/// Largest mesh file in bytes.
pub const LARGEST_MESH: u64 = 64 << 20;
/// Most facets of a mesh.
const MOST_FACETS: usize = 200_000;
/// Largest coordinate in m.
const LARGEST_COORDINATE: f64 = 100.0;

/// Facets and lines with the numbers that the file gives them.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    facets: Vec<Facet>,
    lines: Vec<Line>,
}

/// A triangle; a quadrangle of the file is two of them with one name.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Facet {
    corners: [usize; 3],
    name: Name,
}

/// Vertices, and the indices of the vertices of each triangle.
pub type Surface = (Vec<DVec3>, Vec<[usize; 3]>);

/// A straight line element.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    ends: [usize; 2],
    name: Name,
}

impl Mesh {
    /// Reads the file, which format it has being seen from its content.
    ///
    /// # Errors
    /// What is wrong with it, with line, facet or element.
    pub fn read(bytes: &[u8]) -> Result<Self, MeshError> {
        let mesh = if gmsh::is_gmsh(bytes) { gmsh::read(bytes)? } else { stl::read(bytes)? };
        if mesh.facets.is_empty() && mesh.lines.is_empty() {
            return Err(MeshError::Empty);
        }
        Ok(mesh)
    }

    /// The same in m, `metres` of them in the unit of the file.
    ///
    /// # Errors
    /// A coordinate larger than anything that is cut.
    pub fn scaled(mut self, metres: f64) -> Result<Self, MeshError> {
        for vertex in &mut self.vertices {
            *vertex *= metres;
            if let Some(&far) = vertex.as_ref().iter().find(|x| x.abs() > LARGEST_COORDINATE) {
                return Err(MeshError::FarAway { metres: far, most: LARGEST_COORDINATE });
            }
        }
        Ok(self)
    }

    /// The cross-section in the plane: the boundary of a plane mesh or of a line loop, or the
    /// section of a closed surface with z = 0.
    ///
    /// # Errors
    /// The surface is not closed, the boundary is not one loop, parts overlap.
    pub fn cross_section(&self) -> Result<CrossSection, MeshError> {
        plane::cross_section(self)
    }

    /// Vertices and triangles of the closed surface, corners counter-clockwise seen from outside.
    ///
    /// # Errors
    /// It is not the closed surface of a solid.
    pub fn closed_surface(&self) -> Result<Surface, MeshError> {
        if self.facets.is_empty() {
            return Err(MeshError::Empty);
        }
        surface::check(self)?;
        let triangles = self.facets.iter().map(|facet| facet.corners).collect();
        Ok((self.vertices.clone(), triangles))
    }

    fn extent(&self) -> f64 {
        let (low, high) = self.bounds();
        high.distance(low)
    }

    /// Smallest and largest coordinates of the vertices in use.
    fn bounds(&self) -> (DVec3, DVec3) {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let of_facets = self.facets.iter().flat_map(|facet| facet.corners);
        for vertex in of_facets.chain(self.lines.iter().flat_map(|line| line.ends)) {
            low = low.min(self.vertices[vertex]);
            high = high.max(self.vertices[vertex]);
        }
        (low, high)
    }

    fn corners(&self, facet: &Facet) -> [DVec3; 3] {
        facet.corners.map(|vertex| self.vertices[vertex])
    }
}

/// Joins corners with the same coordinates, bit for bit (-0 is 0): STL names no vertices.
#[derive(Debug, Default)]
struct Welder {
    known: HashMap<[u64; 3], usize>,
    vertices: Vec<DVec3>,
}

impl Welder {
    fn vertex(&mut self, point: [f64; 3]) -> usize {
        let point = point.map(|value| value + 0.0);
        *self.known.entry(point.map(f64::to_bits)).or_insert_with(|| {
            self.vertices.push(point.into());
            self.vertices.len() - 1
        })
    }
}

#[cfg(test)]
mod tests;
