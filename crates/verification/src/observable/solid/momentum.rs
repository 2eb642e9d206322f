//! The balance of momentum.

use crate::evidence::Evidence;
use crate::observable::Observable;
use sphcut_sph::{ChannelId, Snapshot};

/// Change of the total momentum of bodies on which nothing acts.
pub(crate) const MOMENTUM_DRIFT: Observable = Observable {
    name: "momentum_drift",
    unit: "",
    meaning: "largest change of the total momentum over the sum of m |v| at the start",
    arguments: &[],
    evaluate: |evidence, _| {
        let start = momentum(evidence, evidence.first()?);
        let scale = momentum_scale(evidence, evidence.first()?);
        let drift = |snapshot: &Snapshot| {
            let now = momentum(evidence, snapshot);
            (0..3).map(|axis| (now[axis] - start[axis]).powi(2)).sum::<f64>().sqrt() / scale
        };
        Ok(evidence.snapshots().map(drift).fold(0.0, f64::max))
    },
};

/// Contact force plus support reaction minus rate of change of momentum.
pub(crate) const MOMENTUM_CLOSURE: Observable = Observable {
    name: "momentum_closure",
    unit: "",
    meaning: "|mean contact force + support reaction - change of momentum / time| over the mean \
              contact force, the larger of cutting and feed direction",
    arguments: &[],
    evaluate: |evidence, _| momentum_closure(evidence),
};

fn momentum(evidence: &Evidence, snapshot: &Snapshot) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (velocity, body) in snapshot.velocity.iter().zip(&snapshot.body) {
        let mass = evidence.particle_mass(*body);
        for axis in 0..3 {
            sum[axis] += mass * velocity[axis];
        }
    }
    sum
}

fn momentum_scale(evidence: &Evidence, snapshot: &Snapshot) -> f64 {
    let speeds = snapshot.velocity.iter().map(|v| v[0].hypot(v[1]).hypot(v[2]));
    speeds.zip(&snapshot.body).map(|(speed, body)| evidence.particle_mass(*body) * speed).sum()
}

fn momentum_closure(evidence: &Evidence) -> Result<f64, String> {
    if evidence.samples.len() < 2 {
        return Err("the run closed too few sampling intervals".to_owned());
    }
    let directions = [
        (ChannelId::CuttingForce, ChannelId::ReactionCutting, ChannelId::MomentumCutting),
        (ChannelId::FeedForce, ChannelId::ReactionFeed, ChannelId::MomentumFeed),
    ];
    // The first interval only serves as the starting point of the momentum.
    let time = evidence.series(ChannelId::Time);
    let duration = time[time.len() - 1] - time[0];
    let impulse = |channel| {
        let force = evidence.series(channel);
        (1..time.len()).map(|index| force[index] * (time[index] - time[index - 1])).sum::<f64>()
    };
    let scale = directions.map(|(contact, _, _)| impulse(contact)).map(f64::abs);
    let scale = scale[0].max(scale[1]);
    if scale == 0.0 || duration <= 0.0 {
        return Err("nothing touches the tool".to_owned());
    }
    let errors = directions.map(|(contact, reaction, momentum)| {
        let momentum = evidence.series(momentum);
        let change = momentum[momentum.len() - 1] - momentum[0];
        (impulse(contact) + impulse(reaction) - change).abs() / scale
    });
    Ok(errors[0].max(errors[1]))
}
