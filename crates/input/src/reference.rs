//! Reference pages, generated from the same tables as the parser.

use crate::section::{Field, Kind, Presence, Section, range_text};
use crate::units::{self, Unit};
use sphcut_physics::Quantity;
use std::fmt::Write;

/// The page of all keys of a file that `sphcut COMMAND` reads and `manual` explains; `lists` are the sections that may be there several
/// times.
#[must_use]
pub fn keys_of_file(
    (title, command, manual): (&str, &str, &str),
    sections: &[Section],
    lists: &[&str],
) -> String {
    let mut page = format!(
        "<!-- Generated from the tables of the program by `cargo xtask docs`. -->\n\n# {title}: all keys\n\n\
         What `sphcut {command}` reads; [{manual}]({manual}) says what it does. Quantities are written as in\n\
         [scenarios](scenario.md): a number and a unit in quotes.\n\n"
    );
    for one in sections {
        match one.name.as_str() {
            "" => section(&mut page, one),
            name if lists.contains(&name) => headed(&mut page, one, Brackets::Double),
            _ => headed(&mut page, one, Brackets::Single),
        }
    }
    page
}

/// `[section]` or `[[section]]`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Brackets {
    /// A table that is there once.
    Single,
    /// A list of tables.
    Double,
}

/// Appends a line; writing to a string cannot fail.
macro_rules! line {
    ($page:expr, $($text:tt)*) => {
        writeln!($page, $($text)*).expect("writing to a string cannot fail")
    };
}

/// Appends the table of quantities and their units.
pub fn unit_table(page: &mut String) {
    line!(page, "| quantity | units (others of the same dimension are accepted) |\n|---|---|");
    for quantity in units::NAMED {
        let units = units::accepted_units(*quantity).join("`, `");
        line!(page, "| {} | `{units}` |", quantity.name());
    }
    line!(page, "");
}

/// Appends a section with its heading.
pub fn headed(page: &mut String, section: &Section, brackets: Brackets) {
    match brackets {
        Brackets::Single => line!(page, "## `[{}]`\n", section.name),
        Brackets::Double => line!(page, "## `[[{}]]`\n", section.name),
    }
    self::section(page, section);
}

/// Appends what a section is for and its keys.
pub fn section(page: &mut String, section: &Section) {
    line!(page, "{}\n", section.meaning);
    rows(page, section.fields.iter());
}

/// Appends a table of keys.
pub fn rows<'f>(page: &mut String, fields: impl Iterator<Item = &'f Field>) {
    line!(page, "| key | value | without it | meaning |\n|---|---|---|---|");
    for field in fields {
        line!(
            page,
            "| `{}` | {} | {} | {} |",
            field.key,
            value(&field.kind),
            without(field),
            field.meaning.replace('|', "\\|")
        );
    }
    line!(page, "");
}

fn value(kind: &Kind) -> String {
    match kind {
        Kind::Quantity(Quantity::Dimensionless, range) => {
            format!("number {}", range_text(*range, &Unit::preferred(Quantity::Dimensionless)))
        }
        Kind::Quantity(quantity, range) => {
            format!("{} {}", quantity.name(), range_text(*range, &Unit::preferred(*quantity)))
        }
        Kind::Tabulated(quantity, range) => format!(
            "{} {}, or a list of pairs `[temperature, {}]`",
            quantity.name(),
            range_text(*range, &Unit::preferred(*quantity)),
            quantity.name()
        ),
        Kind::Count { min, max } if *max == i64::MAX => format!("whole number from {min}"),
        Kind::Count { min, max } => format!("whole number from {min} to {max}"),
        Kind::Choice(words) => format!("`\"{}\"`", words.join("\"`, `\"")),
        Kind::Text => "text".to_owned(),
        Kind::Path => "path of a file, relative to the scenario".to_owned(),
        Kind::Switch => "`true`, `false`".to_owned(),
        Kind::Vector(Quantity::Dimensionless) => "list of numbers".to_owned(),
        Kind::Vector(quantity) => format!("list, each a {}", quantity.name()),
        Kind::PartialVector(quantity) => format!("list, each a {} or `\"free\"`", quantity.name()),
        Kind::Table => "table".to_owned(),
        Kind::Tables => "list of tables".to_owned(),
        Kind::Literal(what) => (*what).to_owned(),
        Kind::Material => "name of a material, `\"FILE.toml\"`, or a table".to_owned(),
    }
}

fn without(field: &Field) -> String {
    match &field.presence {
        Presence::Required => "**required**".to_owned(),
        Presence::Optional => "-".to_owned(),
        Presence::Default(text) => format!("`{text}`"),
        Presence::Derived(text) => (*text).to_owned(),
    }
}
