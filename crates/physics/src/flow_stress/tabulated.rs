//! A flow stress given as a table over strain, strain rate and temperature.

use super::{FlowState, FlowStressEntry, FlowStressLaw, FlowStressTable};
use std::sync::Arc;

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
    use crate::flow_stress::FlowStressTableError;
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
            matches!(missing, FlowStressTableError::Gap(s, r, t) if s == 0.0 && r == 1e4 && t == 700.0),
            "{missing:?}"
        );
        let mut twice = points();
        twice.push(twice[3]);
        assert_eq!(FlowStressTable::new(&twice), Err(FlowStressTableError::Twice(12)));
        let mut negative = points();
        negative[5][3] = -1.0;
        assert_eq!(FlowStressTable::new(&negative), Err(FlowStressTableError::NotPositive(5)));
        // Points on a diagonal would make a grid of their number cubed.
        let diagonal: Vec<[f64; 4]> = (1..2000).map(f64::from).map(|k| [k, k, k, 1e8]).collect();
        assert!(matches!(FlowStressTable::new(&diagonal), Err(FlowStressTableError::Gap(..))));
        assert_eq!(FlowStressTable::new(&[]), Err(FlowStressTableError::Empty));
    }
}
