//! A flow stress given as a table over strain, strain rate and temperature.

use super::{FlowState, FlowStressEntry, FlowStressLaw};
use std::fmt;
use std::sync::Arc;

/// ```text
/// sigma_y = linear between the corners of the cell in eps_p, ln(eps_p_dot) and T
/// ```
/// The table is a full grid: every strain with every rate at every temperature. Outside it the value
/// at its rim holds, for each of the three on its own: no hardening beyond the last strain, no rate
/// dependence below the first and above the last rate, no softening above the last temperature.
/// These clamps are the statement that nothing was measured there; a table for cutting should reach to
/// where the strength is gone.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowStressTable {
    strain: Vec<f64>,
    /// Natural logarithm of the rates in 1/s.
    log_rate: Vec<f64>,
    temperature: Vec<f64>,
    /// In Pa; the temperature runs fastest, the strain slowest.
    stress: Vec<f64>,
}

/// Why points are no table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TableError {
    /// No point at all.
    Empty,
    /// A value that is not finite, or not positive where it has to be: index of the point.
    NotPositive(usize),
    /// The same strain, rate and temperature twice: index of the second point.
    Twice(usize),
    /// A corner of the grid without a value: strain, rate in 1/s and temperature in K.
    Gap(f64, f64, f64),
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the table is empty"),
            Self::NotPositive(_) => f.write_str(
                "rate, temperature and flow stress must be above 0, the strain not below",
            ),
            Self::Twice(_) => f.write_str("this strain, rate and temperature are there twice"),
            Self::Gap(strain, rate, temperature) => write!(
                f,
                "the table is no full grid: it has nothing at strain {strain}, rate {rate} 1/s and \
                 {temperature} K"
            ),
        }
    }
}

impl std::error::Error for TableError {}

/// The cell of an axis around a value: lower index, share of the way to the next, and the slope of
/// that share over the value, 0 outside the axis.
struct Cell {
    low: usize,
    share: f64,
    slope: f64,
}

fn cell(axis: &[f64], value: f64) -> Cell {
    let above = axis.partition_point(|knot| *knot <= value);
    if above == 0 {
        return Cell { low: 0, share: 0.0, slope: 0.0 };
    }
    let low = above - 1;
    match axis.get(above) {
        None => Cell { low, share: 0.0, slope: 0.0 },
        Some(next) => {
            let slope = 1.0 / (next - axis[low]);
            Cell { low, share: (value - axis[low]) * slope, slope }
        }
    }
}

fn axis(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

impl FlowStressTable {
    /// From points of strain, rate in 1/s, temperature in K and flow stress in Pa, in any order.
    ///
    /// # Errors
    /// What makes them no full grid of admissible values.
    pub fn new(points: &[[f64; 4]]) -> Result<Self, TableError> {
        if points.is_empty() {
            return Err(TableError::Empty);
        }
        let bad = |point: &[f64; 4]| {
            let positive = point[1..].iter().all(|value| *value > 0.0 && value.is_finite());
            !(positive && point[0] >= 0.0 && point[0].is_finite())
        };
        if let Some(index) = points.iter().position(bad) {
            return Err(TableError::NotPositive(index));
        }
        let along = |which: usize| axis(points.iter().map(|point| point[which]).collect());
        let (strain, rate, temperature) = (along(0), along(1), along(2));
        let place = |point: &[f64; 4]| {
            let index = |axis: &[f64], value: f64| axis.partition_point(|knot| *knot < value);
            (index(&strain, point[0]) * rate.len() + index(&rate, point[1])) * temperature.len()
                + index(&temperature, point[2])
        };
        // A full grid has no more points than were given: memory stays in bounds.
        let corners = strain.len().saturating_mul(rate.len()).saturating_mul(temperature.len());
        let mut stress = vec![None; corners.min(points.len())];
        for (index, point) in points.iter().enumerate() {
            match stress.get_mut(place(point)) {
                Some(Some(_)) => return Err(TableError::Twice(index)),
                Some(empty) => *empty = Some(point[3]),
                None => {}
            }
        }
        if let Some(gap) = stress.iter().position(Option::is_none) {
            return Err(Self::gap(gap, &strain, &rate, &temperature));
        }
        if corners > stress.len() {
            return Err(Self::gap(stress.len(), &strain, &rate, &temperature));
        }
        let log_rate = rate.iter().map(|rate| rate.ln()).collect();
        Ok(Self { strain, log_rate, temperature, stress: stress.into_iter().flatten().collect() })
    }

    fn gap(place: usize, strain: &[f64], rate: &[f64], temperature: &[f64]) -> TableError {
        let (row, warmth) = (place / temperature.len(), place % temperature.len());
        TableError::Gap(strain[row / rate.len()], rate[row % rate.len()], temperature[warmth])
    }

    /// Number of strains, rates and temperatures.
    #[must_use]
    pub fn size(&self) -> [usize; 3] {
        [self.strain.len(), self.log_rate.len(), self.temperature.len()]
    }

    /// Strain, rate in 1/s, temperature in K and flow stress in Pa of every corner.
    pub fn points(&self) -> impl Iterator<Item = [f64; 4]> + '_ {
        let [_, rates, temperatures] = self.size();
        self.stress.iter().enumerate().map(move |(place, stress)| {
            let (row, warmth) = (place / temperatures, place % temperatures);
            let rate = self.log_rate[row % rates].exp();
            [self.strain[row / rates], rate, self.temperature[warmth], *stress]
        })
    }

    /// Flow stress in Pa and its derivatives over strain, ln(rate) and temperature.
    fn value(&self, state: &FlowState) -> (f64, [f64; 3]) {
        let log_rate = state.plastic_strain_rate.max(f64::MIN_POSITIVE).ln();
        let cells = [
            cell(&self.strain, state.plastic_strain),
            cell(&self.log_rate, log_rate),
            cell(&self.temperature, state.temperature),
        ];
        let [_, rates, temperatures] = self.size();
        let (mut value, mut slopes) = (0.0, [0.0; 3]);
        for corner in 0..8 {
            let upper: [bool; 3] = std::array::from_fn(|axis| corner >> axis & 1 == 1);
            // The upper corner of a cell without extent weighs nothing and may not exist.
            if (0..3).any(|axis| upper[axis] && cells[axis].slope == 0.0) {
                continue;
            }
            let index: [usize; 3] =
                std::array::from_fn(|axis| cells[axis].low + usize::from(upper[axis]));
            let stress = self.stress[(index[0] * rates + index[1]) * temperatures + index[2]];
            let weight: [f64; 3] = std::array::from_fn(|axis| {
                if upper[axis] { cells[axis].share } else { 1.0 - cells[axis].share }
            });
            value += weight[0] * weight[1] * weight[2] * stress;
            for (axis, slope) in slopes.iter_mut().enumerate() {
                let sign = if upper[axis] { 1.0 } else { -1.0 };
                let others = weight[(axis + 1) % 3] * weight[(axis + 2) % 3];
                *slope += sign * cells[axis].slope * others * stress;
            }
        }
        (value, slopes)
    }
}

/// The law of a table.
#[derive(Debug, Clone)]
pub struct Tabulated(pub Arc<FlowStressTable>);

impl FlowStressLaw for Tabulated {
    fn flow_stress(&self, state: &FlowState) -> f64 {
        self.0.value(state).0
    }

    fn flow_stress_along(&self, state: &FlowState, change: &FlowState) -> (f64, f64) {
        let (stress, [by_strain, by_log_rate, by_temperature]) = self.0.value(state);
        let rate_change = if state.plastic_strain_rate > 0.0 {
            change.plastic_strain_rate / state.plastic_strain_rate
        } else {
            0.0
        };
        let slope = by_strain * change.plastic_strain
            + by_log_rate * rate_change
            + by_temperature * change.temperature;
        (stress, slope)
    }
}

pub(super) const ENTRY: FlowStressEntry = FlowStressEntry {
    key: "tabulated",
    title: "Table over strain, strain rate and temperature",
    equation: "sigma_y linear between the points of a full grid in eps_p, ln(eps_p_dot) and T; beyond \
               the grid the value at its rim",
    source: "the tests that the table comes from",
    validity: "inside the grid; nothing hardens, softens or depends on the rate beyond it",
    parameters: &[],
    table: Some(
        "CSV of a full grid with the columns plastic_strain, strain_rate [1/s], temperature [degC] and \
         flow_stress [MPa], in any order and with any units",
    ),
    build: |values| {
        let table = values.table_data().expect("a law with a table is built from values with it");
        Box::new(Tabulated(Arc::clone(table)))
    },
};

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Two strains, two rates, three temperatures; 100 MPa at the first corner.
    fn points() -> Vec<[f64; 4]> {
        let mut points = Vec::new();
        for (strain, hardening) in [(0.0, 0.0), (0.5, 200e6)] {
            for (rate, growth) in [(1.0, 0.0), (1e4, 40e6)] {
                for (temperature, softening) in [(300.0, 0.0), (700.0, 0.25), (1500.0, 0.9)] {
                    let stress = (100e6 + hardening + growth) * (1.0 - softening);
                    points.push([strain, rate, temperature, stress]);
                }
            }
        }
        points
    }

    fn at(plastic_strain: f64, plastic_strain_rate: f64, temperature: f64) -> FlowState {
        FlowState { plastic_strain, plastic_strain_rate, temperature }
    }

    fn law() -> Tabulated {
        Tabulated(Arc::new(FlowStressTable::new(&points()).unwrap()))
    }

    #[test]
    fn values_by_hand() {
        let law = law();
        // The corners themselves.
        for [strain, rate, temperature, stress] in points() {
            let found = law.flow_stress(&at(strain, rate, temperature));
            assert_relative_eq!(found, stress, max_relative = 1e-14);
        }
        // Half way in strain, in ln(rate) (100/s) and between 300 and 700 K:
        // (100 + 100 + 20) MPa x 0.875 = 192.5 MPa.
        assert_relative_eq!(
            law.flow_stress(&at(0.25, 100.0, 500.0)),
            192.5e6,
            max_relative = 1e-12
        );
        // Beyond the rim: 340 MPa x 0.1 at large strain, high rate, hot; 100 MPa at rest and cold.
        assert_relative_eq!(law.flow_stress(&at(9.0, 1e7, 2000.0)), 34e6, max_relative = 1e-12);
        assert_relative_eq!(law.flow_stress(&at(0.0, 0.0, 100.0)), 100e6, max_relative = 1e-12);
    }

    #[test]
    fn the_slope_is_that_of_the_flow_stress() {
        let law = law();
        for state in [at(0.2, 30.0, 450.0), at(0.1, 5e3, 1100.0), at(2.0, 1e6, 900.0)] {
            let change = at(0.01, 0.2 * state.plastic_strain_rate, 5.0);
            let moved = |share: f64| {
                law.flow_stress(&at(
                    state.plastic_strain + share * change.plastic_strain,
                    state.plastic_strain_rate + share * change.plastic_strain_rate,
                    state.temperature + share * change.temperature,
                ))
            };
            let quotient = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            let (stress, slope) = law.flow_stress_along(&state, &change);
            // Rounding of the quotient: 1e-16/1e-5 of the stress.
            assert!((slope - quotient).abs() < 1e-9 * stress, "{slope} {quotient}");
        }
    }

    #[test]
    fn one_point_is_a_constant_and_the_order_does_not_matter() {
        let one = Tabulated(Arc::new(FlowStressTable::new(&[[0.1, 1.0, 300.0, 5e8]]).unwrap()));
        assert_eq!(one.flow_stress(&at(3.0, 1e5, 900.0)), 5e8);
        let mut reversed = points();
        reversed.reverse();
        assert_eq!(FlowStressTable::new(&reversed), FlowStressTable::new(&points()));
        assert_eq!(law().0.size(), [2, 2, 3]);
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        let mut gap = points();
        gap.remove(4);
        let missing = FlowStressTable::new(&gap).unwrap_err();
        assert!(
            matches!(missing, TableError::Gap(s, r, t) if s == 0.0 && r == 1e4 && t == 700.0),
            "{missing:?}"
        );
        let mut twice = points();
        twice.push(twice[3]);
        assert_eq!(FlowStressTable::new(&twice), Err(TableError::Twice(12)));
        let mut negative = points();
        negative[5][3] = -1.0;
        assert_eq!(FlowStressTable::new(&negative), Err(TableError::NotPositive(5)));
        // Points on a diagonal would make a grid of their number cubed.
        let diagonal: Vec<[f64; 4]> = (1..2000).map(f64::from).map(|k| [k, k, k, 1e8]).collect();
        assert!(matches!(FlowStressTable::new(&diagonal), Err(TableError::Gap(..))));
        assert_eq!(FlowStressTable::new(&[]), Err(TableError::Empty));
    }
}
