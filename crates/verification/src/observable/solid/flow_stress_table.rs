//! The flow-stress law of a scenario against hand values.

use crate::evidence::Evidence;
use crate::observable::Observable;
use sphcut_physics::flow_stress::FlowState;

/// Largest relative deviation from the rows of `reference.csv`.
pub(crate) const FLOW_STRESS_TABLE_ERROR: Observable = Observable {
    name: "flow_stress_table_error",
    unit: "",
    meaning: "largest deviation of the first material's flow stress from the rows of \
              reference.csv (plastic_strain, plastic_strain_rate, temperature, flow_stress), in \
              terms of the largest stress there",
    arguments: &[],
    evaluate: |evidence, _| flow_stress_table_error(evidence),
};

fn flow_stress_table_error(evidence: &Evidence) -> Result<f64, String> {
    let material = &evidence.setup.materials[0];
    let law = (material.flow_stress.build)(&material.flow_stress_values);
    let table = &evidence.reference;
    let strain = table.numbers("plastic_strain")?;
    let rate = table.numbers("plastic_strain_rate")?;
    let temperature = table.numbers("temperature")?;
    let expected = table.numbers("flow_stress")?;
    if table.is_empty() {
        return Err("reference.csv has no rows".to_owned());
    }
    let largest = expected.iter().copied().fold(0.0, f64::max);
    let deviations = (0..table.len()).map(|row| {
        let state = FlowState {
            plastic_strain: strain[row],
            plastic_strain_rate: rate[row],
            temperature: temperature[row],
        };
        (law.flow_stress(&state) - expected[row]).abs() / largest
    });
    Ok(deviations.fold(0.0, f64::max))
}
