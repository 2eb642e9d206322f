//! What reading a scenario leaves behind besides the values: mistakes and the description.

use crate::problem::{Mistake, Problem, SourceText};
use crate::record::Record;
use crate::units;
use sphcut_physics::Quantity;
use std::ops::Range;
use std::sync::Arc;

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
    /// The same as a number, not rounded; `None` for words, lists and tables.
    pub number: Option<f64>,
    /// SI unit; empty for words and pure numbers.
    pub unit: &'static str,
    /// Where the value comes from.
    pub origin: Origin,
}

/// What reading a scenario leaves behind besides the values.
#[derive(Debug, Default)]
pub struct Findings {
    /// In the order in which they were found.
    pub problems: Vec<Problem>,
    /// Every key that was understood.
    pub description: Vec<ResolvedEntry>,
}

/// More mistakes than anyone reads; bounds time and memory on hostile texts.
const MOST_PROBLEMS: usize = 200;

impl Findings {
    /// What was read, or nothing and its mistake reported at `key` of `record`.
    pub fn accept<T>(
        &mut self,
        record: &Record<'_>,
        key: &str,
        read: Result<T, Box<Mistake>>,
    ) -> Option<T> {
        read.map_err(|mistake| self.problem(&record.source, record.span(key), *mistake)).ok()
    }

    /// Reports a mistake at `span` of `source`.
    pub fn problem(&mut self, source: &Arc<SourceText>, span: Range<usize>, mistake: Mistake) {
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

    /// Says what the file holds that was named last under `key` of `section`.
    pub fn resolved(&mut self, section: &str, key: &str, content: String) {
        let named = |entry: &&mut ResolvedEntry| entry.section == section && entry.key == key;
        if let Some(entry) = self.description.iter_mut().rev().find(named) {
            entry.value = content;
        }
    }

    /// Says that the value of a pure number, told as its default, follows from other keys.
    pub fn followed(&mut self, section: &str, key: &str, si: f64) {
        self.description.retain(|entry| entry.section != section || entry.key != key);
        self.derived(section, key, Quantity::Dimensionless, si);
    }

    /// Notes a value that follows from others.
    pub fn derived(&mut self, section: &str, key: &str, quantity: Quantity, si: f64) {
        let value = units::significant(si);
        self.description.push(ResolvedEntry {
            section: section.to_owned(),
            key: key.to_owned(),
            text: units::readable(quantity, si),
            value,
            number: Some(si),
            unit: quantity.si_unit(),
            origin: Origin::Derived,
        });
    }
}
