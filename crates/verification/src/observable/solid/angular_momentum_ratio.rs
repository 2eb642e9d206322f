//! Whether angular momentum is kept.

use crate::evidence::Evidence;
use crate::observable::Observable;
use sphcut_sph::Snapshot;

/// L_z at the end over L_z at the start, about the origin.
pub(crate) const ANGULAR_MOMENTUM_RATIO: Observable = Observable {
    name: "angular_momentum_ratio",
    unit: "",
    meaning: "angular momentum about z at the end over that at the start",
    arguments: &[],
    evaluate: |evidence, _| {
        Ok(angular_momentum(evidence, evidence.last()?)
            / angular_momentum(evidence, evidence.first()?))
    },
};

/// sum of m (x v_y - y v_x).
fn angular_momentum(evidence: &Evidence, snapshot: &Snapshot) -> f64 {
    let moment = |index: usize| {
        let (position, velocity) = (snapshot.position[index], snapshot.velocity[index]);
        position[0] * velocity[1] - position[1] * velocity[0]
    };
    (0..snapshot.id.len())
        .map(|index| evidence.particle_mass(snapshot.body[index]) * moment(index))
        .sum()
}
