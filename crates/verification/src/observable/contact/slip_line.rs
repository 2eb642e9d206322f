//! A smooth tool in a rigid-plastic body, against the slip-line field of the flow.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::ChannelId;

/// Force of the tool over that of the slip-line field.
pub(crate) const SLIP_LINE_RATIO: Observable = Observable {
    name: "slip_line_ratio",
    unit: "",
    meaning: "mean force of the wall along its first velocity between two times, over the load of a \
              slip-line field: `pressure` times 2k times `width`, k = initial yield / sqrt(3) of the \
              first material",
    arguments: &[
        argument("pressure", None, "pressure of the field in terms of 2k"),
        argument("width", None, "width across the motion on which it acts, in m"),
        argument("from", None, "start of the mean in s"),
        argument("to", None, "end of the mean in s"),
    ],
    evaluate: slip_line_ratio,
};

fn slip_line_ratio(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let window = arguments.get("from")..=arguments.get("to");
    let tool = evidence.setup.tool.as_ref().ok_or("the scenario has no wall")?;
    let speed = tool.velocity.iter().map(|component| component * component).sum::<f64>().sqrt();
    if speed == 0.0 {
        return Err("the wall does not move at the start".to_owned());
    }
    let direction = tool.velocity.map(|component| component / speed);
    // The channels hold the force of the tool on the body along +x and, as the feed force does, along -y.
    let forces: Vec<f64> = evidence
        .samples
        .iter()
        .filter(|sample| window.contains(&sample.get(ChannelId::Time)))
        .map(|sample| {
            direction[0] * sample.get(ChannelId::CuttingForce)
                - direction[1] * sample.get(ChannelId::FeedForce)
        })
        .collect();
    if forces.is_empty() {
        return Err("no sample lies between `from` and `to`".to_owned());
    }
    let materials = &evidence.setup.materials;
    let shear_yield = materials[0].flow_stress_values.get("initial_yield") / 3.0_f64.sqrt();
    let load = arguments.get("pressure") * 2.0 * shear_yield * arguments.get("width");
    Ok(forces.iter().sum::<f64>() / forces.len() as f64 / load)
}
