//! Measured springback as a table: comma-separated, a header with units, one cutting speed per line.

use crate::spelling::nearest;
use crate::units;
use sphcut_physics::Quantity;
use std::fmt;

/// One line of the table in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredSpringback {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// Springback in m.
    pub springback: f64,
    /// Half width of its uncertainty in m.
    pub uncertainty: f64,
    /// F_c in N, if the table has it.
    pub cutting_force: Option<f64>,
    /// F_n in N, if the table has it.
    pub normal_force: Option<f64>,
}

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

/// Name, quantity, an example of the unit, and whether the table must have it.
const COLUMNS: [(&str, Quantity, &str, bool); 5] = [
    ("v_c", Quantity::Speed, "m/min", true),
    ("springback", Quantity::Length, "um", true),
    ("uncertainty", Quantity::Length, "um", true),
    ("F_c", Quantity::Force, "N", false),
    ("F_n", Quantity::Force, "N", false),
];

/// A column of the file: which of [`COLUMNS`] it is, and the text of its unit.
struct Column {
    kind: usize,
    unit: String,
}

/// Reads a table with the columns `v_c`, `springback`, `uncertainty` and, if it has them, `F_c` and
/// `F_n`, in any order, each with its unit in brackets: `v_c [m/min]`. Empty lines and lines that begin
/// with `#` are skipped.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read_measured_springback(text: &str) -> Result<Vec<MeasuredSpringback>, TableProblem> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((number, line)) = lines.next() else {
        return Err(whole(1, "the table is empty"));
    };
    let columns = header(number, line)?;
    let rows: Vec<MeasuredSpringback> =
        lines.map(|(number, line)| row(number, line, &columns)).collect::<Result<_, _>>()?;
    if rows.is_empty() {
        return Err(whole(number, "no measurement follows the header"));
    }
    Ok(rows)
}

fn whole(line: usize, message: impl Into<String>) -> TableProblem {
    TableProblem { line, column: None, message: message.into() }
}

fn header(line: usize, text: &str) -> Result<Vec<Column>, TableProblem> {
    let mut columns: Vec<Column> = Vec::new();
    for (index, cell) in text.split(',').map(str::trim).enumerate() {
        let (name, rest) = cell.split_once('[').unwrap_or((cell, ""));
        let name = name.trim();
        let wrong = |message: String| TableProblem {
            line,
            column: Some((index + 1, name.to_owned())),
            message,
        };
        let Some(kind) = COLUMNS.iter().position(|column| column.0 == name) else {
            let known = COLUMNS.map(|column| column.0);
            let hint = nearest(name, known).map_or_else(
                || format!("there are {}", known.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            return Err(wrong(format!("no such column; {hint}")));
        };
        if columns.iter().any(|column| column.kind == kind) {
            return Err(wrong("the column is there twice".to_owned()));
        }
        let (_, quantity, example, _) = COLUMNS[kind];
        let unit = rest.strip_suffix(']').unwrap_or("").trim().to_owned();
        if unit.is_empty() {
            return Err(wrong(format!("the unit is missing: write `{name} [{example}]`")));
        }
        units::parse(&format!("1 {unit}"), quantity)
            .map_err(|error| wrong(format!("`{unit}`: {error}; for example `{example}`")))?;
        columns.push(Column { kind, unit });
    }
    let missing = COLUMNS
        .iter()
        .enumerate()
        .find(|(kind, column)| column.3 && !columns.iter().any(|found| found.kind == *kind));
    match missing {
        Some((_, (name, _, example, _))) => {
            Err(whole(line, format!("the column `{name} [{example}]` is missing")))
        }
        None => Ok(columns),
    }
}

fn row(line: usize, text: &str, columns: &[Column]) -> Result<MeasuredSpringback, TableProblem> {
    let cells: Vec<&str> = text.split(',').map(str::trim).collect();
    if cells.len() != columns.len() {
        let message = format!("{} cells, but the header has {}", cells.len(), columns.len());
        return Err(whole(line, message));
    }
    let mut values = [None; COLUMNS.len()];
    for (index, (cell, column)) in cells.iter().zip(columns).enumerate() {
        let (name, quantity, ..) = COLUMNS[column.kind];
        let wrong = |message: String| TableProblem {
            line,
            column: Some((index + 1, name.to_owned())),
            message: format!("`{cell}`: {message}"),
        };
        // The unit stands in the header; a bare number is what is wanted.
        let number: f64 = cell.parse().map_err(|_| wrong("not a number".to_owned()))?;
        let value = units::parse(&format!("{number} {}", column.unit), quantity)
            .map_err(|error| wrong(error.to_string()))?
            .si;
        let must_be_positive = matches!(name, "v_c" | "uncertainty");
        if must_be_positive && value <= 0.0 {
            return Err(wrong("must be above 0".to_owned()));
        }
        values[column.kind] = Some(value);
    }
    let [Some(cutting_speed), Some(springback), Some(uncertainty), cutting_force, normal_force] =
        values
    else {
        return Err(whole(line, "a needed column is missing"));
    };
    Ok(MeasuredSpringback { cutting_speed, springback, uncertainty, cutting_force, normal_force })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_the_header_are_read_in_any_order() {
        let text = "# turning\nspringback [um],v_c [m/min],uncertainty [nm],F_c [kN]\n\n1.5,150,850,0.2\n-0.1,300,850,0.3\n";
        let rows = read_measured_springback(text).unwrap();
        assert_eq!(rows.len(), 2);
        let expected = MeasuredSpringback {
            cutting_speed: 2.5,
            springback: 1.5e-6,
            uncertainty: 850e-9,
            cutting_force: Some(200.0),
            normal_force: None,
        };
        assert_eq!(rows[0], expected);
        assert_eq!(rows[1].springback, -0.1 / 1e6);
    }

    #[test]
    fn mistakes_are_told_with_line_and_column() {
        let good = "v_c [m/min],springback [um],uncertainty [um]\n";
        for (text, expected) in [
            (String::new(), "line 1: the table is empty"),
            (good.to_owned(), "line 1: no measurement follows the header"),
            (
                good.replace("springback", "spring_back"),
                "line 1, column 2 `spring_back`: no such column; did you mean `springback`?",
            ),
            (good.replace(" [um]", ""), "line 1, column 2 `springback`: the unit is missing"),
            (good.replace("[m/min]", "[mm]"), "line 1, column 1 `v_c`: `mm`: this is a length"),
            (
                good.replace("uncertainty [um]", "F_c [N]"),
                "line 1: the column `uncertainty [um]` is missing",
            ),
            (
                good.replace("uncertainty", "springback"),
                "line 1, column 3 `springback`: the column is there twice",
            ),
            (format!("{good}\n150,1.5\n"), "line 3: 2 cells, but the header has 3"),
            (
                format!("{good}150,1.5,0.85\n150,1.5 um,0.85\n"),
                "line 3, column 2 `springback`: `1.5 um`: not a number",
            ),
            (format!("{good}150,nan,0.85\n"), "line 2, column 2 `springback`: `nan`"),
            (format!("{good}0,1.5,0.85\n"), "line 2, column 1 `v_c`: `0`: must be above 0"),
            (
                format!("{good}150,1.5,-1\n"),
                "line 2, column 3 `uncertainty`: `-1`: must be above 0",
            ),
        ] {
            let message = read_measured_springback(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }
}
