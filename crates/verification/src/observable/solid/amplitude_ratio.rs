//! How much of a vibration is left.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};

pub(crate) const PROBE: [Argument; 4] = [
    argument("x", None, "x of the probe in m"),
    argument("y", Some(0.0), "y of the probe in m"),
    argument("z", Some(0.0), "z of the probe in m"),
    argument("axis", None, "component that is watched: 0, 1 or 2"),
];

/// Largest speed of a probe over the last part of the run over its speed at the start.
pub(crate) const AMPLITUDE_RATIO: Observable = Observable {
    name: "amplitude_ratio",
    unit: "",
    meaning: "largest |v| of the particle nearest to a probe after `from`, over |v| at the start",
    arguments: &[
        PROBE[0],
        PROBE[1],
        PROBE[2],
        PROBE[3],
        argument("from", None, "start of the last part in s"),
    ],
    evaluate: amplitude_ratio,
};

fn amplitude_ratio(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let probe = evidence.nearest(["x", "y", "z"].map(|key| arguments.get(key)))?;
    let (axis, from) = (arguments.index("axis"), arguments.get("from"));
    let speed = |snapshot: &sphcut_sph::Snapshot| snapshot.velocity[probe][axis].abs();
    let late = evidence.snapshots().filter(|snapshot| snapshot.time >= from);
    Ok(late.map(speed).fold(0.0, f64::max) / speed(evidence.first()?))
}
