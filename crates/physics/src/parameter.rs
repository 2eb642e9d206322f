//! Parameters of a law as data: stated once, read by parser, errors, schema,
//! catalogue and tests.

use crate::Quantity;
use crate::flow_stress::FlowStressTable;
use std::sync::Arc;

/// The interval of admissible SI values of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest admissible value.
    pub min: f64,
    /// Largest admissible value.
    pub max: f64,
    /// Whether `min` itself is excluded.
    pub min_excluded: bool,
}

impl Range {
    /// All values from `min` to `max`, both included.
    #[must_use]
    pub const fn closed(min: f64, max: f64) -> Self {
        Self { min, max, min_excluded: false }
    }

    /// All values above `min` up to and including `max`.
    #[must_use]
    pub const fn above(min: f64, max: f64) -> Self {
        Self { min, max, min_excluded: true }
    }

    /// Whether `value` lies inside; never true for NaN.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        let above_min = if self.min_excluded { value > self.min } else { value >= self.min };
        above_min && value <= self.max
    }
}

/// One parameter of a law, an effect or an option group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key in the scenario file, e.g. `initial_yield`.
    pub key: &'static str,
    /// Letter in the formula, e.g. `A`.
    pub symbol: &'static str,
    /// Physical quantity; its SI unit is the unit of all numbers here.
    pub quantity: Quantity,
    /// Admissible SI values.
    pub range: Range,
    /// Default SI value; `None` if the user has to give it.
    pub default: Option<f64>,
    /// One line for the person who sets it.
    pub meaning: &'static str,
    /// Where the default or the range comes from.
    pub source: &'static str,
}

/// Why a set of parameter values was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// A parameter without default was not given.
    #[error("`{key}` is missing and has no default")]
    Missing {
        /// Key of the parameter.
        key: &'static str,
    },
    /// A key that the table does not have.
    #[error("`{key}` is not a parameter of this table")]
    Unknown {
        /// The key as given.
        key: String,
    },
    /// A value outside the range of the table, or not finite.
    #[error(
        "`{key}` = {value} lies outside {}{}, {}]",
        if .range.min_excluded { "(" } else { "[" }, .range.min, .range.max
    )]
    OutOfRange {
        /// Key of the parameter.
        key: &'static str,
        /// The SI value given.
        value: f64,
        /// The admissible range.
        range: Range,
    },
}

/// Checked SI values of a parameter table, in the table's order; with them the table of measured
/// values for a law that has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    table: &'static [Parameter],
    values: Vec<f64>,
    table_data: Option<Arc<FlowStressTable>>,
}

impl Values {
    /// Resolves `given` (key, SI value) against `table`: fills defaults, checks ranges.
    ///
    /// # Errors
    /// All mistakes at once: unknown keys, missing values, values out of range.
    pub fn resolve(
        table: &'static [Parameter],
        given: &[(&str, f64)],
    ) -> Result<Self, Vec<ParameterError>> {
        let mut errors: Vec<ParameterError> = given
            .iter()
            .filter(|(key, _)| !table.iter().any(|parameter| parameter.key == *key))
            .map(|(key, _)| ParameterError::Unknown { key: (*key).to_owned() })
            .collect();
        let mut values = Vec::with_capacity(table.len());
        for parameter in table {
            let found = given.iter().rev().find(|(key, _)| *key == parameter.key);
            match found.map(|(_, value)| *value).or(parameter.default) {
                None => errors.push(ParameterError::Missing { key: parameter.key }),
                Some(value) if !parameter.range.contains(value) => {
                    errors.push(ParameterError::OutOfRange {
                        key: parameter.key,
                        value,
                        range: parameter.range,
                    });
                }
                Some(value) => values.push(value),
            }
        }
        if errors.is_empty() { Ok(Self { table, values, table_data: None }) } else { Err(errors) }
    }

    /// The defaults of a table in which every parameter has one.
    ///
    /// # Panics
    /// If a parameter of `table` has no default: a mistake in the table itself.
    #[must_use]
    pub fn defaults(table: &'static [Parameter]) -> Self {
        Self::resolve(table, &[]).expect("every parameter of this table has a default in range")
    }

    /// The value of `key`.
    ///
    /// # Panics
    /// If the table has no such key: a mistake in the calling law, not in user input.
    #[must_use]
    pub fn get(&self, key: &str) -> f64 {
        let index = self.table.iter().position(|parameter| parameter.key == key);
        self.values[index.unwrap_or_else(|| panic!("the parameter table has no key `{key}`"))]
    }

    /// The same values with a table of measured ones.
    #[must_use]
    pub fn with_table_data(self, data: Option<Arc<FlowStressTable>>) -> Self {
        Self { table_data: data, ..self }
    }

    /// The table of measured values, if there is one.
    #[must_use]
    pub fn table_data(&self) -> Option<&Arc<FlowStressTable>> {
        self.table_data.as_ref()
    }

    /// The table these values belong to.
    #[must_use]
    pub fn table(&self) -> &'static [Parameter] {
        self.table
    }

    /// Parameter and value, in the table's order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Parameter, f64)> + '_ {
        self.table.iter().zip(self.values.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &[Parameter] = &[
        Parameter {
            key: "initial_yield",
            symbol: "A",
            quantity: Quantity::Stress,
            range: Range::above(0.0, 1e10),
            default: None,
            meaning: "",
            source: "",
        },
        Parameter {
            key: "rate_coefficient",
            symbol: "C",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 1.0),
            default: Some(0.1),
            meaning: "",
            source: "",
        },
    ];

    #[test]
    fn defaults_fill_what_is_not_given() {
        let values = Values::resolve(TABLE, &[("initial_yield", 3e8)]).unwrap();
        assert_eq!(values.get("initial_yield"), 3e8);
        assert_eq!(values.get("rate_coefficient"), 0.1);
    }

    #[test]
    fn all_mistakes_are_reported_at_once() {
        let errors =
            Values::resolve(TABLE, &[("rate_coefficient", 2.0), ("colour", 1.0)]).unwrap_err();
        assert_eq!(errors.len(), 3, "{errors:?}");
    }

    #[test]
    fn not_a_number_is_never_in_range() {
        assert!(Values::resolve(TABLE, &[("initial_yield", f64::NAN)]).is_err());
        assert!(!Range::closed(f64::NEG_INFINITY, f64::INFINITY).contains(f64::NAN));
    }
}
