//! What a section of a scenario may contain, as data: read by the parser, the
//! error messages, the JSON schema and the reference page.

use crate::units::{self, Unit};
use sphcut_physics::{Parameter, Quantity, Range};
use std::borrow::Cow;

/// What a key may hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A quantity with unit; a number alone is accepted for pure numbers.
    Quantity(Quantity, Range),
    /// A quantity with unit, or a list of pairs of temperature and quantity.
    Tabulated(Quantity, Range),
    /// A whole number.
    Count {
        /// Least.
        min: i64,
        /// Largest.
        max: i64,
    },
    /// One of some words.
    Choice(Vec<&'static str>),
    /// Free text.
    Text,
    /// Path of a file, relative to the scenario.
    Path,
    /// `true` or `false`.
    Switch,
    /// A list of quantities, one for each dimension.
    Vector(Quantity),
    /// The same, with the word "free" allowed for a component.
    PartialVector(Quantity),
    /// A table with the keys of its own section.
    Table,
    /// A list of tables: `[[body]]`.
    Tables,
    /// The name of a material or a table.
    Material,
    /// A value of whatever key it is for, or a list of them; the words say which.
    Literal(&'static str),
}

/// Whether a key must be there, and what holds without it.
#[derive(Debug, Clone, PartialEq)]
pub enum Presence {
    /// It must be given.
    Required,
    /// It may be missing; then the feature is not used.
    Optional,
    /// The value without it, as a user would write it.
    Default(Cow<'static, str>),
    /// The value without it follows from other keys, in words.
    Derived(&'static str),
}

/// One key.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Key in the file.
    pub key: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Whether it may be left out.
    pub presence: Presence,
    /// One line for people.
    pub meaning: Cow<'static, str>,
    /// What the error about a missing key proposes.
    pub example: &'static str,
}

/// A section: its keys and what it is for.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name in messages, e.g. `tool.friction`; empty for the top of the file.
    pub name: String,
    /// One line for people.
    pub meaning: &'static str,
    /// Its keys.
    pub fields: Vec<Field>,
}

impl Section {
    /// A table of keys.
    pub fn new(name: &str, meaning: &'static str, fields: Vec<Field>) -> Self {
        Self { name: name.to_owned(), meaning, fields }
    }

    /// Adds the keys of a parameter table.
    pub fn with_parameters(mut self, table: &'static [Parameter]) -> Self {
        self.fields.extend(table.iter().map(Field::from_parameter));
        self
    }

    /// The key of this name.
    pub fn field(&self, key: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.key == key)
    }

    /// Names of the keys.
    pub fn keys(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.fields.iter().map(|field| field.key)
    }

    /// The same keys, all of them optional: an override.
    pub fn all_optional(mut self, name: &str, meaning: &'static str) -> Self {
        name.clone_into(&mut self.name);
        self.meaning = meaning;
        for field in &mut self.fields {
            field.presence = Presence::Optional;
        }
        self
    }
}

impl Field {
    /// A key.
    pub fn new(key: &'static str, kind: Kind, presence: Presence, meaning: &'static str) -> Self {
        Self { key, kind, presence, meaning: Cow::Borrowed(meaning), example: "" }
    }

    /// A key that has to be there.
    #[must_use]
    pub fn required(key: &'static str, kind: Kind, meaning: &'static str) -> Self {
        Self::new(key, kind, Presence::Required, meaning)
    }

    /// A key that may be left out.
    #[must_use]
    pub fn optional(key: &'static str, kind: Kind, meaning: &'static str) -> Self {
        Self::new(key, kind, Presence::Optional, meaning)
    }

    /// A key with a value without it, as a user would write it.
    #[must_use]
    pub fn with_default(
        key: &'static str,
        kind: Kind,
        value: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(key, kind, default(value), meaning)
    }

    /// A key whose value without it follows from other keys, as `without` says.
    #[must_use]
    pub fn derived(
        key: &'static str,
        kind: Kind,
        without: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(key, kind, Presence::Derived(without), meaning)
    }

    /// With an example, as it would be written.
    pub fn example(mut self, example: &'static str) -> Self {
        self.example = example;
        self
    }

    /// A parameter of a law as a key of its section: the table is the only statement of it.
    fn from_parameter(parameter: &Parameter) -> Self {
        let presence = parameter.default.map_or(Presence::Required, |value| {
            Presence::Default(Cow::Owned(Unit::si(parameter.quantity).express(value)))
        });
        Self {
            key: parameter.key,
            kind: Kind::Quantity(parameter.quantity, parameter.range),
            presence,
            meaning: Cow::Owned(format!("{} ({})", parameter.meaning, parameter.symbol)),
            example: "",
        }
    }

    /// A line that could stand in the file.
    pub fn example_line(&self) -> String {
        if matches!(self.kind, Kind::Table | Kind::Tables) && !self.example.is_empty() {
            return self.example.to_owned();
        }
        if !self.example.is_empty() {
            return format!("{} = {}", self.key, self.example);
        }
        match &self.kind {
            Kind::Quantity(Quantity::Dimensionless, _) => format!("{} = 0.5", self.key),
            Kind::Quantity(quantity, _)
            | Kind::Tabulated(quantity, _)
            | Kind::Vector(quantity)
            | Kind::PartialVector(quantity) => {
                format!("{} = \"1 {}\"", self.key, units::accepted_units(*quantity)[0])
            }
            Kind::Count { min, .. } => format!("{} = {min}", self.key),
            Kind::Choice(words) => format!("{} = \"{}\"", self.key, words.first().unwrap_or(&"")),
            Kind::Text | Kind::Material => format!("{} = \"...\"", self.key),
            Kind::Path => format!("{} = \"file.csv\"", self.key),
            Kind::Switch => format!("{} = true", self.key),
            Kind::Table => format!("[{}]", self.key),
            Kind::Tables => format!("[[{}]]", self.key),
            Kind::Literal(_) => format!("{} = 1", self.key),
        }
    }
}

/// "from 1.1 to 2.5", "above 0 up to 1", in the unit given.
pub fn range_text(range: Range, unit: &Unit) -> String {
    let lower = if range.min_excluded { "above" } else { "from" };
    let upper = if range.min_excluded { "up to" } else { "to" };
    format!("{lower} {} {upper} {}", unit.express(range.min), unit.express(range.max))
}

/// A default, written as in a file.
#[must_use]
pub const fn default(text: &'static str) -> Presence {
    Presence::Default(Cow::Borrowed(text))
}

/// A quantity above 0 and up to `max` in SI.
#[must_use]
pub const fn positive(quantity: Quantity, max: f64) -> Kind {
    Kind::Quantity(quantity, Range::above(0.0, max))
}

/// A quantity from `min` to `max` in SI.
#[must_use]
pub const fn between(quantity: Quantity, min: f64, max: f64) -> Kind {
    Kind::Quantity(quantity, Range::closed(min, max))
}

/// What is wrong with tables of keys: a default that is not read or out of range, a key without meaning, not in snake case or there
/// twice, a proposal that cannot be written. Tests of the crates that have tables expect nothing.
#[must_use]
pub fn faults(sections: &[Section]) -> Vec<String> {
    let fault = |section: &Section, field: &Field, what: &str| {
        format!("[{}] {}: {what}", section.name, field.key)
    };
    let mut found = Vec::new();
    for section in sections {
        if section.meaning.is_empty() {
            found.push(format!("[{}]: no meaning", section.name));
        }
        for (index, field) in section.fields.iter().enumerate() {
            let again = section.fields[..index].iter().any(|other| other.key == field.key);
            let snake = field.key.chars().all(|c| c.is_ascii_lowercase() || c == '_');
            if field.meaning.is_empty() || again || !snake {
                found.push(fault(section, field, "no meaning, twice, or not in snake case"));
            }
            if let Presence::Default(text) = &field.presence
                && !is_good_default(&field.kind, text)
            {
                found.push(fault(section, field, &format!("bad default {text}")));
            }
            let line = field.example_line();
            if !line.starts_with('[') && toml::de::DeTable::parse(&line).is_err() {
                found.push(fault(section, field, &format!("proposes {line}")));
            }
        }
    }
    found
}

fn is_good_default(kind: &Kind, text: &str) -> bool {
    match kind {
        Kind::Quantity(quantity, range) | Kind::Tabulated(quantity, range) => {
            units::parse(text, *quantity).is_ok_and(|measured| range.contains(measured.si))
        }
        Kind::Count { min, max } => text.parse().is_ok_and(|count| (*min..=*max).contains(&count)),
        Kind::Choice(words) => words.contains(&text),
        Kind::Switch => text == "true" || text == "false",
        _ => false,
    }
}
