//! Reads one table of a file against its [`Section`]: unknown keys, missing
//! keys, types, units and ranges, all mistakes in one go.

use crate::problem::{Mistake, Problem, Source};
use crate::section::{Field, Kind, Presence, Section, range_text};
use crate::spelling;
use crate::units::{self, Measured, Unit, UnitError};
use sphcut_physics::Quantity;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where a value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Written in the file.
    Given,
    /// The default of the key.
    Default,
    /// Follows from other keys.
    Derived,
}

/// One resolved key, for `sphcut check`.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedEntry {
    /// Section, e.g. `tool.friction`; empty for the top of the file.
    pub section: String,
    /// Key.
    pub key: String,
    /// The value as the user wrote it, or as the default is written.
    pub text: String,
    /// The value in SI, or the word.
    pub value: String,
    /// SI unit; empty for words and pure numbers.
    pub unit: &'static str,
    /// Where the value comes from.
    pub origin: Origin,
}

/// What reading a scenario leaves behind besides the values.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub(crate) problems: Vec<Problem>,
    pub(crate) description: Vec<ResolvedEntry>,
}

/// More mistakes than anyone reads; bounds time and memory on hostile texts.
const MOST_PROBLEMS: usize = 200;

impl Findings {
    pub(crate) fn problem(&mut self, source: &Arc<Source>, span: Range<usize>, mistake: Mistake) {
        match self.problems.len() {
            0..MOST_PROBLEMS => self.problems.push(Problem::new(source, span, mistake)),
            MOST_PROBLEMS => {
                let message = format!("more than {MOST_PROBLEMS} mistakes: the rest is not told");
                let help = "correct these first".to_owned();
                let mistake = Mistake::TooLarge { message, help };
                self.problems.push(Problem::new(source, span, mistake));
            }
            _ => {}
        }
    }

    /// Notes a value that follows from others.
    pub(crate) fn derived(&mut self, section: &str, key: &str, quantity: Quantity, si: f64) {
        let value = units::significant(si);
        self.description.push(ResolvedEntry {
            section: section.to_owned(),
            key: key.to_owned(),
            text: Unit::si(quantity).express(si),
            value,
            unit: quantity.si_unit(),
            origin: Origin::Derived,
        });
    }
}

/// A value that passed all checks of its key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Number(f64),
    Count(i64),
    Text(String),
    Switch(bool),
    Numbers(Vec<Option<f64>>),
}

/// The values of one table, and where they stand.
#[derive(Debug)]
pub(crate) struct Record<'t> {
    pub(crate) source: Arc<Source>,
    pub(crate) section: String,
    /// Where the table begins.
    pub(crate) heading: Range<usize>,
    raw: &'t DeTable<'t>,
    items: Vec<(&'static str, Value)>,
    /// Keys that are written with a mistyped name.
    meant: Vec<&'static str>,
}

impl<'t> Record<'t> {
    fn find(&self, key: &str) -> Option<&Value> {
        self.items.iter().find(|item| item.0 == key).map(|item| &item.1)
    }

    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        match self.find(key)? {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    pub(crate) fn count(&self, key: &str) -> Option<i64> {
        match self.find(key)? {
            Value::Count(count) => Some(*count),
            _ => None,
        }
    }

    pub(crate) fn text(&self, key: &str) -> Option<&str> {
        match self.find(key)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(crate) fn switch(&self, key: &str) -> Option<bool> {
        match self.find(key)? {
            Value::Switch(switch) => Some(*switch),
            _ => None,
        }
    }

    pub(crate) fn partial_vector(&self, key: &str) -> Option<&[Option<f64>]> {
        match self.find(key)? {
            Value::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }

    /// A vector with three components, those beyond the dimension zero.
    pub(crate) fn vector(&self, key: &str) -> Option<[f64; 3]> {
        let mut vector = [0.0; 3];
        for (component, value) in vector.iter_mut().zip(self.partial_vector(key)?) {
            *component = (*value)?;
        }
        Some(vector)
    }

    /// Whether the key is written in the file, right or wrong.
    pub(crate) fn is_written(&self, key: &str) -> bool {
        self.raw.get(key).is_some()
    }

    /// Whether the key is missing: neither written nor meant by a mistyped one.
    pub(crate) fn lacks(&self, key: &str) -> bool {
        !self.is_written(key) && !self.meant.contains(&key)
    }

    /// Where the value of `key` stands; the heading if it is not written.
    pub(crate) fn span(&self, key: &str) -> Range<usize> {
        self.raw.get(key).map_or_else(|| self.heading.clone(), Spanned::span)
    }

    pub(crate) fn table(&self, key: &str) -> Option<(&'t DeTable<'t>, Range<usize>)> {
        match self.raw.get(key)? {
            value if value.get_ref().is_table() => {
                Some((value.get_ref().as_table()?, heading_span(self.raw, key)))
            }
            _ => None,
        }
    }

    /// The tables of `[[key]]`, each with its place.
    pub(crate) fn tables(&self, key: &str) -> Vec<(&'t DeTable<'t>, Range<usize>)> {
        let Some(list) = self.raw.get(key).and_then(|value| value.get_ref().as_array()) else {
            return Vec::new();
        };
        list.iter().filter_map(|value| Some((value.get_ref().as_table()?, value.span()))).collect()
    }

    /// SI values of all quantities, as `(key, value)`, of those that are written.
    pub(crate) fn written_numbers(&self) -> Vec<(&'static str, f64)> {
        self.items
            .iter()
            .filter(|(key, _)| self.is_written(key))
            .filter_map(|(key, value)| match value {
                Value::Number(number) => Some((*key, *number)),
                _ => None,
            })
            .collect()
    }
}

/// Where `[key]` or `key = {...}` stands.
fn heading_span(table: &DeTable<'_>, key: &str) -> Range<usize> {
    table.get_key_value(key).map_or(0..0, |(written, value)| {
        let (key_span, value_span) = (written.span(), value.span());
        if value_span.is_empty() { key_span } else { value_span }
    })
}

/// A text as a quantity, an integer, ... of `field`.
struct FieldReader<'r> {
    source: &'r Arc<Source>,
    findings: &'r mut Findings,
    field: &'r Field,
    dimension: usize,
}

/// How a table is to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Defaults {
    /// Defaults fill what is not written; what is required must be there.
    Fill,
    /// Only what is written counts: an override.
    Ignore,
}

/// Reads `table` against `section`; mistakes and the description go to `findings`.
pub(crate) fn read<'t>(
    findings: &mut Findings,
    source: &Arc<Source>,
    (raw, heading): (&'t DeTable<'t>, Range<usize>),
    section: &Section,
    dimension: usize,
) -> Record<'t> {
    read_with(findings, source, (raw, heading), section, dimension, Defaults::Fill)
}

/// As [`read`], with a choice about what is not written.
pub(crate) fn read_with<'t>(
    findings: &mut Findings,
    source: &Arc<Source>,
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
    source: &Arc<Source>,
    raw: &DeTable<'_>,
    section: &Section,
) -> Vec<&'static str> {
    let mut meant = Vec::new();
    for key in raw.keys() {
        let name = key.get_ref().as_ref();
        if section.field(name).is_none() {
            let nearest = spelling::nearest(name, section.keys());
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

/// Longest text of a user that is repeated in a message.
const LONGEST_QUOTE: usize = 60;

/// Text of a user as it may be repeated: short and without control characters.
pub(crate) fn shortened(text: &str) -> String {
    let mut quote: String = text
        .chars()
        .take(LONGEST_QUOTE)
        .map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c })
        .collect();
    if text.chars().nth(LONGEST_QUOTE).is_some() {
        quote.push_str("...");
    }
    quote
}

/// The default of a key that is not written; a mistake if it is required.
fn absent(
    findings: &mut Findings,
    source: &Arc<Source>,
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

/// The mistake of a key that is not there.
pub(crate) fn missing(section: &Section, field: &Field) -> Mistake {
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
        Kind::Quantity(quantity, _) => Value::Number(
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
        Kind::Quantity(quantity, _) | Kind::Vector(quantity) | Kind::PartialVector(quantity) => {
            quantity.si_unit()
        }
        _ => "",
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
    };
    let section = section.name.clone();
    let key = field.key.to_owned();
    findings.description.push(ResolvedEntry { section, key, text, value, unit, origin });
}

impl FieldReader<'_> {
    /// The checked value and its text; `None` after a mistake and for tables.
    fn value(&mut self, written: &Spanned<DeValue<'_>>) -> Option<(Value, String)> {
        let span = written.span();
        let value = written.get_ref();
        match &self.field.kind {
            Kind::Quantity(quantity, range) => {
                let (measured, text) = self.quantity(value, &span, *quantity)?;
                if !range.contains(measured.si) {
                    let range = range_text(*range, &measured.unit);
                    self.mistake(span, Mistake::OutOfRange { key: self.key(), text, range });
                    return None;
                }
                Some((Value::Number(measured.si), text))
            }
            Kind::Count { min, max } => self.count(value, &span, *min, *max),
            Kind::Choice(words) => self.choice(value, span, words),
            Kind::Text | Kind::Path => {
                let text = self.string(value, &span)?;
                Some((Value::Text(text.clone()), text))
            }
            Kind::Switch => match value.as_bool() {
                Some(switch) => Some((Value::Switch(switch), switch.to_string())),
                None => self.wrong_type(&span, "true or false", value),
            },
            Kind::Vector(quantity) => self.vector(value, &span, *quantity, Free::Refused),
            Kind::PartialVector(quantity) => self.vector(value, &span, *quantity, Free::Allowed),
            Kind::Table if value.is_table() => None,
            Kind::Table => self.wrong_type(&span, "a table", value),
            Kind::Tables => self.tables(value, &span),
            Kind::Material if value.is_table() => None,
            Kind::Material => match value.as_str() {
                Some(name) => Some((Value::Text(name.to_owned()), name.to_owned())),
                None => self.wrong_type(&span, "the name of a material or a table", value),
            },
        }
    }

    fn key(&self) -> String {
        self.field.key.to_owned()
    }

    fn mistake(&mut self, span: Range<usize>, mistake: Mistake) {
        self.findings.problem(self.source, span, mistake);
    }

    fn wrong_type<T>(&mut self, span: &Range<usize>, expected: &str, value: &DeValue) -> Option<T> {
        let (expected, found) = (expected.to_owned(), type_name(value).to_owned());
        self.mistake(span.clone(), Mistake::WrongType { key: self.key(), expected, found });
        None
    }

    fn string(&mut self, value: &DeValue, span: &Range<usize>) -> Option<String> {
        match value.as_str() {
            Some(text) => Some(text.to_owned()),
            None => self.wrong_type(span, "text in quotes", value),
        }
    }

    fn quantity(
        &mut self,
        value: &DeValue,
        span: &Range<usize>,
        quantity: Quantity,
    ) -> Option<(Measured, String)> {
        let text = match value {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(number) => number.to_string(),
            DeValue::Float(number) => number.to_string(),
            _ => {
                let expected = expected_quantity(quantity);
                return self.wrong_type(span, &expected, value);
            }
        };
        match units::parse(&text, quantity) {
            Ok(measured) => Some((measured, text)),
            Err(error) => {
                self.refuse_quantity(span, quantity, text, error);
                None
            }
        }
    }

    fn refuse_quantity(
        &mut self,
        span: &Range<usize>,
        quantity: Quantity,
        text: String,
        error: UnitError,
    ) {
        let mistake = Mistake::Quantity {
            key: self.key(),
            text: shortened(&text),
            wanted: quantity.name(),
            units: units::accepted_units(quantity).to_vec(),
            error,
        };
        self.mistake(span.clone(), mistake);
    }

    fn count(
        &mut self,
        value: &DeValue,
        span: &Range<usize>,
        min: i64,
        max: i64,
    ) -> Option<(Value, String)> {
        let DeValue::Integer(number) = value else {
            return self.wrong_type(span, "a whole number", value);
        };
        let text = number.to_string();
        match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(count) if (min..=max).contains(&count) => Some((Value::Count(count), text)),
            _ => {
                let range = format!("from {min} to {max}");
                let text = shortened(&text);
                self.mistake(span.clone(), Mistake::OutOfRange { key: self.key(), text, range });
                None
            }
        }
    }

    fn choice(
        &mut self,
        value: &DeValue,
        span: Range<usize>,
        words: &[&'static str],
    ) -> Option<(Value, String)> {
        let word = self.string(value, &span)?;
        if words.contains(&word.as_str()) {
            return Some((Value::Text(word.clone()), word));
        }
        let nearest = spelling::nearest(&word, words.iter().copied()).map(str::to_owned);
        let allowed = words.iter().map(|word| (*word).to_owned()).collect();
        let word = shortened(&word);
        self.mistake(span, Mistake::NotAChoice { key: self.key(), word, nearest, allowed });
        None
    }

    fn vector(
        &mut self,
        value: &DeValue,
        span: &Range<usize>,
        quantity: Quantity,
        free: Free,
    ) -> Option<(Value, String)> {
        let expected = format!("a list of {} values in brackets", self.dimension);
        let Some(list) = value.as_array() else {
            return self.wrong_type(span, &expected, value);
        };
        if list.len() != self.dimension {
            let found = format!("a list of {}", list.len());
            self.mistake(span.clone(), Mistake::WrongType { key: self.key(), expected, found });
            return None;
        }
        let components: Vec<Option<(Option<f64>, String)>> =
            list.iter().map(|component| self.component(component, quantity, free)).collect();
        let components: Vec<(Option<f64>, String)> =
            components.into_iter().collect::<Option<_>>()?;
        let text: Vec<&str> = components.iter().map(|component| component.1.as_str()).collect();
        let text = format!("[{}]", text.join(", "));
        Some((Value::Numbers(components.iter().map(|component| component.0).collect()), text))
    }

    fn component(
        &mut self,
        component: &Spanned<DeValue<'_>>,
        quantity: Quantity,
        free: Free,
    ) -> Option<(Option<f64>, String)> {
        let value = component.get_ref();
        if free == Free::Allowed && value.as_str() == Some("free") {
            return Some((None, "free".to_owned()));
        }
        let (measured, text) = self.quantity(value, &component.span(), quantity)?;
        Some((Some(measured.si), text))
    }

    fn tables<T>(&mut self, value: &DeValue, span: &Range<usize>) -> Option<T> {
        let list = value.as_array();
        if list.is_some_and(|list| list.iter().all(|entry| entry.get_ref().is_table())) {
            return None;
        }
        let expected = format!("a list of tables: [[{}]]", self.field.key);
        self.wrong_type(span, &expected, value)
    }
}

/// Whether a component of a vector may be left free.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Free {
    Allowed,
    Refused,
}

fn expected_quantity(quantity: Quantity) -> String {
    if quantity == Quantity::Dimensionless {
        return "a number".to_owned();
    }
    let unit = units::accepted_units(quantity)[0];
    format!("{} in quotes such as \"1 {unit}\"", crate::problem::article(quantity.name()))
}

fn type_name(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
