//! The results of a sweep as one table.

use crate::Sweep;
use crate::plan::{CutSize, SweepPlan};
use crate::store::{ResultEntry, Store};
use crate::{Address, State};
use csv::ReaderBuilder;
use serde_json::Value;
use sphcut_physics::csv::{meant, shown};
use sphcut_record::{ColumnH5, FactH5, GroupH5, RunError, ZERO_CELSIUS, write_columns_h5};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Runs, what was varied, and every number of their summaries.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// Title of the sweep.
    pub title: String,
    /// What was varied: key and SI unit.
    pub axes: Vec<(String, String)>,
    /// Which of them say something of their own: several values, and not so many times those of another.
    pub own: Vec<bool>,
    /// One for each run of the plan.
    pub rows: Vec<SweepRow>,
    /// Names of the numbers of the summaries, in their order.
    pub names: Vec<String>,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// Place in the design, from 1.
    pub number: usize,
    /// Where its result is kept.
    pub address: Address,
    /// What became of it.
    pub state: State,
    /// Values of the axes as written, without quotes.
    pub values: Vec<String>,
    /// The same in SI, for those that are numbers.
    pub numbers: Vec<Option<f64>>,
    /// Speed, thickness and width, of a cut.
    pub condition: Option<CutSize>,
    /// Name of the workpiece's material.
    pub material: String,
    /// F_c, F_f and F_p in N, each with the half width of its 95 % interval; of a cut with a result.
    pub forces: [Option<[f64; 2]>; 3],
    /// The numbers of its summary by name.
    pub summary: BTreeMap<String, f64>,
    /// What it took, of a run with a result.
    pub entry: Option<ResultEntry>,
    /// Folder of its result.
    pub folder: PathBuf,
}

const FORCES: [(&str, &str); 3] = [("F_c", "cutting"), ("F_f", "feed"), ("F_p", "passive")];
const M_PER_MIN: f64 = 60.0;
const MM: f64 = 1e3;

/// The unit that a quantity of a scenario has in the table, which is that of the summaries, and how much of it an SI unit is.
fn in_the_table(unit: &str) -> (&str, f64) {
    match unit {
        "m/s" => ("m/min", M_PER_MIN),
        "m" => ("mm", MM),
        "Pa" => ("MPa", 1e-6),
        "rad" => ("deg", 1.0_f64.to_degrees()),
        _ => (unit, 1.0),
    }
}

impl SweepRow {
    /// The folder of the result as seen from the folder `beside`, if it lies in it; absolute otherwise.
    #[must_use]
    pub fn folder_from(&self, beside: &Path) -> String {
        near(&self.folder, beside)
    }

    /// Whether there is a result.
    #[must_use]
    pub fn has_result(&self) -> bool {
        matches!(self.state, State::Finished | State::Reused)
    }

    fn word(&self) -> &'static str {
        match self.state {
            State::Finished | State::Reused => "finished",
            State::Failed(_) => "failed",
            State::Waiting | State::Running(_) | State::Elsewhere | State::Stopped => "missing",
        }
    }

    fn reason(&self) -> &str {
        if let State::Failed(reason) = &self.state { reason } else { "" }
    }
}

impl SweepTable {
    /// Puts the results of `plan` together; `summary` reads the summary of the run in a folder.
    #[must_use]
    pub fn new(
        sweep: &Sweep,
        plan: &SweepPlan,
        store: &Store,
        states: &[State],
        summary: &dyn Fn(&Path) -> Option<Value>,
    ) -> Self {
        let mut names: Vec<String> = Vec::new();
        let mut rows = Vec::new();
        for (run, state) in plan.runs.iter().zip(states) {
            let folder = store.result(&run.address);
            let mut row = SweepRow {
                number: run.number,
                address: run.address,
                state: state.clone(),
                values: run.values.iter().map(|value| value.trim_matches('"').to_owned()).collect(),
                numbers: run.numbers.clone(),
                condition: run.condition,
                material: run.material.clone(),
                forces: [None; 3],
                summary: BTreeMap::new(),
                entry: None,
                folder,
            };
            if row.has_result() {
                // Unreadable notes of a run that is there leave its cost unknown.
                row.entry = store.entry(&run.address).ok().flatten();
                if let Some(value) = summary(&row.folder) {
                    flatten(&value, String::new(), &mut |name, number| {
                        if !names.contains(&name) {
                            names.push(name.clone());
                        }
                        if let Some(number) = number {
                            row.summary.insert(name, number);
                        }
                    });
                }
                row.forces = forces(&row);
            }
            rows.push(row);
        }
        // What no run has a number for, such as a reason that is not given, is no column.
        names.retain(|name| rows.iter().any(|row: &SweepRow| row.summary.contains_key(name)));
        let several = |axis: usize| {
            rows.iter().any(|row: &SweepRow| row.values[axis] != rows[0].values[axis])
        };
        let own = (0..sweep.axes.len())
            .map(|axis| sweep.axes[axis].follows(&sweep.axes).is_none() && several(axis))
            .collect();
        Self { title: sweep.title.clone(), axes: axes(sweep, plan), own, rows, names }
    }

    /// The table as comma-separated values under one line of heads, in the units of the summary: run, address, folder of the result (relative to `beside` if it lies in it), state, reason, what was varied, speed, thickness, width,
    /// forces with intervals, then every number of the summaries under its name there.
    #[must_use]
    pub fn csv(&self, beside: &Path) -> String {
        let mut heads: Vec<String> =
            ["run", "address", "folder", "state", "reason"].map(str::to_owned).to_vec();
        for ((key, unit), number) in self.axes.iter().zip(self.numeric()) {
            heads.push(if number && !unit.is_empty() {
                format!("{key} [{}]", in_the_table(unit).0)
            } else {
                key.clone()
            });
        }
        heads.extend(["v_c [m/min]", "h [mm]", "b [mm]"].map(str::to_owned));
        heads.extend(
            FORCES
                .iter()
                .flat_map(|(symbol, _)| [format!("{symbol} [N]"), format!("{symbol}_ci95 [N]")]),
        );
        heads.extend(self.names.iter().cloned());
        let mut text = String::new();
        line(&mut text, heads.into_iter().map(|head| quoted(&head)));
        for row in &self.rows {
            let mut cells = vec![
                row.number.to_string(),
                row.address.to_string(),
                quoted(&row.folder_from(beside)),
                row.word().to_owned(),
                quoted(row.reason()),
            ];
            for (((value, number), numeric), (_, unit)) in
                row.values.iter().zip(&row.numbers).zip(self.numeric()).zip(&self.axes)
            {
                let scaled = number.map(|number| rounded(number * in_the_table(unit).1));
                cells.push(if numeric { cell(scaled) } else { quoted(value) });
            }
            cells.extend(conditions(row).map(cell));
            cells.extend(row.forces.iter().flat_map(|force| {
                [cell(force.map(|force| force[0])), cell(force.map(|force| force[1]))]
            }));
            cells.extend(self.names.iter().map(|name| cell(row.summary.get(name).copied())));
            line(&mut text, cells.into_iter());
        }
        text
    }

    /// Simulated forces over speed and thickness as `sphcut greybox` reads them, with the half widths of their 95 % intervals, chip
    /// thickness, contact length and interface temperature where they are known, and the material: the cuts with a result. `None` without any.
    #[must_use]
    pub fn simulated_csv(&self) -> Option<String> {
        let mut text = String::from(
            "v_c [m/min],h [mm],b [mm],F_c [N],F_c_ci95 [N],F_f [N],F_f_ci95 [N],F_p [N],F_p_ci95 [N],chip_thickness [mm],\
             contact_length [mm],T_interface [degC],T_interface_ci95 [K],material\n",
        );
        let mut cuts = 0;
        for row in &self.rows {
            let [Some(speed), Some(thickness), Some(width)] = conditions(row) else { continue };
            let [Some(cutting), Some(feed), Some(passive)] = row.forces else { continue };
            let forces = [cutting, feed, passive];
            if forces.iter().flatten().any(|number| !number.is_finite()) {
                continue;
            }
            let number = |name: &str| row.summary.get(name).copied();
            let beside = [
                number("chip.thickness_mm"),
                number("interface.contact_length_mm"),
                number("temperature.interface_mean_k").map(|kelvin| kelvin - ZERO_CELSIUS),
                number("temperature.interface_ci95_k"),
            ];
            let conditions = [speed, thickness, width].map(|number| number.to_string());
            // In the plane there is no passive force to know.
            let is_known = |place: usize, force: &[f64; 2]| place < 2 || force[0] != 0.0;
            let forces = forces.iter().enumerate().flat_map(|(place, force)| {
                if is_known(place, force) {
                    force.map(short)
                } else {
                    [String::new(), String::new()]
                }
            });
            let beside = beside.map(|number| number.map_or_else(String::new, short));
            let material = quoted(&row.material);
            line(&mut text, conditions.into_iter().chain(forces).chain(beside).chain([material]));
            cuts += 1;
        }
        (cuts > 0).then_some(text)
    }

    /// Writes the table as HDF5: group `runs`, a column for each of the table as comma-separated values; numbers
    /// that are not known are NaN. `text` is that of the sweep.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_h5(&self, path: &Path, text: &str, version: &str) -> Result<(), RunError> {
        let column = |of: &dyn Fn(&SweepRow) -> Option<f64>| -> Vec<f64> {
            self.rows.iter().map(|row| of(row).unwrap_or(f64::NAN)).collect()
        };
        let mut numbers: Vec<(String, String, Vec<f64>)> =
            vec![("run".to_owned(), String::new(), column(&|row| Some(row.number as f64)))];
        let mut texts: Vec<(String, Vec<String>)> = vec![
            ("address".to_owned(), self.rows.iter().map(|row| row.address.to_string()).collect()),
            ("state".to_owned(), self.rows.iter().map(|row| row.word().to_owned()).collect()),
            ("reason".to_owned(), self.rows.iter().map(|row| row.reason().to_owned()).collect()),
        ];
        for (index, ((key, unit), numeric)) in self.axes.iter().zip(self.numeric()).enumerate() {
            if numeric {
                numbers.push((key.clone(), unit.clone(), column(&|row| row.numbers[index])));
            } else {
                let values = self.rows.iter().map(|row| row.values[index].clone()).collect();
                texts.push((key.clone(), values));
            }
        }
        for (index, (name, unit)) in [("v_c", "m/min"), ("h", "mm"), ("b", "mm")].iter().enumerate()
        {
            let values = column(&|row| conditions(row)[index]);
            numbers.push(((*name).to_owned(), (*unit).to_owned(), values));
        }
        for (index, (symbol, _)) in FORCES.iter().enumerate() {
            for (part, ending) in ["", "_ci95"].iter().enumerate() {
                let values = column(&|row| row.forces[index].map(|force| force[part]));
                numbers.push((format!("{symbol}{ending}"), "N".to_owned(), values));
            }
        }
        for name in &self.names {
            numbers.push((
                name.clone(),
                String::new(),
                column(&|row| row.summary.get(name).copied()),
            ));
        }
        let group = GroupH5 {
            path: "runs".to_owned(),
            facts: Vec::new(),
            columns: numbers
                .iter()
                .map(|(name, unit, values)| ColumnH5 { name, unit, values })
                .collect(),
            texts: texts
                .iter()
                .map(|(name, values)| (name.as_str(), values.iter().map(String::as_str).collect()))
                .collect(),
        };
        let facts = [
            ("title", FactH5::Text(self.title.clone())),
            ("sweep", FactH5::Text(text.to_owned())),
            ("version", FactH5::Text(version.to_owned())),
        ];
        write_columns_h5(path, &facts, &[group])
    }

    /// Which axes are numbers in every run.
    fn numeric(&self) -> impl Iterator<Item = bool> + '_ {
        (0..self.axes.len()).map(|axis| self.rows.iter().all(|row| row.numbers[axis].is_some()))
    }
}

/// Keys and their SI units.
fn axes(sweep: &Sweep, plan: &SweepPlan) -> Vec<(String, String)> {
    let first: Vec<&str> = plan.runs[0].values.iter().map(String::as_str).collect();
    // It was read when the sweep was planned.
    let scenario = sweep.scenario(&first).ok();
    let unit = |axis: &crate::SweepAxis| {
        scenario.as_ref().and_then(|scenario| axis.entry(scenario)).map_or("", |entry| entry.unit)
    };
    sweep.axes.iter().map(|axis| (axis.key.to_string(), unit(axis).to_owned())).collect()
}

/// `number` to ten digits: 9e-5 and not 8.999999999999999e-5.
fn rounded(number: f64) -> f64 {
    format!("{number:.9e}").parse().unwrap_or(number)
}

/// v_c in m/min, h and b in mm, to ten digits.
fn conditions(row: &SweepRow) -> [Option<f64>; 3] {
    let Some(condition) = row.condition else { return [None; 3] };
    [
        condition.cutting_speed * M_PER_MIN,
        condition.uncut_chip_thickness * MM,
        condition.width_of_cut * MM,
    ]
    .map(|number| Some(rounded(number)))
}

fn forces(row: &SweepRow) -> [Option<[f64; 2]>; 3] {
    FORCES.map(|(_, name)| {
        let of = |part: &str| row.summary.get(&format!("forces.{name}.{part}")).copied();
        row.condition?;
        Some([of("mean_n")?, of("ci95_n").unwrap_or(f64::NAN)])
    })
}

/// Every number and switch under its path; lists of numbers by their place. Lists of tables, such as profiles, stay
/// in the summary of the run.
fn flatten(value: &Value, path: String, take: &mut impl FnMut(String, Option<f64>)) {
    match value {
        Value::Object(table) => {
            for (key, inner) in table {
                let dot = if path.is_empty() { "" } else { "." };
                flatten(inner, format!("{path}{dot}{key}"), take);
            }
        }
        Value::Array(list) if list.iter().all(Value::is_number) => {
            for (index, inner) in list.iter().enumerate() {
                flatten(inner, format!("{path}.{index}"), take);
            }
        }
        Value::Array(list) if path == "warnings" => take(path, Some(list.len() as f64)),
        Value::Number(number) => take(path, number.as_f64()),
        Value::Bool(switch) => take(path, Some(f64::from(u8::from(*switch)))),
        Value::Null => take(path, None),
        Value::Array(_) | Value::String(_) => {}
    }
}

fn cell(number: Option<f64>) -> String {
    number.filter(|number| number.is_finite()).map_or_else(String::new, |number| number.to_string())
}

/// Six digits: more than an interval leaves certain.
fn short(number: f64) -> String {
    format!("{number:.5e}")
        .parse::<f64>()
        .map_or_else(|_| String::new(), |number| number.to_string())
}

/// `folder` as seen from `beside`, if it lies in it; absolute otherwise.
fn near(folder: &Path, beside: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (folder, beside) = (absolute(folder), absolute(beside));
    folder.strip_prefix(beside).unwrap_or(&folder).display().to_string()
}

/// The runs with a result in a table as [`SweepTable::csv`] writes it: number and folder. `None` if it is no such table.
#[must_use]
pub fn results_of(csv: &str) -> Option<Vec<(String, PathBuf)>> {
    let mut reader = ReaderBuilder::new().comment(Some(b'#')).from_reader(csv.as_bytes());
    let heads = reader.headers().ok()?.clone();
    let place = |name: &str| heads.iter().position(|head| head == name);
    let (run, folder, state) = (place("run")?, place("folder")?, place("state")?);
    let mut found = Vec::new();
    for cells in reader.records() {
        let cells = cells.ok()?;
        if &cells[state] == "finished" {
            found.push((cells[run].to_owned(), PathBuf::from(meant(&cells[folder]))));
        }
    }
    Some(found)
}

fn quoted(text: &str) -> String {
    let text = shown(text);
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        text
    }
}

fn line(text: &mut String, cells: impl Iterator<Item = String>) {
    let cells: Vec<String> = cells.collect();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", cells.join(","));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_tells_where_its_results_are() {
        let text = "# a, b\nrun,address,folder,state,reason\n1,ab,\"a, \"\"b\"\"/c\",finished,\n2,cd,x,failed,\"no, really\"\n";
        assert_eq!(results_of(text).unwrap(), [("1".to_owned(), PathBuf::from("a, \"b\"/c"))]);
        assert!(results_of("v_c [m/min],h [mm]\n1,2\n").is_none());
        assert_eq!(quoted("=HYPERLINK(1)"), "'=HYPERLINK(1)");
        let folder = quoted("-x, \"y\"");
        let read = results_of(&format!("run,folder,state\n1,{folder},finished\n")).unwrap();
        assert_eq!(read, [("1".to_owned(), PathBuf::from("-x, \"y\""))]);
        assert_eq!(near(Path::new("out/store/x"), Path::new("out")), "store/x");
        let absolute = std::path::absolute("out/store/x").unwrap();
        assert_eq!(near(&absolute, Path::new("out")), "store/x");
        assert!(Path::new(&near(Path::new("store/x"), Path::new("out"))).is_absolute());
    }
}
