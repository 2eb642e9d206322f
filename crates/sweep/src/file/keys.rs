//! Sections of a file of a sweep.

use sphcut_input::section::{Field, Kind, Presence, Section, default};
use sphcut_physics::{Quantity, Range};

/// Designs.
pub(crate) const DESIGNS: &[&str] = &["full_factorial", "list", "latin_hypercube", "sobol"];

/// Most runs of one sweep.
const MOST_RUNS: i64 = 100_000;

/// Every section, for the reference page.
pub(crate) fn sections() -> Vec<Section> {
    vec![root(), design(), vary()]
}

/// The top of the file.
pub(crate) fn root() -> Section {
    Section::new(
        "",
        "A sweep: one scenario, run many times with other values of some of its keys, one [[vary]] for each.",
        vec![
            Field::new("title", Kind::Text, Presence::Required, "one line that says what is varied")
                .example("\"Speed and thickness in AISI 1045\""),
            Field::new(
                "base",
                Kind::Path,
                Presence::Required,
                "the scenario, relative to this file; it must be one that runs on its own",
            )
            .example("\"cut.toml\""),
            Field::new("design", Kind::Table, Presence::Derived("full factorial"), "which combinations run")
                .example("[design] with kind"),
            Field::new("vary", Kind::Tables, Presence::Required, "one key with its values")
                .example("[[vary]] with key and values"),
            Field::new(
                "constraints",
                Kind::Literal("list of texts"),
                Presence::Optional,
                "inequalities between keys or between a key and a value; combinations that break one are left out: \
                 `SIDE < SIDE` with `<`, `<=`, `>` or `>=`, a side being `KEY`, `NUMBER * KEY` or a value with its unit",
            )
            .example("[\"process.uncut_chip_thickness >= 2 * tool.edge_radius\"]"),
        ],
    )
}

/// `[design]`.
pub(crate) fn design() -> Section {
    let count = |key, max, presence, meaning| {
        Field::new(key, Kind::Count { min: 1, max }, presence, meaning)
    };
    Section::new(
        "design",
        "Which combinations of the values run.",
        vec![
            Field::new(
                "kind",
                Kind::Choice(DESIGNS.to_vec()),
                default("full_factorial"),
                "every combination; the first values of all keys together, then the second ones and so on (`list`); \
                 or `runs` points that fill the space of the keys",
            ),
            count(
                "runs",
                MOST_RUNS,
                Presence::Optional,
                "points of a Latin hypercube or a Sobol sequence",
            )
            .example("64"),
            Field::new(
                "seed",
                Kind::Count { min: 0, max: u32::MAX as i64 },
                default("1"),
                "seed of a Latin hypercube or of the scrambling of a Sobol sequence",
            ),
            count(
                "replicates",
                1000,
                default("1"),
                "every combination runs with as many seeds of the disordered lattice, from that of the scenario on",
            ),
        ],
    )
}

/// `[[vary]]`.
pub(crate) fn vary() -> Section {
    let literal = |key, meaning| {
        Field::new(key, Kind::Literal("value as in the scenario"), Presence::Optional, meaning)
    };
    Section::new(
        "vary",
        "One key of the scenario and its values: a list, a range with steps, a range with a number of values, or so many times \
         another key.",
        vec![
            Field::new(
                "key",
                Kind::Text,
                Presence::Required,
                "section and key of the scenario, `body[2].temperature` in lists (counted from 1); a key that the \
                 scenario does not write is added",
            )
            .example("\"process.cutting_speed\""),
            Field::new(
                "values",
                Kind::Literal("list of values as in the scenario"),
                Presence::Optional,
                "the values, also words, switches, lists or whole tables",
            ),
            literal("from", "instead of `values`: the first value of a range").example("\"100 m/min\""),
            literal("to", "the last value, in the unit of the first").example("\"200 m/min\""),
            literal("step", "distance of the values, in the same unit").example("\"10 m/min\""),
            Field::new(
                "count",
                Kind::Count { min: 2, max: 10_000 },
                Presence::Optional,
                "instead of `step`: number of values, both ends among them; neither is needed for a Latin hypercube or a \
                 Sobol sequence, which take values from all of the range",
            ),
            Field::new(
                "spacing",
                Kind::Choice(vec!["linear", "logarithmic"]),
                default("linear"),
                "how the values of a range with `count`, or of a design that fills the space, are spread",
            ),
            Field::new(
                "of",
                Kind::Text,
                Presence::Optional,
                "instead of `values` and of a range: another varied key whose values are quantities; in every run this key \
                 is `times` its value",
            )
            .example("\"process.uncut_chip_thickness\""),
            Field::new(
                "times",
                Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 1e6)),
                Presence::Derived("required with `of`"),
                "the factor on the value of `of`",
            )
            .example("5"),
        ],
    )
}

/// The page of all keys, as Markdown.
#[must_use]
pub fn reference_page() -> String {
    let about = ("Files of sweeps", "sweep", "sweeps.md");
    sphcut_input::reference::keys_of_file(about, &sections(), &["vary"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_explained_and_its_default_and_example_can_be_read() {
        assert_eq!(sphcut_input::section::faults(&sections()), [""; 0]);
    }
}
