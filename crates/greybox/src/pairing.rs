//! Measured rows beside the simulation of their condition.

use crate::error::{GreyBoxError, LISTED};
use crate::samples::{Input, TrainingRows, mean};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One line of a table of forces. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceRow {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// F_c and F_f in N.
    pub forces: [f64; 2],
    /// Standard deviations of the measurements of which the row is the mean, in N.
    pub deviations: [Option<f64>; 2],
    /// How many measurements the row is the mean of.
    pub count: Option<f64>,
}

/// The two forces of an orthogonal cut; the order of `ForceRow::forces`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceKind {
    /// F_c.
    Cutting,
    /// F_f.
    Feed,
}

impl ForceKind {
    /// Both, in their order.
    pub const BOTH: [Self; 2] = [Self::Cutting, Self::Feed];

    /// Its place in a pair of forces.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Cutting => 0,
            Self::Feed => 1,
        }
    }

    /// Its symbol.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Cutting => "F_c",
            Self::Feed => "F_f",
        }
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cutting => "cutting force",
            Self::Feed => "feed force",
        }
    }
}

/// A pair of v_c and h that was measured, with its simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedCondition {
    /// v_c in m/s and h in m, means of the measured rows.
    pub input: Input,
    /// The level of v_c and that of h, counted from the lowest.
    pub levels: [usize; 2],
    /// Simulated forces in N; the mean if there are several simulations.
    pub simulated: [f64; 2],
    /// Number of simulations.
    pub simulations: usize,
}

/// A measured row and the condition it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedRow {
    /// Index of its condition.
    pub condition: usize,
    /// What was measured.
    pub measured: ForceRow,
}

/// Measured rows and the conditions they belong to.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// Rows, by condition and then in the order of the table.
    pub rows: Vec<PairedRow>,
    /// Conditions, by v_c and then by h.
    pub conditions: Vec<PairedCondition>,
    /// Simulated conditions that nobody measured: inputs and forces.
    pub only_simulated: Vec<(Input, [f64; 2])>,
    /// Whether repeats were condensed to the means of their conditions.
    pub condensed: bool,
}

/// Values of v_c or h that differ by less, relative to the lowest of them, are one level.
const SAME_LEVEL: f64 = 0.01;
/// Conditions that a cross-validation of some meaning needs.
const FEWEST_CONDITIONS: usize = 10;
/// Rows that support vectors and Gaussian processes can take: their cost grows with the cube.
const MOST_ROWS: usize = 2000;

/// Puts every measured row beside the mean of the simulations of its condition.
///
/// # Errors
/// Fewer than ten or more than two thousand conditions; conditions without a simulation.
pub fn pair(simulated: &[ForceRow], measured: &[ForceRow]) -> Result<Pairs, GreyBoxError> {
    pair_at_least(FEWEST_CONDITIONS, simulated, measured)
}

/// [`pair`] with another least number of conditions.
pub(crate) fn pair_at_least(
    fewest: usize,
    simulated: &[ForceRow],
    measured: &[ForceRow],
) -> Result<Pairs, GreyBoxError> {
    let both = || simulated.iter().chain(measured);
    let speeds = Levels::of(both().map(|row| row.cutting_speed));
    let thicknesses = Levels::of(both().map(|row| row.uncut_chip_thickness));
    let key = |row: &ForceRow| {
        (speeds.level(row.cutting_speed), thicknesses.level(row.uncut_chip_thickness))
    };
    let by_key = |rows: &[ForceRow]| {
        let mut cells: BTreeMap<(usize, usize), Vec<ForceRow>> = BTreeMap::new();
        rows.iter().for_each(|row| cells.entry(key(row)).or_default().push(*row));
        cells
    };
    let (mut simulations, cells) = (by_key(simulated), by_key(measured));
    check_count(cells.len(), fewest)?;
    let condensed = measured.len() > MOST_ROWS;
    let mut pairs =
        Pairs { rows: Vec::new(), conditions: Vec::new(), only_simulated: Vec::new(), condensed };
    let mut missing = Vec::new();
    for (levels, cell) in &cells {
        let input = mean_input(cell);
        let Some(runs) = simulations.remove(levels) else {
            missing.push(input);
            continue;
        };
        let condition = pairs.conditions.len();
        pairs.conditions.push(PairedCondition {
            input,
            levels: [levels.0, levels.1],
            simulated: mean_forces(&runs),
            simulations: runs.len(),
        });
        let rows = if condensed { vec![condense(cell, input)] } else { cell.clone() };
        pairs.rows.extend(rows.into_iter().map(|measured| PairedRow { condition, measured }));
    }
    if !missing.is_empty() {
        let count = missing.len();
        missing.truncate(LISTED);
        return Err(GreyBoxError::NotSimulated { first: missing, count, of: cells.len() });
    }
    pairs.only_simulated =
        simulations.values().map(|runs| (mean_input(runs), mean_forces(runs))).collect();
    renumber(&mut pairs.conditions);
    Ok(pairs)
}

fn check_count(found: usize, needed: usize) -> Result<(), GreyBoxError> {
    if found < needed {
        return Err(GreyBoxError::TooFewConditions { found, needed });
    }
    if found > MOST_ROWS {
        return Err(GreyBoxError::TooManyConditions { found, limit: MOST_ROWS });
    }
    Ok(())
}

/// Levels that were measured are counted from 0 without gaps.
fn renumber(conditions: &mut [PairedCondition]) {
    for axis in 0..2 {
        let mut used: Vec<usize> = conditions.iter().map(|c| c.levels[axis]).collect();
        used.sort_unstable();
        used.dedup();
        for condition in conditions.iter_mut() {
            condition.levels[axis] = used.partition_point(|&level| level < condition.levels[axis]);
        }
    }
}

fn mean_input(rows: &[ForceRow]) -> Input {
    let of = |pick: fn(&ForceRow) -> f64| mean(&rows.iter().map(pick).collect::<Vec<_>>());
    [of(|row| row.cutting_speed), of(|row| row.uncut_chip_thickness)]
}

fn mean_forces(rows: &[ForceRow]) -> [f64; 2] {
    [0, 1].map(|k| mean(&rows.iter().map(|row| row.forces[k]).collect::<Vec<_>>()))
}

/// The rows of one condition as one.
fn condense(rows: &[ForceRow], input: Input) -> ForceRow {
    let forces = mean_forces(rows);
    let deviations = [0, 1].map(|k| {
        let squares: f64 = rows.iter().map(|row| (row.forces[k] - forces[k]).powi(2)).sum();
        (rows.len() > 1).then(|| (squares / (rows.len() - 1) as f64).sqrt())
    });
    ForceRow {
        cutting_speed: input[0],
        uncut_chip_thickness: input[1],
        forces,
        deviations,
        count: Some(rows.len() as f64),
    }
}

/// The different values of a column.
struct Levels {
    starts: Vec<f64>,
}

impl Levels {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        let mut starts: Vec<f64> = Vec::new();
        for value in sorted {
            if starts.last().is_none_or(|start| value > start * (1.0 + SAME_LEVEL)) {
                starts.push(value);
            }
        }
        Self { starts }
    }

    fn level(&self, value: f64) -> usize {
        self.starts.partition_point(|&start| start <= value).saturating_sub(1)
    }
}

impl Pairs {
    /// Cutting conditions of every row.
    #[must_use]
    pub fn inputs(&self) -> Vec<Input> {
        self.rows.iter().map(|row| self.conditions[row.condition].input).collect()
    }

    /// Measured values of a force in N, row by row.
    #[must_use]
    pub fn measured(&self, force: ForceKind) -> Vec<f64> {
        self.rows.iter().map(|row| row.measured.forces[force.index()]).collect()
    }

    /// Simulated values of a force in N, row by row.
    #[must_use]
    pub fn simulated(&self, force: ForceKind) -> Vec<f64> {
        self.rows
            .iter()
            .map(|row| self.conditions[row.condition].simulated[force.index()])
            .collect()
    }

    /// What the regressor of a force is taught: measured minus simulated over (v_c, h).
    #[must_use]
    pub fn residuals(&self, force: ForceKind) -> TrainingRows {
        let (measured, simulated) = (self.measured(force), self.simulated(force));
        TrainingRows {
            inputs: self.inputs(),
            targets: measured.iter().zip(&simulated).map(|(y, f)| y - f).collect(),
            groups: self.rows.iter().map(|row| row.condition).collect(),
        }
    }

    /// The level of v_c (0) or h (1) of every row.
    #[must_use]
    pub fn levels(&self, axis: usize) -> Vec<usize> {
        self.rows.iter().map(|row| self.conditions[row.condition].levels[axis]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(speed: f64, thickness: f64, force: f64) -> ForceRow {
        ForceRow {
            cutting_speed: speed,
            uncut_chip_thickness: thickness,
            forces: [force, force / 2.0],
            deviations: [None; 2],
            count: None,
        }
    }

    fn plan(force: f64) -> Vec<ForceRow> {
        (0..12).map(|k| row(1.0 + f64::from(k / 4), 1e-4 * f64::from(1 + k % 4), force)).collect()
    }

    #[test]
    fn repeats_are_found_within_a_percent_and_simulations_averaged() {
        let mut measured = plan(100.0);
        measured.push(row(1.004, 1.002e-4, 110.0));
        let mut simulated = plan(60.0);
        simulated.push(row(1.0, 1e-4, 70.0));
        simulated.push(row(9.0, 1e-4, 70.0));
        let pairs = pair(&simulated, &measured).unwrap();
        assert_eq!((pairs.rows.len(), pairs.conditions.len()), (13, 12));
        assert_eq!(pairs.conditions[0].simulated, [65.0, 32.5]);
        let residuals = pairs.residuals(ForceKind::Cutting);
        assert_eq!(residuals.targets[..3], [35.0, 45.0, 40.0]);
        assert_eq!(residuals.groups[..3], [0, 0, 1]);
        assert_eq!(pairs.levels(0)[12], 2);
        assert_eq!(pairs.only_simulated.len(), 1);
    }

    #[test]
    fn what_cannot_be_paired_is_named() {
        let error = pair(&plan(1.0)[..10], &plan(2.0)).unwrap_err().to_string();
        assert!(error.starts_with("2 of 12 measured conditions have no simulation"), "{error}");
        assert!(error.contains("v_c 180.0000 m/min, h 0.3000 mm"), "{error}");
        let metres: Vec<ForceRow> = plan(2.0)
            .into_iter()
            .map(|row| ForceRow { uncut_chip_thickness: 1e3 * row.uncut_chip_thickness, ..row })
            .collect();
        let error = pair(&plan(1.0), &metres).unwrap_err().to_string();
        assert!(error.ends_with("not one has: are the units of both tables right?"), "{error}");
        let error = pair(&plan(1.0), &plan(2.0)[..3]).unwrap_err();
        assert_eq!(error, GreyBoxError::TooFewConditions { found: 3, needed: 10 });
        let many: Vec<ForceRow> =
            (0..2001).map(|k| row(1.011_f64.powi(k % 50), 1.011_f64.powi(k / 50), 1.0)).collect();
        let error = pair(&many, &many).unwrap_err();
        assert_eq!(error, GreyBoxError::TooManyConditions { found: 2001, limit: 2000 });
    }

    #[test]
    fn a_long_table_is_condensed_to_its_conditions() {
        let measured: Vec<ForceRow> =
            (0..200).flat_map(|k| plan(100.0 + f64::from(k % 2))).collect();
        let pairs = pair(&plan(60.0), &measured).unwrap();
        assert!(pairs.condensed && pairs.rows.len() == 12);
        let first = pairs.rows[0].measured;
        assert_eq!((first.forces[0], first.count), (100.5, Some(200.0)));
        // Values 100 and 101 in equal number: sqrt(200 * 0.25 / 199).
        approx(first.deviations[0].unwrap(), (50.0_f64 / 199.0).sqrt());
    }

    fn approx(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-12, "{value} {expected}");
    }
}
