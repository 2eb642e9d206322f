//! Whether facets are the closed surface of a solid: every edge has two facets that run along it
//! in opposite directions, every part has its outside outside, no two facets cross.

use super::error::{MeshError, Name};
use super::vector::area_vector;
use super::{Facet, Mesh, intersection};
use glam::DVec3;
use std::collections::BTreeMap;

/// Height of a facet without area, as a share of the size of the mesh. Coordinates of single
/// precision are exact to about 1e-7 of it: a facet as thin as this has no normal.
const THINNEST: f64 = 1e-9;

/// The facets along an edge: index, and whether they run from its lower to its higher vertex.
type Edges = BTreeMap<(usize, usize), Vec<(usize, Direction)>>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    Up,
    Down,
}

/// # Errors
/// The first fault, in the order: no area, branch, hole, flipped, inside out, crossing.
pub(super) fn check(mesh: &Mesh) -> Result<(), MeshError> {
    areas(mesh)?;
    let edges = edges(&mesh.facets);
    two_facets_each(mesh, &edges)?;
    orientation(mesh, &edges)?;
    outside(mesh, &edges)?;
    intersection::check(mesh)
}

/// Every facet has an area.
pub(super) fn areas(mesh: &Mesh) -> Result<(), MeshError> {
    let thinnest = THINNEST * mesh.extent();
    for facet in &mesh.facets {
        let corners = mesh.corners(facet);
        let [a, b, c] = corners;
        let longest = b.distance(a).max(c.distance(b)).max(a.distance(c));
        if area_vector(corners).length() <= thinnest * longest {
            return Err(MeshError::Degenerate { name: facet.name });
        }
    }
    Ok(())
}

fn edges(facets: &[Facet]) -> Edges {
    let mut edges = Edges::new();
    for (index, facet) in facets.iter().enumerate() {
        for side in 0..3 {
            let (from, to) = (facet.corners[side], facet.corners[(side + 1) % 3]);
            let direction = if from < to { Direction::Up } else { Direction::Down };
            edges.entry((from.min(to), from.max(to))).or_default().push((index, direction));
        }
    }
    edges
}

/// The fault of the facet that comes first in the file is told.
fn two_facets_each(mesh: &Mesh, edges: &Edges) -> Result<(), MeshError> {
    let name = |place: usize| mesh.facets[place].name;
    let wrong = edges.iter().filter(|(_, facets)| facets.len() != 2);
    let Some(((from, to), facets)) = wrong.min_by_key(|(_, facets)| facets[0].0) else {
        return Ok(());
    };
    Err(match facets.as_slice() {
        [first, second, third, ..] => {
            MeshError::Branch { first: name(first.0), second: name(second.0), third: name(third.0) }
        }
        _ => MeshError::Hole {
            name: name(facets[0].0),
            from: mesh.vertices[*from].to_array(),
            to: mesh.vertices[*to].to_array(),
        },
    })
}

/// Of two facets that run the same way along an edge, the one with more such edges is flipped.
fn orientation(mesh: &Mesh, edges: &Edges) -> Result<(), MeshError> {
    let against: Vec<(usize, usize)> = edges
        .values()
        .filter(|facets| facets[0].1 == facets[1].1)
        .map(|facets| (facets[0].0, facets[1].0))
        .collect();
    let mut count = vec![0_usize; mesh.facets.len()];
    for (first, second) in &against {
        count[*first] += 1;
        count[*second] += 1;
    }
    // The facet with the most; of several the first of the file.
    let most = (0..count.len()).rev().max_by_key(|facet| count[*facet]);
    let pair = most.and_then(|facet| {
        let partner = |(first, second): &(usize, usize)| match facet {
            _ if facet == *first => Some(*second),
            _ if facet == *second => Some(*first),
            _ => None,
        };
        Some((facet, against.iter().find_map(partner)?))
    });
    match pair {
        None => Ok(()),
        Some((facet, neighbour)) => Err(MeshError::Flipped {
            name: mesh.facets[facet].name,
            neighbour: mesh.facets[neighbour].name,
        }),
    }
}

/// Every connected part encloses a positive volume.
fn outside(mesh: &Mesh, edges: &Edges) -> Result<(), MeshError> {
    // Reference point inside the mesh: volumes of far away tetrahedra would cancel badly.
    let (low, high) = mesh.bounds();
    let origin = 0.5 * (low + high);
    let part = parts(mesh.facets.len(), edges);
    let mut volume = BTreeMap::<usize, (f64, Name)>::new();
    for (index, facet) in mesh.facets.iter().enumerate() {
        let [a, b, c] = mesh.corners(facet).map(|corner: DVec3| corner - origin);
        volume.entry(part[index]).or_insert((0.0, facet.name)).0 += a.dot(b.cross(c));
    }
    match volume.values().find(|(volume, _)| *volume <= 0.0) {
        None => Ok(()),
        Some((_, name)) => Err(MeshError::InsideOut { name: *name }),
    }
}

/// For each facet the first facet of its connected part.
fn parts(count: usize, edges: &Edges) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..count).collect();
    fn root(parent: &mut [usize], mut facet: usize) -> usize {
        while parent[facet] != facet {
            parent[facet] = parent[parent[facet]];
            facet = parent[facet];
        }
        facet
    }
    for facets in edges.values() {
        let first = root(&mut parent, facets[0].0);
        for other in &facets[1..] {
            let second = root(&mut parent, other.0);
            let (low, high) = (first.min(second), first.max(second));
            parent[high] = low;
        }
    }
    (0..count).map(|facet| root(&mut parent, facet)).collect()
}
