//! `[[heat_source]]`.

use super::LONGEST;
use sphcut_input::section::{Field, Kind, Presence, Section, positive};
use sphcut_physics::Quantity;

/// The forms of a heat source.
pub(crate) const HEAT_SOURCE_FORMS: &[&str] = &["gaussian", "box"];

/// `[[heat_source]]` of one `form`.
pub(crate) fn heat_source(form: &str) -> Section {
    let mut fields = vec![
        Field::new("name", Kind::Text, Presence::Required, "name in reports and messages")
            .example("\"beam\""),
        Field::new(
            "form",
            Kind::Choice(HEAT_SOURCE_FORMS.to_vec()),
            Presence::Required,
            "how the power is spread: a normal distribution, or evenly over a box",
        ),
        Field::new(
            "power",
            positive(Quantity::Power, 1e12),
            Presence::Optional,
            "power in three dimensions",
        )
        .example("\"1 kW\""),
        Field::new(
            "power_per_width",
            positive(Quantity::PowerPerWidth, 1e12),
            Presence::Optional,
            "power in the plane",
        )
        .example("\"100 W/mm\""),
        Field::new(
            "velocity",
            Kind::Vector(Quantity::Speed),
            Presence::Derived("at rest"),
            "velocity of the source, whatever the bodies do",
        )
        .example("[\"1 m/s\", \"0 m/s\"]"),
    ];
    let point = |key, meaning| {
        Field::new(key, Kind::Vector(Quantity::Length), Presence::Required, meaning)
            .example("[\"0 mm\", \"0 mm\"]")
    };
    match form {
        "gaussian" => fields.extend([
            point("centre", "where it is strongest at the start"),
            Field::new(
                "standard_deviation",
                positive(Quantity::Length, LONGEST),
                Presence::Required,
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
