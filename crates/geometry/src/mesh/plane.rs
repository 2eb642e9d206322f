//! The cross-section of a tool in the plane.

use super::error::{MeshError, Name};
use super::vector::area_vector;
use super::{Mesh, surface};
use crate::outline::{self, MOST_POINTS};
use crate::tool_section::signed_double_area;
use glam::DVec3;
use std::collections::BTreeMap;

/// Deviation from a plane, and distance of points that are one, as a share of the size of the mesh.
const FLAT: f64 = 1e-9;
/// Deviation of the area of the elements from that of their outline: rounding of single precision.
const SAME_AREA: f64 = 1e-6;

/// The cross-section of a tool in m.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossSection {
    /// Closed counter-clockwise polygon.
    pub polygon: Vec<[f64; 2]>,
    /// Holes inside it, which nothing can touch: they are left out.
    pub holes: usize,
}

/// A piece of a boundary between two numbered points.
struct Link {
    ends: [usize; 2],
    name: Name,
}

pub(super) fn cross_section(mesh: &Mesh) -> Result<CrossSection, MeshError> {
    let (low, high) = mesh.bounds();
    if mesh.facets.is_empty() {
        let links: Vec<Link> =
            mesh.lines.iter().map(|line| Link { ends: line.ends, name: line.name }).collect();
        return outermost(mesh, &mesh.vertices, &links).map(|(section, _)| section);
    }
    if high[2] - low[2] <= FLAT * mesh.extent() {
        return boundary(mesh);
    }
    surface::check(mesh)?;
    // The limits z -> 0 from above and from below: a tool that begins or ends at z = 0 has its
    // end face as section.
    let (points, links) = [Above::WithoutZero, Above::WithZero]
        .into_iter()
        .map(|above| section_with_zero(mesh, above))
        .find(|(_, links)| !links.is_empty())
        .ok_or(MeshError::NoSection { low: low[2], high: high[2] })?;
    outermost(mesh, &points, &links).map(|(section, _)| section)
}

/// The boundary of plane elements: the edges with one of them.
fn boundary(mesh: &Mesh) -> Result<CrossSection, MeshError> {
    surface::areas(mesh)?;
    let mut edges = BTreeMap::<(usize, usize), Vec<Name>>::new();
    for facet in &mesh.facets {
        for side in 0..3 {
            let (from, to) = (facet.corners[side], facet.corners[(side + 1) % 3]);
            edges.entry((from.min(to), from.max(to))).or_default().push(facet.name);
        }
    }
    if let Some([first, second, third, ..]) =
        edges.values().find(|names| names.len() > 2).map(Vec::as_slice)
    {
        return Err(MeshError::Branch { first: *first, second: *second, third: *third });
    }
    let links: Vec<Link> = edges
        .iter()
        .filter(|(_, names)| names.len() == 1)
        .map(|((from, to), names)| Link { ends: [*from, *to], name: names[0] })
        .collect();
    let (section, area) = outermost(mesh, &mesh.vertices, &links)?;
    let covered: f64 =
        mesh.facets.iter().map(|facet| area_vector(mesh.corners(facet)).length()).sum();
    // Elements that lie on each other have more area than their outline encloses.
    if (covered - area).abs() > SAME_AREA * covered {
        return Err(MeshError::Overlap);
    }
    Ok(section)
}

/// Which vertices count as above the plane z = 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Above {
    WithZero,
    WithoutZero,
}

/// The section of a closed surface with z = 0: one point for each edge that crosses, one link for
/// each facet that does.
fn section_with_zero(mesh: &Mesh, above: Above) -> (Vec<DVec3>, Vec<Link>) {
    let is_above = |vertex: usize| {
        let z = mesh.vertices[vertex][2];
        z > 0.0 || (above == Above::WithZero && z == 0.0)
    };
    let mut known = BTreeMap::<(usize, usize), usize>::new();
    let mut points = Vec::new();
    let mut links = Vec::new();
    for facet in &mesh.facets {
        let mut ends = Vec::with_capacity(2);
        for side in 0..3 {
            let (from, to) = (facet.corners[side], facet.corners[(side + 1) % 3]);
            if is_above(from) == is_above(to) {
                continue;
            }
            // From the lower to the higher number, so that both facets see the same point.
            let edge = (from.min(to), from.max(to));
            ends.push(*known.entry(edge).or_insert_with(|| {
                let (a, b) = (mesh.vertices[edge.0], mesh.vertices[edge.1]);
                let crossing = a + a.z / (a.z - b.z) * (b - a);
                points.push(if b.z == 0.0 { b } else { crossing });
                points.len() - 1
            }));
        }
        if let [first, second] = ends[..] {
            links.push(Link { ends: [first, second], name: facet.name });
        }
    }
    (points, links)
}

/// The largest loop of `links` and twice the area that all loops enclose, holes subtracted.
/// The others must be holes in the largest.
fn outermost(
    mesh: &Mesh,
    points: &[DVec3],
    links: &[Link],
) -> Result<(CrossSection, f64), MeshError> {
    let nearest = FLAT * mesh.extent();
    let mut loops: Vec<Vec<[f64; 2]>> = loops(points, links)?
        .into_iter()
        .map(|one| without_repetition(one, nearest))
        // Where the surface only touches the plane, a loop shrinks to a point or a line.
        .filter(|one| one.len() > 2)
        .collect();
    if loops.iter().map(Vec::len).sum::<usize>() > MOST_POINTS {
        let reason = format!("more than {MOST_POINTS} points");
        return Err(MeshError::Outline { reason });
    }
    let size = |polygon: &[[f64; 2]]| signed_double_area(polygon).abs();
    loops.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let Some((outer, inner)) = loops.split_first() else { return Err(MeshError::NoArea) };
    if inner.iter().flatten().any(|point| !contains(outer, *point)) {
        return Err(MeshError::Parts { count: loops.len() });
    }
    let area = size(outer) - inner.iter().map(|hole| size(hole)).sum::<f64>();
    let holes = inner.len();
    let polygon =
        outline::checked(outer.clone()).map_err(|reason| MeshError::Outline { reason })?;
    Ok((CrossSection { polygon, holes }, area))
}

/// Closed loops of links; every point has exactly two.
fn loops(points: &[DVec3], links: &[Link]) -> Result<Vec<Vec<[f64; 2]>>, MeshError> {
    let mut at = BTreeMap::<usize, Vec<usize>>::new();
    for (index, link) in links.iter().enumerate() {
        for end in link.ends {
            at.entry(end).or_default().push(index);
        }
    }
    for (point, meeting) in &at {
        match meeting.len() {
            1 => {
                let name = links[meeting[0]].name;
                return Err(MeshError::OpenLoop { name, at: points[*point].to_array() });
            }
            2 => {}
            _ => return Err(MeshError::Pinched { at: points[*point].to_array() }),
        }
    }
    let mut used = vec![false; links.len()];
    let mut loops = Vec::new();
    for first in 0..links.len() {
        let (mut link, mut point) = (first, links[first].ends[0]);
        let mut one = Vec::new();
        while !used[link] {
            used[link] = true;
            one.push(points[point].truncate().to_array());
            let [a, b] = links[link].ends;
            point = if point == a { b } else { a };
            let next = at[&point].iter().copied().find(|other| *other != link);
            link = next.unwrap_or(link);
        }
        if !one.is_empty() {
            loops.push(one);
        }
    }
    Ok(loops)
}

/// Neighbouring points that are one are kept once.
fn without_repetition(points: Vec<[f64; 2]>, nearest: f64) -> Vec<[f64; 2]> {
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) > nearest;
    let mut kept: Vec<[f64; 2]> = Vec::with_capacity(points.len());
    for point in points {
        if kept.last().is_none_or(|last| apart(last, &point)) {
            kept.push(point);
        }
    }
    while kept.len() > 1 && !apart(&kept[0], &kept[kept.len() - 1]) {
        kept.pop();
    }
    kept
}

/// Whether the point lies inside the polygon: a ray towards +x leaves it an odd number of times.
fn contains(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let next = polygon.iter().cycle().skip(1);
    let crossed = polygon.iter().zip(next).filter(|(a, b)| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}
