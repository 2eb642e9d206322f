//! Lengths and radii of a deformed body. A particle reaches half a spacing beyond its centre.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use std::f64::consts::TAU;

/// Extent of all particles along an axis.
pub(crate) const BODY_LENGTH: Observable = Observable {
    name: "body_length",
    unit: "m",
    meaning: "extent of the particles along an axis at the end, half a spacing added at each side",
    arguments: &[argument("axis", None, "0, 1 or 2")],
    evaluate: body_length,
};

/// Radius about the z axis at a height above the lowest particle.
pub(crate) const RADIUS_AT: Observable = Observable {
    name: "radius_at",
    unit: "m",
    meaning: "largest distance from the z axis at a height above the lowest particle at the end, \
              half a spacing added",
    arguments: &[argument("height", Some(0.0), "height above the lowest particle in m")],
    evaluate: radius_at,
};

fn body_length(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let axis = arguments.index("axis");
    let positions = evidence.last()?.position.iter().map(|position| position[axis]);
    let (low, high) = positions
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    Ok(high - low + evidence.setup.particle_spacing)
}

/// Largest radius about the z axis.
pub(crate) const LARGEST_RADIUS: Observable = Observable {
    name: "largest_radius",
    unit: "m",
    meaning: "largest distance of a particle from the z axis at the end, half a spacing added",
    arguments: &[],
    evaluate: |evidence, _| {
        let radii = evidence.last()?.position.iter().map(|p| p[0].hypot(p[1]));
        Ok(radii.fold(0.0, f64::max) + 0.5 * evidence.setup.particle_spacing)
    },
};

/// Mean radius of the sectors about the z axis.
pub(crate) const FOOT_RADIUS: Observable = Observable {
    name: "foot_radius",
    unit: "m",
    meaning: "mean reach from the z axis of 16 sectors, over the particles within three spacings of the lowest one at \
              the end, half a spacing added",
    arguments: &[],
    evaluate: |evidence, _| {
        let reaches = reaches(evidence)?;
        Ok(reaches.iter().sum::<f64>() / reaches.len() as f64)
    },
};

/// Smallest over largest radius of the sectors about the z axis.
pub(crate) const ROUNDNESS: Observable = Observable {
    name: "roundness",
    unit: "",
    meaning: "smallest over largest reach from the z axis of 16 sectors, over the particles within \
              three spacings of the lowest one at the end, half a spacing added",
    arguments: &[],
    evaluate: |evidence, _| {
        let reaches = reaches(evidence)?;
        let (least, largest) =
            reaches.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), r| (l.min(*r), h.max(*r)));
        Ok(least / largest)
    },
};

fn radius_at(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let (positions, spacing) = (&evidence.last()?.position, evidence.setup.particle_spacing);
    let height = lowest(positions) + arguments.get("height");
    let radius = positions
        .iter()
        .filter(|position| (position[2] - height).abs() <= 0.75 * spacing)
        .map(|position| position[0].hypot(position[1]))
        .fold(f64::NEG_INFINITY, f64::max);
    if radius.is_finite() {
        Ok(radius + 0.5 * spacing)
    } else {
        Err("no particle lies at this height".to_owned())
    }
}

fn lowest(positions: &[[f64; 3]]) -> f64 {
    positions.iter().map(|position| position[2]).fold(f64::INFINITY, f64::min)
}

/// Number of sectors of [`FOOT_RADIUS`] and [`ROUNDNESS`]: 22.5 deg each, several spacings of drawn-out material at a rim, the
/// first about the x axis. Particles of a lattice lie on the axes and diagonals by symmetry; no boundary may.
const SECTORS: usize = 16;

/// Reach of each sector from the z axis in m.
fn reaches(evidence: &Evidence) -> Result<[f64; SECTORS], String> {
    let (positions, spacing) = (&evidence.last()?.position, evidence.setup.particle_spacing);
    let top = lowest(positions) + 3.0 * spacing;
    let mut radii = [0.0_f64; SECTORS];
    for position in positions.iter().filter(|position| position[2] <= top) {
        let angle = position[1].atan2(position[0]).rem_euclid(TAU);
        let sector = (angle / TAU * SECTORS as f64).round() as usize % SECTORS;
        radii[sector] = radii[sector].max(position[0].hypot(position[1]));
    }
    if radii.iter().any(|radius| *radius > 0.0) {
        Ok(radii.map(|radius| radius + 0.5 * spacing))
    } else {
        Err("no particle lies off the axis".to_owned())
    }
}
