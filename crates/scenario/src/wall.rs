//! `[wall]`: what is rigid in a scenario of bodies, and how it moves.

use crate::bodies::check_table_count;
use crate::tool::heat;
use crate::{sections, shared, tool};
use glam::DVec3;
use sphcut_geometry::mesh::Mesh;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_input::files::Surroundings;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::{Values, friction};
use sphcut_sph::setup::{Tool, VelocityChange};

/// `[wall]`: a half space or a body from a mesh, rigid and all tool.
pub(crate) fn wall(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    dimension: usize,
    particle_spacing: Option<f64>,
) -> Option<Option<Tool>> {
    let Some(table) = root.table("wall") else { return Some(None) };
    let record = reader::read(findings, &root.source, table, &sections::wall(), dimension);
    let friction = match record.table("friction") {
        Some(table) => shared::friction(findings, &record, table),
        None => Some(frictionless()),
    };
    tool::refuse_unit_without_mesh(findings, &record);
    let surface = if record.is_written("mesh_file") {
        wall_from_mesh(findings, &record, surroundings, dimension)
    } else {
        half_space(findings, &record)
    };
    let velocity = match record.is_written("velocity") {
        true => record.vector("velocity")?,
        false => [0.0; 3],
    };
    let velocity_changes = velocity_changes(findings, &record, dimension);
    let (friction, friction_values) = friction?;
    let surface = surface?;
    let point = record.vector("point")?;
    let solid = match &surface {
        ToolSurface::Triangles { vertices, triangles } => {
            Some((vertices.iter().copied().map(Into::into).collect(), triangles.clone()))
        }
        _ => None,
    };
    let around = heat::ToolHeatSite {
        shape: match (&surface, &solid) {
            (ToolSurface::Polygon(corners), _) => heat::ToolHeatShape::Outline(corners),
            (_, Some(solid)) => heat::ToolHeatShape::Surface(solid),
            _ => heat::ToolHeatShape::HalfSpace,
        },
        centre: point,
        outer_sides: None,
        by_default: false,
        fine_reach: f64::INFINITY,
        particle_spacing: particle_spacing?,
    };
    let heat = heat::tool_heat(findings, &record, &around)?;
    Some(Some(Tool {
        surface,
        velocity,
        velocity_changes: velocity_changes?,
        edge_radius: None,
        friction,
        friction_values,
        heat,
    }))
}

fn half_space(findings: &mut Findings, record: &Record<'_>) -> Option<ToolSurface> {
    shared::require(findings, record, &["normal"]);
    let normal = record.vector("normal")?;
    let length = normal.iter().map(|component| component * component).sum::<f64>().sqrt();
    if !(length > 1e-100 && length.is_finite()) {
        let mistake = Mistake::Contradiction {
            message: "`normal` has no direction".to_owned(),
            help: "for example: normal = [0, 1]".to_owned(),
        };
        findings.problem(&record.source, record.span("normal"), mistake);
        return None;
    }
    Some(ToolSurface::HalfSpace {
        point: record.vector("point")?,
        normal: normal.map(|component| component / length),
    })
}

/// The mesh, its origin moved to `point`: its closed surface in space, its cross-section in the
/// plane.
fn wall_from_mesh(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
    dimension: usize,
) -> Option<ToolSurface> {
    if record.is_written("normal") {
        let mistake = Mistake::Contradiction {
            message: "`normal` and `mesh_file` exclude each other: the mesh has its own normals"
                .to_owned(),
            help: "keep one of them".to_owned(),
        };
        findings.problem(&record.source, record.span("normal"), mistake);
    }
    if dimension == 3 {
        let read = tool::read_mesh(findings, record, surroundings, Mesh::closed_surface);
        let (vertices, triangles) = read?;
        let point = record.vector("point")?;
        let at = DVec3::from(point);
        let vertices = vertices.iter().map(|vertex| (vertex + at).to_array()).collect();
        return Some(ToolSurface::Triangles { vertices, triangles });
    }
    let section = tool::read_mesh(findings, record, surroundings, Mesh::cross_section)?;
    let point = record.vector("point")?;
    let moved = |corner: [f64; 2]| [corner[0] + point[0], corner[1] + point[1]];
    Some(ToolSurface::Polygon(section.polygon.into_iter().map(moved).collect()))
}

/// `[[wall.velocity_change]]`, in the order of time.
fn velocity_changes(
    findings: &mut Findings,
    wall: &Record<'_>,
    dimension: usize,
) -> Option<Vec<VelocityChange>> {
    let tables = wall.tables("velocity_change");
    let count = tables.len();
    check_table_count(findings, wall, "wall.velocity_change", count)?;
    let mut changes: Vec<VelocityChange> = Vec::new();
    for table in tables {
        let section = sections::velocity_change();
        let record = reader::read(findings, &wall.source, table, &section, dimension);
        let (Some(time), Some(velocity)) = (record.number("time"), record.vector("velocity"))
        else {
            continue;
        };
        if changes.last().is_some_and(|before| before.time >= time) {
            let mistake = Mistake::Contradiction {
                message: "this change of the velocity is not later than the one before".to_owned(),
                help: "write the changes in the order of time".to_owned(),
            };
            findings.problem(&record.source, record.span("time"), mistake);
        }
        changes.push(VelocityChange { time, velocity });
    }
    (changes.len() == count).then_some(changes)
}

/// Length of the path of a wall up to `time`.
pub(crate) fn path(wall: &Tool, time: f64) -> f64 {
    let speed = |velocity: [f64; 3]| velocity[0].hypot(velocity[1]).hypot(velocity[2]);
    let (mut path, mut start, mut velocity) = (0.0, 0.0, wall.velocity);
    for change in wall.velocity_changes.iter().filter(|change| change.time < time) {
        path += speed(velocity) * (change.time - start);
        (start, velocity) = (change.time, change.velocity);
    }
    path + speed(velocity) * (time - start)
}

/// Coulomb friction with the coefficient zero.
fn frictionless() -> (&'static friction::FrictionEntry, Values) {
    let law = friction::find("coulomb").expect("the catalogue has Coulomb friction");
    let values = Values::resolve(law.parameters, &[("friction_coefficient", 0.0)])
        .expect("no friction is in the range of Coulomb friction");
    (law, values)
}
