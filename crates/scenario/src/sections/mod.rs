//! Every section of a scenario and of a material file.

mod bodies;
mod cut;
mod heat_source;
mod material;
mod tool_heat;

pub(crate) use bodies::{
    SHAPE_KEYS, VELOCITY_FIELDS, body, support, velocity, velocity_change, wall,
};
pub(crate) use cut::{
    boundaries, compliance, compliance_of, passes, process, run_out, tool, window, workpiece,
};
pub(crate) use heat_source::{HEAT_SOURCE_FORMS, heat_source};
pub(crate) use material::{
    effect, effects, equation_of_state, flow_stress, friction, material, tested,
};
pub(crate) use tool_heat::{SUBSTANCE, coating, tool_heat};

use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_input::units;
use sphcut_physics::{Quantity, Range};
use sphcut_sph::kernel::KernelChoice;
use sphcut_sph::options;
use sphcut_sph::setup::Lattice;
use std::borrow::Cow;

/// Initial arrangements by name.
pub(crate) const LATTICES: &[(&str, Lattice)] = &[
    ("square", Lattice::Square),
    ("hexagonal", Lattice::Hexagonal),
    ("disordered", Lattice::Disordered),
];

/// Resolution presets: particle spacings across the uncut chip thickness.
pub(crate) const PRESETS: &[(&str, f64)] = &[("draft", 7.0), ("standard", 10.0), ("fine", 14.0)];

const LONGEST: f64 = 100.0;
const HOTTEST: f64 = 10_000.0;
const ROOM_TEMPERATURE: Presence = Presence::Default(Cow::Borrowed("293.15 K"));

fn temperature(key: &'static str, presence: Presence, meaning: &'static str) -> Field {
    Field::new(key, positive(Quantity::Temperature, HOTTEST), presence, meaning)
        .example("\"293.15 K\"")
}

/// Heat of a tool or a wall.
fn heat_table() -> Field {
    let meaning = "conduction of heat in it, in the plane";
    Field::derived("heat", Kind::Table, "it takes no heat", meaning)
}

fn mesh_file(meaning: &'static str) -> Field {
    Field::optional("mesh_file", Kind::Path, meaning).example("\"tool.stl\"")
}

fn mesh_unit() -> Field {
    Field::derived(
        "mesh_unit",
        Kind::Choice(units::accepted_units(Quantity::Length).to_vec()),
        "required with `mesh_file`",
        "unit of the coordinates in `mesh_file`: the formats state none",
    )
    .example("\"mm\"")
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
            Field::required("title", Kind::Text, "one line that says what is simulated")
                .example("\"Orthogonal cut of AISI 1045\""),
            Field::with_default(
                "dimension",
                Kind::Count { min: 2, max: 3 },
                "2",
                "2 for plane strain, 3 for three dimensions: bodies in space, a cut as turning",
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
            table("workpiece", Presence::Optional, "the workpiece of a cut")
                .example("[workpiece] with material, length and height"),
            table("tool", Presence::Optional, "the rigid tool of a cut")
                .example("[tool] with rake_angle, clearance_angle, edge_radius and friction"),
            table("process", Presence::Optional, "what the tool does in a cut")
                .example("[process] with cutting_speed, uncut_chip_thickness and width_of_cut"),
            table("passes", Presence::Optional, "several passes of a cut"),
            table("window", Presence::Optional, "what of a long cut is followed"),
            table("boundaries", Presence::Optional, "how the workpiece of a cut is held"),
            Field::optional("body", Kind::Tables, "a body made of particles")
                .example("[[body]] with name, material and shape"),
            Field::optional("support", Kind::Tables, "a region of held or moved particles"),
            Field::optional(
                "heat_source",
                Kind::Tables,
                "heat released in the volume of the bodies",
            ),
            table("wall", Presence::Optional, "a rigid wall"),
            table("resolution", Presence::Required, "particles and kernel")
                .example("[resolution] with preset = \"draft\""),
            table("heat", Presence::Optional, "heat sources and conduction"),
            table(
                "effects",
                Presence::Optional,
                "optional effects of the materials: [effects.NAME]",
            ),
            table("numerics", Presence::Optional, "discretisation and time step"),
            table("contact", Presence::Optional, "contact between particles and tool"),
            table("output", Presence::Optional, "what is recorded"),
            table("stop", Presence::Required, "when the run ends")
                .example("[stop] with travel = \"1.5 mm\""),
        ],
    )
}

/// `[resolution]`.
pub(crate) fn resolution() -> Section {
    Section::new(
        "resolution",
        "`particle_spacing`, or for a cut one of `preset` and `particles_across_chip`, or `particles_across_edge`, or one of those two and the edge: the finer spacing counts.",
        vec![
            Field::derived("particle_spacing", Kind::Quantity(Quantity::Length, Range::closed(1e-9, 1.0)), "from one of the next three", "distance of neighbouring particles at the start")
            .example("\"20 um\""),
            Field::optional("preset", choice(PRESETS.iter().map(|preset| preset.0)), "spacing relative to the uncut chip thickness: draft h/7, standard h/10, fine h/14. In a plane cut with a round edge it grades as `[resolution.grading]` says, halved around the edge at most twice until 1.8 particles lie across its radius; `particles_across_chip` is uniform"),
            Field::optional("particles_across_chip", Kind::Quantity(Quantity::Dimensionless, Range::closed(1.0, 1000.0)), "uncut chip thickness over spacing, as a preset but of your choice")
            .example("12"),
            Field::optional("particles_across_edge", Kind::Quantity(Quantity::Dimensionless, Range::closed(0.5, 1000.0)), "edge radius over spacing, alone or beside one of the two above; ploughing is resolved from 5 on, and a sharp edge then makes many particles")
            .example("5"),
            Field::with_default("kernel", choice(KernelChoice::ALL.iter().map(|kernel| kernel.0)), "wendland_c2", "smoothing kernel"),
            Field::with_default("lattice", choice(LATTICES.iter().map(|lattice| lattice.0)), "square", "initial arrangement of the particles"),
            Field::derived("lattice_aspect", Kind::Quantity(Quantity::Dimensionless, Range::closed(0.25, 4.0)), "2 for a cut, 1 otherwise", "distance of particles along the first axis of a box (the cutting direction) over that \
                 across it, at the same volume"),
            Field::with_default("seed", Kind::Count { min: 0, max: i64::MAX }, "0", "seed of the disordered lattice"),
            Field::optional("grading", Kind::Table, "a cut: the spacing is that above around the plane in which the chip parts, and larger elsewhere; a preset needs no such table"),
        ],
    )
}

/// `[resolution.grading]`.
pub(crate) fn grading() -> Section {
    let length = |key, rule, meaning| {
        Field::derived(key, positive(Quantity::Length, LONGEST), rule, meaning)
    };
    let edge = "r_n, three spacings at least; h/2 for a sharp edge";
    let doublings =
        |key, rule, meaning| Field::derived(key, Kind::Count { min: 0, max: 4 }, rule, meaning);
    Section::new(
        "resolution.grading",
        "Between `fine_above` over and `fine_below` under the plane in which the chip parts the spacing is that of [resolution]; beyond, it doubles every five rows.",
        vec![
            length("fine_above", edge, "fine material that enters the chip: its underside").example("\"40 um\""),
            length("fine_below", "as `fine_above`; h at least, where a preset or `particles_across_chip` asks for a chip as fine as the edge", "fine material under the machined surface").example("\"0.1 mm\""),
            doublings("doublings_above", "up to the spacing that the preset has in the chip, or `particles_across_chip` beside `particles_across_edge`; else 0", "how often the spacing doubles towards the free side of the chip").example("1"),
            doublings("doublings_below", "one more than `doublings_above`", "how often the spacing doubles towards the bottom").example("2"),
        ],
    )
}

/// `[heat]`.
pub(crate) fn heat() -> Section {
    let switch = |key, meaning| Field::with_default(key, Kind::Switch, "true", meaning);
    let mut section = Section::new(
        "heat",
        "Heat sources, conduction and their shares.",
        vec![
            switch("plastic_heating", "plastic work heats the particles"),
            switch("friction_heating", "friction heats the particles"),
            switch("conduction", "heat flows between particles"),
        ],
    )
    .with_parameters(sphcut_physics::heat::PARAMETERS);
    let share = section.fields.iter_mut().find(|field| field.key == "friction_heat_share");
    share.expect("a parameter of heat").presence = Presence::Derived(
        "1 where the tool takes no heat; with [tool.heat] e_w / (e_w + e_t), e = sqrt(k rho cp) of workpiece and substrate at \
         their initial temperatures",
    );
    section
}

/// `[numerics]`.
pub(crate) fn numerics() -> Section {
    let mut section = Section::new(
        "numerics",
        "Discretisation and time step.",
        vec![
            Field::with_default("mechanics", Kind::Switch, "true", "whether the particles move; false solves heat conduction alone"),
            Field::optional("inertia_number", Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 1.0)), "for a cut, instead of `mass_scaling`: s rho v_c^2 over the flow stress at a strain of 1, the rate v_c/h and the \
                 initial temperature; `mass_scaling` follows from it, within its range")
            .example("0.012"),
        ],
    )
    .with_parameters(options::NUMERICS);
    for (key, rule) in [
        ("courant", "0.45 with `preset` in a plane cut, 0.3 otherwise"),
        ("support_stretch", "1 for a cut, 1.5 otherwise"),
        ("shifting_distance", "1 for a cut, 0 otherwise"),
    ] {
        let field = section.fields.iter_mut().find(|field| field.key == key);
        field.expect("an option of the discretisation").presence = Presence::Derived(rule);
    }
    section
}

/// `[contact]`.
pub(crate) fn contact() -> Section {
    Section::new(
        "contact",
        "Contact between particles and tool, and between bodies.",
        vec![Field::with_default(
            "bonded",
            Kind::Switch,
            "true",
            "true: bodies that touch are one continuum; false: they meet in frictionless contact",
        )],
    )
    .with_parameters(options::CONTACT)
}

/// `[output]`.
pub(crate) fn output() -> Section {
    Section::new(
        "output",
        "What is recorded.",
        vec![
            Field::with_default(
                "snapshots",
                Kind::Count { min: 1, max: 10_000 },
                "40",
                "pictures of all particles over the run",
            ),
            Field::derived(
                "sampling_travel",
                positive(Quantity::Length, LONGEST),
                "a five hundredth of the travel",
                "travel over which a force is averaged (cut)",
            )
            .example("\"2 um\""),
            Field::derived(
                "sampling_time",
                positive(Quantity::Time, 1e6),
                "a five hundredth of the time",
                "time over which a force is averaged (bodies)",
            ),
            Field::with_default(
                "checkpoint_interval",
                between(Quantity::Time, 1.0, 1e6),
                "10 min",
                "wall-clock time between checkpoints",
            ),
            Field::with_default("pictures", Kind::Switch, "true", "pictures in the report"),
            Field::with_default(
                "animation",
                Kind::Switch,
                "true",
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
            Field::derived(
                "travel",
                positive(Quantity::Length, LONGEST),
                "required for a cut",
                "path of the tool from its start",
            )
            .example("\"1.5 mm\""),
            Field::derived(
                "time",
                positive(Quantity::Time, 1e6),
                "required for bodies",
                "simulated time",
            )
            .example("\"1 ms\""),
            Field::optional(
                "steady",
                Kind::Table,
                "ends the cut once the mean cutting force is known well enough",
            ),
        ],
    )
}

/// `[stop.steady]`.
pub(crate) fn steady() -> Section {
    Section::new(
        "stop.steady",
        "All conditions must hold.",
        vec![
            Field::required("relative_half_width", Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 0.5)), "half width of the 95 % interval of the mean cutting force over the mean")
            .example("0.02"),
            Field::optional("feed_relative_half_width", Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 0.5)), "the same of the mean feed force; without it the feed force does not decide on the end")
            .example("0.05"),
            Field::required("minimum_travel", positive(Quantity::Length, LONGEST), "travel before which the run never ends")
            .example("\"1 mm\""),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_physics::{flow_stress as flow_stress_laws, friction as friction_laws};

    fn all() -> Vec<Section> {
        let mut sections = vec![
            root(),
            workpiece(),
            tool(),
            process(),
            passes(),
            window(),
            boundaries(),
            resolution(),
            heat(),
            numerics(),
            contact(),
            effects(),
            output(),
            stop(),
            steady(),
            grading(),
            body(),
            support(),
            wall(),
            velocity_change(),
            material("material"),
            tool_heat("tool.heat"),
            coating("tool.heat.coating"),
        ];
        sections.extend(VELOCITY_FIELDS.iter().map(|field| velocity(field)));
        sections.extend(HEAT_SOURCE_FORMS.iter().map(|form| heat_source(form)));
        sections.extend(flow_stress_laws::LAWS.iter().map(|law| flow_stress("flow", Some(law))));
        let states = sphcut_physics::equation_of_state::LAWS.iter();
        sections.extend(states.map(|law| equation_of_state("state", Some(law))));
        sections.extend(sphcut_physics::effects::EFFECTS.iter().map(|effect| self::effect(effect)));
        sections.extend(friction_laws::LAWS.iter().map(|law| friction("friction", Some(law))));
        sections
    }

    #[test]
    fn every_key_is_explained_and_its_default_and_example_can_be_read() {
        assert_eq!(sphcut_input::section::faults(&all()), [""; 0]);
    }
}
