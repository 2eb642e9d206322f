//! Reads one table of a file against its [`Section`]: unknown keys, missing
//! keys, types, units and ranges, all mistakes in one go.

use crate::field_reader::FieldReader;
use crate::findings::{Findings, Origin, ResolvedEntry};
use crate::problem::{Mistake, SourceText, shortened};
use crate::record::{Record, Value};
use crate::section::{Field, Kind, Presence, Section};
use crate::{spelling, units};
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// How a table is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Defaults {
    /// Defaults fill what is not written; what is required must be there.
    Fill,
    /// Only what is written counts: an override.
    Ignore,
}

/// Reads `table` against `section`; mistakes and the description go to `findings`.
pub fn read<'t>(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    (raw, heading): (&'t DeTable<'t>, Range<usize>),
    section: &Section,
    dimension: usize,
) -> Record<'t> {
    read_with(findings, source, (raw, heading), section, dimension, Defaults::Fill)
}

/// As [`read`], with a choice about what is not written.
pub fn read_with<'t>(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    (raw, heading): (&'t DeTable<'t>, Range<usize>),
    section: &Section,
    dimension: usize,
    defaults: Defaults,
) -> Record<'t> {
    let meant = refuse_unknown_keys(findings, source, raw, section);
    let mut items = Vec::new();
    for field in &section.fields {
        let mut reader = FieldReader { source, findings: &mut *findings, field, dimension };
        if let Some(written) = raw.get(field.key) {
            if let Some((value, text)) = reader.value(written) {
                describe(findings, section, field, &value, text, Origin::Given);
                items.push((field.key, value));
            }
        } else if defaults == Defaults::Fill
            && !meant.contains(&field.key)
            && let Some(value) = absent(findings, source, &heading, section, field)
        {
            items.push((field.key, value));
        }
    }
    Record { source: Arc::clone(source), section: section.name.clone(), heading, raw, items, meant }
}

/// Reports unknown keys; returns the keys that they probably were meant to be.
fn refuse_unknown_keys(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    raw: &DeTable<'_>,
    section: &Section,
) -> Vec<&'static str> {
    let mut meant = Vec::new();
    for key in raw.keys() {
        let name = key.get_ref().as_ref();
        if section.field(name).is_none() {
            // The symbol of a textbook, such as A of Johnson and Cook, stands in brackets after the meaning.
            let symbol = format!("({name})");
            let by_symbol = section.fields.iter().find(|field| field.meaning.ends_with(&symbol));
            let nearest = by_symbol
                .map(|field| field.key)
                .or_else(|| spelling::nearest(name, section.keys()));
            meant.extend(section.keys().find(|known| Some(*known) == nearest));
            let mistake = Mistake::UnknownKey {
                section: section.name.clone(),
                key: shortened(name),
                nearest: nearest.map(str::to_owned),
                allowed: section.keys().map(str::to_owned).collect(),
            };
            findings.problem(source, key.span(), mistake);
        }
    }
    meant
}

/// The default of a key that is not written; a mistake if it is required.
fn absent(
    findings: &mut Findings,
    source: &Arc<SourceText>,
    heading: &Range<usize>,
    section: &Section,
    field: &Field,
) -> Option<Value> {
    match &field.presence {
        Presence::Optional | Presence::Derived(_) => None,
        Presence::Required => {
            findings.problem(source, heading.clone(), missing(section, field));
            None
        }
        Presence::Default(text) => {
            let value = default_value(field, text);
            describe(findings, section, field, &value, text.to_string(), Origin::Default);
            Some(value)
        }
    }
}

/// The mistake of a word that is not one of `choices`.
pub fn not_a_choice(key: &str, word: &str, choices: &[&'static str]) -> Mistake {
    Mistake::NotAChoice {
        key: key.to_owned(),
        word: shortened(word),
        nearest: spelling::nearest(word, choices.iter().copied()).map(str::to_owned),
        allowed: choices.iter().map(|choice| (*choice).to_owned()).collect(),
    }
}

/// The mistake of a key that is not there.
pub fn missing(section: &Section, field: &Field) -> Mistake {
    let key = match field.kind {
        Kind::Table if section.name.is_empty() => format!("[{}]", field.key),
        Kind::Tables if section.name.is_empty() => format!("[[{}]]", field.key),
        _ => field.key.to_owned(),
    };
    Mistake::Missing {
        section: section.name.clone(),
        key,
        meaning: field.meaning.to_string(),
        example: field.example_line(),
    }
}

/// Defaults are written like user text and read by the same parser.
fn default_value(field: &Field, text: &str) -> Value {
    match &field.kind {
        Kind::Quantity(quantity, _) | Kind::Tabulated(quantity, _) => Value::Number(
            units::parse(text, *quantity).expect("a test reads the default of every key").si,
        ),
        Kind::Count { .. } => {
            Value::Count(text.parse().expect("a test reads the default of every key"))
        }
        Kind::Switch => Value::Switch(text == "true"),
        _ => Value::Text(text.to_string()),
    }
}

fn describe(
    findings: &mut Findings,
    section: &Section,
    field: &Field,
    value: &Value,
    text: String,
    origin: Origin,
) {
    let unit = match field.kind {
        Kind::Quantity(quantity, _)
        | Kind::Tabulated(quantity, _)
        | Kind::Vector(quantity)
        | Kind::PartialVector(quantity) => quantity.si_unit(),
        _ => "",
    };
    let number = match value {
        Value::Number(number) => Some(*number),
        Value::Count(count) => Some(*count as f64),
        _ => None,
    };
    let value = match value {
        Value::Number(number) => units::significant(*number),
        Value::Count(count) => count.to_string(),
        Value::Switch(switch) => switch.to_string(),
        Value::Text(word) => word.clone(),
        Value::Numbers(numbers) => numbers
            .iter()
            .map(|number| number.map_or_else(|| "free".to_owned(), units::significant))
            .collect::<Vec<_>>()
            .join(", "),
        Value::Table(table) => table
            .pairs()
            .map(|(kelvin, number)| {
                format!("{} K: {}", units::significant(kelvin), units::significant(number))
            })
            .collect::<Vec<_>>()
            .join(", "),
    };
    let section = section.name.clone();
    let key = field.key.to_owned();
    findings.description.push(ResolvedEntry { section, key, text, value, number, unit, origin });
}
