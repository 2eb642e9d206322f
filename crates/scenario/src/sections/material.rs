//! Sections of a material and of the laws.

use super::choice;
use sphcut_input::section::{Field, Kind, Section, positive};
use sphcut_physics::effects::{self, EffectEntry};
use sphcut_physics::equation_of_state::{self, EquationOfStateEntry};
use sphcut_physics::flow_stress::{self, FlowStressEntry};
use sphcut_physics::friction::{self, FrictionEntry};
use sphcut_physics::{Quantity, Range};

/// A positive quantity or a table of it over the temperature.
pub(super) fn tabulated(quantity: Quantity, max: f64) -> Kind {
    Kind::Tabulated(quantity, Range::above(0.0, max))
}

/// A material, from a file or inline.
pub(crate) fn material(name: &str) -> Section {
    Section::new(
        name,
        "A material.",
        vec![
            Field::derived("title", Kind::Text, "the name", "name for reports"),
            Field::required("density", positive(Quantity::Density, 1e5), "rho, mass density")
                .example("\"7850 kg/m^3\""),
            Field::required(
                "young_modulus",
                tabulated(Quantity::Stress, 1e13),
                "E, Young's modulus",
            )
            .example("\"205 GPa\""),
            Field::required(
                "poisson_ratio",
                Kind::Quantity(Quantity::Dimensionless, Range::closed(-0.9, 0.495)),
                "nu, Poisson's ratio",
            )
            .example("0.3"),
            Field::derived(
                "specific_heat",
                tabulated(Quantity::SpecificHeat, 1e5),
                "required where heat acts",
                "cp, specific heat capacity",
            )
            .example("\"486 J/(kg K)\""),
            Field::derived(
                "thermal_conductivity",
                tabulated(Quantity::ThermalConductivity, 1e4),
                "required where heat acts",
                "k, thermal conductivity",
            )
            .example("\"50 W/(m K)\""),
            Field::required("flow_stress", Kind::Table, "when the material yields")
                .example("flow_stress = { law = \"elastic\" }"),
            Field::derived(
                "equation_of_state",
                Kind::Table,
                "linear",
                "pressure over volume and temperature",
            ),
            Field::optional(
                "tested",
                Kind::Table,
                "how far the tests went to which the flow stress was fitted; a cut that goes farther is warned of",
            ),
            Field::derived(
                "sources",
                Kind::Table,
                "required in material files",
                "where each value comes from: the keys of this table as text",
            ),
            Field::optional("notes", Kind::Text, "choices and their effect"),
        ],
    )
}

/// `flow_stress` of a material.
pub(crate) fn flow_stress(name: &str, law: Option<&'static FlowStressEntry>) -> Section {
    let names = choice(flow_stress::LAWS.iter().map(|law| law.key));
    let fields =
        vec![Field::required("law", names, "the flow-stress law").example("\"johnson_cook\"")];
    let mut section = Section::new(name, "When the material yields.", fields);
    let Some(law) = law else { return section };
    if let Some(table) = law.table {
        let file = Field::required("table_file", Kind::Path, table);
        section.fields.push(file.example("\"flow_stress.csv\""));
    }
    section.with_parameters(law.parameters)
}

/// `tested` of a material.
pub(crate) fn tested(name: &str) -> Section {
    Section::new(
        name,
        "How far the tests went to which the flow stress was fitted.",
        vec![
            Field::optional(
                "plastic_strain",
                positive(Quantity::Dimensionless, 100.0),
                "largest equivalent plastic strain of the tests",
            ),
            Field::optional(
                "strain_rate",
                positive(Quantity::Rate, 1e9),
                "largest strain rate of the tests",
            ),
            Field::optional(
                "temperature",
                positive(Quantity::Temperature, 1e4),
                "highest temperature of the tests",
            ),
        ],
    )
}

/// `equation_of_state` of a material.
pub(crate) fn equation_of_state(name: &str, law: Option<&'static EquationOfStateEntry>) -> Section {
    let names = choice(equation_of_state::LAWS.iter().map(|law| law.key));
    let fields =
        vec![Field::required("law", names, "the equation of state").example("\"mie_gruneisen\"")];
    let section = Section::new(name, "Pressure over volume and temperature.", fields);
    law.map_or(section.clone(), |law| section.with_parameters(law.parameters))
}

/// `[effects]`: a table for each effect that acts.
pub(crate) fn effects() -> Section {
    let table = |effect: &&EffectEntry| Field::optional(effect.key, Kind::Table, effect.title);
    Section::new(
        "effects",
        "Optional effects of all materials: `[effects.NAME]` switches one on, without it it does not exist.",
        effects::EFFECTS.iter().map(table).collect(),
    )
}

/// `[effects.NAME]`.
pub(crate) fn effect(effect: &'static EffectEntry) -> Section {
    Section::new(&format!("effects.{}", effect.key), effect.title, Vec::new())
        .with_parameters(effect.parameters)
}

/// `friction` of a tool or a wall.
pub(crate) fn friction(name: &str, law: Option<&'static FrictionEntry>) -> Section {
    let names = choice(friction::LAWS.iter().map(|law| law.key));
    let fields = vec![Field::required("law", names, "the friction law").example("\"coulomb\"")];
    let section = Section::new(name, "Friction between tool and workpiece.", fields);
    law.map_or(section.clone(), |law| section.with_parameters(law.parameters))
}
