//! How fast bodies part after a collision.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::Snapshot;

/// Speed of separation over speed of approach of the first two bodies.
pub(crate) const RESTITUTION: Observable = Observable {
    name: "restitution",
    unit: "",
    meaning: "relative speed of the first two bodies' centres at the end over that at the start, \
              with the sign of separation",
    arguments: &[argument("axis", Some(0.0), "direction of the collision: 0, 1 or 2")],
    evaluate: |evidence, arguments| {
        let axis = arguments.index("axis");
        let relative = |snapshot: &Snapshot| {
            mean_velocity(snapshot, 1, axis) - mean_velocity(snapshot, 0, axis)
        };
        Ok(-relative(evidence.last()?) / relative(evidence.first()?))
    },
};

/// Speed of rebound over speed of impact of the first body.
pub(crate) const REBOUND: Observable = Observable {
    name: "rebound",
    unit: "",
    meaning: "velocity of the first body's centre at the end over that at the start, sign turned",
    arguments: &[argument("axis", None, "direction of the impact: 0, 1 or 2")],
    evaluate: rebound,
};

fn rebound(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let axis = arguments.index("axis");
    Ok(-mean_velocity(evidence.last()?, 0, axis) / mean_velocity(evidence.first()?, 0, axis))
}

/// Velocity of the centre of a body of equal particles.
fn mean_velocity(snapshot: &Snapshot, body: u32, axis: usize) -> f64 {
    let of_body = snapshot.velocity.iter().zip(&snapshot.body).filter(|(_, owner)| **owner == body);
    let (count, sum) =
        of_body.fold((0.0, 0.0), |(count, sum), (v, _)| (count + 1.0, sum + v[axis]));
    sum / count
}
