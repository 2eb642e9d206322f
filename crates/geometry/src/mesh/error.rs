//! What can be wrong with a mesh file, in words for the person at the file.

use sphcut_physics::quantity::significant;
use std::fmt;

/// The name of a piece of the mesh in its file: "facet 12" of an STL, "element 12" of Gmsh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Name {
    pub(super) word: &'static str,
    pub(super) number: u64,
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.word, self.number)
    }
}

/// What is wrong with a mesh. Coordinates in m.
#[expect(missing_docs, reason = "each variant says what its fields are")]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Neither STL nor Gmsh.
    #[error("it is neither an STL nor a Gmsh MSH file")]
    Unknown,
    /// A Gmsh file of another version, or binary.
    #[error("it is a Gmsh file of version {version}")]
    Gmsh { version: String },
    /// A line that is not what the format has there.
    #[error("line {line}: expected {expected}")]
    Line { line: usize, expected: &'static str },
    /// The file ends too early.
    #[error("it ends where {expected} should follow: the file is truncated")]
    Ended { expected: &'static str },
    /// A binary STL whose length does not fit the number of its facets.
    #[error("it announces {facets} facets, which take {needed} bytes, and has {found}{}",
        if .found < .needed { ": the file is truncated" } else { "" })]
    Length { facets: u32, needed: u64, found: u64 },
    /// More facets than this program takes.
    #[error("more than {most} facets")]
    TooMany { most: usize },
    /// No facets and no lines.
    #[error("it has no facets")]
    Empty,
    /// A coordinate that is no number.
    #[error("{name} has a coordinate that is not a number")]
    NotFinite { name: Name },
    /// A coordinate beyond anything that is cut.
    #[error("a coordinate of {} m lies beyond {most} m: is mesh_unit right?", significant(*.metres))]
    FarAway { metres: f64, most: f64 },
    /// An element names a node that the file does not have.
    #[error("{name} names node {node}, which is missing")]
    NoSuchNode { name: Name, node: u64 },
    /// Two nodes with one number.
    #[error("node {node} is there twice")]
    SameNode { node: u64 },
    /// A curved element.
    #[error("{name} is curved (higher order)")]
    Curved { name: Name },
    /// A facet without area.
    #[error("{name} has no area")]
    Degenerate { name: Name },
    /// Corners run the other way round than the normal that the file states.
    #[error("{name} is flipped: its corners run the other way round than its normal says")]
    StatedNormal { name: Name },
    /// An edge with one facet.
    #[error("a hole: {name} has an open edge from {} to {}", point(.from), point(.to))]
    Hole { name: Name, from: [f64; 3], to: [f64; 3] },
    /// An edge with more than two facets.
    #[error("{first}, {second} and {third} share one edge: a surface has two facets there")]
    Branch { first: Name, second: Name, third: Name },
    /// A facet turned the other way round than its neighbour.
    #[error("{name} is flipped: its normal disagrees with that of {neighbour}")]
    Flipped { name: Name, neighbour: Name },
    /// A closed part that is inside out; the first of its facets.
    #[error("the surface is inside out: {name} and all connected to it face inwards")]
    InsideOut { name: Name },
    /// Two facets that pass through each other.
    #[error("the surface crosses itself: {first} passes through {second}")]
    Crossing { first: Name, second: Name },
    /// Too many pairs of facets lie close to each other.
    #[error("too many facets lie in each other's way to look for crossings")]
    Entangled,
    /// The plane z = 0 does not meet the surface.
    #[error("the plane z = 0 does not cut it: it lies between z = {} and {} mm",
        significant(.low * 1e3), significant(.high * 1e3))]
    NoSection { low: f64, high: f64 },
    /// The cross-section encloses nothing.
    #[error("its cross-section encloses no area")]
    NoArea,
    /// More than one loop that is not a hole of the largest.
    #[error("its cross-section has {count} separate parts: a tool is one")]
    Parts { count: usize },
    /// Lines that do not close.
    #[error("its lines do not close: {name} ends alone at {}", point(.at))]
    OpenLoop { name: Name, at: [f64; 3] },
    /// A point where boundaries touch.
    #[error("its boundary touches itself at {}", point(.at))]
    Pinched { at: [f64; 3] },
    /// Elements of a plane mesh cover each other.
    #[error("its elements cover each other")]
    Overlap,
    /// What the checks of an outline say.
    #[error("its cross-section: {reason}")]
    Outline { reason: String },
}

fn point(at: &[f64; 3]) -> String {
    let [x, y, z] = at.map(|value| significant(value * 1e3));
    format!("({x}, {y}, {z}) mm")
}

impl MeshError {
    /// What to do about it.
    pub fn help(&self) -> &'static str {
        match self {
            Self::Unknown => "STL (binary or ASCII), or Gmsh MSH 2.2 or 4.1 in ASCII",
            Self::Gmsh { .. } => {
                "save it as MSH 2.2 or 4.1 in ASCII: Mesh.MshFileVersion = 4.1; Mesh.Binary = 0;"
            }
            Self::Curved { .. } => "mesh with elements of first order: Mesh.ElementOrder = 1;",
            Self::Hole { .. } => {
                "close the surface; corners meet only where their coordinates are equal to the last digit"
            }
            Self::StatedNormal { .. } | Self::Flipped { .. } => {
                "make the normals agree and point outwards before saving: \"recompute normals \
                 outside\", in Gmsh setOutwardOrientation"
            }
            Self::InsideOut { .. } => {
                "turn all normals round before saving: \"flip normals\", in Gmsh ReverseMesh"
            }
            Self::NoSection { .. } => "move the tool so that z = 0 lies where it shall be cut",
            Self::TooMany { .. } | Self::Entangled => {
                "mesh it coarser: a particle does not see what is much smaller than itself"
            }
            _ => "",
        }
    }
}
