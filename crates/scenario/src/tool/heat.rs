//! `[tool.heat]` and `[wall.heat]`: heat in the tool.

use crate::sections;
use sphcut_geometry::mesh::{Surface, triangle_distance};
use sphcut_geometry::tool_section::point_distance;
use sphcut_input::document::contradiction;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::{Quantity, ROOM_TEMPERATURE, TemperatureTable};
use sphcut_tool_heat::{Coating, OuterBoundary, ThermalMaterial, ToolHeat};
use toml::de::DeTable;

/// The surface of a tool.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ToolHeatShape<'a> {
    /// In the plane, counter-clockwise.
    Outline(&'a [[f64; 2]]),
    /// In space, closed.
    Surface(&'a Surface),
    HalfSpace,
}

/// What of the tool is known where its heat is read.
pub(crate) struct ToolHeatSite<'a> {
    pub(crate) shape: ToolHeatShape<'a>,
    /// The cutting edge, or the point of a wall.
    pub(crate) centre: [f64; 3],
    /// Sides at which the tool is cut off, where its shape says so.
    pub(crate) outer_sides: Option<Vec<usize>>,
    /// Without the key, in m.
    pub(crate) fine_reach: f64,
    pub(crate) particle_spacing: f64,
    /// Whether it takes heat where nothing is said of it.
    pub(crate) by_default: bool,
}

/// `heat` of `owner`: `Some(None)` where the tool takes none, `None` after a mistake.
pub(crate) fn tool_heat(
    findings: &mut Findings,
    owner: &Record<'_>,
    around: &ToolHeatSite<'_>,
) -> Option<Option<ToolHeat>> {
    let empty = DeTable::new();
    let table = match owner.table("heat") {
        Some(table) => table,
        None if around.by_default => (&empty, owner.heading.clone()),
        None => return Some(None),
    };
    let name = format!("{}.heat", owner.section);
    let record = reader::read(findings, &owner.source, table, &sections::tool_heat(&name), 2);
    refuse_parts_of_a_material(findings, &record);
    let coating = coating(findings, &record);
    let outer = outer(findings, &record);
    if matches!(around.shape, ToolHeatShape::HalfSpace) {
        let mistake = Mistake::Contradiction {
            message: "a half space has no mesh to conduct heat in".to_owned(),
            help: "give the wall a `mesh_file`: in the plane for example a rectangle as a Gmsh line loop, in space \
                   a closed surface"
                .to_owned(),
        };
        findings.problem(&record.source, record.heading.clone(), mistake);
        return None;
    }
    let outer_sides = outer_sides(findings, &record, around, outer?)?;
    let element_size = match record.is_written("element_size") {
        true => record.number("element_size")?,
        false => {
            let size = 0.5 * around.particle_spacing;
            findings.derived(&name, "element_size", Quantity::Length, size);
            size
        }
    };
    let fine_reach = match record.is_written("fine_reach") {
        true => record.number("fine_reach")?,
        false => {
            if around.fine_reach.is_finite() {
                findings.derived(&name, "fine_reach", Quantity::Length, around.fine_reach);
            }
            around.fine_reach
        }
    };
    Some(Some(ToolHeat {
        substrate: thermal_material(&record)?,
        coating: coating?,
        temperature: record.number("temperature")?,
        contact_conductance: record.number("contact_conductance")?,
        outer_sides,
        outer: outer?,
        fine_centre: around.centre,
        fine_reach,
        element_size,
        capacity_scaling: record.number("capacity_scaling").unwrap_or(1.0),
    }))
}

fn coating(findings: &mut Findings, heat: &Record<'_>) -> Option<Option<Coating>> {
    let Some(table) = heat.table("coating") else { return Some(None) };
    let name = format!("{}.coating", heat.section);
    let record = reader::read(findings, &heat.source, table, &sections::coating(&name), 2);
    Some(Some(Coating {
        thickness: record.number("thickness")?,
        material: thermal_material(&record)?,
    }))
}

/// The defaults are one material: beside a value of another one they would be nothing.
fn refuse_parts_of_a_material(findings: &mut Findings, record: &Record<'_>) {
    let (written, lacking): (Vec<&str>, Vec<&str>) =
        sections::SUBSTANCE.into_iter().partition(|key| record.is_written(key));
    let (Some(first), false) = (written.first(), lacking.is_empty()) else { return };
    let listed: Vec<String> = lacking.iter().map(|key| format!("`{key}`")).collect();
    let message =
        format!("`{first}` without {}: they belong to one material", listed.join(" and "));
    contradiction(
        findings,
        record,
        first,
        message,
        "write all three of density, specific_heat and thermal_conductivity, or none for cemented carbide",
    );
}

fn thermal_material(record: &Record<'_>) -> Option<ThermalMaterial> {
    Some(ThermalMaterial {
        density: record.number("density")?,
        specific_heat: property(record, "specific_heat")?,
        thermal_conductivity: property(record, "thermal_conductivity")?,
    })
}

/// A table over temperature; one value is a table of one pair.
fn property(record: &Record<'_>, key: &str) -> Option<TemperatureTable> {
    if let Some(value) = record.number(key) {
        let table = TemperatureTable::new(&[(ROOM_TEMPERATURE, value)]);
        return Some(table.expect("the range of the key is above zero"));
    }
    record.written_tables().into_iter().find(|(known, _)| *known == key).map(|(_, table)| table)
}

fn outer(findings: &mut Findings, record: &Record<'_>) -> Option<OuterBoundary> {
    let kind = record.text("outer")?;
    let idle: &[(&str, &str)] = match kind {
        "adiabatic" => &[
            ("outer_temperature", "no heat passes adiabatic sides"),
            ("film_coefficient", "no heat passes adiabatic sides"),
        ],
        "fixed" => &[("film_coefficient", "the sides keep their temperature")],
        _ => &[],
    };
    for (key, why) in idle.iter().filter(|(key, _)| record.is_written(key)) {
        let mistake = Mistake::Contradiction {
            message: format!("`{key}` has no effect with outer = \"{kind}\": {why}"),
            help: "remove it, or choose outer = \"convective\"".to_owned(),
        };
        findings.problem(&record.source, record.span(key), mistake);
    }
    let temperature = match record.is_written("outer_temperature") {
        true => record.number("outer_temperature"),
        false => record.number("temperature"),
    };
    if kind == "convective" && record.lacks("film_coefficient") {
        let section = sections::tool_heat(&record.section);
        let field = section.field("film_coefficient").expect("a key of the section");
        findings.problem(&record.source, record.heading.clone(), reader::missing(&section, field));
    }
    Some(match kind {
        "adiabatic" => OuterBoundary::Adiabatic,
        "fixed" => OuterBoundary::Fixed(temperature?),
        _ => OuterBoundary::Convective {
            film_coefficient: record.number("film_coefficient")?,
            ambient: temperature?,
        },
    })
}

/// The sides at which the tool is cut off.
fn outer_sides(
    findings: &mut Findings,
    record: &Record<'_>,
    around: &ToolHeatSite<'_>,
    outer: OuterBoundary,
) -> Option<Vec<usize>> {
    if !record.is_written("outer_distance") {
        if let Some(known) = &around.outer_sides {
            return Some(known.clone());
        }
        if outer == OuterBoundary::Adiabatic && record.lacks("coating") {
            return Some(Vec::new());
        }
        let section = sections::tool_heat(&record.section);
        let field = section.field("outer_distance").expect("a key of the section");
        findings.problem(&record.source, record.heading.clone(), reader::missing(&section, field));
        return None;
    }
    let distance = record.number("outer_distance")?;
    let away = distances(around);
    let sides: Vec<usize> = (0..away.len()).filter(|side| away[*side] >= distance).collect();
    if sides.is_empty() && outer != OuterBoundary::Adiabatic {
        let farthest = away.iter().copied().fold(0.0, f64::max);
        let mistake = Mistake::Contradiction {
            message: format!(
                "no side of the tool lies as far away as outer_distance: the farthest is {} mm away",
                sphcut_input::units::significant(farthest * 1e3)
            ),
            help: "choose a smaller distance, or outer = \"adiabatic\"".to_owned(),
        };
        findings.problem(&record.source, record.span("outer_distance"), mistake);
        return None;
    }
    if sides.len() == away.len() {
        let mistake = Mistake::Contradiction {
            message: "all sides of the tool lie farther away than outer_distance: none is left to be touched"
                .to_owned(),
            help: "choose a larger distance".to_owned(),
        };
        findings.problem(&record.source, record.span("outer_distance"), mistake);
        return None;
    }
    Some(sides)
}

/// How far each side of the tool is from its cutting edge.
fn distances(around: &ToolHeatSite<'_>) -> Vec<f64> {
    match around.shape {
        ToolHeatShape::Outline(polygon) => {
            let [x, y, _] = around.centre;
            let side = |k: usize| (polygon[k], polygon[(k + 1) % polygon.len()]);
            (0..polygon.len()).map(|k| point_distance([x, y], side(k))).collect()
        }
        ToolHeatShape::Surface((vertices, triangles)) => triangles
            .iter()
            .map(|triangle| triangle_distance(around.centre.into(), &triangle.map(|v| vertices[v])))
            .collect(),
        ToolHeatShape::HalfSpace => Vec::new(),
    }
}
