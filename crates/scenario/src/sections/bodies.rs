//! Sections of a scenario of bodies.

use super::{LONGEST, ROOM_TEMPERATURE, temperature};
use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_physics::Quantity;
use std::f64::consts::PI;

const FASTEST: f64 = 1e5;

/// `[[body]]`.
pub(crate) fn body() -> Section {
    let mut fields = vec![
        Field::new("name", Kind::Text, Presence::Required, "name in reports and messages")
            .example("\"bar\""),
        Field::new("material", Kind::Material, Presence::Required, "as in [workpiece]")
            .example("\"ofhc_copper_johnson_cook\""),
        Field::new(
            "override",
            Kind::Table,
            Presence::Optional,
            "single values that replace those of the material",
        ),
        temperature("temperature", ROOM_TEMPERATURE, "initial temperature"),
        Field::new(
            "velocity",
            Kind::Table,
            Presence::Optional,
            "initial velocity; at rest without it",
        ),
    ];
    fields.extend(shape_fields());
    Section::new("body", "A body made of particles.", fields)
}

/// `[[support]]`.
pub(crate) fn support() -> Section {
    let mut fields = vec![
        Field::new("name", Kind::Text, Presence::Required, "name in reports and messages").example("\"clamp\""),
        Field::new("velocity", Kind::PartialVector(Quantity::Speed), Presence::Derived("all components free"), "prescribed velocity, component by component in the unrotated frame of the region; \"free\" prescribes nothing")
            .example("[\"0 m/s\", \"free\"]"),
        temperature("temperature", Presence::Optional, "prescribed temperature"),
    ];
    fields.extend(shape_fields());
    Section::new("support", "Takes the particles that lie in its region at the start.", fields)
}

/// The keys of a shape; which of them apply depends on `shape`.
fn shape_fields() -> Vec<Field> {
    let point = |key, meaning| {
        Field::new(key, Kind::Vector(Quantity::Length), Presence::Optional, meaning)
            .example("[\"0 mm\", \"0 mm\"]")
    };
    vec![
        Field::new(
            "shape",
            Kind::Choice(vec!["box", "cylinder"]),
            Presence::Required,
            "`box`: min, max, rotation; `cylinder` (a disc in 2D, axis along z): centre, radius, inner_radius, length",
        ),
        point("min", "box: smallest corner"),
        point("max", "box: largest corner"),
        Field::new(
            "rotation",
            between(Quantity::Angle, -4.0 * PI, 4.0 * PI),
            Presence::Optional,
            "box: turns it about the origin, counter-clockwise, lattice included",
        ),
        point("centre", "cylinder: centre of its lower end face"),
        Field::new(
            "radius",
            positive(Quantity::Length, LONGEST),
            Presence::Optional,
            "cylinder: outer radius",
        )
        .example("\"4 cm\""),
        Field::new(
            "inner_radius",
            between(Quantity::Length, 0.0, LONGEST),
            Presence::Optional,
            "cylinder: radius of its hole",
        ),
        Field::new(
            "length",
            positive(Quantity::Length, LONGEST),
            Presence::Optional,
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
    let mut fields = vec![Field::new(
        "field",
        Kind::Choice(VELOCITY_FIELDS.to_vec()),
        Presence::Required,
        "form of the initial velocity",
    )];
    fields.extend(match field {
        "uniform" => vec![
            Field::new("value", Kind::Vector(Quantity::Speed), Presence::Required, "the velocity")
                .example("[\"180 m/s\", \"0 m/s\"]"),
        ],
        "rotation" => vec![
            Field::new(
                "centre",
                Kind::Vector(Quantity::Length),
                Presence::Required,
                "a point of the axis along z",
            )
            .example("[\"0 mm\", \"0 mm\"]"),
            Field::new(
                "angular_velocity",
                between(Quantity::AngularSpeed, -1e9, 1e9),
                Presence::Required,
                "counter-clockwise",
            ),
        ],
        "cantilever_mode" => vec![
            Field::new("clamp", coordinate(), Presence::Required, "x of the clamped end")
                .example("\"0 mm\""),
            Field::new(
                "length",
                positive(Quantity::Length, LONGEST),
                Presence::Required,
                "free length",
            ),
            Field::new(
                "amplitude",
                speed(),
                Presence::Required,
                "velocity of the free end along y",
            ),
        ],
        "longitudinal_sine" => vec![
            Field::new(
                "amplitude",
                speed(),
                Presence::Required,
                "amplitude of the velocity along x",
            ),
            Field::new(
                "wavelength",
                positive(Quantity::Length, LONGEST),
                Presence::Required,
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
            Field::new("time", positive(Quantity::Time, 1e6), Presence::Required, "from when on")
                .example("\"1 ms\""),
            Field::new(
                "velocity",
                Kind::Vector(Quantity::Speed),
                Presence::Required,
                "the new velocity",
            )
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
            Field::new(
                "point",
                Kind::Vector(Quantity::Length),
                Presence::Required,
                "a point of its surface; with `mesh_file` the place of the origin of the mesh",
            )
            .example("[\"0 mm\", \"0 mm\"]"),
            Field::new(
                "normal",
                Kind::Vector(Quantity::Dimensionless),
                Presence::Derived("required unless `mesh_file` is given"),
                "direction out of the wall, of any length",
            )
            .example("[0, 1]"),
            Field::new(
                "velocity",
                Kind::Vector(Quantity::Speed),
                Presence::Derived("at rest"),
                "velocity of the wall from the start",
            ),
            Field::new(
                "velocity_change",
                Kind::Tables,
                Presence::Optional,
                "velocities that hold from later times on: load, release, next pass",
            ),
            super::mesh_file(
                "STL (binary or ASCII) or Gmsh MSH (2.2 or 4.1, ASCII): a closed surface, of which a plane scenario takes the section with z = 0; in the plane also a plane mesh or line loop in x and y",
            ),
            super::mesh_unit(),
            Field::new(
                "friction",
                Kind::Table,
                Presence::Derived("no friction"),
                "friction between wall and bodies",
            ),
            super::heat_table(),
        ],
    )
}
