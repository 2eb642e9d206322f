//! Period of a vibration by its zero crossings.

use super::amplitude_ratio::PROBE;
use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::VelocityField;

/// Period of the displacement of a probe; the start counts as its first zero.
pub(crate) const DISPLACEMENT_PERIOD: Observable = Observable {
    name: "displacement_period",
    unit: "s",
    meaning: "twice the mean time between zeros of the displacement of a probe, the start included",
    arguments: &PROBE,
    evaluate: |evidence, arguments| {
        let (probe, axis) = probe(evidence, arguments)?;
        let start = evidence.first()?.position[probe][axis];
        period(evidence, 1, |snapshot| snapshot.position[probe][axis] - start)
    },
};

/// Period of the velocity of a probe.
pub(crate) const VELOCITY_PERIOD: Observable = Observable {
    name: "velocity_period",
    unit: "s",
    meaning: "twice the mean time between zeros of the velocity of a probe",
    arguments: &PROBE,
    evaluate: velocity_period,
};

/// Wavelength of the initial sine over the period of a probe.
pub(crate) const WAVE_SPEED: Observable = Observable {
    name: "wave_speed",
    unit: "m/s",
    meaning: "wavelength of the initial longitudinal sine over the period of a probe's velocity",
    arguments: &PROBE,
    evaluate: |evidence, arguments| match evidence.setup.bodies[0].velocity {
        VelocityField::LongitudinalSine { wavelength, .. } => {
            Ok(wavelength / velocity_period(evidence, arguments)?)
        }
        _ => Err("the first body does not start with a longitudinal sine".to_owned()),
    },
};

fn velocity_period(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let (probe, axis) = probe(evidence, arguments)?;
    period(evidence, 0, |snapshot| snapshot.velocity[probe][axis])
}

fn probe(evidence: &Evidence, arguments: &ObservableArguments) -> Result<(usize, usize), String> {
    let point = ["x", "y", "z"].map(|key| arguments.get(key));
    Ok((evidence.nearest(point)?, arguments.index("axis")))
}

/// Twice the mean distance of the zeros of `signal`, the first `skip` snapshots left out of the
/// search and the instant of the last of them counted as a zero.
fn period(
    evidence: &Evidence,
    skip: usize,
    signal: impl Fn(&Snapshot) -> f64,
) -> Result<f64, String> {
    let points: Vec<(f64, f64)> =
        evidence.snapshots().map(|snapshot| (snapshot.time, signal(snapshot))).collect();
    let mut zeros: Vec<f64> = points.iter().take(skip).map(|point| point.0).collect();
    zeros.extend(crossings(points.get(skip..).unwrap_or_default()));
    if zeros.len() < 2 {
        return Err(format!("{} zero(s) are too few for a period", zeros.len()));
    }
    Ok(2.0 * (zeros[zeros.len() - 1] - zeros[0]) / (zeros.len() - 1) as f64)
}

/// Times at which a sampled signal changes sign, by linear interpolation.
fn crossings(points: &[(f64, f64)]) -> Vec<f64> {
    points
        .windows(2)
        .filter(|pair| pair[0].1 * pair[1].1 < 0.0)
        .map(|pair| {
            let ((start, before), (end, after)) = (pair[0], pair[1]);
            start + (end - start) * before / (before - after)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_sine_crosses_zero_every_half_period() {
        let points: Vec<(f64, f64)> =
            (0..200).map(|index| f64::from(index) * 0.05).map(|time| (time, time.sin())).collect();
        let zeros = crossings(&points[1..]);
        assert_eq!(zeros.len(), 3);
        // Linear interpolation of a sine near its zero: error of order dt^3.
        assert_relative_eq!(zeros[1] - zeros[0], std::f64::consts::PI, max_relative = 1e-5);
    }
}
