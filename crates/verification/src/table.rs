//! A small table of named columns read from comma-separated text.

use crate::error::CaseError;
use std::fs;
use std::path::Path;

/// Columns of text cells; lines that begin with `#` are comments.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReferenceTable {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl ReferenceTable {
    /// Reads the table at `path`.
    ///
    /// # Errors
    /// An unreadable file, no header, a row with another number of cells than the header.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let text = fs::read_to_string(path).map_err(|error| CaseError::unreadable(path, &error))?;
        Self::parse(&text).map_err(|reason| CaseError::invalid(path, reason))
    }

    /// Reads a table from text.
    ///
    /// # Errors
    /// No header; a row with another number of cells than the header.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
        let cells = |line: &str| line.split(',').map(|cell| cell.trim().to_owned()).collect();
        let (_, header) = lines.next().ok_or("the table has no header line")?;
        let columns: Vec<String> = cells(header);
        let mut rows = Vec::new();
        for (index, line) in lines {
            let row: Vec<String> = cells(line);
            if row.len() != columns.len() {
                let (found, expected) = (row.len(), columns.len());
                return Err(format!("line {}: {found} cells instead of {expected}", index + 1));
            }
            rows.push(row);
        }
        Ok(Self { columns, rows })
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether the table has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The cells of column `name`, top to bottom.
    ///
    /// # Errors
    /// No such column.
    pub fn texts(&self, name: &str) -> Result<Vec<&str>, String> {
        let column = self.column(name)?;
        Ok(self.rows.iter().map(|row| row[column].as_str()).collect())
    }

    /// The numbers of column `name`, top to bottom.
    ///
    /// # Errors
    /// No such column; a cell that is not a number.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        let column = self.column(name)?;
        self.rows.iter().map(|row| number(&row[column], name)).collect()
    }

    /// The number in column `name` of the row whose cell in column `key_column` is `key`.
    ///
    /// # Errors
    /// No such row or column; not a number.
    pub fn lookup(&self, key_column: &str, key: &str, name: &str) -> Result<f64, String> {
        let (key_index, index) = (self.column(key_column)?, self.column(name)?);
        let row = self.rows.iter().find(|row| row[key_index] == key);
        let row = row.ok_or_else(|| format!("no row with {key_column} = {key}"))?;
        number(&row[index], name)
    }

    fn column(&self, name: &str) -> Result<usize, String> {
        self.columns
            .iter()
            .position(|column| column == name)
            .ok_or_else(|| format!("no column `{name}`; there are: {}", self.columns.join(", ")))
    }
}

fn number(cell: &str, column: &str) -> Result<f64, String> {
    cell.parse().map_err(|_| format!("`{cell}` in column `{column}` is not a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_columns_and_looks_up_rows() {
        let table = ReferenceTable::parse("# comment\nrun,force\nslow, 1.5\n\nfast,2e3\n").unwrap();
        assert_eq!(table.len(), 2);
        assert_eq!(table.numbers("force").unwrap(), [1.5, 2000.0]);
        assert_eq!(table.lookup("run", "fast", "force").unwrap(), 2000.0);
        assert!(table.lookup("run", "none", "force").is_err());
        assert!(table.numbers("run").is_err());
    }

    #[test]
    fn a_short_row_is_an_error_with_its_line() {
        assert!(ReferenceTable::parse("a,b\n1,2\n3\n").unwrap_err().contains("line 3"));
        assert!(ReferenceTable::parse("# nothing\n").is_err());
    }
}
