//! The tool in space: tetrahedra over its substrate, a coating as layers of prisms on its surface.
//!
//! The tetrahedra are stuffed into a graded octree (`octree.rs`, `stuffing.rs`) up to the tool's surface,
//! or up to the coating's thickness below it. A coating is a stack of nodes over each node of that surface, from it to its foot on
//! the tool's surface, in as many layers as in the plane:
//! ```text
//! K = k_c A / (d / n),   C = rho_c cp_c A d / n        n layers of the thickness d
//! ```
//! with A a node's third of the triangles about it at the depth of the layer. Heat in a coating flows across
//! it only: along it the substrate below conducts (k L) / (k_c d) times as much over a width L, some
//! thousand times for 3 um of AlTiN on carbide over 0.1 mm. The edge of a coating where the tool is cut off is insulated.

use crate::conduction::{Conduction, Link};
use crate::description::{ToolHeat, ToolHeatError, unusable};
use crate::mesh::{COATING_LAYERS, MOST_NODES, too_thick};
use crate::octree::{Cube, Octree};
use crate::outline::{COARSEST, GROWTH};
use crate::skin::Skin;
use crate::stuffing::{Background, Solid, stuff, volume};
use glam::DVec3;
use rayon::prelude::*;
use sphcut_geometry::tool_surface::{IndexedSurface, ToolSurface};

/// A cell is divided while it is wider than this many of the wanted sizes: halves are then as far from
/// it as the whole.
const ROUNDING: f64 = std::f64::consts::SQRT_2;

/// The mesh in the tool's own frame.
#[derive(Debug)]
pub(crate) struct SolidMesh {
    /// Those of the substrate, then those of the coating.
    pub(crate) nodes: Vec<DVec3>,
    /// Tetrahedra of the substrate.
    pub(crate) tetrahedra: usize,
    /// Prisms of the coating.
    pub(crate) prisms: usize,
    /// Of the substrate and the coating, in m^3.
    pub(crate) volume: f64,
    /// IndexedSurface of the whole tool: nodes of its triangles.
    pub(crate) surface: Vec<[u32; 3]>,
}

/// All that is made of a tool in space.
pub(crate) struct SolidParts {
    pub(crate) mesh: SolidMesh,
    pub(crate) skin: Skin,
    pub(crate) conduction: Conduction,
    /// Area of outer sides at each node in m^2.
    pub(crate) outer: Vec<f64>,
}

/// The tool's surface in two parts.
struct SurfaceParts<'a> {
    surface: &'a IndexedSurface,
    /// The facets that particles can touch.
    touchable: IndexedSurface,
    /// Those at which the tool is cut off, if any.
    cut_off: Option<IndexedSurface>,
    thickness: f64,
    heat: &'a ToolHeat,
    largest: f64,
}

impl SurfaceParts<'_> {
    /// Distances of a point inside from the sides of the substrate: those below a coating, and those where
    /// the tool is cut off.
    fn distances(&self, x: DVec3) -> [f64; 2] {
        let away = |surface: &IndexedSurface| surface.foot(x).nearest.distance.abs();
        let cut_off = self.cut_off.as_ref().map_or(f64::INFINITY, away);
        [away(&self.touchable) - self.thickness, cut_off]
    }

    /// Distance from the substrate's surface, positive inside.
    fn level(&self, x: DVec3) -> f64 {
        let distance = self.surface.foot(x).nearest.distance;
        if distance > 0.0 || self.thickness == 0.0 {
            return -distance;
        }
        let [coated, cut_off] = self.distances(x);
        coated.min(cut_off)
    }

    /// The place on the substrate's surface next to a point of it.
    fn project(&self, x: DVec3) -> DVec3 {
        if self.thickness == 0.0 {
            return self.surface.foot(x).place;
        }
        let [coated, outer] = self.distances(x);
        match &self.cut_off {
            Some(cut_off) if outer.abs() < coated.abs() => cut_off.foot(x).place,
            _ => {
                let foot = self.touchable.foot(x);
                foot.place - self.thickness * foot.nearest.normal
            }
        }
    }

    /// Whether the tool is cut off at a triangle of the substrate's surface.
    fn is_cut_off(&self, nodes: &[DVec3], triangle: &[u32; 3]) -> bool {
        let corners = triangle.map(|node| nodes[node as usize]);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let [coated, cut_off] = self.distances(middle);
        cut_off.abs() < coated.abs()
    }

    /// Whether a cell is wider than it is to be. Sizes grow with the distance from facets that can be touched,
    /// and from the place where they are.
    fn is_coarse(&self, centre: DVec3, width: f64) -> bool {
        let reach = 0.5 * 3.0_f64.sqrt() * width;
        let distance = self.surface.foot(centre).nearest.distance;
        if distance > reach {
            return false;
        }
        let along = centre.distance(self.heat.fine_centre.into()) - self.heat.fine_reach - reach;
        let inwards = self.touchable.foot(centre).nearest.distance.abs() - reach;
        let away = inwards.max(along).max(0.0);
        let wanted = (self.heat.element_size + GROWTH * away).min(self.largest);
        width > ROUNDING * wanted
    }
}

/// Meshes the tool.
///
/// # Errors
/// A surface of other than triangles; a mesh that cannot be made.
pub(crate) fn solid(
    description: &ToolSurface,
    heat: &ToolHeat,
) -> Result<SolidParts, ToolHeatError> {
    let ToolSurface::Triangles { triangles, .. } = description else {
        return Err(unusable("in space it needs a tool with a closed surface, no half space"));
    };
    let surface = IndexedSurface::new(description).map_err(|fault| unusable(fault.reason))?;
    let mut is_outer = vec![false; triangles.len()];
    for side in &heat.outer_sides {
        *is_outer.get_mut(*side).ok_or_else(|| unusable(format!("there is no facet {side}")))? =
            true;
    }
    if is_outer.iter().all(|outer| *outer) {
        return Err(unusable("all of its surface is cut off: particles can touch none of it"));
    }
    let [low, high] = surface.bounds();
    let extent = (high - low).max_element();
    let is_inner: Vec<bool> = is_outer.iter().map(|outer| !outer).collect();
    let parts = SurfaceParts {
        touchable: surface.without(&is_outer),
        cut_off: is_outer.contains(&true).then(|| surface.without(&is_inner)),
        surface: &surface,
        thickness: heat.coating_thickness(),
        heat,
        largest: (COARSEST * extent).max(heat.element_size),
    };
    let solid = parts.fill([low, high])?;
    parts.coat(solid)
}

impl SurfaceParts<'_> {
    /// Tetrahedra over the substrate.
    fn fill(&self, bounds: [DVec3; 2]) -> Result<Solid, ToolHeatError> {
        let too_many = || {
            unusable(format!(
                "its mesh would have more than {MOST_NODES} nodes: choose a larger element size or a \
                 shorter fine reach"
            ))
        };
        let cube = Cube::about(bounds, self.heat.element_size).ok_or_else(too_many)?;
        let tree = Octree::new(cube, |centre, width| self.is_coarse(centre, width));
        let tree = tree.ok_or_else(too_many)?;
        let points = tree.positions();
        let level: Vec<f64> = points.par_iter().map(|point| self.level(*point)).collect();
        let mut elements = Vec::new();
        tree.each_tetrahedron(|corners| {
            if corners.iter().any(|corner| level[*corner as usize] > 0.0) {
                elements.push(corners);
            }
        });
        let background = Background { is_centre: tree.are_centres(), points, level, elements };
        let solid = stuff(background, |x| self.project(x));
        if solid.elements.is_empty() {
            return Err(too_thick());
        }
        if solid.nodes.len() > MOST_NODES {
            return Err(too_many());
        }
        Ok(solid)
    }

    /// The whole tool from its substrate.
    fn coat(&self, solid: Solid) -> Result<SolidParts, ToolHeatError> {
        let boundary = solid.boundary();
        let third = |nodes: &[DVec3], triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|node| nodes[node as usize]);
            (b - a).cross(c - a).length() / 6.0
        };
        let cut_off: Vec<bool> =
            boundary.par_iter().map(|triangle| self.is_cut_off(&solid.nodes, triangle)).collect();
        let mut outer = vec![0.0; solid.nodes.len()];
        for (triangle, _) in boundary.iter().zip(&cut_off).filter(|(_, outer)| **outer) {
            let share = third(&solid.nodes, triangle);
            triangle.iter().for_each(|node| outer[*node as usize] += share);
        }
        let mut parts = Parts::of(&solid, self.heat);
        let coated: Vec<[u32; 3]> =
            boundary.iter().zip(&cut_off).filter(|(_, o)| !**o).map(|(t, _)| *t).collect();
        let mut top: Vec<u32> = (0..solid.nodes.len() as u32).collect();
        let mut volume = parts.volume;
        let mut nodes = solid.nodes;
        if let Some(coating) = &self.heat.coating {
            let height = coating.thickness / COATING_LAYERS as f64;
            // Places of the nodes layer by layer: from the substrate to the foot on the surface.
            let mut is_coated = vec![false; top.len()];
            coated.iter().flatten().for_each(|node| is_coated[*node as usize] = true);
            let base = nodes.clone();
            let feet: Vec<DVec3> = base.par_iter().map(|x| self.touchable.foot(*x).place).collect();
            let mut below = base.clone();
            for layer in 1..=COATING_LAYERS {
                let share = layer as f64 / COATING_LAYERS as f64;
                let above: Vec<DVec3> =
                    base.iter().zip(&feet).map(|(from, to)| from + share * (to - from)).collect();
                let mut area = vec![0.0; base.len()];
                for triangle in &coated {
                    let mean = 0.5 * (third(&below, triangle) + third(&above, triangle));
                    triangle.iter().for_each(|node| area[*node as usize] += mean);
                }
                for node in (0..base.len()).filter(|node| is_coated[*node]) {
                    let number = nodes.len() as u32;
                    nodes.push(above[node]);
                    parts.stack(top[node], number, area[node] / height);
                    let mass = coating.material.density * area[node] * height;
                    parts.mass[top[node] as usize][1] += 0.5 * mass;
                    parts.mass.push([0.0, 0.5 * mass]);
                    volume += area[node] * height;
                    outer.push(0.0);
                    top[node] = number;
                }
                below = above;
            }
            if nodes.len() > 2 * MOST_NODES {
                return Err(unusable("its coating has too many nodes: choose larger elements"));
            }
        }
        let topped = |triangle: &[u32; 3]| triangle.map(|node| top[node as usize]);
        let skin: Vec<[u32; 3]> = coated.iter().map(topped).collect();
        if skin.is_empty() {
            return Err(unusable(
                "none of its surface can be touched: `outer_distance` is too small",
            ));
        }
        let mesh = SolidMesh {
            tetrahedra: solid.elements.len(),
            prisms: if self.heat.coating.is_some() { COATING_LAYERS * coated.len() } else { 0 },
            volume,
            surface: boundary
                .iter()
                .zip(&cut_off)
                .map(|(triangle, outer)| if *outer { *triangle } else { topped(triangle) })
                .collect(),
            nodes,
        };
        let skin = Skin::new(&mesh.nodes, &skin);
        let conduction = Conduction::of_links(parts.links, &parts.mass, self.heat);
        Ok(SolidParts { mesh, skin, conduction, outer })
    }
}

/// Conductances and masses as they gather.
struct Parts {
    links: Vec<Link>,
    /// Of substrate and coating at each node in kg.
    mass: Vec<[f64; 2]>,
    volume: f64,
}

impl Parts {
    /// Of the substrate: `K_ij = -k V grad phi_i . grad phi_j` with `grad phi_i = A_i / 3V`, A_i the area of the face opposite to i,
    /// as a vector inwards.
    fn of(solid: &Solid, heat: &ToolHeat) -> Self {
        let mut mass = vec![[0.0; 2]; solid.nodes.len()];
        let mut links = Vec::with_capacity(6 * solid.elements.len());
        let mut whole = 0.0;
        for element in &solid.elements {
            let corners = solid.corners(element);
            let content = volume(corners);
            whole += content;
            let [a, b, c, d] = corners;
            let face = |p: DVec3, q: DVec3, r: DVec3| 0.5 * (q - p).cross(r - p);
            // The faces seen from inside counter-clockwise.
            let inwards = [face(b, d, c), face(a, c, d), face(a, d, b), face(a, b, c)];
            for i in 0..4 {
                mass[element[i] as usize][0] += 0.25 * heat.substrate.density * content;
                for j in i + 1..4 {
                    let weight = -inwards[i].dot(inwards[j]) / (9.0 * content);
                    links.push(Link::new([element[i], element[j]], weight, 0));
                }
            }
        }
        links.sort_by_key(|link| link.nodes);
        links.dedup_by(|next, kept| {
            let is_same = next.nodes == kept.nodes;
            if is_same {
                kept.weight += next.weight;
            }
            is_same
        });
        Self { links, mass, volume: whole }
    }

    fn stack(&mut self, below: u32, above: u32, weight: f64) {
        self.links.push(Link::new([below, above], weight, 1));
    }
}
