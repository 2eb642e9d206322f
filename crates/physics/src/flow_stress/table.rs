//! Measured flow stresses over strain, strain rate and temperature.

use super::law::FlowState;

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
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FlowStressTableError {
    /// No point at all.
    #[error("the table is empty")]
    Empty,
    /// A value that is not finite, or not positive where it has to be: index of the point.
    #[error("rate, temperature and flow stress must be above 0, the strain not below")]
    NotPositive(usize),
    /// The same strain, rate and temperature twice: index of the second point.
    #[error("this strain, rate and temperature are there twice")]
    Twice(usize),
    /// A corner of the grid without a value: strain, rate in 1/s and temperature in K.
    #[error("the table is no full grid: it has nothing at strain {0}, rate {1} 1/s and {2} K")]
    Gap(f64, f64, f64),
}

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
    pub fn new(points: &[[f64; 4]]) -> Result<Self, FlowStressTableError> {
        if points.is_empty() {
            return Err(FlowStressTableError::Empty);
        }
        let bad = |point: &[f64; 4]| {
            let positive = point[1..].iter().all(|value| *value > 0.0 && value.is_finite());
            !(positive && point[0] >= 0.0 && point[0].is_finite())
        };
        if let Some(index) = points.iter().position(bad) {
            return Err(FlowStressTableError::NotPositive(index));
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
                Some(Some(_)) => return Err(FlowStressTableError::Twice(index)),
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

    fn gap(
        place: usize,
        strain: &[f64],
        rate: &[f64],
        temperature: &[f64],
    ) -> FlowStressTableError {
        let (row, warmth) = (place / temperature.len(), place % temperature.len());
        FlowStressTableError::Gap(
            strain[row / rate.len()],
            rate[row % rate.len()],
            temperature[warmth],
        )
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
    pub(super) fn value(&self, state: &FlowState) -> (f64, [f64; 3]) {
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
