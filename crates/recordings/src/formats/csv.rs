//! Text with separated columns.

use super::{FormatError, at, quoted};
use crate::{RawColumn, RawTable};

/// What stands between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Separator {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// Tabulator.
    Tab,
    /// Blanks, any number.
    Space,
}

/// What stands before the decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DecimalMark {
    /// `.`
    #[default]
    Point,
    /// `,`
    Comma,
}

/// How a text is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CsvLayout {
    /// Between cells.
    pub separator: Separator,
    /// Before decimals.
    pub decimal: DecimalMark,
    /// Line of the column names, from 1; numbers begin `skip` lines below it.
    pub header: usize,
    /// Lines between the names and the numbers, such as one of units.
    pub skip: usize,
}

impl Default for CsvLayout {
    fn default() -> Self {
        Self { separator: Separator::Comma, decimal: DecimalMark::Point, header: 1, skip: 0 }
    }
}

/// Words that measuring programs write where a number is missing.
const MISSING: [&str; 6] = ["", "nan", "-nan", "null", "na", "n/a"];

/// Reads the columns of `text`. Names are those of the header without quotes. A cell that is empty or
/// says that the number is missing is not a number; a text that is no number at all is an error, and so
/// is a line with another number of cells.
///
/// # Errors
/// The first line that does not fit.
pub fn read_csv(text: &str, layout: CsvLayout) -> Result<RawTable, FormatError> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim_end_matches('\r')));
    let header = layout.header.max(1);
    let Some((_, names)) = lines.by_ref().find(|(number, _)| *number == header) else {
        return Err(at(header, "the file ends before its header"));
    };
    let mut columns: Vec<RawColumn> = split(names, layout.separator)
        .map(|name| RawColumn {
            name: name.trim().trim_matches('"').trim().to_owned(),
            ..RawColumn::default()
        })
        .collect();
    for (number, line) in lines.skip(layout.skip) {
        if line.trim().is_empty() {
            continue;
        }
        let cells = split(line, layout.separator).count();
        if cells != columns.len() {
            let message = format!("{cells} cells, but the header has {}", columns.len());
            return Err(at(number, message));
        }
        for (column, cell) in columns.iter_mut().zip(split(line, layout.separator)) {
            let value = number_of(cell, layout.decimal).ok_or_else(|| {
                let (name, cell) = (quoted(&column.name), quoted(cell.trim()));
                at(number, format!("column `{name}`: `{cell}` is not a number"))
            })?;
            column.values.push(value);
        }
    }
    Ok(RawTable { columns })
}

fn split(line: &str, separator: Separator) -> Box<dyn Iterator<Item = &str> + '_> {
    match separator {
        Separator::Comma => Box::new(line.split(',')),
        Separator::Semicolon => Box::new(line.split(';')),
        Separator::Tab => Box::new(line.split('\t')),
        Separator::Space => Box::new(line.split_whitespace()),
    }
}

/// A cell as a number; not a number for a missing one; `None` for anything else.
pub(super) fn number_of(cell: &str, decimal: DecimalMark) -> Option<f64> {
    let cell = cell.trim().trim_matches('"').trim();
    if MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word)) {
        return Some(f64::NAN);
    }
    match decimal {
        DecimalMark::Point => cell.parse().ok(),
        // A point would be a thousands' mark: not guessed.
        DecimalMark::Comma if cell.contains('.') => None,
        DecimalMark::Comma => cell.replace(',', ".").parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layout_of_a_german_program_is_read() {
        let text = "Messung 12\r\nt;\"Fx\";Fy\r\ns;N;N\r\n0,0;1,5;-2e1\r\n0,1;;nan\r\n\r\n";
        let layout = CsvLayout {
            separator: Separator::Semicolon,
            decimal: DecimalMark::Comma,
            header: 2,
            skip: 1,
        };
        let table = read_csv(text, layout).unwrap();
        assert_eq!(table.columns.len(), 3);
        assert_eq!(table.columns[1].name, "Fx");
        assert_eq!(table.columns[0].values, [0.0, 0.1]);
        assert_eq!(table.columns[2].values[0], -20.0);
        assert!(table.columns[1].values[1].is_nan() && table.columns[2].values[1].is_nan());
    }

    #[test]
    fn what_does_not_fit_is_told_with_its_line() {
        let read = |text| read_csv(text, CsvLayout::default()).unwrap_err().to_string();
        assert_eq!(read(""), "line 1: the file ends before its header");
        assert_eq!(read("a,b\n1,2\n1\n"), "line 3: 1 cells, but the header has 2");
        assert_eq!(read("a,b\n1,x y\n"), "line 2: column `b`: `x y` is not a number");
        let comma = CsvLayout { decimal: DecimalMark::Comma, ..CsvLayout::default() };
        assert!(read_csv("a\n1.000,5\n", comma).is_err());
    }
}
