//! Linear triangles over the tool: its coating in layers, its inside by Delaunay's rule.
//!
//! The coating is a strip along the sides that can touch: each side of the outline and the same side
//! moved inwards by the thickness bound a row of quadrilaterals, each divided into layers and those into
//! two triangles. A strip of a few micrometres keeps its number of elements however thin it is, where
//! triangles of equal sides would need the square of the length over the thickness. What remains inside
//! is filled with points of a quadtree and triangulated. In a Delaunay mesh no pair of nodes conducts
//! from cold to hot as long as no angle opposite the boundary is obtuse.

use crate::description::{ToolHeat, ToolHeatError, unusable};
use crate::outline::{MeshOutline, SizeField, bounds, double_area, length};
use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

/// Layers of elements across a coating.
pub(crate) const COATING_LAYERS: usize = 3;
/// Distance of points inside from the boundary, in sizes of the elements there.
const CLEARANCE: f64 = 0.6;
/// Deepest subdivision of the quadtree: 2^16 cells across.
const DEEPEST: usize = 16;
/// Most nodes of a mesh.
pub(crate) const MOST_NODES: usize = 300_000;

/// What an element is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layer {
    Substrate,
    Coating,
}

/// The mesh in the tool's own frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlaneMesh {
    pub(crate) nodes: Vec<DVec2>,
    /// Counter-clockwise.
    pub(crate) elements: Vec<[u32; 3]>,
    pub(crate) layer: Vec<Layer>,
    /// Nodes on the outline, counter-clockwise.
    pub(crate) rim: Vec<u32>,
    /// Whether the tool is cut off at the side from a node of the rim to the next.
    pub(crate) rim_is_outer: Vec<bool>,
}

/// A vertex that knows its number.
struct Vertex {
    position: Point2<f64>,
    index: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

impl PlaneMesh {
    /// Meshes the polygon `corners`.
    ///
    /// # Errors
    /// A coating that is thicker than the shape allows; more nodes than can be.
    pub(crate) fn new(corners: &[DVec2], heat: &ToolHeat) -> Result<Self, ToolHeatError> {
        let size = SizeField::new(corners, heat);
        let outline = MeshOutline::new(corners, heat, &size);
        let thickness = heat.coating_thickness();
        let inner = MeshOutline {
            points: (0..outline.points.len()).map(|k| inset(&outline, k, thickness)).collect(),
            is_outer: outline.is_outer.clone(),
        };
        check_sides(&outline, &inner)?;
        let mut mesh = Self {
            nodes: inner.points.clone(),
            elements: Vec::new(),
            layer: Vec::new(),
            rim: Vec::new(),
            rim_is_outer: Vec::new(),
        };
        mesh.nodes.extend(inside_points(&inner, &size)?);
        mesh.fill(&inner)?;
        mesh.coat(&outline, &inner)?;
        Ok(mesh)
    }

    /// Triangulates the nodes there are inside the closed line of the first ones.
    fn fill(&mut self, boundary: &MeshOutline) -> Result<(), ToolHeatError> {
        let count = boundary.points.len();
        let vertices = self
            .nodes
            .iter()
            .zip(0..)
            .map(|(node, index)| Vertex { position: Point2::new(node.x, node.y), index });
        let edges = (0..count).map(|k| [k, boundary.next(k)]).collect();
        let mut crossing = 0;
        let triangulation = ConstrainedDelaunayTriangulation::<Vertex>::try_bulk_load_cdt(
            vertices.collect(),
            edges,
            |_| crossing += 1,
        )
        .map_err(|error| unusable(format!("its outline cannot be meshed: {error}")))?;
        if crossing > 0 {
            return Err(unusable("its outline crosses itself"));
        }
        for (triangle, is_inside) in sides_of(&triangulation, boundary) {
            if is_inside {
                self.elements.push(triangle);
                self.layer.push(Layer::Substrate);
            }
        }
        // The order of faces is that of the triangulation's making; that of their nodes is nobody's.
        self.elements.sort_unstable();
        Ok(())
    }

    /// Adds the coating between the outline and the inner boundary, whose nodes come first.
    fn coat(&mut self, outline: &MeshOutline, inner: &MeshOutline) -> Result<(), ToolHeatError> {
        let count = outline.points.len();
        // Nodes from the inner boundary to the surface, one after the other.
        let mut columns: Vec<Vec<u32>> = (0..count as u32).map(|k| vec![k]).collect();
        for (k, column) in columns.iter_mut().enumerate() {
            let (from, to) = (inner.points[k], outline.points[k]);
            if from == to {
                continue;
            }
            for layer in 1..=COATING_LAYERS {
                let share = layer as f64 / COATING_LAYERS as f64;
                column.push(self.nodes.len() as u32);
                self.nodes.push(from + share * (to - from));
            }
        }
        for k in 0..count {
            let (here, there) = (&columns[k], &columns[outline.next(k)]);
            if outline.is_outer[k] || here.len() == 1 {
                continue;
            }
            for layer in 0..COATING_LAYERS {
                let [a, b] = [here[layer], there[layer]];
                let [d, c] = [here[layer + 1], there[layer + 1]];
                let diagonal =
                    |p: u32, q: u32| length(self.nodes[q as usize] - self.nodes[p as usize]);
                let halves = if diagonal(b, d) < diagonal(a, c) {
                    [[a, d, b], [b, d, c]]
                } else {
                    [[a, d, c], [a, c, b]]
                };
                for element in halves {
                    let [p, q, r] = element.map(|node| self.nodes[node as usize]);
                    if double_area(p, q, r) <= 0.0 {
                        return Err(too_thick());
                    }
                    self.elements.push(element);
                    self.layer.push(Layer::Coating);
                }
            }
        }
        self.rim_is_outer.clear();
        for (k, column) in columns.iter().enumerate() {
            let ends = [outline.is_outer[outline.previous(k)], outline.is_outer[k]];
            // Where a coating ends, its end face is part of the side that cuts the tool off.
            let path: Vec<u32> = match ends {
                [true, false] => column.clone(),
                [false, true] => column.iter().rev().copied().collect(),
                _ => vec![column[column.len() - 1]],
            };
            let last = path.len() - 1;
            for (place, node) in path.into_iter().enumerate() {
                self.rim.push(node);
                self.rim_is_outer.push(if place < last { true } else { outline.is_outer[k] });
            }
        }
        Ok(())
    }
}

/// The triangles, and whether each lies inside the boundary: those to the left of its sides do, and
/// with them all that is reached from there without crossing it. The place of a triangle alone does not
/// tell: points along a straight side lie on a line but for rounding, and the needles between them have no
/// middle to speak of.
fn sides_of(
    triangulation: &ConstrainedDelaunayTriangulation<Vertex>,
    boundary: &MeshOutline,
) -> Vec<([u32; 3], bool)> {
    let faces = triangulation.num_inner_faces();
    // Numbers of inner faces begin at 1: face 0 is the outside of all.
    let mut is_inside: Vec<Option<bool>> = vec![None; faces + 1];
    let mut waiting = Vec::new();
    let is_left = |from: u32, to: u32| {
        let (from, to) = (from as usize, to as usize);
        let count = boundary.points.len();
        (from < count && to < count).then_some(())?;
        match (boundary.next(from) == to, boundary.next(to) == from) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    };
    for face in triangulation.inner_faces() {
        let known = face
            .adjacent_edges()
            .iter()
            .find_map(|edge| is_left(edge.from().data().index, edge.to().data().index));
        if known.is_some() {
            is_inside[face.index()] = known;
            waiting.push(face);
        }
    }
    while let Some(face) = waiting.pop() {
        for edge in face.adjacent_edges().iter().filter(|edge| !edge.is_constraint_edge()) {
            let Some(neighbour) = edge.rev().face().as_inner() else { continue };
            if is_inside[neighbour.index()].is_none() {
                is_inside[neighbour.index()] = is_inside[face.index()];
                waiting.push(neighbour);
            }
        }
    }
    triangulation
        .inner_faces()
        .map(|face| {
            let triangle = face.vertices().map(|vertex| vertex.data().index);
            (triangle, is_inside[face.index()] == Some(true))
        })
        .collect()
}

pub(crate) fn too_thick() -> ToolHeatError {
    unusable("the coating is too thick for the shape: thinner than the edge radius it must be")
}

/// Where point `k` of the outline lies on the boundary of the substrate.
fn inset(outline: &MeshOutline, k: usize, thickness: f64) -> DVec2 {
    let here = outline.points[k];
    let before = here - outline.points[outline.previous(k)];
    let after = outline.points[outline.next(k)] - here;
    let normal = |side: DVec2| DVec2::new(side.y, -side.x) / length(side);
    let (first, second) = (normal(before), normal(after));
    let coated = [!outline.is_outer[outline.previous(k)], !outline.is_outer[k]];
    match coated {
        _ if thickness == 0.0 => here,
        [false, false] => here,
        [true, true] => {
            let cosine = first.dot(second);
            here + -thickness / (1.0 + cosine) * (first + second)
        }
        // Along the outer side, until the coated one is a thickness away.
        [true, false] => {
            let way = after / length(after);
            here + thickness / -way.dot(first) * way
        }
        [false, true] => {
            let way = -before / length(before);
            here + thickness / -way.dot(second) * way
        }
    }
}

/// A side that turned round was overtaken by its neighbours.
fn check_sides(outline: &MeshOutline, inner: &MeshOutline) -> Result<(), ToolHeatError> {
    for k in 0..outline.points.len() {
        let outer = outline.points[outline.next(k)] - outline.points[k];
        let side = inner.points[outline.next(k)] - inner.points[k];
        if outer.dot(side) <= 0.0 {
            return Err(too_thick());
        }
    }
    Ok(())
}

/// Centres of the cells of a quadtree as fine as `size` asks for.
fn inside_points(boundary: &MeshOutline, size: &SizeField) -> Result<Vec<DVec2>, ToolHeatError> {
    let [low, high] = bounds(&boundary.points);
    let (centre, width) = (0.5 * (low + high), (high - low).max_element());
    let mut found = Vec::new();
    divide_cell(centre, width, DEEPEST, boundary, size, &mut found);
    if found.len() + boundary.points.len() > MOST_NODES {
        return Err(unusable(format!(
            "its mesh would have more than {MOST_NODES} nodes: choose a larger element size"
        )));
    }
    Ok(found)
}

fn divide_cell(
    centre: DVec2,
    width: f64,
    levels: usize,
    boundary: &MeshOutline,
    size: &SizeField,
    found: &mut Vec<DVec2>,
) {
    if found.len() > MOST_NODES {
        return;
    }
    let distance = boundary.distance(centre);
    let inside = boundary.contains(centre);
    if !inside && distance > 0.75 * width {
        return;
    }
    if levels > 0 && width > size.at(centre) {
        for [x, y] in [[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]] {
            let place = centre + DVec2::new(x, y) * width;
            divide_cell(place, 0.5 * width, levels - 1, boundary, size, found);
        }
        return;
    }
    if inside && distance >= CLEARANCE * size.at(centre) {
        found.push(centre);
    }
}
