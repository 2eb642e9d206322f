//! Measured springback as a table: comma-separated, a header with units, one cutting speed per line.

use crate::columns::{self, ColumnRule, TableLine, TableProblem, column};
use sphcut_physics::Quantity;

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

const COLUMNS: [ColumnRule; 5] = [
    column("v_c", Quantity::Speed, "m/min", (true, true)),
    column("springback", Quantity::Length, "um", (true, false)),
    column("uncertainty", Quantity::Length, "um", (true, true)),
    column("F_c", Quantity::Force, "N", (false, false)),
    column("F_n", Quantity::Force, "N", (false, false)),
];

/// Reads a table with the columns `v_c`, `springback`, `uncertainty` and, if it has them, `F_c` and
/// `F_n`, in any order, each with its unit in brackets: `v_c [m/min]`. Empty lines and lines that begin
/// with `#` are skipped.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read_measured_springback(text: &str) -> Result<Vec<MeasuredSpringback>, TableProblem> {
    let lines = columns::read(text, &COLUMNS, "no measurement follows the header")?;
    let row = |line: TableLine| MeasuredSpringback {
        cutting_speed: line.required(0),
        springback: line.required(1),
        uncertainty: line.required(2),
        cutting_force: line.get(3),
        normal_force: line.get(4),
    };
    Ok(lines.into_iter().map(row).collect())
}

/// Forces measured at one cutting speed. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredForceRow {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// F_c in N.
    pub cutting_force: f64,
    /// F_n in N.
    pub normal_force: f64,
}

/// The same columns where forces are what is asked for.
const FORCE_COLUMNS: [ColumnRule; 5] = [
    column("v_c", Quantity::Speed, "m/min", (true, true)),
    column("F_c", Quantity::Force, "N", (true, true)),
    column("F_n", Quantity::Force, "N", (true, true)),
    column("springback", Quantity::Length, "um", (false, false)),
    column("uncertainty", Quantity::Length, "um", (false, true)),
];

/// Cutting speeds that differ by less are the same.
const SAME_SPEED: f64 = 0.01;

/// Reads the table of [`read_measured_springback`] for its forces: `v_c`, `F_c` and `F_n` have to be
/// there, `springback` and `uncertainty` may be.
///
/// # Errors
/// The first mistake with its line and column; a cutting speed that is there twice.
pub fn read_measured_forces(text: &str) -> Result<Vec<MeasuredForceRow>, TableProblem> {
    let mut rows: Vec<MeasuredForceRow> = Vec::new();
    for line in columns::read(text, &FORCE_COLUMNS, "no measurement follows the header")? {
        let row = MeasuredForceRow {
            cutting_speed: line.required(0),
            cutting_force: line.required(1),
            normal_force: line.required(2),
        };
        let same = |other: &MeasuredForceRow| {
            (other.cutting_speed - row.cutting_speed).abs() <= SAME_SPEED * row.cutting_speed
        };
        if rows.iter().any(same) {
            let message = "this cutting speed is there twice (speeds within 1 % are the same): \
                           give the mean of its measurements";
            return Err(line.problem(message));
        }
        rows.push(row);
    }
    Ok(rows)
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
    fn tables_of_programs_with_a_decimal_comma_are_read() {
        let text = "\u{feff}# 5\" insert, \"a\nv_c [m/min];springback [um];uncertainty [um]\r\n\r\n150;1,5;0,85\r\n\"300\";-0.1;0,85";
        let rows = read_measured_springback(text).unwrap();
        assert_eq!(
            (rows.len(), rows[0].springback, rows[1].springback),
            (2, 1.5 / 1e6, -0.1 / 1e6)
        );
        let tabs = text.replace(';', "\t");
        assert_eq!(read_measured_springback(&tabs).unwrap(), rows);
        for (wrong, expected) in [
            (
                text.replace("1,5", "1.001,5"),
                "line 4, column 2 `springback`: `1.001,5`: write it without a sign between thousands",
            ),
            (
                text.replace("0,85", "0,8,5"),
                "line 4, column 3 `uncertainty`: `0,8,5`: not a number",
            ),
            (
                text.replace(';', ","),
                "line 4: 5 cells, but the header has 3; where the decimal sign is a comma, part the cells by semicolons",
            ),
        ] {
            assert_eq!(read_measured_springback(&wrong).unwrap_err().to_string(), expected);
        }
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

    #[test]
    fn forces_are_read_from_the_same_table() {
        let text =
            "v_c [m/min],springback [um],uncertainty [um],F_c [N],F_n [kN]\n150,1.2,0.85,600,0.2\n";
        let rows = read_measured_forces(text).unwrap();
        let expected =
            MeasuredForceRow { cutting_speed: 2.5, cutting_force: 600.0, normal_force: 200.0 };
        assert_eq!(rows, [expected]);
        for (text, expected) in [
            ("v_c [m/min],F_c [N]\n150,600\n", "line 1: the column `F_n [N]` is missing"),
            ("v_c [m/min],F_c [N],F_n [N]\n150,600,0\n", "line 2, column 3 `F_n`: `0`: must be"),
            (
                "v_c [m/min],F_c [N],F_n [N]\n150,600,200\n\n150.5,600,200\n",
                "line 4: this cutting speed is there twice",
            ),
        ] {
            let message = read_measured_forces(text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }
}
