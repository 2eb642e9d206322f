//! `[tool]` of turning: an insert from its angles and radii, or a mesh.

use crate::process::CuttingProcess;
use crate::shared::{refuse_keys, require};
use crate::tool::{LONGEST_CONTACT, face_length, read_mesh, shapes};
use sphcut_geometry::insert::{BODY, InsertGeometry};
use sphcut_geometry::mesh::{Mesh, Surface};
use sphcut_input::files::Surroundings;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::record::Record;
use sphcut_input::units::significant;

/// Its keys beside those of a plane tool.
pub(crate) const KEYS: [&str; 3] =
    ["nose_radius", "side_cutting_edge_angle", "front_cutting_edge_angle"];
const ANGLES: [&str; 2] = ["rake_angle", "clearance_angle"];

/// A tool in space.
pub(crate) struct Turned {
    /// Closed, its lowest point at (x, -depth of cut, 0).
    pub(crate) surface: Surface,
    /// Facets at which it is cut off, where its shape says so.
    pub(crate) cut_off: Option<Vec<usize>>,
    /// How far from its lowest point it can be touched, roughly, in m.
    pub(crate) reach: f64,
}

/// The tool of turning. `sizes`: particle spacing and travel; `width`: that of the workpiece.
pub(crate) fn turned(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
    process: Option<CuttingProcess>,
    sizes: Option<(f64, f64)>,
    width: Option<f64>,
) -> Option<Turned> {
    let plane = ["outline"].into_iter().chain(shapes::KEYS);
    let before = findings.problems.len();
    refuse_keys(
        findings,
        record,
        plane,
        "belongs to a plane tool, this is turning",
        "remove it, or set dimension = 2",
    );
    if record.is_written("mesh_file") {
        let own = ANGLES.into_iter().chain(KEYS);
        refuse_keys(
            findings,
            record,
            own,
            "and `mesh_file` exclude each other: the mesh has its own shape",
            "keep one of them; edge_radius may stay, for reports",
        );
        let read = read_mesh(findings, record, surroundings, Mesh::closed_surface);
        let depth = process?.depth;
        let turned = Turned {
            surface: at_depth(read?, depth),
            cut_off: None,
            reach: LONGEST_CONTACT * depth + record.number("edge_radius").unwrap_or(0.0),
        };
        return Some(turned).filter(|_| findings.problems.len() == before);
    }
    let needed: Vec<&str> = ANGLES.into_iter().chain(["edge_radius"]).chain(KEYS).collect();
    require(findings, record, &needed);
    let (particle_spacing, travel) = sizes?;
    let nose_radius = record.number("nose_radius")?;
    let edge_radius = record.number("edge_radius")?;
    let depth_of_cut = process?.depth;
    let insert = InsertGeometry {
        nose_radius,
        edge_radius,
        rake_angle: record.number("rake_angle")?,
        clearance_angle: record.number("clearance_angle")?,
        side_cutting_edge_angle: record.number("side_cutting_edge_angle")?,
        front_cutting_edge_angle: record.number("front_cutting_edge_angle")?,
        depth_of_cut,
        // Beyond both sides of the workpiece, and as high as a straight chip.
        edge_length: (2.0 * width?).max(face_length(depth_of_cut, travel, edge_radius)),
        particle_spacing,
        body: BODY * nose_radius,
    };
    check(findings, record, &insert)?;
    let insert = if record.table("heat").is_some() { insert.deepened() } else { insert };
    let surface = insert.surface();
    // The ends of the edge in the first groove, or the end of the contact on the rake face.
    let groove = (2.0 * nose_radius * depth_of_cut).sqrt() + 2.0 * depth_of_cut;
    let turned = Turned {
        cut_off: Some(insert.cut_off(&surface)),
        surface,
        reach: groove.max(LONGEST_CONTACT * depth_of_cut) + edge_radius,
    };
    (findings.problems.len() == before).then_some(turned)
}

/// Angles and radii that leave no body.
fn check(findings: &mut Findings, record: &Record<'_>, insert: &InsertGeometry) -> Option<()> {
    let micrometres = |length: f64| format!("{} um", significant(length * 1e6));
    let (key, message, help) = if insert.edge_radius <= 0.0 {
        (
            "edge_radius",
            "the edge of an insert is rounded: edge_radius must be above 0".to_owned(),
            "a radius far below the particle spacing acts like a sharp edge",
        )
    } else if insert.nose_radius <= insert.edge_radius {
        (
            "nose_radius",
            format!(
                "nose_radius = {} is not larger than the edge radius",
                micrometres(insert.nose_radius)
            ),
            "the edge runs round the nose: choose a larger nose_radius or a smaller edge_radius",
        )
    } else if insert.depth_of_cut >= insert.nose_radius {
        (
            "nose_radius",
            format!(
                "nose_radius = {} does not exceed the depth of cut",
                micrometres(insert.nose_radius)
            ),
            "only the nose cuts here: for a depth beyond it give the tool as `mesh_file`",
        )
    } else if insert.radius_at_back() <= 0.0 {
        (
            "clearance_angle",
            "the flanks meet before the insert ends: it has no body".to_owned(),
            "choose a smaller clearance or rake angle, a larger nose_radius or a shorter travel",
        )
    } else {
        return Some(());
    };
    let mistake = Mistake::Contradiction { message, help: help.to_owned() };
    findings.problem(&record.source, record.span(key), mistake);
    None
}

/// The mesh moved along y and z so that its lowest point (the middle of several) lies at y = -depth, z = 0.
fn at_depth((mut vertices, triangles): Surface, depth: f64) -> Surface {
    let lowest = vertices.iter().map(|vertex| vertex[1]).fold(f64::INFINITY, f64::min);
    let tips: Vec<f64> =
        vertices.iter().filter(|vertex| vertex[1] == lowest).map(|vertex| vertex[2]).collect();
    let low = tips.iter().copied().fold(f64::INFINITY, f64::min);
    let high = tips.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for vertex in &mut vertices {
        vertex[1] -= lowest + depth;
        vertex[2] -= 0.5 * (low + high);
    }
    (vertices, triangles)
}
