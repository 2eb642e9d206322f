//! `[tool.heat]` and `[wall.heat]`.

use super::material::tabulated;
use super::{LONGEST, ROOM_TEMPERATURE, default, positive, temperature};
use crate::section::{Field, Kind, Presence, Section};
use sphcut_physics::Quantity;

/// What may hold where the model of a tool is cut off.
const OUTER: &[&str] = &["fixed", "adiabatic", "convective"];

/// What conducts and stores heat.
fn thermal_fields(examples: [&'static str; 3]) -> Vec<Field> {
    vec![
        Field::new(
            "density",
            positive(Quantity::Density, 1e5),
            Presence::Required,
            "rho, mass density",
        )
        .example(examples[0]),
        Field::new(
            "specific_heat",
            tabulated(Quantity::SpecificHeat, 1e5),
            Presence::Required,
            "cp, specific heat capacity",
        )
        .example(examples[1]),
        Field::new(
            "thermal_conductivity",
            tabulated(Quantity::ThermalConductivity, 1e4),
            Presence::Required,
            "k, thermal conductivity",
        )
        .example(examples[2]),
    ]
}

/// `heat` of a tool or a wall.
pub(crate) fn tool_heat(name: &str) -> Section {
    let mut fields = thermal_fields(["\"14850 kg/m^3\"", "\"202 J/(kg K)\"", "\"100 W/(m K)\""]);
    fields.extend([
        temperature("temperature", ROOM_TEMPERATURE, "initial temperature of the tool"),
        Field::new(
            "contact_conductance",
            positive(Quantity::HeatTransfer, 1e12),
            Presence::Required,
            "h_c between workpiece and tool: q = h_c (T_workpiece - T_tool) at the surfaces",
        )
        .example("\"1e6 W/(m^2 K)\""),
        Field::new(
            "outer",
            Kind::Choice(OUTER.to_vec()),
            default("fixed"),
            "what holds where the model of the tool is cut off; no heat passes the other sides outside the contact",
        ),
        temperature(
            "outer_temperature",
            Presence::Derived("the initial temperature of the tool"),
            "kept at the outer sides (`fixed`), or that of the surroundings (`convective`)",
        ),
        Field::new(
            "film_coefficient",
            positive(Quantity::HeatTransfer, 1e9),
            Presence::Derived("required for `convective`"),
            "heat flow from the outer sides per area and difference of temperature",
        )
        .example("\"1000 W/(m^2 K)\""),
        Field::new(
            "outer_distance",
            positive(Quantity::Length, LONGEST),
            Presence::Derived("where a tool of angles is cut off; otherwise required"),
            "sides, in space facets, all of which lie farther from the cutting edge (of a wall: from `point`) are outer ones",
        )
        .example("\"1 mm\""),
        Field::new(
            "element_size",
            positive(Quantity::Length, LONGEST),
            Presence::Derived("half a particle spacing"),
            "length of the smallest elements, along the sides that particles can touch",
        )
        .example("\"5 um\""),
        Field::new(
            "fine_reach",
            positive(Quantity::Length, LONGEST),
            Presence::Derived("five uncut chip thicknesses (in turning depths of cut, or the groove) and the edge radius; of a wall: everywhere"),
            "distance from the cutting edge up to which the elements are that small; farther they grow",
        )
        .example("\"0.5 mm\""),
        Field::new(
            "coating",
            Kind::Table,
            Presence::Optional,
            "a layer on all sides but the outer ones",
        ),
    ]);
    Section::new(
        name,
        "Heat in the tool by finite elements on a mesh of its own; without this table the tool takes no heat but \
         the share of friction that does not heat the workpiece, which is then lost.",
        fields,
    )
}

/// `coating` of a tool with heat.
pub(crate) fn coating(name: &str) -> Section {
    let mut fields = vec![
        Field::new(
            "thickness",
            positive(Quantity::Length, 1e-3),
            Presence::Required,
            "thickness; the coating lies inside the outline of the tool",
        )
        .example("\"3 um\""),
    ];
    fields.extend(thermal_fields([
        "\"4000 kg/m^3\"",
        "\"800 J/(kg K)\"",
        "[[\"0 degC\", \"4.64 W/(m K)\"], [\"1000 degC\", \"5.18 W/(m K)\"]]",
    ]));
    Section::new(name, "A coating, in three layers.", fields)
}
