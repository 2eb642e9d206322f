//! Forces over cutting conditions as a table: comma-separated, a header with units, a condition per line.

use crate::columns::{self, ColumnRule, TableProblem, column, text_column};
use sphcut_physics::Quantity;

/// One line of the table in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTableRow {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// F_c in N.
    pub cutting_force: f64,
    /// F_f in N.
    pub feed_force: f64,
    /// Standard deviation of F_c between the measurements of which the line is the mean, in N.
    pub cutting_force_deviation: Option<f64>,
    /// The same of F_f.
    pub feed_force_deviation: Option<f64>,
    /// Number of these measurements.
    pub count: Option<f64>,
    /// b in m.
    pub width_of_cut: Option<f64>,
    /// Of the workpiece.
    pub material: Option<String>,
    /// Its name.
    pub tool: Option<String>,
}

/// What is used, then what tables of `sphcut recordings` and `sphcut sweep` have beside it.
const COLUMNS: [ColumnRule; 21] = [
    column("v_c", Quantity::Speed, "m/min", (true, true)),
    column("h", Quantity::Length, "mm", (true, true)),
    column("F_c", Quantity::Force, "N", (true, false)),
    column("F_f", Quantity::Force, "N", (true, false)),
    column("F_c_sd", Quantity::Force, "N", (false, false)),
    column("F_f_sd", Quantity::Force, "N", (false, false)),
    column("n", Quantity::Dimensionless, "", (false, true)),
    column("b", Quantity::Length, "mm", (false, true)),
    column("F_p", Quantity::Force, "N", (false, false)),
    column("F_p_sd", Quantity::Force, "N", (false, false)),
    column("order", Quantity::Dimensionless, "", (false, false)),
    column("time", Quantity::Time, "s", (false, false)),
    column("F_c_ci95", Quantity::Force, "N", (false, false)),
    column("F_f_ci95", Quantity::Force, "N", (false, false)),
    column("F_p_ci95", Quantity::Force, "N", (false, false)),
    column("chip_thickness", Quantity::Length, "mm", (false, false)),
    column("contact_length", Quantity::Length, "mm", (false, false)),
    column("T_interface", Quantity::Temperature, "degC", (false, false)),
    column("T_interface_ci95", Quantity::TemperatureDifference, "K", (false, false)),
    text_column("material"),
    text_column("tool"),
];

/// Reads a table with the columns `v_c`, `h`, `F_c` and `F_f` and, if it has them, `F_c_sd`, `F_f_sd` (standard
/// deviations), `n`, `b` and the names of `material` and `tool`, in any order, each with its unit in brackets: `v_c [m/min]`. What tables of `sphcut recordings` and `sphcut sweep` have
/// besides is read over. A condition may be there more than once. Empty lines and lines that
/// begin with `#` are skipped.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read_force_table(text: &str) -> Result<Vec<ForceTableRow>, TableProblem> {
    columns::read(text, &COLUMNS, "no line with forces follows the header")?
        .into_iter()
        .map(|line| {
            let row = ForceTableRow {
                cutting_speed: line.required(0),
                uncut_chip_thickness: line.required(1),
                cutting_force: line.required(2),
                feed_force: line.required(3),
                cutting_force_deviation: line.get(4),
                feed_force_deviation: line.get(5),
                count: line.get(6),
                width_of_cut: line.get(7),
                material: line.text(19).map(str::to_owned),
                tool: line.text(20).map(str::to_owned),
            };
            let deviations = [row.cutting_force_deviation, row.feed_force_deviation];
            if deviations.into_iter().flatten().any(|deviation| deviation < 0.0) {
                return Err(line.problem("a standard deviation is never below 0"));
            }
            Ok(row)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_any_order_and_what_may_be_missing() {
        let text = "h [um],F_f [kN],v_c [m/s],F_c [N],n,F_c_sd [N]\n100,0.1,2.5,600,3,4\n60,0.05,2.5,400,1,\n";
        let rows = read_force_table(text).unwrap();
        let expected = ForceTableRow {
            cutting_speed: 2.5,
            uncut_chip_thickness: 100e-6,
            cutting_force: 600.0,
            feed_force: 100.0,
            cutting_force_deviation: Some(4.0),
            feed_force_deviation: None,
            count: Some(3.0),
            width_of_cut: None,
            material: None,
            tool: None,
        };
        assert_eq!(rows[0], expected);
        assert_eq!((rows[1].cutting_force_deviation, rows[1].count), (None, Some(1.0)));
        let recorded = "v_c [m/min],h [mm],b [mm],F_c [N],F_f [N],F_p [N],F_c_sd [N],F_f_sd [N],F_p_sd [N],n,order,\
                        time [s]\n150,0.1,3,600,200,10,4,3,1,5,2,12.5\n";
        assert_eq!(read_force_table(recorded).unwrap()[0].feed_force_deviation, Some(3.0));
        let named = "v_c [m/min],h [mm],F_c [N],F_f [N],material,tool,b [mm]\n150,0.1,600,200,\"C45, normalised\",,3\n";
        let row = &read_force_table(named).unwrap()[0];
        assert_eq!(row.material.as_deref(), Some("C45, normalised"));
        assert_eq!((row.tool.as_deref(), row.width_of_cut), (None, Some(3e-3)));
    }

    #[test]
    fn the_deviation_of_a_single_measurement_may_be_nan_and_is_then_unknown() {
        let head = "v_c [m/min],h [mm],F_c [N],F_f [N],F_c_sd [N],F_f_sd [N],n\n";
        for unknown in ["", "nan", "NaN", "NA"] {
            let rows = read_force_table(&format!("{head}150,0.1,600,200,{unknown},3,1\n")).unwrap();
            assert_eq!(rows[0].cutting_force_deviation, None, "{unknown}");
            assert_eq!(rows[0].feed_force_deviation, Some(3.0));
        }
        for (cell, expected) in [("inf", "`inf`"), ("-", "not a number"), ("none", "not a number")]
        {
            let error =
                read_force_table(&format!("{head}150,0.1,600,200,{cell},3,1\n")).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
        }
    }

    #[test]
    fn mistakes_are_told_with_line_and_column() {
        let good = "v_c [m/min],h [mm],F_c [N],F_f [N]\n";
        for (text, expected) in [
            (String::new(), "line 1: the table is empty"),
            (good.to_owned(), "line 1: no line with forces follows the header"),
            (good.replace("F_f [N]", "n"), "line 1: the column `F_f [N]` is missing"),
            (good.replace("[mm]", "[N]"), "line 1, column 2 `h`: `N`: this is a force"),
            (
                good.replace(" [mm]", ""),
                "line 1, column 2 `h`: the unit is missing: write `h [mm]`",
            ),
            (
                good.replace("F_c [N]", "F_c [N/mm]"),
                "line 1, column 3 `F_c`: `N/mm`: this is a force per width; multiply the values by the width of cut",
            ),
            (
                good.replace("h [mm]", "F_t_sd [N]"),
                "line 1, column 2 `F_t_sd`: no such column; there are",
            ),
            (
                good.replace("h [mm]", "F_c_std [N]"),
                "line 1, column 2 `F_c_std`: no such column; did you mean `F_c_sd`?",
            ),
            (good.replace("h [mm]", "Fc [N]"), "line 1, column 3 `F_c`: the column is there twice"),
            (format!("{good}150,0.1,nan,5\n"), "line 2, column 3 `F_c`: `nan`"),
            (format!("{good}150,0.1,inf,5\n"), "line 2, column 3 `F_c`: `inf`"),
            (format!("{good}150,0.1,,5\n"), "line 2, column 3 `F_c`: ``: not a number"),
            (format!("{good}150,0,1,5\n"), "line 2, column 2 `h`: `0`: must be above 0"),
            (format!("{good}150;0.1;1;5\n"), "line 2: 1 cells, but the header has 4"),
            (
                format!("{},F_c_sd [N]\n150,0.1,1,5,-2\n", good.trim_end()),
                "line 2: a standard deviation is never below 0",
            ),
        ] {
            let message = read_force_table(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }

    #[test]
    fn a_million_lines_are_read() {
        let mut text = "v_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
        for k in 0..1_000_000 {
            let (speed, thickness) = (100 + 10 * (k % 11), 6 + k / 11 % 10);
            text += &format!("{speed},0.{thickness:02},{}.5,200\n", 500 + k % 7);
        }
        assert_eq!(read_force_table(&text).unwrap().len(), 1_000_000);
    }
}
