//! `[tool]` of a cut: angles and an edge radius, an outline, or a mesh.

pub(crate) mod heat;
pub(crate) mod machine;
pub(crate) mod shapes;
pub(crate) mod turning;
use crate::process::CuttingProcess;
use crate::sections;
use crate::shared::{self, refuse_keys, require};
use glam::DVec3;
use sphcut_geometry::mesh::{LARGEST_MESH, Mesh, MeshError, Surface};
use sphcut_geometry::outline;
use sphcut_geometry::tool_section::EdgeGeometry;
use sphcut_input::files::{self, LARGEST_OUTLINE, Surroundings};
use sphcut_input::findings::Findings;
use sphcut_input::problem::{Mistake, shortened};
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::units;
use sphcut_physics::friction::FrictionEntry;
use sphcut_physics::{Quantity, Values};
use sphcut_sph::setup::Machine;
use sphcut_tool_heat::ToolHeat;

/// `[tool]` before it is placed.
#[derive(Debug)]
pub(crate) struct ToolShape {
    pub(crate) edge_radius: Option<f64>,
    /// `None` for a tool of corners or triangles.
    pub(crate) rake_angle: Option<f64>,
    pub(crate) body: ToolVolume,
    pub(crate) friction: (&'static FrictionEntry, Values),
    /// Its places as those of the polygon.
    pub(crate) heat: Option<ToolHeat>,
    pub(crate) machine: Machine,
    /// What the user should know about it.
    pub(crate) notes: Vec<String>,
}

/// The space that a tool fills, in m, its lowest point at the depth of cut.
#[derive(Debug)]
pub(crate) enum ToolVolume {
    /// Counter-clockwise, in the plane.
    Section(Vec<[f64; 2]>),
    /// A closed surface, seen from outside counter-clockwise.
    Solid(Surface),
}

impl ToolVolume {
    /// Height of its highest point above the uncut surface.
    pub(crate) fn top(&self) -> f64 {
        match self {
            Self::Section(polygon) => polygon.iter().map(|point| point[1]).fold(0.0, f64::max),
            Self::Solid((vertices, _)) => vertices.iter().map(|point| point[1]).fold(0.0, f64::max),
        }
    }
}

/// The keys that describe the tool in another way than by its angles.
const WHOLE_SHAPES: [&str; 2] = ["outline", "mesh_file"];

/// What a tool is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Space {
    /// A plane cut; whether its tool takes heat where nothing is said of it.
    Plane { tool_takes_heat: bool },
    /// Turning, of a workpiece of this width in m.
    Solid { width: Option<f64> },
}

/// `[tool]`. `sizes`: particle spacing and a length that the faces must exceed, usually the travel.
pub(crate) fn tool(
    findings: &mut Findings,
    root: &Record<'_>,
    surroundings: &Surroundings,
    process: Option<CuttingProcess>,
    sizes: Option<(f64, f64)>,
    space: Space,
) -> Option<ToolShape> {
    let record = reader::read(findings, &root.source, root.table("tool")?, &sections::tool(), 2);
    let friction =
        record.table("friction").and_then(|table| shared::friction(findings, &record, table));
    refuse_unit_without_mesh(findings, &record);
    let edge_radius = record.number("edge_radius");
    let rake_angle = record.number("rake_angle");
    if let Space::Solid { width } = space {
        refuse_keys(
            findings,
            &record,
            ["compliance", "run_out"],
            "is there in plane cuts only, this is turning",
            "remove it: machine and spindle are rigid",
        );
        let turned = turning::turned(findings, &record, surroundings, process, sizes, width)?;
        let around = heat::ToolHeatSite {
            centre: lowest_point(&turned.surface.0),
            shape: heat::ToolHeatShape::Surface(&turned.surface),
            outer_sides: turned.cut_off,
            fine_reach: turned.reach,
            particle_spacing: sizes?.0,
            by_default: false,
        };
        let heat = heat::tool_heat(findings, &record, &around)?;
        return Some(ToolShape {
            edge_radius,
            rake_angle,
            body: ToolVolume::Solid(turned.surface),
            friction: friction?,
            heat,
            machine: Machine::default(),
            notes: Vec::new(),
        });
    }
    refuse_keys(
        findings,
        &record,
        turning::KEYS,
        "belongs to turning, this is a plane cut",
        "remove it, or set dimension = 3",
    );
    let mut notes = Vec::new();
    let whole = WHOLE_SHAPES.into_iter().find(|key| record.is_written(key));
    let polygon = match whole {
        Some(key) => {
            refuse_keys_beside(findings, &record, key);
            let points = match key {
                "outline" => read_outline(findings, &record, surroundings),
                _ => read_cross_section(findings, &record, surroundings, &mut notes),
            };
            at_depth(&points?, process?.depth)
        }
        None => from_angles(findings, &record, process, sizes, &mut notes)?,
    };
    let machine = machine::machine(findings, &record);
    let mut around = heat_surroundings(&record, &polygon, whole, process?, sizes?.0);
    // Where a tool of another shape is cut off is not known.
    around.by_default = whole.is_none() && space == Space::Plane { tool_takes_heat: true };
    let heat = heat::tool_heat(findings, &record, &around)?;
    let body = ToolVolume::Section(polygon);
    Some(ToolShape {
        edge_radius,
        rake_angle,
        body,
        friction: friction?,
        heat,
        machine: machine?,
        notes,
    })
}

/// Uncut chip thicknesses from the edge within which a chip touches the rake face.
pub(crate) const LONGEST_CONTACT: f64 = 5.0;

/// What the heat of the tool needs to know of its shape.
fn heat_surroundings<'a>(
    record: &Record<'_>,
    polygon: &'a [[f64; 2]],
    whole: Option<&str>,
    process: CuttingProcess,
    particle_spacing: f64,
) -> heat::ToolHeatSite<'a> {
    let lowest = polygon.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    let deepest = polygon.iter().filter(|point| point[1] == lowest);
    let foremost = deepest.map(|point| point[0]).fold(f64::NEG_INFINITY, f64::max);
    let count = polygon.len();
    let reach = LONGEST_CONTACT * process.depth;
    heat::ToolHeatSite {
        shape: heat::ToolHeatShape::Outline(polygon),
        centre: [foremost, lowest, 0.0],
        // The corners of a tool of angles end with those of rake face, back and flank.
        outer_sides: whole.is_none().then(|| vec![count - 3, count - 2]),
        fine_reach: reach + record.number("edge_radius").unwrap_or(0.0),
        particle_spacing,
        by_default: false,
    }
}

/// The foremost of the lowest vertices.
fn lowest_point(vertices: &[DVec3]) -> [f64; 3] {
    let by_place = |a: &&DVec3, b: &&DVec3| a.y.total_cmp(&b.y).then(b.x.total_cmp(&a.x));
    vertices.iter().min_by(by_place).expect("a surface has vertices").to_array()
}

/// The tool of plane faces and a rounded edge.
fn from_angles(
    findings: &mut Findings,
    record: &Record<'_>,
    process: Option<CuttingProcess>,
    sizes: Option<(f64, f64)>,
    notes: &mut Vec<String>,
) -> Option<Vec<[f64; 2]>> {
    require(findings, record, &["rake_angle", "clearance_angle", "edge_radius"]);
    let (particle_spacing, travel) = sizes?;
    let edge_radius = record.number("edge_radius")?;
    let uncut_chip_thickness = process?.depth;
    let geometry = EdgeGeometry {
        rake_angle: record.number("rake_angle")?,
        clearance_angle: record.number("clearance_angle")?,
        edge_radius,
        uncut_chip_thickness,
        face_length: face_length(uncut_chip_thickness, travel, edge_radius),
        particle_spacing,
        chamfer: None,
        wear_land: 0.0,
        built_up_edge: None,
    };
    check_wedge(findings, record, &geometry)?;
    let geometry = shapes::add(findings, record, geometry)?;
    notes.extend(shapes::warnings(&geometry));
    Some(geometry.polygon())
}

/// Long enough for a chip as long as the travel that stays straight on the rake face.
pub(crate) fn face_length(uncut_chip_thickness: f64, travel: f64, edge_radius: f64) -> f64 {
    (10.0 * uncut_chip_thickness).max(travel + 5.0 * uncut_chip_thickness) + 5.0 * edge_radius
}

/// Smallest wedge angle that leaves a tool to speak of.
const SMALLEST_WEDGE: f64 = 5.0 / 180.0 * std::f64::consts::PI;

fn check_wedge(findings: &mut Findings, record: &Record<'_>, tool: &EdgeGeometry) -> Option<()> {
    if tool.wedge_angle() >= SMALLEST_WEDGE {
        return Some(());
    }
    let mistake = Mistake::Contradiction {
        message: format!(
            "rake and clearance angle leave a wedge of {} deg: the tool has no body",
            sphcut_input::units::significant(tool.wedge_angle().to_degrees())
        ),
        help: "rake_angle + clearance_angle must stay below 85 deg".to_owned(),
    };
    findings.problem(&record.source, record.span("rake_angle"), mistake);
    None
}

/// Angles and a second shape beside the one of `shape`.
fn refuse_keys_beside(findings: &mut Findings, record: &Record<'_>, shape: &str) {
    let own = match shape {
        "outline" => "the outline has its own shape",
        _ => "the mesh has its own shape",
    };
    let angles = ["rake_angle", "clearance_angle"].into_iter().chain(shapes::KEYS);
    let angles = angles.map(|key| (key, own));
    let shapes = WHOLE_SHAPES.into_iter().filter(|key| *key != shape);
    for (key, why) in angles.chain(shapes.map(|key| (key, "each of them is the whole tool"))) {
        if record.is_written(key) {
            let mistake = Mistake::Contradiction {
                message: format!("`{key}` and `{shape}` exclude each other: {why}"),
                help: "keep one of them; edge_radius may stay, for reports".to_owned(),
            };
            findings.problem(&record.source, record.span(key), mistake);
        }
    }
}

pub(crate) fn refuse_unit_without_mesh(findings: &mut Findings, record: &Record<'_>) {
    if record.is_written("mesh_unit") && record.lacks("mesh_file") {
        let mistake = Mistake::Contradiction {
            message: "`mesh_unit` has no effect without `mesh_file`".to_owned(),
            help: "remove it, or name the file".to_owned(),
        };
        findings.problem(&record.source, record.span("mesh_unit"), mistake);
    }
}

/// The polygon moved along y so that its lowest point lies at y = -h.
fn at_depth(points: &[[f64; 2]], uncut_chip_thickness: f64) -> Vec<[f64; 2]> {
    let lowest = points.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min);
    points.iter().map(|point| [point[0], point[1] - lowest - uncut_chip_thickness]).collect()
}

fn read_outline(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<[f64; 2]>> {
    let path = record.text("outline")?;
    let read = surroundings.read(path, LARGEST_OUTLINE).and_then(|text| {
        let help = "a header line, then the corners as x, y in mm, the rake face towards +x";
        outline::parse(&text).map_err(|reason| files::file_mistake(path, reason, help))
    });
    findings.accept(record, "outline", read)
}

/// The cross-section of the mesh.
fn read_cross_section(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
    notes: &mut Vec<String>,
) -> Option<Vec<[f64; 2]>> {
    let section = read_mesh(findings, record, surroundings, Mesh::cross_section)?;
    if section.holes > 0 {
        notes.push(format!(
            "{} holes inside the cross-section of `{}` are left out: nothing can touch them",
            section.holes,
            shortened(record.text("mesh_file")?)
        ));
    }
    Some(section.polygon)
}

/// What `take` makes of the mesh that `mesh_file` and `mesh_unit` name, in m.
pub(crate) fn read_mesh<T>(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
    take: impl Fn(&Mesh) -> Result<T, MeshError>,
) -> Option<T> {
    require(findings, record, &["mesh_unit"]);
    let (path, unit) = (record.text("mesh_file")?, record.text("mesh_unit")?);
    let metres = units::parse(&format!("1 {unit}"), Quantity::Length)
        .expect("the choices of mesh_unit are units of length")
        .si;
    let read = surroundings.read_bytes(path, LARGEST_MESH).and_then(|bytes| {
        Mesh::read(&bytes)
            .and_then(|mesh| mesh.scaled(metres))
            .and_then(|mesh| take(&mesh))
            .map_err(|error| files::file_mistake(path, error.to_string(), error.help()))
    });
    findings.accept(record, "mesh_file", read)
}
