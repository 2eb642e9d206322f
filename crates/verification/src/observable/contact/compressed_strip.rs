//! A strip of ideally plastic material compressed between plates, plane strain. The first body is a quarter
//! of it: a box with the middle of the strip at its smallest corner, the wall moves against its upper side.

use super::rough_plates;
use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_sph::ChannelId;
use sphcut_sph::setup::Shape;

const ARGUMENTS: &[Argument] = &[
    argument("from", None, "start of the mean in s"),
    argument("to", None, "end of the mean in s"),
];

/// Force of a rough plate over that of the slip-line field.
pub(crate) const ROUGH_PLATES_RATIO: Observable = Observable {
    name: "rough_plates_ratio",
    unit: "",
    meaning: "mean force of the wall between two times over that of the slip-line field of a strip between rough \
              plates, k = initial yield / sqrt(3); the width of the strip follows from its height at \
              constant volume",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| force_ratio(evidence, arguments, rough_plates::mean_pressure),
};

/// Force of a plate with Coulomb friction over that of the slab solution.
///
/// Slices of the strip slide on the plates and yield where `p - sigma_x = 2k` (Siebel, von Karman):
/// ```text
/// p = 2k exp(2 mu (w/2 - x) / h),   mean: 2k (h / mu w) (exp(mu w / h) - 1)
/// ```
/// It neglects the shear stress in the yield condition, `1 - sqrt(1 - (tau/k)^2)` at the plates and a third of it over
/// the height, and holds while `mu p < k`.
pub(crate) const SLIDING_PLATES_RATIO: Observable = Observable {
    name: "sliding_plates_ratio",
    unit: "",
    meaning: "mean force of the wall between two times over that of the slab solution with the friction coefficient \
              of the wall, (h / mu w) (exp(mu w / h) - 1) times 2k; the width of the strip follows from its height \
              at constant volume",
    arguments: ARGUMENTS,
    evaluate: sliding_plates_ratio,
};

fn sliding_plates_ratio(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let tool = evidence.setup.tool.as_ref().ok_or("there is no wall")?;
    let coefficient = tool.friction_values.get("friction_coefficient");
    let (width, height) = quarter(evidence)?;
    if 2.0 * coefficient * (coefficient * width / height).exp() > 1.0 {
        return Err("the strip sticks in its middle: mu p exceeds k".to_owned());
    }
    force_ratio(evidence, arguments, |ratio| slab_pressure(coefficient * ratio))
}

/// Mean pressure of the slab solution over 2k, `exponent` = mu w / h.
fn slab_pressure(exponent: f64) -> f64 {
    if exponent > 0.0 { exponent.exp_m1() / exponent } else { 1.0 }
}

/// Width and height of the quarter in m.
fn quarter(evidence: &Evidence) -> Result<(f64, f64), String> {
    match evidence.setup.bodies.first().map(|body| &body.shape) {
        Some(Shape::Box { min, max, .. }) => Ok((max[0] - min[0], max[1] - min[1])),
        _ => Err("the strip has to be a box".to_owned()),
    }
}

/// Sum of the forces over that of the limits `pressure(w/h)` in 2k.
fn force_ratio(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    pressure: impl Fn(f64) -> f64,
) -> Result<f64, String> {
    let tool = evidence.setup.tool.as_ref().ok_or("there is no wall")?;
    let (width, height) = quarter(evidence)?;
    let flow_stress = evidence.setup.materials[0].flow_stress_values.get("initial_yield");
    let window = arguments.get("from")..=arguments.get("to");
    let (mut force, mut limit) = (0.0, 0.0);
    for sample in &evidence.samples {
        let time = sample.get(ChannelId::Time);
        if window.contains(&time) {
            let now = height + tool.velocity[1] * time;
            let wide = width * height / now;
            force += sample.get(ChannelId::FeedForce);
            limit += 2.0 * flow_stress / 3.0_f64.sqrt() * wide * pressure(wide / now);
        }
    }
    if limit > 0.0 {
        Ok(force / limit)
    } else {
        Err("no sample lies between `from` and `to`".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_raises_the_pressure_on_a_slab() {
        assert_eq!(slab_pressure(0.0), 1.0);
        // mu 0.1, w/h 4: (1.491825 - 1) / 0.4 = 1.229562
        assert!((slab_pressure(0.4) - 1.229562).abs() < 1e-6);
        assert!((slab_pressure(1e-9) - 1.0).abs() < 1e-8);
    }
}
