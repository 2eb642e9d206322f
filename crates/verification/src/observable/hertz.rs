//! Line contact of a cylinder with a rigid wall below it (Hertz; Johnson, Contact Mechanics,
//! 1985, section 4.2): half-width a = sqrt(4 F R / (pi E')), largest pressure
//! p_0 = sqrt(F E' / (pi R)), E' = E / (1 - nu^2), F per width.

use super::{Arguments, Observable, argument};
use crate::evidence::Evidence;
use sphcut_sph::Snapshot;
use sphcut_sph::setup::Shape;
use std::f64::consts::PI;

const SHARE: super::Argument =
    argument("share", Some(0.25), "share of the run whose snapshots are averaged, from its end");

/// Half-width of the contact over Hertz's.
pub(super) const HERTZ_WIDTH_RATIO: Observable = Observable {
    name: "hertz_width_ratio",
    unit: "",
    meaning: "contact half-width (twice the standard deviation of the contact force along the \
              wall, exact for an elliptic pressure) over Hertz's for the same force",
    arguments: &[SHARE],
    evaluate: |evidence, arguments| mean(evidence, arguments, width_ratio),
};

/// Largest normal stress over Hertz's pressure.
pub(super) const HERTZ_PRESSURE_RATIO: Observable = Observable {
    name: "hertz_pressure_ratio",
    unit: "",
    meaning: "largest compressive stress normal to the wall over Hertz's pressure for the same \
              force",
    arguments: &[SHARE],
    evaluate: |evidence, arguments| mean(evidence, arguments, pressure_ratio),
};

struct Line {
    radius: f64,
    modulus: f64,
}

fn mean(
    evidence: &Evidence,
    arguments: &Arguments,
    ratio: fn(&Line, &Snapshot) -> f64,
) -> Result<f64, String> {
    let Shape::Cylinder { radius, .. } = evidence.setup.bodies[0].shape else {
        return Err("the first body is not a cylinder".to_owned());
    };
    let moduli = &evidence.setup.materials[evidence.setup.bodies[0].material].moduli;
    let (bulk, shear) = (moduli.bulk, moduli.shear);
    let poisson = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
    let line = Line { radius, modulus: moduli.young() / (1.0 - poisson * poisson) };
    let start = (1.0 - arguments.get("share")) * evidence.last()?.time;
    let ratios: Vec<f64> = evidence
        .snapshots
        .iter()
        .filter(|snapshot| snapshot.time >= start && force(snapshot) > 0.0)
        .map(|snapshot| ratio(&line, snapshot))
        .collect();
    if ratios.is_empty() {
        return Err("the cylinder does not touch the wall".to_owned());
    }
    Ok(ratios.iter().sum::<f64>() / ratios.len() as f64)
}

fn force(snapshot: &Snapshot) -> f64 {
    snapshot.contact_force.iter().map(|force| force[1]).sum()
}

fn width_ratio(line: &Line, snapshot: &Snapshot) -> f64 {
    let total = force(snapshot);
    let weighted = |power: i32, centre: f64| {
        let terms = snapshot.contact_force.iter().zip(&snapshot.position);
        terms.map(|(force, position)| force[1] * (position[0] - centre).powi(power)).sum::<f64>()
            / total
    };
    let centre = weighted(1, 0.0);
    let half_width = 2.0 * weighted(2, centre).sqrt();
    half_width / (4.0 * total * line.radius / (PI * line.modulus)).sqrt()
}

fn pressure_ratio(line: &Line, snapshot: &Snapshot) -> f64 {
    let largest = snapshot.stress.iter().map(|stress| -stress[1]).fold(0.0, f64::max);
    largest / (force(snapshot) * line.modulus / (PI * line.radius)).sqrt()
}
