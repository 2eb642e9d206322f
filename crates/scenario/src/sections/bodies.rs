//! Sections of a scenario of bodies.

use super::{LONGEST, ROOM_TEMPERATURE, temperature};
use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_physics::Quantity;
use std::f64::consts::PI;

const FASTEST: f64 = 1e5;

/// `[[body]]`.
pub(crate) fn body() -> Section {
    let mut fields = vec![
        Field::required("name", Kind::Text, "name in reports and messages").example("\"bar\""),
        Field::required("material", Kind::Material, "as in [workpiece]")
            .example("\"ofhc_copper_johnson_cook\""),
        Field::optional(
            "override",
            Kind::Table,
            "single values that replace those of the material",
        ),
        temperature("temperature", ROOM_TEMPERATURE, "initial temperature"),
        Field::optional("velocity", Kind::Table, "initial velocity; at rest without it"),
    ];
    fields.extend(shape_fields());
    Section::new("body", "A body made of particles.", fields)
}

/// `[[support]]`.
pub(crate) fn support() -> Section {
    let mut fields = vec![
        Field::required("name", Kind::Text, "name in reports and messages").example("\"clamp\""),
        Field::derived("velocity", Kind::PartialVector(Quantity::Speed), "all components free", "prescribed velocity, component by component in the unrotated frame of the region; \"free\" prescribes nothing")
            .example("[\"0 m/s\", \"free\"]"),
        temperature("temperature", Presence::Optional, "prescribed temperature"),
    ];
    fields.extend(shape_fields());
    Section::new("support", "Takes the particles that lie in its region at the start.", fields)
}

/// The keys of a shape; which of them apply depends on `shape`.
fn shape_fields() -> Vec<Field> {
    let point = |key, meaning| {
        Field::optional(key, Kind::Vector(Quantity::Length), meaning)
            .example("[\"0 mm\", \"0 mm\"]")
    };
    vec![
        Field::required(
            "shape",
            Kind::Choice(vec!["box", "cylinder"]),
            "`box`: min, max, rotation; `cylinder` (a disc in 2D, axis along z): centre, radius, inner_radius, length",
        ),
        point("min", "box: smallest corner"),
        point("max", "box: largest corner"),
        Field::optional(
            "rotation",
            between(Quantity::Angle, -4.0 * PI, 4.0 * PI),
            "box: turns it about the origin, counter-clockwise, lattice included",
        ),
        point("centre", "cylinder: centre of its lower end face"),
        Field::optional("radius", positive(Quantity::Length, LONGEST), "cylinder: outer radius")
            .example("\"4 cm\""),
        Field::optional(
            "inner_radius",
            between(Quantity::Length, 0.0, LONGEST),
            "cylinder: radius of its hole",
        ),
        Field::optional(
            "length",
            positive(Quantity::Length, LONGEST),
            "cylinder: extent along z, in 3D",
        )
        .example("\"32.4 mm\""),
    ]
}

/// The keys of a shape that belong to `box` and to `cylinder`.
pub(crate) const SHAPE_KEYS: &[(&str, &[&str])] = &[
    ("box", &["min", "max", "rotation"]),
    ("cylinder", &["centre", "radius", "inner_radius", "length"]),
];

/// `velocity` of a body, for one `field`.
pub(crate) fn velocity(field: &str) -> Section {
    let speed = || between(Quantity::Speed, -FASTEST, FASTEST);
    let coordinate = || between(Quantity::Length, -LONGEST, LONGEST);
    let mut fields = vec![Field::required(
        "field",
        Kind::Choice(VELOCITY_FIELDS.to_vec()),
        "form of the initial velocity",
    )];
    fields.extend(match field {
        "uniform" => vec![
            Field::required("value", Kind::Vector(Quantity::Speed), "the velocity")
                .example("[\"180 m/s\", \"0 m/s\"]"),
        ],
        "rotation" => vec![
            Field::required(
                "centre",
                Kind::Vector(Quantity::Length),
                "a point of the axis along z",
            )
            .example("[\"0 mm\", \"0 mm\"]"),
            Field::required(
                "angular_velocity",
                between(Quantity::AngularSpeed, -1e9, 1e9),
                "counter-clockwise",
            ),
        ],
        "cantilever_mode" => vec![
            Field::required("clamp", coordinate(), "x of the clamped end").example("\"0 mm\""),
            Field::required("length", positive(Quantity::Length, LONGEST), "free length"),
            Field::required("amplitude", speed(), "velocity of the free end along y"),
        ],
        "longitudinal_sine" => vec![
            Field::required("amplitude", speed(), "amplitude of the velocity along x"),
            Field::required(
                "wavelength",
                positive(Quantity::Length, LONGEST),
                "wavelength along x",
            ),
        ],
        _ => Vec::new(),
    });
    Section::new("body.velocity", "Initial velocity of a body.", fields)
}

/// The forms of an initial velocity.
pub(crate) const VELOCITY_FIELDS: &[&str] =
    &["uniform", "rotation", "cantilever_mode", "longitudinal_sine"];

/// `[[wall.velocity_change]]`.
pub(crate) fn velocity_change() -> Section {
    Section::new(
        "wall.velocity_change",
        "A velocity of the wall that holds from some time on.",
        vec![
            Field::required("time", positive(Quantity::Time, 1e6), "from when on")
                .example("\"1 ms\""),
            Field::required("velocity", Kind::Vector(Quantity::Speed), "the new velocity")
                .example("[\"0 m/s\", \"1 m/s\"]"),
        ],
    )
}

/// `[wall]`.
pub(crate) fn wall() -> Section {
    Section::new(
        "wall",
        "A rigid half space, or a rigid body from a mesh.",
        vec![
            Field::required(
                "point",
                Kind::Vector(Quantity::Length),
                "a point of its surface; with `mesh_file` the place of the origin of the mesh",
            )
            .example("[\"0 mm\", \"0 mm\"]"),
            Field::derived(
                "normal",
                Kind::Vector(Quantity::Dimensionless),
                "required unless `mesh_file` is given",
                "direction out of the wall, of any length",
            )
            .example("[0, 1]"),
            Field::derived(
                "velocity",
                Kind::Vector(Quantity::Speed),
                "at rest",
                "velocity of the wall from the start",
            ),
            Field::optional(
                "velocity_change",
                Kind::Tables,
                "velocities that hold from later times on: load, release, next pass",
            ),
            super::mesh_file(
                "STL (binary or ASCII) or Gmsh MSH (2.2 or 4.1, ASCII): a closed surface, of which a plane scenario takes the section with z = 0; in the plane also a plane mesh or line loop in x and y",
            ),
            super::mesh_unit(),
            Field::derived(
                "friction",
                Kind::Table,
                "no friction",
                "friction between wall and bodies",
            ),
            super::heat_table(),
        ],
    )
}
