//! Bodies and supports: scenarios with a known answer.

use crate::material::Shelf;
use crate::sections::{self, SHAPE_KEYS};
use sphcut_input::findings::Findings;
use sphcut_input::problem::{Mistake, shortened};
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_sph::setup::{Body, Material, Shape, Support, VelocityField};

/// All `[[body]]` tables with their materials; `None` after a mistake.
pub(crate) fn bodies(
    findings: &mut Findings,
    root: &Record<'_>,
    shelf: &mut Shelf<'_>,
    dimension: usize,
) -> Option<(Vec<Body>, Vec<Material>)> {
    let mut bodies = Vec::new();
    let mut materials = Vec::new();
    let tables = root.tables("body");
    let count = tables.len();
    check_table_count(findings, root, "body", count)?;
    for table in tables {
        let record = reader::read(findings, &root.source, table, &sections::body(), dimension);
        let material = shelf.material(findings, &record);
        let shape = shape(findings, &record, dimension);
        let velocity = velocity(findings, &record, dimension);
        if let (Some(known), Some(shape), Some(velocity)) = (material, shape, velocity) {
            let (Some(name), Some(temperature)) =
                (record.text("name"), record.number("temperature"))
            else {
                continue;
            };
            bodies.push(Body {
                name: name.to_owned(),
                material: materials.len(),
                shape,
                velocity,
                temperature,
            });
            materials.push(known.material);
        }
    }
    (bodies.len() == count).then_some((bodies, materials))
}

/// Most bodies and most supports of a scenario; the solver numbers supports with a byte.
const MOST_TABLES: usize = 250;

pub(crate) fn check_table_count(
    findings: &mut Findings,
    root: &Record<'_>,
    key: &str,
    count: usize,
) -> Option<()> {
    if count <= MOST_TABLES {
        return Some(());
    }
    let mistake = Mistake::TooLarge {
        message: format!(
            "{count} tables [[{key}]]: more than the {MOST_TABLES} this program takes"
        ),
        help: "describe fewer of them".to_owned(),
    };
    findings.problem(&root.source, root.span(key), mistake);
    None
}

/// All `[[support]]` tables.
pub(crate) fn supports(
    findings: &mut Findings,
    root: &Record<'_>,
    dimension: usize,
) -> Option<Vec<Support>> {
    let mut supports = Vec::new();
    let tables = root.tables("support");
    let count = tables.len();
    check_table_count(findings, root, "support", count)?;
    for table in tables {
        let record = reader::read(findings, &root.source, table, &sections::support(), dimension);
        let region = shape(findings, &record, dimension);
        let mut velocity = [None; 3];
        for (component, given) in
            velocity.iter_mut().zip(record.partial_vector("velocity").unwrap_or_default())
        {
            *component = *given;
        }
        let temperature = record.number("temperature");
        if !record.is_written("velocity") && !record.is_written("temperature") {
            let mistake = Mistake::Contradiction {
                message:
                    "this support holds nothing: neither `velocity` nor `temperature` is given"
                        .to_owned(),
                help: "for example: velocity = [\"0 m/s\", \"free\"]".to_owned(),
            };
            findings.problem(&record.source, record.heading.clone(), mistake);
        }
        if let (Some(region), Some(name)) = (region, record.text("name")) {
            supports.push(Support { name: name.to_owned(), region, velocity, temperature });
        }
    }
    (supports.len() == count).then_some(supports)
}

/// The shape of a body or a support.
fn shape(findings: &mut Findings, record: &Record<'_>, dimension: usize) -> Option<Shape> {
    let kind = record.text("shape")?;
    refuse_keys_of_other_shapes(findings, record, kind);
    match kind {
        "box" => {
            require_shape_keys(findings, record, &["min", "max"]);
            box_shape(findings, record, dimension)
        }
        _ => {
            let needed: &[&str] = if dimension == 3 {
                &["centre", "radius", "length"]
            } else {
                &["centre", "radius"]
            };
            require_shape_keys(findings, record, needed);
            cylinder(findings, record, dimension)
        }
    }
}

fn refuse_keys_of_other_shapes(findings: &mut Findings, record: &Record<'_>, kind: &str) {
    for (other, keys) in SHAPE_KEYS.iter().filter(|shape| shape.0 != kind) {
        for key in keys.iter().filter(|key| record.is_written(key)) {
            let mistake = Mistake::Contradiction {
                message: format!("`{key}` belongs to the shape `{other}`, this is a `{kind}`"),
                help: "remove it or change `shape`".to_owned(),
            };
            findings.problem(&record.source, record.span(key), mistake);
        }
    }
}

fn require_shape_keys(findings: &mut Findings, record: &Record<'_>, keys: &[&str]) {
    let section = if record.section == "body" { sections::body() } else { sections::support() };
    for key in keys.iter().filter(|key| record.lacks(key)) {
        let field = section.field(key).expect("the caller names keys of a shape");
        findings.problem(&record.source, record.heading.clone(), reader::missing(&section, field));
    }
}

/// The lower and the upper corner of a box in m, if they are in this order.
pub(crate) fn corners(
    findings: &mut Findings,
    record: &Record<'_>,
    dimension: usize,
) -> Option<([f64; 3], [f64; 3])> {
    let (min, max) = (record.vector("min")?, record.vector("max")?);
    if (0..dimension).any(|axis| min[axis] >= max[axis]) {
        let mistake = Mistake::Contradiction {
            message: "`max` must lie above `min` in every component".to_owned(),
            help: "exchange or correct the corners".to_owned(),
        };
        findings.problem(&record.source, record.span("max"), mistake);
        return None;
    }
    Some((min, max))
}

fn box_shape(findings: &mut Findings, record: &Record<'_>, dimension: usize) -> Option<Shape> {
    let (min, max) = corners(findings, record, dimension)?;
    let rotation = match record.is_written("rotation") {
        true => record.number("rotation")?,
        false => 0.0,
    };
    Some(Shape::Box { min, max, rotation, mirrored: false })
}

fn cylinder(findings: &mut Findings, record: &Record<'_>, dimension: usize) -> Option<Shape> {
    let radius = record.number("radius")?;
    let inner_radius = match record.is_written("inner_radius") {
        true => record.number("inner_radius")?,
        false => 0.0,
    };
    if inner_radius >= radius {
        let mistake = Mistake::Contradiction {
            message: "`inner_radius` must be smaller than `radius`".to_owned(),
            help: "a full disc has no inner_radius".to_owned(),
        };
        findings.problem(&record.source, record.span("inner_radius"), mistake);
        return None;
    }
    if dimension == 2 && record.is_written("length") {
        let mistake = Mistake::Contradiction {
            message: "a disc in the plane has no `length`".to_owned(),
            help: "remove it, or set dimension = 3".to_owned(),
        };
        findings.problem(&record.source, record.span("length"), mistake);
        return None;
    }
    // A plane disc has no length: the solver ignores it.
    let length = if dimension == 3 { record.number("length")? } else { 0.0 };
    Some(Shape::Cylinder { centre: record.vector("centre")?, radius, inner_radius, length })
}

/// The initial velocity of a body.
fn velocity(
    findings: &mut Findings,
    owner: &Record<'_>,
    dimension: usize,
) -> Option<VelocityField> {
    if !owner.is_written("velocity") {
        return Some(VelocityField::Uniform([0.0; 3]));
    }
    let table = owner.table("velocity")?;
    let field = table.0.get("field").and_then(|field| field.get_ref().as_str()).unwrap_or("");
    let known = sections::VELOCITY_FIELDS.contains(&field);
    let section = sections::velocity(field);
    if !known && table.0.contains_key("field") {
        // Only the field itself is a mistake: the other keys cannot be judged without it.
        report_unknown_field(findings, owner, table.0, field);
        return None;
    }
    let record = reader::read(findings, &owner.source, table, &section, dimension);
    match field {
        "uniform" => Some(VelocityField::Uniform(record.vector("value")?)),
        "rotation" => Some(VelocityField::Rotation {
            centre: record.vector("centre")?,
            angular_velocity: record.number("angular_velocity")?,
        }),
        "cantilever_mode" => Some(VelocityField::CantileverMode {
            clamp: record.number("clamp")?,
            length: record.number("length")?,
            amplitude: record.number("amplitude")?,
        }),
        "longitudinal_sine" => Some(VelocityField::LongitudinalSine {
            amplitude: record.number("amplitude")?,
            wavelength: record.number("wavelength")?,
        }),
        _ => None,
    }
}

fn report_unknown_field(
    findings: &mut Findings,
    owner: &Record<'_>,
    table: &toml::de::DeTable<'_>,
    field: &str,
) {
    let mistake = reader::not_a_choice("field", field, sections::VELOCITY_FIELDS);
    let span = table.get("field").map_or(owner.heading.clone(), toml::Spanned::span);
    findings.problem(&owner.source, span, mistake);
}

/// A body thinner than half a spacing would hold no particle.
pub(crate) fn check_thickness(
    findings: &mut Findings,
    root: &Record<'_>,
    bodies: &[Body],
    spacing: f64,
    dimension: usize,
) {
    for (body, (_, place)) in bodies.iter().zip(root.tables("body")) {
        let thickness = crate::warnings::thickness(&body.shape, dimension);
        if thickness < spacing {
            let mistake = Mistake::Contradiction {
                message: format!(
                    "body `{}` is {} mm thick, less than the particle spacing",
                    shortened(&body.name),
                    sphcut_input::units::significant(thickness * 1e3)
                ),
                help: "choose a smaller particle_spacing".to_owned(),
            };
            findings.problem(&root.source, place, mistake);
        }
    }
}

/// Particles of all bodies, from their volumes.
pub(crate) fn particle_count(bodies: &[Body], spacing: f64, dimension: usize) -> f64 {
    bodies.iter().map(|body| body.shape.volume(dimension)).sum::<f64>()
        / spacing.powi(if dimension == 3 { 3 } else { 2 })
}
