//! The values of one table, read and checked.

use crate::problem::SourceText;
use sphcut_physics::{ROOM_TEMPERATURE, TemperatureTable};
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::DeTable;

/// A value that passed all checks of its key.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// In SI.
    Number(f64),
    /// A whole number.
    Count(i64),
    /// A word or a text.
    Text(String),
    /// Yes or no.
    Switch(bool),
    /// Components in SI; `None` where one is free.
    Numbers(Vec<Option<f64>>),
    /// Over temperature, in SI.
    Table(TemperatureTable),
}

/// The values of one table, and where they stand.
#[derive(Debug)]
pub struct Record<'t> {
    /// The file.
    pub source: Arc<SourceText>,
    /// Name of the table.
    pub section: String,
    /// Where the table begins.
    pub heading: Range<usize>,
    /// As it is written.
    pub raw: &'t DeTable<'t>,
    /// Key and value of what is stated or has a default.
    pub items: Vec<(&'static str, Value)>,
    /// Keys that are written with a mistyped name.
    pub meant: Vec<&'static str>,
}

impl<'t> Record<'t> {
    fn find(&self, key: &str) -> Option<&Value> {
        self.items.iter().find(|item| item.0 == key).map(|item| &item.1)
    }

    /// The number under `key` in SI.
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.find(key)? {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// The whole number under `key`.
    pub fn count(&self, key: &str) -> Option<i64> {
        match self.find(key)? {
            Value::Count(count) => Some(*count),
            _ => None,
        }
    }

    /// The text under `key`.
    pub fn text(&self, key: &str) -> Option<&str> {
        match self.find(key)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The switch under `key`.
    pub fn switch(&self, key: &str) -> Option<bool> {
        match self.find(key)? {
            Value::Switch(switch) => Some(*switch),
            _ => None,
        }
    }

    /// The components under `key`.
    pub fn partial_vector(&self, key: &str) -> Option<&[Option<f64>]> {
        match self.find(key)? {
            Value::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }

    /// A vector with three components, those beyond the dimension zero.
    pub fn vector(&self, key: &str) -> Option<[f64; 3]> {
        let mut vector = [0.0; 3];
        for (component, value) in vector.iter_mut().zip(self.partial_vector(key)?) {
            *component = (*value)?;
        }
        Some(vector)
    }

    /// Whether the key is written in the file, right or wrong.
    pub fn is_written(&self, key: &str) -> bool {
        self.raw.get(key).is_some()
    }

    /// Whether the key is missing: neither written nor meant by a mistyped one.
    pub fn lacks(&self, key: &str) -> bool {
        !self.is_written(key) && !self.meant.contains(&key)
    }

    /// Where the value of `key` stands; the heading if it is not written.
    pub fn span(&self, key: &str) -> Range<usize> {
        self.raw.get(key).map_or_else(|| self.heading.clone(), Spanned::span)
    }

    /// The table under `key`, and where it stands.
    pub fn table(&self, key: &str) -> Option<(&'t DeTable<'t>, Range<usize>)> {
        match self.raw.get(key)? {
            value if value.get_ref().is_table() => {
                Some((value.get_ref().as_table()?, heading_span(self.raw, key)))
            }
            _ => None,
        }
    }

    /// The tables of `[[key]]`, each with its place.
    pub fn tables(&self, key: &str) -> Vec<(&'t DeTable<'t>, Range<usize>)> {
        let Some(list) = self.raw.get(key).and_then(|value| value.get_ref().as_array()) else {
            return Vec::new();
        };
        list.iter().filter_map(|value| Some((value.get_ref().as_table()?, value.span()))).collect()
    }

    /// SI values of all quantities, as `(key, value)`, of those that are written; of a table the
    /// value at room temperature.
    pub fn written_numbers(&self) -> Vec<(&'static str, f64)> {
        self.items
            .iter()
            .filter(|(key, _)| self.is_written(key))
            .filter_map(|(key, value)| match value {
                Value::Number(number) => Some((*key, *number)),
                Value::Table(table) => Some((*key, table.value(ROOM_TEMPERATURE))),
                _ => None,
            })
            .collect()
    }

    /// Properties that are written as tables.
    pub fn written_tables(&self) -> Vec<(&'static str, TemperatureTable)> {
        self.items
            .iter()
            .filter_map(|(key, value)| match value {
                Value::Table(table) => Some((*key, table.clone())),
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
