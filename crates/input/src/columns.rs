//! Tables with a header that names columns and their units. Cells are parted by commas, or, as Excel writes them where the decimal
//! sign is a comma, by semicolons or tabs; cells in quotes may hold any of them.

use crate::spelling::nearest;
use crate::units;
use csv::{ReaderBuilder, StringRecord, Trim};
use sphcut_physics::{Quantity, csv::meant};
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
    /// What it measures; `None` of a text.
    pub quantity: Option<Quantity>,
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
    ColumnRule { name, quantity: Some(quantity), unit, required, positive }
}

/// The rule of a column of texts that a table may have.
#[must_use]
pub const fn text_column(name: &'static str) -> ColumnRule {
    ColumnRule { name, quantity: None, unit: "", required: false, positive: false }
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
    /// Of the rules of texts, in their order; none where the table has no such column.
    texts: Vec<(usize, String)>,
}

impl TableLine {
    /// The text in the column of the rule `index`, if there is one.
    #[must_use]
    pub fn text(&self, index: usize) -> Option<&str> {
        self.texts.iter().find(|(rule, _)| *rule == index).map(|(_, text)| text.as_str())
    }

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
    let text = text.trim_start_matches('\u{feff}');
    let delimiter = delimiter(text);
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .comment(Some(b'#'))
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text.as_bytes());
    let mut columns = None;
    let (mut rows, mut head) = (Vec::new(), 1);
    // The reader counts from the empty lines before a record: where it ends is what tells its line.
    let (mut number, mut counted) = (1, 0);
    let mut cells = StringRecord::new();
    while reader.read_record(&mut cells).map_err(|error| whole(1, error.to_string()))? {
        let read = &text[..reader.position().byte() as usize];
        let end = read.trim_end_matches(['\r', '\n']).len();
        number += read[counted..end].matches('\n').count();
        counted = end;
        if cells.iter().all(str::is_empty) || cells[0].starts_with('#') {
            continue;
        }
        let Some(columns) = &columns else {
            (columns, head) = (Some(header(number, &cells, rules)?), number);
            continue;
        };
        rows.push(row(number, &cells, rules, columns, delimiter)?);
    }
    match columns {
        None => Err(whole(1, "the table is empty")),
        Some(_) if rows.is_empty() => Err(whole(head, nothing)),
        Some(_) => Ok(rows),
    }
}

/// What parts the cells: the first of semicolon and tab that the header has, else a comma.
fn delimiter(text: &str) -> u8 {
    let head = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let has = |sign: &&u8| head.is_some_and(|line| line.as_bytes().contains(sign));
    b";\t".iter().find(has).copied().unwrap_or(b',')
}

/// A mistake of a whole line.
pub fn whole(line: usize, message: impl Into<String>) -> TableProblem {
    TableProblem { line, column: None, message: message.into() }
}

fn header(
    line: usize,
    cells: &StringRecord,
    rules: &[ColumnRule],
) -> Result<Vec<Column>, TableProblem> {
    let mut columns: Vec<Column> = Vec::new();
    for (index, cell) in cells.iter().enumerate() {
        let (name, rest) = cell.split_once('[').unwrap_or((cell, ""));
        let name = crate::problem::shortened(name.trim());
        let wrong = |message: String| TableProblem {
            line,
            column: Some((index + 1, name.clone())),
            message,
        };
        let exact = rules.iter().position(|rule| rule.name == name);
        // `Fc`, `FC` and `F-c` are `F_c` to everybody.
        let alike = || rules.iter().position(|rule| plain(rule.name) == plain(&name));
        let Some(found) = exact.or_else(alike) else {
            let known: Vec<&'static str> = rules.iter().map(|rule| rule.name).collect();
            let hint = meant_column(&name, rules).map_or_else(
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
        if let Some(quantity) = rule.quantity {
            let one = format!("1 {unit}");
            let is_per_width =
                quantity == Quantity::Force && units::parse(&one, Quantity::ForcePerWidth).is_ok();
            let hint = if is_per_width {
                "multiply the values by the width of cut and write `N`".to_owned()
            } else {
                format!("for example `{}`", rule.unit)
            };
            units::parse(&one, quantity)
                .map_err(|error| wrong(format!("`{unit}`: {error}; {hint}")))?;
        }
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
    cells: &StringRecord,
    rules: &[ColumnRule],
    columns: &[Column],
    delimiter: u8,
) -> Result<TableLine, TableProblem> {
    if cells.len() != columns.len() {
        let hint = if delimiter == b',' && cells.len() > columns.len() {
            "; where the decimal sign is a comma, part the cells by semicolons"
        } else {
            ""
        };
        let message = format!("{} cells, but the header has {}{hint}", cells.len(), columns.len());
        return Err(whole(line, message));
    }
    let mut found = TableLine { number: line, values: vec![None; rules.len()], texts: Vec::new() };
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
        let Some(quantity) = rule.quantity else {
            if cell.is_empty() {
                return Err(wrong("a name is needed".to_owned()));
            }
            found.texts.push((column.rule, meant(cell).to_owned()));
            continue;
        };
        let has_decimal_comma = delimiter != b',' && cell.matches(',').count() == 1;
        if has_decimal_comma && cell.contains('.') {
            return Err(wrong("write it without a sign between thousands".to_owned()));
        }
        let digits = if has_decimal_comma { &cell.replace(',', ".") } else { cell };
        // The unit stands in the header; a bare number is what is wanted.
        let number: f64 = digits.parse().map_err(|_| wrong("not a number".to_owned()))?;
        let value = units::parse(&format!("{number} {}", column.unit), quantity)
            .map_err(|error| wrong(error.to_string()))?
            .si;
        if rule.positive && value <= 0.0 {
            return Err(wrong("must be above 0".to_owned()));
        }
        found.values[column.rule] = Some(value);
    }
    Ok(found)
}

/// Without case, `_`, `-` and blanks.
fn plain(name: &str) -> String {
    name.to_lowercase().replace(['_', '-', ' '], "")
}

/// The column that a name is a misspelling of: never one of another quantity, which `F_t` would be for `F_c`. Of a symbol and of what
/// begins with one (`F_t_sd`) letter and index have to agree; a bare symbol is none.
fn meant_column(name: &str, rules: &[ColumnRule]) -> Option<&'static str> {
    let is_symbol = |name: &str| plain(name).len() <= 3;
    let known = rules.iter().map(|rule| rule.name);
    if is_symbol(name) {
        return None;
    }
    let symbol = |name: &str| plain(name).chars().take(2).collect::<String>();
    let begins_with_symbol = |name: &str| name.chars().nth(1) == Some('_');
    let fits = |known: &&str| {
        !begins_with_symbol(name) && !begins_with_symbol(known) || symbol(known) == symbol(name)
    };
    nearest(name, known.filter(|known| !is_symbol(known)).filter(fits))
}
