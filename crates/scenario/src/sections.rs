//! Every section of a scenario and of a material file.

use crate::section::{Field, Kind, Presence, Section};
use sphcut_physics::flow_stress::{self, FlowStressEntry};
use sphcut_physics::friction::{self, FrictionEntry};
use sphcut_physics::{Quantity, Range};
use sphcut_sph::kernel::KernelChoice;
use sphcut_sph::options;
use sphcut_sph::setup::Lattice;
use std::borrow::Cow;
use std::f64::consts::PI;

/// Initial arrangements by name.
pub(crate) const LATTICES: &[(&str, Lattice)] = &[
    ("square", Lattice::Square),
    ("hexagonal", Lattice::Hexagonal),
    ("disordered", Lattice::Disordered),
];

/// Resolution presets: particle spacings across the uncut chip thickness.
pub(crate) const PRESETS: &[(&str, f64)] = &[("draft", 5.0), ("standard", 10.0), ("fine", 14.0)];

const LONGEST: f64 = 100.0;
const FASTEST: f64 = 1e5;
const HOTTEST: f64 = 10_000.0;
const ROOM_TEMPERATURE: Presence = Presence::Default(Cow::Borrowed("293.15 K"));

const fn default(text: &'static str) -> Presence {
    Presence::Default(Cow::Borrowed(text))
}

const fn positive(quantity: Quantity, max: f64) -> Kind {
    Kind::Quantity(quantity, Range::above(0.0, max))
}

const fn between(quantity: Quantity, min: f64, max: f64) -> Kind {
    Kind::Quantity(quantity, Range::closed(min, max))
}

fn temperature(key: &'static str, presence: Presence, meaning: &'static str) -> Field {
    Field::new(key, positive(Quantity::Temperature, HOTTEST), presence, meaning)
        .example("\"293.15 K\"")
}

fn choice(names: impl Iterator<Item = &'static str>) -> Kind {
    Kind::Choice(names.collect())
}

/// The top of the file.
pub(crate) fn root() -> Section {
    let table = |key, presence, meaning| Field::new(key, Kind::Table, presence, meaning);
    Section::new(
        "",
        "A scenario is either a cut ([workpiece], [tool], [process]) or a set of [[body]] tables.",
        vec![
            Field::new(
                "title",
                Kind::Text,
                Presence::Required,
                "one line that says what is simulated",
            )
            .example("\"Orthogonal cut of AISI 1045\""),
            Field::new(
                "dimension",
                Kind::Count { min: 2, max: 3 },
                default("2"),
                "2 for plane strain, 3 for three dimensions (bodies only)",
            ),
            table(
                "sources",
                Presence::Optional,
                "where the figures come from: free keys, text values",
            ),
            table(
                "materials",
                Presence::Optional,
                "materials of this file by name: [materials.NAME]",
            ),
            table("workpiece", Presence::Optional, "the workpiece of a cut"),
            table("tool", Presence::Optional, "the rigid tool of a cut"),
            table("process", Presence::Optional, "what the tool does in a cut"),
            table("boundaries", Presence::Optional, "how the workpiece of a cut is held"),
            Field::new("body", Kind::Tables, Presence::Optional, "a body made of particles"),
            Field::new(
                "support",
                Kind::Tables,
                Presence::Optional,
                "a region of held or moved particles",
            ),
            table("wall", Presence::Optional, "a rigid wall"),
            table("resolution", Presence::Required, "particles and kernel")
                .example("\n[resolution]\npreset = \"draft\""),
            table("heat", Presence::Optional, "heat sources and conduction"),
            table("numerics", Presence::Optional, "discretisation and time step"),
            table("contact", Presence::Optional, "contact between particles and tool"),
            table("output", Presence::Optional, "what is recorded"),
            table("stop", Presence::Required, "when the run ends")
                .example("\n[stop]\ntravel = \"1.5 mm\""),
        ],
    )
}

/// `[workpiece]`.
pub(crate) fn workpiece() -> Section {
    Section::new(
        "workpiece",
        "A rectangle; before the cut its upper side is y = 0 and its front side x = 0.",
        vec![
            Field::new(
                "material",
                Kind::Material,
                Presence::Required,
                "name of a material, a file `name.toml` beside the scenario, or a table",
            )
            .example("\"aisi1045_table5\""),
            Field::new(
                "override",
                Kind::Table,
                Presence::Optional,
                "single values that replace those of the material",
            ),
            Field::new(
                "length",
                positive(Quantity::Length, LONGEST),
                Presence::Required,
                "extent along the cut",
            )
            .example("\"2.5 mm\""),
            Field::new(
                "height",
                positive(Quantity::Length, LONGEST),
                Presence::Required,
                "extent below the uncut surface",
            )
            .example("\"0.5 mm\""),
            temperature("temperature", ROOM_TEMPERATURE, "initial temperature"),
        ],
    )
}

/// `[tool]`.
pub(crate) fn tool() -> Section {
    let angle = |key, min: f64, max: f64, meaning| {
        let range = Range::closed(min * PI / 180.0, max * PI / 180.0);
        Field::new(
            key,
            Kind::Quantity(Quantity::Angle, range),
            Presence::Derived("required unless `outline` is given"),
            meaning,
        )
    };
    Section::new(
        "tool",
        "Rake angle, clearance angle and edge radius, or an outline.",
        vec![
            angle(
                "rake_angle",
                -60.0,
                60.0,
                "gamma, positive if the rake face leans away from the chip",
            )
            .example("\"5 deg\""),
            angle("clearance_angle", 0.0, 45.0, "alpha, between flank and machined surface")
                .example("\"7 deg\""),
            Field::new(
                "edge_radius",
                between(Quantity::Length, 0.0, 5e-3),
                Presence::Derived("required unless `outline` is given"),
                "r_n, radius of the rounded cutting edge",
            )
            .example("\"20 um\""),
            Field::new(
                "outline",
                Kind::Path,
                Presence::Optional,
                "CSV file with the tool's cross-section: two columns x, y in mm, a header line; the tool cuts towards +x and is moved so that its lowest point runs at the depth of cut",
            ),
            Field::new(
                "friction",
                Kind::Table,
                Presence::Required,
                "friction between tool and workpiece",
            )
            .example("\n[tool.friction]\nlaw = \"coulomb\"\nfriction_coefficient = 0.3"),
        ],
    )
}

/// `[process]`.
pub(crate) fn process() -> Section {
    Section::new(
        "process",
        "The tool moves through the resting workpiece.",
        vec![
            Field::new(
                "cutting_speed",
                positive(Quantity::Speed, 1000.0),
                Presence::Required,
                "v_c",
            )
            .example("\"150 m/min\""),
            Field::new(
                "uncut_chip_thickness",
                positive(Quantity::Length, 0.01),
                Presence::Required,
                "h, depth of the layer that the tool takes off",
            )
            .example("\"0.1 mm\""),
            Field::new(
                "width_of_cut",
                positive(Quantity::Length, 1.0),
                Presence::Required,
                "b, extent along the cutting edge",
            )
            .example("\"3 mm\""),
            Field::new(
                "orientation",
                between(Quantity::Angle, -4.0 * PI, 4.0 * PI),
                default("0 deg"),
                "rotates the whole set-up about the origin, counter-clockwise; results do not depend on it",
            ),
            Field::new(
                "mirrored",
                Kind::Switch,
                default("false"),
                "mirrors the whole set-up (y to -y) before the rotation; results do not depend on it",
            ),
        ],
    )
}

/// `[boundaries]`.
pub(crate) fn boundaries() -> Section {
    let side = |key, meaning| {
        Field::new(key, Kind::Choice(vec!["fixed", "sliding", "free"]), default("fixed"), meaning)
    };
    Section::new(
        "boundaries",
        "`fixed`: the particles rest; `sliding`: they may move along the side only; `free`: nothing is prescribed.",
        vec![
            side("bottom", "the side away from the tool"),
            side("back", "the side at the end of the cut"),
            temperature(
                "bottom_temperature",
                Presence::Optional,
                "temperature kept at the bottom; without it no heat passes",
            ),
            temperature(
                "back_temperature",
                Presence::Optional,
                "temperature kept at the back; without it no heat passes",
            ),
            Field::new(
                "layers",
                Kind::Count { min: 1, max: 20 },
                default("3"),
                "rows of particles that belong to a held side",
            ),
        ],
    )
}

/// `[resolution]`.
pub(crate) fn resolution() -> Section {
    Section::new(
        "resolution",
        "Either `particle_spacing` or, for a cut, `preset`.",
        vec![
            Field::new(
                "particle_spacing",
                Kind::Quantity(Quantity::Length, Range::closed(1e-9, 1.0)),
                Presence::Derived("from `preset`"),
                "distance of neighbouring particles at the start",
            )
            .example("\"20 um\""),
            Field::new(
                "preset",
                choice(PRESETS.iter().map(|preset| preset.0)),
                Presence::Optional,
                "spacing relative to the uncut chip thickness: draft h/5, standard h/10, fine h/14",
            ),
            Field::new(
                "kernel",
                choice(KernelChoice::ALL.iter().map(|kernel| kernel.0)),
                default("wendland_c2"),
                "smoothing kernel",
            ),
            Field::new(
                "lattice",
                choice(LATTICES.iter().map(|lattice| lattice.0)),
                default("square"),
                "initial arrangement of the particles",
            ),
            Field::new(
                "seed",
                Kind::Count { min: 0, max: i64::MAX },
                default("0"),
                "seed of the disordered lattice",
            ),
        ],
    )
}

/// `[heat]`.
pub(crate) fn heat() -> Section {
    let switch = |key, meaning| Field::new(key, Kind::Switch, default("true"), meaning);
    Section::new(
        "heat",
        "Heat sources, conduction and their shares.",
        vec![
            switch("plastic_heating", "plastic work heats the particles"),
            switch("friction_heating", "friction heats the particles"),
            switch("conduction", "heat flows between particles"),
        ],
    )
    .with_parameters(sphcut_physics::heat::PARAMETERS)
}

/// `[numerics]`.
pub(crate) fn numerics() -> Section {
    Section::new("numerics", "Discretisation and time step.", Vec::new())
        .with_parameters(options::NUMERICS)
}

/// `[contact]`.
pub(crate) fn contact() -> Section {
    Section::new("contact", "Contact between particles and tool.", Vec::new())
        .with_parameters(options::CONTACT)
}

/// `[output]`.
pub(crate) fn output() -> Section {
    Section::new(
        "output",
        "What is recorded.",
        vec![
            Field::new(
                "snapshots",
                Kind::Count { min: 1, max: 10_000 },
                default("40"),
                "pictures of all particles over the run",
            ),
            Field::new(
                "sampling_travel",
                positive(Quantity::Length, LONGEST),
                Presence::Derived("a five hundredth of the travel"),
                "travel over which a force is averaged (cut)",
            )
            .example("\"2 um\""),
            Field::new(
                "sampling_time",
                positive(Quantity::Time, 1e6),
                Presence::Derived("a five hundredth of the time"),
                "time over which a force is averaged (bodies)",
            ),
            Field::new(
                "checkpoint_interval",
                between(Quantity::Time, 1.0, 1e6),
                default("10 min"),
                "wall-clock time between checkpoints",
            ),
            Field::new("pictures", Kind::Switch, default("true"), "pictures in the report"),
            Field::new(
                "animation",
                Kind::Switch,
                default("true"),
                "animation of the chip in the report",
            ),
        ],
    )
}

/// `[stop]`.
pub(crate) fn stop() -> Section {
    Section::new(
        "stop",
        "A cut ends after `travel`, or earlier when `steady` holds; bodies are followed for `time`.",
        vec![
            Field::new(
                "travel",
                positive(Quantity::Length, LONGEST),
                Presence::Derived("required for a cut"),
                "path of the tool from its start",
            )
            .example("\"1.5 mm\""),
            Field::new(
                "time",
                positive(Quantity::Time, 1e6),
                Presence::Derived("required for bodies"),
                "simulated time",
            )
            .example("\"1 ms\""),
            Field::new(
                "steady",
                Kind::Table,
                Presence::Optional,
                "ends the cut once the mean cutting force is known well enough",
            ),
        ],
    )
}

/// `[stop.steady]`.
pub(crate) fn steady() -> Section {
    Section::new(
        "stop.steady",
        "Both conditions must hold.",
        vec![
            Field::new(
                "relative_half_width",
                Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 0.5)),
                Presence::Required,
                "half width of the 95 % interval of the mean cutting force over the mean",
            )
            .example("0.02"),
            Field::new(
                "minimum_travel",
                positive(Quantity::Length, LONGEST),
                Presence::Required,
                "travel before which the run never ends",
            )
            .example("\"1 mm\""),
        ],
    )
}

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

/// `[wall]`.
pub(crate) fn wall() -> Section {
    Section::new(
        "wall",
        "A rigid half space.",
        vec![
            Field::new(
                "point",
                Kind::Vector(Quantity::Length),
                Presence::Required,
                "a point of its surface",
            )
            .example("[\"0 mm\", \"0 mm\"]"),
            Field::new(
                "normal",
                Kind::Vector(Quantity::Dimensionless),
                Presence::Required,
                "direction out of the wall, of any length",
            )
            .example("[0, 1]"),
            Field::new(
                "velocity",
                Kind::Vector(Quantity::Speed),
                Presence::Derived("at rest"),
                "velocity of the wall",
            ),
            Field::new(
                "friction",
                Kind::Table,
                Presence::Derived("no friction"),
                "friction between wall and bodies",
            ),
        ],
    )
}

/// A material, from a file or inline.
pub(crate) fn material(name: &str) -> Section {
    Section::new(
        name,
        "A material.",
        vec![
            Field::new("title", Kind::Text, Presence::Derived("the name"), "name for reports"),
            Field::new("density", positive(Quantity::Density, 1e5), Presence::Required, "rho")
                .example("\"7850 kg/m^3\""),
            Field::new("young_modulus", positive(Quantity::Stress, 1e13), Presence::Required, "E")
                .example("\"205 GPa\""),
            Field::new(
                "poisson_ratio",
                Kind::Quantity(Quantity::Dimensionless, Range::closed(-0.9, 0.495)),
                Presence::Required,
                "nu",
            )
            .example("0.3"),
            Field::new(
                "specific_heat",
                positive(Quantity::SpecificHeat, 1e5),
                Presence::Derived("required where heat acts"),
                "cp",
            )
            .example("\"486 J/(kg K)\""),
            Field::new(
                "thermal_conductivity",
                positive(Quantity::ThermalConductivity, 1e4),
                Presence::Derived("required where heat acts"),
                "k",
            )
            .example("\"50 W/(m K)\""),
            Field::new("flow_stress", Kind::Table, Presence::Required, "when the material yields")
                .example("{ law = \"elastic\" }"),
            Field::new(
                "sources",
                Kind::Table,
                Presence::Derived("required in material files"),
                "where each value comes from: the keys of this table as text",
            ),
            Field::new("notes", Kind::Text, Presence::Optional, "choices and their effect"),
        ],
    )
}

/// `flow_stress` of a material.
pub(crate) fn flow_stress(name: &str, law: Option<&'static FlowStressEntry>) -> Section {
    let names = choice(flow_stress::LAWS.iter().map(|law| law.key));
    let fields = vec![
        Field::new("law", names, Presence::Required, "the flow-stress law")
            .example("\"johnson_cook\""),
    ];
    let section = Section::new(name, "When the material yields.", fields);
    law.map_or(section.clone(), |law| section.with_parameters(law.parameters))
}

/// `friction` of a tool or a wall.
pub(crate) fn friction(name: &str, law: Option<&'static FrictionEntry>) -> Section {
    let names = choice(friction::LAWS.iter().map(|law| law.key));
    let fields = vec![
        Field::new("law", names, Presence::Required, "the friction law").example("\"coulomb\""),
    ];
    let section = Section::new(name, "Friction between tool and workpiece.", fields);
    law.map_or(section.clone(), |law| section.with_parameters(law.parameters))
}
