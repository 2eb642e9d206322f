//! Comma-separated tables with a header that names columns and their units.

use crate::spelling::nearest;
use crate::units;
use sphcut_physics::Quantity;
use std::fmt;

/// What is wrong in a table, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct TableProblem {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, with its name; `None` if the whole line is meant.
    pub column: Option<(usize, String)>,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for TableProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}", self.line)?;
        if let Some((number, name)) = &self.column {
            write!(f, ", column {number} `{name}`")?;
        }
        write!(f, ": {}", self.message)
    }
}

impl std::error::Error for TableProblem {}

/// A column that a table may have.
pub struct ColumnRule {
    /// Name in the header.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// An example of its unit; empty for a pure number.
    pub unit: &'static str,
    /// Whether a table without it is refused.
    pub required: bool,
    /// Whether its values must be above 0.
    pub positive: bool,
}

/// A rule; the last two are whether the column is required and whether its values must be above 0.
#[must_use]
pub const fn column(
    name: &'static str,
    quantity: Quantity,
    unit: &'static str,
    (required, positive): (bool, bool),
) -> ColumnRule {
    ColumnRule { name, quantity, unit, required, positive }
}

impl ColumnRule {
    /// As it stands in a header.
    fn heading(&self) -> String {
        if self.unit.is_empty() {
            self.name.to_owned()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

/// A column of the file: which of the rules it follows, and the text of its unit.
struct Column {
    rule: usize,
    unit: String,
}

/// A line of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableLine {
    /// Its number, from 1.
    pub number: usize,
    values: Vec<Option<f64>>,
}

impl TableLine {
    /// The SI value in the column of the rule `index`, if there is one.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<f64> {
        self.values[index]
    }

    /// The SI value in the column of the rule `index`, which is required: [`read`] refuses a line without it.
    #[must_use]
    pub fn required(&self, index: usize) -> f64 {
        self.values[index].expect("a line without a required value was refused")
    }

    /// The SI values of the first `N` rules, which are all required.
    #[must_use]
    pub fn all<const N: usize>(&self) -> [f64; N] {
        std::array::from_fn(|index| self.required(index))
    }

    /// A mistake of this line as a whole.
    #[must_use]
    pub fn problem(&self, message: impl Into<String>) -> TableProblem {
        whole(self.number, message)
    }
}

/// Reads a table with the columns of `rules` in any order. Empty lines and lines that begin with `#`
/// are skipped; cells of columns that are not required may be empty or say that there is no number ([`UNKNOWN`]). `nothing` says what is missing if no line follows the header.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read(
    text: &str,
    rules: &[ColumnRule],
    nothing: &str,
) -> Result<Vec<TableLine>, TableProblem> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((number, line)) = lines.next() else {
        return Err(whole(1, "the table is empty"));
    };
    let columns = header(number, line, rules)?;
    let rows: Vec<TableLine> = lines
        .map(|(number, line)| Ok(TableLine { number, values: row(number, line, rules, &columns)? }))
        .collect::<Result<_, _>>()?;
    if rows.is_empty() { Err(whole(number, nothing)) } else { Ok(rows) }
}

/// A mistake of a whole line.
pub fn whole(line: usize, message: impl Into<String>) -> TableProblem {
    TableProblem { line, column: None, message: message.into() }
}

fn header(line: usize, text: &str, rules: &[ColumnRule]) -> Result<Vec<Column>, TableProblem> {
    let mut columns: Vec<Column> = Vec::new();
    for (index, cell) in text.split(',').map(str::trim).enumerate() {
        let (name, rest) = cell.split_once('[').unwrap_or((cell, ""));
        let name = crate::problem::shortened(name.trim());
        let wrong = |message: String| TableProblem {
            line,
            column: Some((index + 1, name.clone())),
            message,
        };
        let Some(found) = rules.iter().position(|rule| rule.name == name) else {
            let known: Vec<&'static str> = rules.iter().map(|rule| rule.name).collect();
            let hint = nearest(&name, known.iter().copied()).map_or_else(
                || format!("there are {}", known.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            return Err(wrong(format!("no such column; {hint}")));
        };
        if columns.iter().any(|column| column.rule == found) {
            return Err(wrong("the column is there twice".to_owned()));
        }
        let rule = &rules[found];
        let unit = rest.strip_suffix(']').unwrap_or("").trim().to_owned();
        if unit.is_empty() && !rule.unit.is_empty() {
            return Err(wrong(format!("the unit is missing: write `{}`", rule.heading())));
        }
        units::parse(&format!("1 {unit}"), rule.quantity)
            .map_err(|error| wrong(format!("`{unit}`: {error}; for example `{}`", rule.unit)))?;
        columns.push(Column { rule: found, unit });
    }
    let missing = rules
        .iter()
        .enumerate()
        .find(|(index, rule)| rule.required && !columns.iter().any(|found| found.rule == *index));
    match missing {
        Some((_, rule)) => Err(whole(line, format!("the column `{}` is missing", rule.heading()))),
        None => Ok(columns),
    }
}

/// What programs write where there is no number, such as for the deviation of a single measurement; in any case.
const UNKNOWN: [&str; 3] = ["", "nan", "na"];

fn is_unknown(cell: &str) -> bool {
    UNKNOWN.iter().any(|unknown| cell.eq_ignore_ascii_case(unknown))
}

fn row(
    line: usize,
    text: &str,
    rules: &[ColumnRule],
    columns: &[Column],
) -> Result<Vec<Option<f64>>, TableProblem> {
    let cells: Vec<&str> = text.split(',').map(str::trim).collect();
    if cells.len() != columns.len() {
        let message = format!("{} cells, but the header has {}", cells.len(), columns.len());
        return Err(whole(line, message));
    }
    let mut values = vec![None; rules.len()];
    for (index, (cell, column)) in cells.iter().zip(columns).enumerate() {
        let rule = &rules[column.rule];
        let wrong = |message: String| TableProblem {
            line,
            column: Some((index + 1, rule.name.to_owned())),
            message: format!("`{}`: {message}", crate::problem::shortened(cell)),
        };
        if !rule.required && is_unknown(cell) {
            continue;
        }
        // The unit stands in the header; a bare number is what is wanted.
        let number: f64 = cell.parse().map_err(|_| wrong("not a number".to_owned()))?;
        let value = units::parse(&format!("{number} {}", column.unit), rule.quantity)
            .map_err(|error| wrong(error.to_string()))?
            .si;
        if rule.positive && value <= 0.0 {
            return Err(wrong("must be above 0".to_owned()));
        }
        values[column.rule] = Some(value);
    }
    Ok(values)
}
