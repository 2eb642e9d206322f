//! Lengths and radii of a deformed body. A particle reaches half a spacing beyond its centre.

use super::{Arguments, Observable, argument};
use crate::evidence::Evidence;
use std::f64::consts::TAU;

/// Extent of all particles along an axis.
pub(super) const BODY_LENGTH: Observable = Observable {
    name: "body_length",
    unit: "m",
    meaning: "extent of the particles along an axis at the end, half a spacing added at each side",
    arguments: &[argument("axis", None, "0, 1 or 2")],
    evaluate: body_length,
};

/// Radius about the z axis at a height above the lowest particle.
pub(super) const RADIUS_AT: Observable = Observable {
    name: "radius_at",
    unit: "m",
    meaning: "largest distance from the z axis at a height above the lowest particle at the end, \
              averaged over eight sectors, half a spacing added",
    arguments: &[argument("height", Some(0.0), "height above the lowest particle in m")],
    evaluate: radius_at,
};

fn body_length(evidence: &Evidence, arguments: &Arguments) -> Result<f64, String> {
    let axis = arguments.index("axis");
    let positions = evidence.last()?.position.iter().map(|position| position[axis]);
    let (low, high) = positions
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    Ok(high - low + evidence.setup.particle_spacing)
}

/// Number of sectors over which the radius is averaged.
const SECTORS: usize = 8;

fn radius_at(evidence: &Evidence, arguments: &Arguments) -> Result<f64, String> {
    let (positions, spacing) = (&evidence.last()?.position, evidence.setup.particle_spacing);
    let lowest = positions.iter().map(|position| position[2]).fold(f64::INFINITY, f64::min);
    let height = lowest + arguments.get("height");
    let mut radii = [f64::NEG_INFINITY; SECTORS];
    for position in positions.iter().filter(|p| (p[2] - height).abs() <= 0.75 * spacing) {
        let angle = position[1].atan2(position[0]).rem_euclid(TAU);
        let sector = ((angle / TAU * SECTORS as f64) as usize).min(SECTORS - 1);
        radii[sector] = radii[sector].max(position[0].hypot(position[1]));
    }
    let mean = radii.iter().sum::<f64>() / SECTORS as f64;
    if mean.is_finite() {
        Ok(mean + 0.5 * spacing)
    } else {
        Err("no particle lies at this height in one of the sectors".to_owned())
    }
}
