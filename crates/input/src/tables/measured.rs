//! Measured springback as a table: comma-separated, a header with units, one cutting speed per line.

use crate::columns::{self, ColumnRule, TableLine, TableProblem, column, text_column};
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
    /// F_n in N, in a plane cut F_f.
    pub normal_force: f64,
    /// h in m, if the table has it.
    pub uncut_chip_thickness: Option<f64>,
    /// b in m, if the table has it.
    pub width_of_cut: Option<f64>,
}

/// Columns where forces are what is asked for, then what tables of springback and of `sphcut recordings` have besides.
const FORCE_COLUMNS: [ColumnRule; 17] = [
    column("v_c", Quantity::Speed, "m/min", (true, true)),
    column("F_c", Quantity::Force, "N", (true, true)),
    column("F_n", Quantity::Force, "N", (false, true)),
    column("F_f", Quantity::Force, "N", (false, true)),
    column("h", Quantity::Length, "mm", (false, true)),
    column("b", Quantity::Length, "mm", (false, true)),
    column("springback", Quantity::Length, "um", (false, false)),
    column("uncertainty", Quantity::Length, "um", (false, true)),
    column("F_p", Quantity::Force, "N", (false, false)),
    column("F_c_sd", Quantity::Force, "N", (false, false)),
    column("F_f_sd", Quantity::Force, "N", (false, false)),
    column("F_p_sd", Quantity::Force, "N", (false, false)),
    column("n", Quantity::Dimensionless, "", (false, true)),
    column("order", Quantity::Dimensionless, "", (false, false)),
    column("time", Quantity::Time, "s", (false, false)),
    text_column("material"),
    text_column("tool"),
];

/// Cutting speeds that differ by less are the same, and likewise thicknesses.
const SAME: f64 = 0.01;

/// Reads `v_c`, `F_c` and `F_n` or, as it is called in a plane cut, `F_f`; `h` and `b` if they are there. What tables of springback and of
/// recordings have besides is read over. With a `thickness` in m, the lines of other thicknesses are left out.
///
/// # Errors
/// The first mistake with its line and column; a cutting speed that is there twice.
pub fn read_measured_forces(
    text: &str,
    thickness: Option<f64>,
) -> Result<Vec<MeasuredForceRow>, TableProblem> {
    let mut rows: Vec<MeasuredForceRow> = Vec::new();
    for line in columns::read(text, &FORCE_COLUMNS, "no measurement follows the header")? {
        let normal = match (line.get(2), line.get(3)) {
            (Some(_), Some(_)) => return Err(line.problem("it has `F_n` and `F_f`: leave out one")),
            (normal, feed) => normal.or(feed),
        };
        let row = MeasuredForceRow {
            cutting_speed: line.required(0),
            cutting_force: line.required(1),
            normal_force: normal.ok_or_else(|| line.problem("`F_n` or `F_f` is missing"))?,
            uncut_chip_thickness: line.get(4),
            width_of_cut: line.get(5),
        };
        if let (Some(own), Some(wanted)) = (row.uncut_chip_thickness, thickness)
            && (own - wanted).abs() > SAME * wanted
        {
            continue;
        }
        let same = |other: &MeasuredForceRow| {
            (other.cutting_speed - row.cutting_speed).abs() <= SAME * row.cutting_speed
        };
        if rows.iter().any(same) {
            let message = "this cutting speed is there twice (speeds within 1 % are the same): \
                           give the mean of its measurements";
            return Err(line.problem(message));
        }
        rows.push(row);
    }
    match thickness {
        Some(wanted) if rows.is_empty() => {
            let message = format!("no line has the h of the scenario, {:.4} mm", wanted * 1e3);
            Err(columns::whole(1, message))
        }
        _ => Ok(rows),
    }
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
                good.replace("springback", "sprigback"),
                "line 1, column 2 `sprigback`: no such column; did you mean `springback`?",
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
        let rows = read_measured_forces(text, None).unwrap();
        let expected = MeasuredForceRow {
            cutting_speed: 2.5,
            cutting_force: 600.0,
            normal_force: 200.0,
            uncut_chip_thickness: None,
            width_of_cut: None,
        };
        assert_eq!(rows, [expected]);
        let recorded = "v_c [m/min],h [mm],b [mm],F_c [N],F_f [N],F_p [N],F_c_sd [N],F_f_sd [N],F_p_sd [N],n,order,\
                        time [s]\n150,0.1,3,600,200,10,4,3,1,5,2,12.5\n";
        let two = format!("{recorded}150,0.2,3,900,300,10,4,3,1,5,2,12.5\n");
        let found = read_measured_forces(&two, Some(1e-4)).unwrap();
        let expected = MeasuredForceRow {
            uncut_chip_thickness: Some(1e-4),
            width_of_cut: Some(3e-3),
            ..expected
        };
        assert_eq!(found, [expected]);
        let error = read_measured_forces(recorded, Some(3e-4)).unwrap_err().to_string();
        assert_eq!(error, "line 1: no line has the h of the scenario, 0.3000 mm");
        for (text, expected) in [
            ("v_c [m/min],F_c [N]\n150,600\n", "line 2: `F_n` or `F_f` is missing"),
            (
                "v_c [m/min],F_c [N],F_n [N],F_f [N]\n150,600,200,200\n",
                "line 2: it has `F_n` and `F_f`",
            ),
            ("v_c [m/min],F_c [N],F_n [N]\n150,600,0\n", "line 2, column 3 `F_n`: `0`: must be"),
            (
                "v_c [m/min],F_c [N],F_n [N]\n150,600,200\n\n150.5,600,200\n",
                "line 4: this cutting speed is there twice",
            ),
        ] {
            let message = read_measured_forces(text, None).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }
}
