//! What was measured of many cuts as a table: comma-separated, a header with units, a cut per line.

use crate::columns::{self, ColumnRule, TableLine, TableProblem, column, text_column};
use sphcut_physics::{Channel, CuttingCondition, Quantity, ToolGeometry};

/// How many channels a table may hold.
const CHANNELS: usize = Channel::RECORDED.len();
/// Columns beside them, which come first.
const OTHERS: usize = 9;
/// Largest rake either way, in rad.
const STEEPEST: f64 = std::f64::consts::FRAC_PI_3 * (1.0 + 1e-12);
/// Of how many channels, from the first on, `sphcut sweep` writes half widths.
const INTERVALS: usize = 4;

/// One line of the table in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutTableRow {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// Length that the edge had cut before, in m.
    pub cut_length: Option<f64>,
    /// Place in the order of the cuts.
    pub order: Option<f64>,
    /// Number of cuts of which the line is the mean.
    pub count: Option<f64>,
    /// b in m.
    pub width_of_cut: Option<f64>,
    /// gamma of this cut's tool in rad.
    pub rake_angle: Option<f64>,
    /// r_n of this cut's edge before it has cut, in m.
    pub edge_radius: Option<f64>,
    /// What was measured, by place in [`Channel::RECORDED`] like the next two.
    pub values: [Option<f64>; CHANNELS],
    /// Standard deviations between cuts.
    pub deviations: [Option<f64>; CHANNELS],
    /// Half widths of the 95 % intervals of simulated values.
    pub half_widths: [Option<f64>; CHANNELS],
}

impl CutTableRow {
    /// The condition of the cut.
    #[must_use]
    pub fn condition(&self) -> CuttingCondition {
        CuttingCondition {
            cutting_speed: self.cutting_speed,
            uncut_chip_thickness: self.uncut_chip_thickness,
            cut_length: self.cut_length.unwrap_or(0.0),
            run_order: self.order.unwrap_or(0.0),
            tool: ToolGeometry { rake_angle: self.rake_angle, edge_radius: self.edge_radius },
        }
    }
}

const fn measured(channel: Channel, unit: &'static str) -> ColumnRule {
    column(channel.symbol(), channel.quantity(), unit, (false, true))
}

const COLUMNS: [ColumnRule; OTHERS + 2 * CHANNELS + INTERVALS + 2] = [
    column("v_c", Quantity::Speed, "m/min", (true, true)),
    column("h", Quantity::Length, "mm", (true, true)),
    column("cut_length", Quantity::Length, "m", (false, false)),
    column("order", Quantity::Dimensionless, "", (false, false)),
    column("n", Quantity::Dimensionless, "", (false, true)),
    column("b", Quantity::Length, "mm", (false, true)),
    column("time", Quantity::Time, "s", (false, false)),
    column("rake", Quantity::Angle, "deg", (false, false)),
    column("edge_radius", Quantity::Length, "um", (false, false)),
    measured(Channel::CuttingForce, "N"),
    measured(Channel::FeedForce, "N"),
    measured(Channel::PassiveForce, "N"),
    measured(Channel::InterfaceTemperature, "degC"),
    measured(Channel::ChipThickness, "mm"),
    measured(Channel::ContactLength, "mm"),
    measured(Channel::Springback, "um"),
    column("F_c_sd", Quantity::Force, "N", (false, true)),
    column("F_f_sd", Quantity::Force, "N", (false, true)),
    column("F_p_sd", Quantity::Force, "N", (false, true)),
    column("T_interface_sd", Quantity::TemperatureDifference, "K", (false, true)),
    column("chip_thickness_sd", Quantity::Length, "mm", (false, true)),
    column("contact_length_sd", Quantity::Length, "mm", (false, true)),
    column("springback_sd", Quantity::Length, "um", (false, true)),
    column("F_c_ci95", Quantity::Force, "N", (false, false)),
    column("F_f_ci95", Quantity::Force, "N", (false, false)),
    column("F_p_ci95", Quantity::Force, "N", (false, false)),
    column("T_interface_ci95", Quantity::TemperatureDifference, "K", (false, false)),
    text_column("material"),
    text_column("tool"),
];

/// Reads a table with the columns `v_c` and `h` and at least one channel ([`Channel::RECORDED`]); if it has them, also standard deviations
/// (`F_c_sd` and so on), `n`, `order`, `cut_length`, `b`, and of the tool `rake` and `edge_radius`, which either all lines have or none; in any order, each with its unit in brackets: `v_c [m/min]`. A
/// cell of what was not measured is empty. The half widths of intervals that `sphcut sweep` writes (`F_c_ci95` and so on) say nothing of recordings. Columns `time`, `material` and `tool` are read over. Empty lines and lines that begin with `#` are
/// skipped.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read_cut_table(text: &str) -> Result<Vec<CutTableRow>, TableProblem> {
    let rows = rows(text, "no line with measured values follows the header")?;
    if rows.iter().all(|row| row.values.iter().all(Option::is_none)) {
        let all = Channel::RECORDED.map(Channel::symbol).join(", ");
        let message = format!("nothing was measured: there is none of {all}");
        return Err(columns::whole(1, message));
    }
    Ok(rows)
}

/// The same of cuts that need not have been measured.
///
/// # Errors
/// The first mistake with its line and column.
pub fn read_condition_table(text: &str) -> Result<Vec<CutTableRow>, TableProblem> {
    rows(text, "no line with a cut follows the header")
}

fn rows(text: &str, nothing: &str) -> Result<Vec<CutTableRow>, TableProblem> {
    let lines = columns::read(text, &COLUMNS, nothing)?;
    let part = |line: &TableLine, from: usize| std::array::from_fn(|k| line.get(from + k));
    let mut rows: Vec<CutTableRow> = Vec::with_capacity(lines.len());
    for line in lines {
        let row = CutTableRow {
            cutting_speed: line.required(0),
            uncut_chip_thickness: line.required(1),
            cut_length: line.get(2),
            order: line.get(3),
            count: line.get(4),
            width_of_cut: line.get(5),
            rake_angle: line.get(7),
            edge_radius: line.get(8),
            values: part(&line, OTHERS),
            deviations: part(&line, OTHERS + CHANNELS),
            half_widths: std::array::from_fn(|k| {
                (k < INTERVALS).then(|| line.get(OTHERS + 2 * CHANNELS + k)).flatten()
            }),
        };
        if row.cut_length.is_some_and(|length| length < 0.0) {
            return Err(line.problem("a cut length is never below 0"));
        }
        if row.rake_angle.is_some_and(|rake| rake.abs() > STEEPEST) {
            return Err(line.problem("a rake lies between -60 and 60 deg"));
        }
        if row.edge_radius.is_some_and(|radius| radius < 0.0) {
            return Err(line.problem("an edge radius is never below 0"));
        }
        for (k, name) in ["rake", "edge_radius"].into_iter().enumerate() {
            // An empty cell would be the scenario's, and a number that happens to be the same another tool.
            let first = rows.first().unwrap_or(&row);
            if of_tool(first)[k].is_some() != of_tool(&row)[k].is_some() {
                return Err(
                    line.problem(format!("`{name}` has to be known of every cut or of none"))
                );
            }
        }
        rows.push(row);
    }
    Ok(rows)
}

fn of_tool(row: &CutTableRow) -> [Option<f64>; 2] {
    [row.rake_angle, row.edge_radius]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn units_any_order_and_missing_cells() {
        let text = "h [um],T_interface [degC],v_c [m/s],F_c [kN],T_interface_sd [K],order,cut_length [m],F_c_sd [N]\n\
                    100,500,2.5,0.6,5,1,30,4\n60,,2.5,0.4,,2,60,\n";
        let rows = read_cut_table(text).unwrap();
        assert_eq!((rows[0].cutting_speed, rows[0].uncut_chip_thickness), (2.5, 100e-6));
        assert_eq!(rows[0].values[0], Some(600.0));
        assert_eq!((rows[0].values[3], rows[0].deviations[3]), (Some(773.15), Some(5.0)));
        assert_eq!((rows[0].order, rows[0].cut_length), (Some(1.0), Some(30.0)));
        assert_eq!((rows[1].values[3], rows[1].deviations[0]), (None, None));
        let text = "v_c [m/min],h [mm],F_c [N],F_c_ci95 [N],T_interface [K],T_interface_ci95 [K]\n60,0.1,180,4,700,6\n";
        let row = read_cut_table(text).unwrap()[0];
        assert_eq!((row.half_widths[0], row.half_widths[1]), (Some(4.0), None));
        assert_eq!((row.half_widths[3], row.deviations), (Some(6.0), [None; CHANNELS]));
    }

    #[test]
    fn symbols_without_their_underscore_are_the_same() {
        let text = "vc [m/min];h [mm];FC [N];Ff_sd [N];F-f [N]\n100;0,1;200,8;10;128\n";
        let rows = read_cut_table(text).unwrap();
        assert!((rows[0].cutting_speed - 100.0 / 60.0).abs() < 1e-12);
        assert_eq!((rows[0].values[0], rows[0].values[1]), (Some(200.8), Some(128.0)));
        assert_eq!(rows[0].deviations[1], Some(10.0));
    }

    #[test]
    fn tools_differ_from_cut_to_cut() {
        let text = "v_c [m/min],rake [deg],h [mm],F_c [N],edge_radius [um]\n200,-7,0.1,5,20\n200,60,0.1,5,0\n";
        let rows = read_cut_table(text).unwrap();
        assert!((rows[0].rake_angle.unwrap() + 7.0_f64.to_radians()).abs() < 1e-15);
        assert!((rows[0].edge_radius.unwrap() - 20e-6).abs() < 1e-18);
        assert_eq!(rows[1].edge_radius, Some(0.0));
        assert_eq!(rows[0].values[0], Some(5.0));
    }

    #[test]
    fn what_a_sweep_writes_is_read() {
        let text = include_str!("../../../../validation/aisi1045_sweep/simulated.csv");
        let rows = read_cut_table(text).unwrap();
        assert_eq!(rows.len(), 110);
        let known = |k: usize| rows.iter().filter(|row| row.values[k].is_some()).count();
        // F_c and F_f of all, no passive force in the plane, temperature and contact of most.
        assert_eq!((known(0), known(1), known(2)), (110, 110, 0));
        assert!(known(3) > 100 && known(5) > 100);
        assert_eq!(crate::read_force_table(text).unwrap().len(), 110);
    }

    #[test]
    fn mistakes_are_told_with_line_and_column() {
        let good = "v_c [m/min],h [mm],F_c [N]\n";
        for (text, expected) in [
            (String::new(), "line 1: the table is empty"),
            (good.to_owned(), "line 1: no line with measured values follows the header"),
            (good.replace("h [mm]", "n"), "line 1: the column `h [mm]` is missing"),
            (good.replace("[N]", "[mm]"), "line 1, column 3 `F_c`: `mm`: this is a length"),
            (
                good.replace(" [N]", ""),
                "line 1, column 3 `F_c`: the unit is missing: write `F_c [N]`",
            ),
            (
                format!("{},F_c [kN]\n", good.trim_end()),
                "line 1, column 4 `F_c`: the column is there twice",
            ),
            (good.replace("F_c", "F_x"), "line 1, column 3 `F_x`: no such column; there are v_c"),
            (format!("{good}150,0.1,-5\n"), "line 2, column 3 `F_c`: `-5`: must be above 0"),
            (format!("{good}150,0.1,inf\n"), "line 2, column 3 `F_c`: `inf`"),
            (format!("{good}150,,5\n"), "line 2, column 2 `h`: ``: not a number"),
            (format!("{good}150,0.1\n"), "line 2: 2 cells, but the header has 3"),
            (format!("{good}150,0.1,\n"), "line 1: nothing was measured"),
            (
                "v_c [m/min],h [mm],T_interface [degC],T_interface_sd [degC]\n".to_owned(),
                "line 1, column 4 `T_interface_sd`: `degC`: this is a temperature",
            ),
            (
                "v_c [m/min],h [mm],F_c [N],cut_length [m]\n150,0.1,5,-1\n".to_owned(),
                "line 2: a cut length is never below 0",
            ),
            (
                "v_c [m/min],h [mm],F_c [N],rake [deg]\n150,0.1,5,61\n".to_owned(),
                "line 2: a rake lies between -60 and 60 deg",
            ),
            (
                "v_c [m/min],h [mm],F_c [N],edge_radius [um]\n150,0.1,5,-1\n".to_owned(),
                "line 2: an edge radius is never below 0",
            ),
            (
                "v_c [m/min],h [mm],F_c [N],rake [deg]\n150,0.1,5,-7\n150,0.1,5,\n".to_owned(),
                "line 3: `rake` has to be known of every cut or of none",
            ),
            (
                "v_c [m/min],h [mm],F_c [N],rake [mm]\n150,0.1,5,1\n".to_owned(),
                "line 1, column 4 `rake`: `mm`: this is a length",
            ),
        ] {
            let message = read_cut_table(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected), "{message}\nnot: {expected}");
        }
    }

    proptest! {
        /// Numbers written in other units come back as they were, whatever the order of the columns.
        #[test]
        fn what_was_written_is_read(
            cells in proptest::collection::vec((0.1..500.0f64, 0.01..2.0f64, 1.0..9e3f64), 1..20),
            turned in any::<bool>(),
        ) {
            let mut text = if turned { "F_c [kN],h [um],v_c [m/s]\n" } else { "v_c [m/min],h [mm],F_c [N]\n" }.to_owned();
            for (v, h, f) in &cells {
                text += &if turned {
                    format!("{},{},{}\n", f / 1e3, h * 1e3, v / 60.0)
                } else {
                    format!("{v},{h},{f}\n")
                };
            }
            let rows = read_cut_table(&text).unwrap();
            prop_assert_eq!(rows.len(), cells.len());
            for (row, (v, h, f)) in rows.iter().zip(&cells) {
                prop_assert!((row.cutting_speed * 60.0 / v - 1.0).abs() < 1e-12);
                prop_assert!((row.uncut_chip_thickness * 1e3 / h - 1.0).abs() < 1e-12);
                prop_assert!((row.values[0].unwrap() / f - 1.0).abs() < 1e-12);
            }
        }

        /// No text makes the reader panic, and what it takes is finite and above 0.
        #[test]
        fn any_text_is_read_or_refused(text in "(v_c \\[m/min\\],h \\[mm\\],F_c \\[N\\]\n)?[-0-9.,eE\nnaif# ]{0,60}") {
            if let Ok(rows) = read_cut_table(&text) {
                for row in rows {
                    prop_assert!(row.cutting_speed > 0.0 && row.cutting_speed.is_finite());
                    prop_assert!(row.values.iter().flatten().all(|y| *y > 0.0 && y.is_finite()));
                }
            }
        }
    }
}
