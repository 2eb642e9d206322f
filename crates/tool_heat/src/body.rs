//! The mesh of the tool and its surface, in the plane or in space.

use crate::conduction::Conduction;
use crate::description::{ToolHeat, ToolHeatError, unusable};
use crate::mesh::{COATING_LAYERS, Layer, PlaneMesh};
use crate::outline::double_area;
use crate::rim::Rim;
use crate::skin::Skin;
use crate::solid::{SolidMesh, SolidParts, solid};
use glam::DVec3;
use sphcut_geometry::tool_surface::ToolSurface;

/// What the mesh is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolMeshFacts {
    /// 2 or 3.
    pub dimension: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of triangles; in space of tetrahedra and of prisms of the coating.
    pub elements: usize,
    /// Those of the coating.
    pub coating_elements: usize,
    /// Layers of elements across the coating; 0 without one.
    pub coating_layers: usize,
    /// Thickness of the coating in m; 0 without one.
    pub coating_thickness: f64,
    /// Their area in m^2, or volume in m^3.
    pub extent: f64,
    /// Time step of the tool in s.
    pub time_step: f64,
}

/// What a particle's contact and a picture need of the mesh.
#[derive(Debug)]
pub(crate) enum MeshedTool {
    Plane { mesh: PlaneMesh, rim: Rim },
    Space { mesh: SolidMesh, skin: Skin },
}

/// A body with its equations and the extent of outer sides at each node.
pub(crate) struct Made {
    pub(crate) body: MeshedTool,
    pub(crate) conduction: Conduction,
    pub(crate) outer: Vec<f64>,
}

impl MeshedTool {
    /// # Errors
    /// A half space; a mesh that cannot be made.
    pub(crate) fn make(surface: &ToolSurface, heat: &ToolHeat) -> Result<Made, ToolHeatError> {
        match surface {
            ToolSurface::Polygon(corners) => {
                let mesh =
                    PlaneMesh::new(&corners.iter().map(|c| (*c).into()).collect::<Vec<_>>(), heat)?;
                let conduction = Conduction::new(&mesh, heat);
                let rim = Rim::new(&mesh);
                let outer = rim.lengths(&mesh.rim_is_outer, mesh.nodes.len());
                Ok(Made { body: Self::Plane { mesh, rim }, conduction, outer })
            }
            ToolSurface::Triangles { .. } => {
                let SolidParts { mesh, skin, conduction, outer } = solid(surface, heat)?;
                Ok(Made { body: Self::Space { mesh, skin }, conduction, outer })
            }
            ToolSurface::HalfSpace { .. } => {
                Err(unusable("it needs a tool with an outline or a closed surface, no half space"))
            }
        }
    }

    pub(crate) fn nodes(&self) -> usize {
        match self {
            Self::Plane { mesh, .. } => mesh.nodes.len(),
            Self::Space { mesh, .. } => mesh.nodes.len(),
        }
    }

    /// Numbers of a place that mean something.
    pub(crate) fn place_axes(&self) -> usize {
        match self {
            Self::Plane { .. } => 1,
            Self::Space { .. } => 3,
        }
    }

    /// What a particle of `spacing` covers: a length in the plane, an area in space.
    pub(crate) fn patch(&self, spacing: f64) -> f64 {
        match self {
            Self::Plane { .. } => spacing,
            Self::Space { .. } => spacing * spacing,
        }
    }

    /// Width of a patch of `area`: the length itself in the plane, in space the side of a square as large.
    pub(crate) fn width(&self, area: f64) -> f64 {
        match self {
            Self::Plane { .. } => area,
            Self::Space { .. } => area.sqrt(),
        }
    }

    /// Where `position` (tool frame) touches: in the plane the place along the outline, in space the
    /// position itself.
    pub(crate) fn place(&self, position: DVec3) -> DVec3 {
        match self {
            Self::Plane { rim, .. } => DVec3::new(rim.foot(position.truncate()), 0.0, 0.0),
            Self::Space { .. } => position,
        }
    }

    /// The way from one such place to another.
    pub(crate) fn way(&self, from: DVec3, to: DVec3) -> DVec3 {
        match self {
            Self::Plane { rim, .. } => DVec3::new(rim.way(from.x, to.x), 0.0, 0.0),
            Self::Space { .. } => to - from,
        }
    }

    /// Adds the shares of the nodes that a particle of `width` at `middle` covers.
    pub(crate) fn footprint(&self, middle: DVec3, width: f64, shares: &mut Vec<(u32, f64)>) {
        match self {
            Self::Plane { rim, .. } => rim.footprint(middle.x, width, shares),
            Self::Space { skin, .. } => skin.footprint(middle, width, shares),
        }
    }

    /// All but the time step.
    pub(crate) fn facts(&self, heat: &ToolHeat) -> ToolMeshFacts {
        let coating_layers = if heat.coating.is_some() { COATING_LAYERS } else { 0 };
        let coating_thickness = heat.coating_thickness();
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
                let coated = mesh.layer.iter().filter(|layer| **layer == Layer::Coating);
                let whole = mesh.elements.iter().map(area).sum();
                facts(mesh.elements.len(), coated.count(), whole)
            }
            Self::Space { mesh, .. } => {
                facts(mesh.tetrahedra + mesh.prisms, mesh.prisms, mesh.volume)
            }
        }
    }

    /// Nodes moved by `displacement` and the triangles to show: all of the plane, the surface in space.
    pub(crate) fn picture(&self, displacement: DVec3) -> (Vec<[f64; 3]>, Vec<u32>) {
        let moved = |x: DVec3| (x + displacement).to_array();
        match self {
            Self::Plane { mesh, .. } => (
                mesh.nodes.iter().map(|x| moved(x.extend(0.0))).collect(),
                mesh.elements.iter().flatten().copied().collect(),
            ),
            Self::Space { mesh, .. } => (
                mesh.nodes.iter().map(|x| moved(*x)).collect(),
                mesh.surface.iter().flatten().copied().collect(),
            ),
        }
    }

    /// Bytes of the arrays beside the equations.
    pub(crate) fn memory(&self) -> usize {
        match self {
            Self::Plane { mesh, .. } => mesh.nodes.len() * 4 * size_of::<[f64; 2]>(),
            Self::Space { mesh, skin } => {
                mesh.nodes.len() * (size_of::<DVec3>() + size_of::<[f64; 8]>())
                    + mesh.surface.len() * size_of::<[u32; 3]>()
                    + skin.memory()
            }
        }
    }
}
