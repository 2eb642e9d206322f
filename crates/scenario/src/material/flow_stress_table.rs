//! The file of a tabulated flow stress.

use sphcut_input::columns::{self, ColumnRule, TableProblem, column};
use sphcut_input::files::{Surroundings, file_mistake};
use sphcut_input::findings::Findings;
use sphcut_input::record::Record;
use sphcut_input::units::significant;
use sphcut_physics::Quantity;
use sphcut_physics::flow_stress::{FlowStressTable, FlowStressTableError};
use std::sync::Arc;

/// Largest file in bytes.
const LARGEST_TABLE: u64 = 1 << 20;
/// Most lines of a table.
const MOST_LINES: usize = 10_000;

const COLUMNS: [ColumnRule; 4] = [
    column("plastic_strain", Quantity::Dimensionless, "", (true, false)),
    column("strain_rate", Quantity::Rate, "1/s", (true, true)),
    column("temperature", Quantity::Temperature, "degC", (true, true)),
    column("flow_stress", Quantity::Stress, "MPa", (true, true)),
];

/// The table that `table_file` of a law names, if it names one that can be used.
pub(crate) fn named(
    findings: &mut Findings,
    record: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Arc<FlowStressTable>> {
    let path = record.text("table_file")?;
    let table = surroundings.read(path, LARGEST_TABLE).and_then(|text| {
        read(&text).map_err(|problem| file_mistake(path, problem.to_string(), ""))
    });
    let table = findings.accept(record, "table_file", table)?;
    findings.resolved(&record.section, "table_file", told(&table));
    Some(Arc::new(table))
}

/// Reads a table of flow stress over strain, rate and temperature.
///
/// # Errors
/// The first mistake with its line.
fn read(text: &str) -> Result<FlowStressTable, TableProblem> {
    let lines = columns::read(text, &COLUMNS, "no value follows the header")?;
    if lines.len() > MOST_LINES {
        let message = format!("more than the {MOST_LINES} values that a table may have");
        return Err(lines[MOST_LINES].problem(message));
    }
    let points: Vec<[f64; 4]> = lines.iter().map(|line| line.all()).collect();
    FlowStressTable::new(&points).map_err(|error| {
        let line = match error {
            FlowStressTableError::NotPositive(index) | FlowStressTableError::Twice(index) => {
                lines[index].number
            }
            FlowStressTableError::Empty | FlowStressTableError::Gap(..) => {
                lines.last().map_or(1, |line| line.number)
            }
        };
        columns::whole(line, error.to_string())
    })
}

/// The values of a table as text, in SI units: strain, rate, temperature, flow stress.
fn told(table: &FlowStressTable) -> String {
    let points: Vec<String> =
        table.points().map(|point| point.map(significant).join(" ")).collect();
    points.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "flow_stress [MPa],plastic_strain,strain_rate [1/s],temperature [degC]\n";

    #[test]
    fn a_table_is_read_in_its_units() {
        let table = read(&format!("# tests\n{HEADER}400,0,1,20\n\n600,0.5,1,20\n")).unwrap();
        assert_eq!(table.size(), [2, 1, 1]);
        assert_eq!(told(&table), "0 1 293.15 4e8, 0.5 1 293.15 6e8");
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        for (text, expected) in [
            (HEADER.to_owned(), "line 1: no value follows the header"),
            (
                HEADER.replace("[MPa]", "[K]"),
                "line 1, column 1 `flow_stress`: `K`: this is a temperature; for example `MPa`",
            ),
            (format!("{HEADER}400,0,1,20\n400,0,1,20\n"), "line 3: this strain"),
            (format!("{HEADER}400,-1,1,20\n"), "line 2: rate, temperature and flow stress must be"),
            (format!("{HEADER}0,0,1,20\n"), "line 2, column 1 `flow_stress`: `0`: must be above 0"),
            (
                format!("{HEADER}400,0,1,20\n300,0,1,500\n600,0.5,1,20\n"),
                "line 4: the table is no full grid: it has nothing at strain 0.5, rate 1 1/s and \
                 773.15 K",
            ),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }
}
