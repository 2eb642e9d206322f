//! `[tool.heat]` and `[wall.heat]`.

use super::material::tabulated;
use super::{LONGEST, ROOM_TEMPERATURE, temperature};
use sphcut_input::section::{Field, Kind, Presence, Section, positive};
use sphcut_physics::heat::CARBIDE;
use sphcut_physics::{Quantity, Range};

/// What may hold where the model of a tool is cut off.
const OUTER: &[&str] = &["fixed", "adiabatic", "convective"];

/// Keys of what conducts and stores heat: they belong to one material.
pub(crate) const SUBSTANCE: [&str; 3] = ["density", "specific_heat", "thermal_conductivity"];

/// What conducts and stores heat.
fn thermal_fields(presence: [Presence; 3], examples: [&'static str; 3]) -> Vec<Field> {
    let kinds = [
        positive(Quantity::Density, 1e5),
        tabulated(Quantity::SpecificHeat, 1e5),
        tabulated(Quantity::ThermalConductivity, 1e4),
    ];
    let meanings = ["rho, mass density", "cp, specific heat capacity", "k, thermal conductivity"];
    let given = SUBSTANCE.into_iter().zip(kinds).zip(presence).zip(meanings).zip(examples);
    given
        .map(|((((key, kind), presence), meaning), example)| {
            Field::new(key, kind, presence, meaning).example(example)
        })
        .collect()
}

/// `h_c = 1.25 k_s m / sigma (p / H)^0.95` (Cooper, Mikic and Yovanovich, Int. J. Heat Mass Transfer 12 (1969) 279;
/// Yovanovich 1982) with k_s = 2 k_w k_t / (k_w + k_t) = 67 W/(m K) of steel on carbide, a roughness sigma of 0.5 um, a slope m of 0.1
/// and pressures p of 0.6 to 1 of the hardness H, as they are where a chip sticks, gives 1.0e7 to 1.7e7 W/(m^2 K): 10 K
/// of jump for every 100 W/mm^2.
const CONDUCTANCE: &str = "1e7 W/(m^2 K)";

/// `heat` of a tool or a wall.
pub(crate) fn tool_heat(name: &str) -> Section {
    let of_carbide = [
        format!("{} kg/m^3", CARBIDE.density),
        format!("{} J/(kg K)", CARBIDE.specific_heat),
        format!("{} W/(m K)", CARBIDE.thermal_conductivity),
    ];
    let mut fields = thermal_fields(
        of_carbide.map(|text| Presence::Default(text.into())),
        ["\"14850 kg/m^3\"", "\"202 J/(kg K)\"", "\"100 W/(m K)\""],
    );
    for field in &mut fields {
        field.meaning = format!(
            "{}; default: cemented carbide (WC-Co) after Ducobu, Pantale and Lauwers",
            field.meaning
        )
        .into();
    }
    fields.extend([
        temperature("temperature", ROOM_TEMPERATURE, "initial temperature of the tool"),
        Field::with_default("contact_conductance", positive(Quantity::HeatTransfer, 1e12), CONDUCTANCE, "h_c between workpiece and tool: q = h_c (T_workpiece - T_tool) at the surfaces; the default is an estimate for rough \
             metals pressed together with about their hardness (Cooper, Mikic and Yovanovich 1969)")
        .example("\"1e6 W/(m^2 K)\""),
        Field::with_default("outer", Kind::Choice(OUTER.to_vec()), "fixed", "what holds where the model of the tool is cut off; no heat passes the other sides outside the contact"),
        temperature(
            "outer_temperature",
            Presence::Derived("the initial temperature of the tool"),
            "kept at the outer sides (`fixed`), or that of the surroundings (`convective`)",
        ),
        Field::derived("film_coefficient", positive(Quantity::HeatTransfer, 1e9), "required for `convective`", "heat flow from the outer sides per area and difference of temperature")
        .example("\"1000 W/(m^2 K)\""),
        Field::derived("outer_distance", positive(Quantity::Length, LONGEST), "where a tool of angles is cut off; otherwise required", "sides, in space facets, all of which lie farther from the cutting edge (of a wall: from `point`) are outer ones")
        .example("\"1 mm\""),
        Field::derived("element_size", positive(Quantity::Length, LONGEST), "half a particle spacing", "length of the smallest elements, along the sides that particles can touch")
        .example("\"5 um\""),
        Field::derived("fine_reach", positive(Quantity::Length, LONGEST), "five uncut chip thicknesses (in turning depths of cut, or the groove) and the edge radius; of a wall: everywhere", "distance from the cutting edge up to which the elements are that small; farther they grow")
        .example("\"0.5 mm\""),
        Field::derived("capacity_scaling", Kind::Quantity(Quantity::Dimensionless, Range::closed(1e-6, 1.0)), "1", "heat capacity of the tool in its conduction over its own: with 0.001 a cut of \
             a millisecond warms the tool as a second of cutting does, up to where it is cut off. Temperatures are then those of a tool in use, which starts cold only once \
             (docs/numerics.md, A tool in use)")
        .example("0.001"),
        Field::optional("coating", Kind::Table, "a layer on all sides but the outer ones"),
    ]);
    Section::new(
        name,
        "Heat in the tool by finite elements on a mesh of its own; an empty table is a tool of cemented carbide. A tool of angles in \
         a plane cut has it without being told, unless `friction_heat_share` is written. Any other tool takes no heat without this \
         table, and all friction heats the workpiece.",
        fields,
    )
}

/// `coating` of a tool with heat.
pub(crate) fn coating(name: &str) -> Section {
    let mut fields = vec![
        Field::required(
            "thickness",
            positive(Quantity::Length, 1e-3),
            "thickness; the coating lies inside the outline of the tool",
        )
        .example("\"3 um\""),
    ];
    let required = [Presence::Required, Presence::Required, Presence::Required];
    fields.extend(thermal_fields(
        required,
        [
            "\"4000 kg/m^3\"",
            "\"800 J/(kg K)\"",
            "[[\"0 degC\", \"4.64 W/(m K)\"], [\"1000 degC\", \"5.18 W/(m K)\"]]",
        ],
    ));
    Section::new(name, "A coating, in three layers.", fields)
}
