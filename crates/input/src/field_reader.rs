//! Reads the value of one key: its type, its unit, its range.

use crate::findings::Findings;
use crate::problem::shortened;
use crate::problem::{Mistake, SourceText};
use crate::record::Value;
use crate::section::{Field, Kind, range_text};
use crate::spelling;
use crate::units::{self, Measured, UnitError};
use sphcut_physics::{Quantity, TemperatureTable};
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::DeValue;

/// Pairs that a table may have.
const MOST_PAIRS: usize = 200;

/// Temperatures of a table in K.
const TABLE_TEMPERATURES: sphcut_physics::Range = sphcut_physics::Range::above(0.0, 10_000.0);

/// A text as a quantity, an integer, ... of `field`.
pub struct FieldReader<'r> {
    pub source: &'r Arc<SourceText>,
    pub findings: &'r mut Findings,
    pub field: &'r Field,
    pub dimension: usize,
}

impl FieldReader<'_> {
    /// The checked value and its text; `None` after a mistake and for tables.
    pub fn value(&mut self, written: &Spanned<DeValue<'_>>) -> Option<(Value, String)> {
        let span = written.span();
        let value = written.get_ref();
        match &self.field.kind {
            Kind::Tabulated(quantity, range) if value.is_array() => {
                self.table(value, &span, *quantity, *range)
            }
            Kind::Quantity(quantity, range) | Kind::Tabulated(quantity, range) => {
                let (number, text) = self.in_range(self.key(), value, span, *quantity, *range)?;
                Some((Value::Number(number), text))
            }
            Kind::Count { min, max } => self.count(value, &span, *min, *max),
            Kind::Choice(words) => self.choice(value, span, words),
            Kind::Text | Kind::Path => self.text(value, &span),
            Kind::Switch => match value.as_bool() {
                Some(switch) => Some((Value::Switch(switch), switch.to_string())),
                None => self.wrong_type(&span, "true or false", value),
            },
            Kind::Vector(quantity) => self.vector(value, &span, *quantity, Free::Refused),
            Kind::PartialVector(quantity) => self.vector(value, &span, *quantity, Free::Allowed),
            Kind::Table if value.is_table() => None,
            Kind::Table => self.wrong_type(&span, "a table", value),
            Kind::Tables => self.tables(value, &span),
            Kind::Literal(_) => None,
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

    /// Text that may be shown in a terminal and in a report: no control characters.
    fn text(&mut self, value: &DeValue, span: &Range<usize>) -> Option<(Value, String)> {
        let text = self.string(value, span)?;
        if text.chars().any(|c| c.is_control() && c != '\n' && c != '\t') {
            let expected = "text without control characters".to_owned();
            let found = "text with control characters".to_owned();
            self.mistake(span.clone(), Mistake::WrongType { key: self.key(), expected, found });
            return None;
        }
        Some((Value::Text(text.clone()), text))
    }

    /// The SI value and its text; `key` is what a message calls it.
    fn in_range(
        &mut self,
        key: String,
        value: &DeValue,
        span: Range<usize>,
        quantity: Quantity,
        range: sphcut_physics::Range,
    ) -> Option<(f64, String)> {
        let (measured, text) = self.quantity(value, &span, quantity)?;
        if range.contains(measured.si) {
            return Some((measured.si, text));
        }
        let range = range_text(range, &measured.unit);
        self.mistake(span, Mistake::OutOfRange { key, text, range });
        None
    }

    /// Pairs of temperature and quantity, the temperatures rising.
    fn table(
        &mut self,
        value: &DeValue,
        span: &Range<usize>,
        quantity: Quantity,
        range: sphcut_physics::Range,
    ) -> Option<(Value, String)> {
        let list = value.as_array()?;
        if list.is_empty() || list.len() > MOST_PAIRS {
            let (key, text) = (self.key(), format!("a list of {}", list.len()));
            let range = format!("from 1 to {MOST_PAIRS} pairs");
            self.mistake(span.clone(), Mistake::OutOfRange { key, text, range });
            return None;
        }
        let mut pairs: Vec<(f64, f64)> = Vec::new();
        let mut texts: Vec<String> = Vec::new();
        for entry in list {
            let pair: Vec<&Spanned<DeValue<'_>>> =
                entry.get_ref().as_array().map(|pair| pair.iter().collect()).unwrap_or_default();
            let &[temperature, property] = pair.as_slice() else {
                let unit = units::accepted_units(quantity)[0];
                let expected = format!("a list of pairs such as [\"20 degC\", \"1 {unit}\"]");
                return self.wrong_type(&entry.span(), &expected, entry.get_ref());
            };
            let (kelvin, warm) = self.in_range(
                format!("temperature of {}", self.field.key),
                temperature.get_ref(),
                temperature.span(),
                Quantity::Temperature,
                TABLE_TEMPERATURES,
            )?;
            let (number, text) =
                self.in_range(self.key(), property.get_ref(), property.span(), quantity, range)?;
            if pairs.last().is_some_and(|last| kelvin <= last.0) {
                let mistake = Mistake::Contradiction {
                    message: format!(
                        "`{}`: the temperature {warm} is not above the one before it",
                        self.field.key
                    ),
                    help: "list the pairs in rising order of temperature".to_owned(),
                };
                self.mistake(temperature.span(), mistake);
                return None;
            }
            pairs.push((kelvin, number));
            texts.push(format!("{warm}: {text}"));
        }
        let table = TemperatureTable::new(&pairs).expect("positive and rising, checked above");
        Some((Value::Table(table), texts.join(", ")))
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
