//! A flat punch in a rigid-plastic half plane.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::ChannelId;
use std::f64::consts::PI;

/// Force of the punch over Prandtl's.
pub(crate) const PRANDTL_RATIO: Observable = Observable {
    name: "prandtl_ratio",
    unit: "",
    meaning: "mean force of the wall against the feed direction between two times over Prandtl's \
              limit for a flat punch, (2 + pi) k times its width, k = initial yield / sqrt(3) of the \
              first material",
    arguments: &[
        argument("width", None, "width of the punch in m"),
        argument("from", None, "start of the mean in s"),
        argument("to", None, "end of the mean in s"),
    ],
    evaluate: prandtl_ratio,
};

fn prandtl_ratio(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let window = arguments.get("from")..=arguments.get("to");
    let forces: Vec<f64> = evidence
        .samples
        .iter()
        .filter(|sample| window.contains(&sample.get(ChannelId::Time)))
        .map(|sample| sample.get(ChannelId::FeedForce))
        .collect();
    if forces.is_empty() {
        return Err("no sample lies between `from` and `to`".to_owned());
    }
    let shear_yield =
        evidence.setup.materials[0].flow_stress_values.get("initial_yield") / 3.0_f64.sqrt();
    let limit = (2.0 + PI) * shear_yield * arguments.get("width");
    Ok(forces.iter().sum::<f64>() / forces.len() as f64 / limit)
}
