//! The mesh of the tool and its surface, in the plane or in space.

use super::ToolMeshFacts;
use super::conduction::Conduction;
use super::mesh::{self, ToolMesh, unusable};
use super::outline::double_area;
use super::rim::Rim;
use super::skin::Skin;
use super::solid::{SolidMesh, SolidParts, solid};
use crate::error::SetupError;
use crate::setup::{Tool, ToolHeat as Description, ToolSurface, Vector};

/// What a particle's contact and a picture need of the mesh.
#[derive(Debug)]
pub(super) enum Body {
    Plane { mesh: ToolMesh, rim: Rim },
    Space { mesh: SolidMesh, skin: Skin },
}

/// A body with its equations and the extent of outer sides at each node.
pub(super) struct Made {
    pub(super) body: Body,
    pub(super) conduction: Conduction,
    pub(super) outer: Vec<f64>,
}

impl Body {
    /// # Errors
    /// A half space; a mesh that cannot be made.
    pub(super) fn make(tool: &Tool, heat: &Description) -> Result<Made, SetupError> {
        match &tool.surface {
            ToolSurface::Polygon(corners) => {
                let mesh = ToolMesh::new(corners, heat)?;
                let conduction = Conduction::new(&mesh, heat);
                let rim = Rim::new(&mesh);
                let outer = rim.lengths(&mesh.rim_is_outer, mesh.nodes.len());
                Ok(Made { body: Self::Plane { mesh, rim }, conduction, outer })
            }
            ToolSurface::Triangles { .. } => {
                let SolidParts { mesh, skin, conduction, outer } = solid(&tool.surface, heat)?;
                Ok(Made { body: Self::Space { mesh, skin }, conduction, outer })
            }
            ToolSurface::HalfSpace { .. } => {
                Err(unusable("it needs a tool with an outline or a closed surface, no half space"))
            }
        }
    }

    pub(super) fn nodes(&self) -> usize {
        match self {
            Self::Plane { mesh, .. } => mesh.nodes.len(),
            Self::Space { mesh, .. } => mesh.nodes.len(),
        }
    }

    /// Numbers of a place that mean something.
    pub(super) fn place_axes(&self) -> usize {
        match self {
            Self::Plane { .. } => 1,
            Self::Space { .. } => 3,
        }
    }

    /// What a particle of `spacing` covers: a length in the plane, an area in space.
    pub(super) fn patch(&self, spacing: f64) -> f64 {
        match self {
            Self::Plane { .. } => spacing,
            Self::Space { .. } => spacing * spacing,
        }
    }

    /// Width of a patch of `area`: the length itself in the plane, in space the side of a square as large.
    pub(super) fn width(&self, area: f64) -> f64 {
        match self {
            Self::Plane { .. } => area,
            Self::Space { .. } => area.sqrt(),
        }
    }

    /// Where `position` (tool frame) touches: in the plane the place along the outline, in space the
    /// position itself.
    pub(super) fn place(&self, position: &Vector) -> Vector {
        match self {
            Self::Plane { rim, .. } => [rim.foot([position[0], position[1]]), 0.0, 0.0],
            Self::Space { .. } => *position,
        }
    }

    /// The way from one such place to another.
    pub(super) fn way(&self, from: &Vector, to: &Vector) -> Vector {
        match self {
            Self::Plane { rim, .. } => [rim.way(from[0], to[0]), 0.0, 0.0],
            Self::Space { .. } => std::array::from_fn(|k| to[k] - from[k]),
        }
    }

    /// Adds the shares of the nodes that a particle of `width` at `middle` covers.
    pub(super) fn footprint(&self, middle: &Vector, width: f64, shares: &mut Vec<(u32, f64)>) {
        match self {
            Self::Plane { rim, .. } => rim.footprint(middle[0], width, shares),
            Self::Space { skin, .. } => skin.footprint(middle, width, shares),
        }
    }

    /// All but the time step.
    pub(super) fn facts(&self, heat: &Description) -> ToolMeshFacts {
        let coating_layers = if heat.coating.is_some() { mesh::COATING_LAYERS } else { 0 };
        let coating_thickness = heat.coating.as_ref().map_or(0.0, |coating| coating.thickness);
        let facts = |elements, coating_elements, extent| ToolMeshFacts {
            dimension: if self.place_axes() == 3 { 3 } else { 2 },
            nodes: self.nodes(),
            elements,
            coating_elements,
            coating_layers,
            coating_thickness,
            extent,
            time_step: 0.0,
        };
        match self {
            Self::Plane { mesh, .. } => {
                let area = |element: &[u32; 3]| {
                    let [a, b, c] = element.map(|node| mesh.nodes[node as usize]);
                    0.5 * double_area(a, b, c)
                };
                let coated = mesh.layer.iter().filter(|layer| **layer == mesh::Layer::Coating);
                let whole = mesh.elements.iter().map(area).sum();
                facts(mesh.elements.len(), coated.count(), whole)
            }
            Self::Space { mesh, .. } => {
                facts(mesh.tetrahedra + mesh.prisms, mesh.prisms, mesh.volume)
            }
        }
    }

    /// Nodes moved by `displacement` and the triangles to show: all of the plane, the surface in space.
    pub(super) fn picture(&self, displacement: Vector) -> (Vec<Vector>, Vec<u32>) {
        let moved = |x: Vector| std::array::from_fn(|k| x[k] + displacement[k]);
        match self {
            Self::Plane { mesh, .. } => (
                mesh.nodes.iter().map(|[x, y]| moved([*x, *y, 0.0])).collect(),
                mesh.elements.iter().flatten().copied().collect(),
            ),
            Self::Space { mesh, .. } => (
                mesh.nodes.iter().map(|x| moved(*x)).collect(),
                mesh.surface.iter().flatten().copied().collect(),
            ),
        }
    }

    /// Bytes of the arrays beside the equations.
    pub(super) fn memory(&self) -> usize {
        match self {
            Self::Plane { mesh, .. } => mesh.nodes.len() * 4 * size_of::<[f64; 2]>(),
            Self::Space { mesh, skin } => {
                mesh.nodes.len() * (size_of::<Vector>() + size_of::<[f64; 8]>())
                    + mesh.surface.len() * size_of::<[u32; 3]>()
                    + skin.memory()
            }
        }
    }
}
