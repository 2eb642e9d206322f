//! `[[heat_source]]`.

use super::LONGEST;
use sphcut_input::section::{Field, Kind, Section, positive};
use sphcut_physics::Quantity;

/// The forms of a heat source.
pub(crate) const HEAT_SOURCE_FORMS: &[&str] = &["gaussian", "box"];

/// `[[heat_source]]` of one `form`.
pub(crate) fn heat_source(form: &str) -> Section {
    let mut fields = vec![
        Field::required("name", Kind::Text, "name in reports and messages").example("\"beam\""),
        Field::required(
            "form",
            Kind::Choice(HEAT_SOURCE_FORMS.to_vec()),
            "how the power is spread: a normal distribution, or evenly over a box",
        ),
        Field::optional("power", positive(Quantity::Power, 1e12), "power in three dimensions")
            .example("\"1 kW\""),
        Field::optional(
            "power_per_width",
            positive(Quantity::PowerPerWidth, 1e12),
            "power in the plane",
        )
        .example("\"100 W/mm\""),
        Field::derived(
            "velocity",
            Kind::Vector(Quantity::Speed),
            "at rest",
            "velocity of the source, whatever the bodies do",
        )
        .example("[\"1 m/s\", \"0 m/s\"]"),
    ];
    let point = |key, meaning| {
        Field::required(key, Kind::Vector(Quantity::Length), meaning)
            .example("[\"0 mm\", \"0 mm\"]")
    };
    match form {
        "gaussian" => fields.extend([
            point("centre", "where it is strongest at the start"),
            Field::required(
                "standard_deviation",
                positive(Quantity::Length, LONGEST),
                "of the distribution along each axis; at least half a particle spacing",
            )
            .example("\"0.2 mm\""),
        ]),
        "box" => fields.extend([
            point("min", "smallest corner at the start"),
            point("max", "largest corner at the start"),
        ]),
        _ => {}
    }
    Section::new(
        "heat_source",
        "Releases heat in the volume of the bodies. What of it lies outside them heats nothing.",
        fields,
    )
}
