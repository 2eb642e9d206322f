//! Forces of tools over their time in cut as a table: comma-separated, a header with units, a segment per line.

use crate::columns::{self, ColumnRule, TableLine, TableProblem, column, text_column};
use sphcut_physics::Quantity;

/// One segment in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesRow {
    /// Name or number of the tool.
    pub tool: String,
    /// Time in cut in s.
    pub time: f64,
    /// F_c, F_f and F_p in N.
    pub forces: [f64; 3],
    /// VB in m, where it was read.
    pub land: Option<f64>,
}

const COLUMNS: [ColumnRule; 6] = [
    ColumnRule { required: true, ..text_column("tool") },
    column("time", Quantity::Time, "s", (true, false)),
    column("F_c", Quantity::Force, "N", (true, true)),
    column("F_f", Quantity::Force, "N", (true, true)),
    column("F_p", Quantity::Force, "N", (true, true)),
    column("VB", Quantity::Length, "um", (false, false)),
];

/// Reads a table with the columns `tool,time [s],F_c [N],F_f [N],F_p [N]` in any order and units, and `VB [um]`, whose cells may be empty.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read_series_table(text: &str) -> Result<Vec<SeriesRow>, TableProblem> {
    let lines = columns::read(text, &COLUMNS, "no segment follows the header")?;
    let row = |line: TableLine| {
        let tool = line.text(0).unwrap_or_default().to_owned();
        let [time, forces @ ..] = [1, 2, 3, 4].map(|rule| line.required(rule));
        SeriesRow { tool, time, forces, land: line.get(5) }
    };
    let below = lines.iter().find(|line| line.get(5).is_some_and(|land| land < 0.0));
    if let Some(line) = below {
        return Err(line.problem("a wear land is never below 0"));
    }
    Ok(lines.into_iter().map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_any_order() {
        let rows =
            read_series_table("time [min],tool,F_f [N],F_c [kN],F_p [N]\n0.5,A,300,0.5,100\n")
                .unwrap();
        let tool = "A".to_owned();
        assert_eq!(
            rows,
            [SeriesRow { tool, time: 30.0, forces: [500.0, 300.0, 100.0], land: None }]
        );
        let read = "tool,time [s],F_c [N],F_f [N],F_p [N],VB [um]\nA,0,5,5,5,\nA,1,5,5,5,120\n";
        let lands = read_series_table(read).unwrap().into_iter().map(|row| row.land);
        assert_eq!(lands.collect::<Vec<_>>(), [None, Some(120e-6)]);
        let message = read_series_table(&read.replace("120", "-1")).unwrap_err().to_string();
        assert!(message.contains("line 3: a wear land is never below 0"), "{message}");
    }

    #[test]
    fn mistakes_are_told_with_line_and_column() {
        let good = "tool,time [s],F_c [N],F_f [N],F_p [N]\n";
        for (text, expected) in [
            (good.to_owned(), "line 1: no segment follows the header"),
            (good.replace(",F_p [N]", ""), "line 1: the column `F_p [N]` is missing"),
            (format!("{good}1,0,5,5,-5\n"), "line 2, column 5 `F_p`: `-5`: must be above 0"),
            (format!("{good},0,5,5,5\n"), "line 2, column 1 `tool`: ``: a name is needed"),
            (format!("{good}1,0,5,5\n"), "line 2: 4 cells, but the header has 5"),
            (format!("{good}1,,5,5,5\n"), "line 2, column 2 `time`: ``: not a number"),
        ] {
            let message = read_series_table(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }
}
