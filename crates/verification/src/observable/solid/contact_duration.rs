//! How long and how hard a body touches a wall.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::ChannelId;

/// Share of the largest force below which there is no contact.
const THRESHOLD: f64 = 0.01;

/// Time from the first to the last contact, to one sampling interval.
pub(crate) const CONTACT_DURATION: Observable = Observable {
    name: "contact_duration",
    unit: "s",
    meaning: "time from the first to the last interval with more than 1 % of the largest force",
    arguments: &[],
    evaluate: |evidence, _| contact_duration(evidence),
};

/// Mean magnitude of the contact force in a window of time.
pub(crate) const PLATEAU_FORCE: Observable = Observable {
    name: "plateau_force",
    unit: "N",
    meaning: "mean magnitude of the contact force (per metre of width in 2D) between two times",
    arguments: &[
        argument("from", None, "start of the window in s"),
        argument("to", None, "end of the window in s"),
    ],
    evaluate: plateau_force,
};

fn forces(evidence: &Evidence) -> Vec<(f64, f64)> {
    let channels = [ChannelId::CuttingForce, ChannelId::FeedForce, ChannelId::PassiveForce];
    evidence
        .samples
        .iter()
        .map(|sample| {
            let square: f64 = channels.iter().map(|channel| sample.get(*channel).powi(2)).sum();
            (sample.get(ChannelId::Time), square.sqrt())
        })
        .collect()
}

fn contact_duration(evidence: &Evidence) -> Result<f64, String> {
    let forces = forces(evidence);
    let limit = THRESHOLD * forces.iter().map(|point| point.1).fold(0.0, f64::max);
    let touching: Vec<usize> = (0..forces.len()).filter(|index| forces[*index].1 > limit).collect();
    let (Some(first), Some(last)) = (touching.first(), touching.last()) else {
        return Err("the body never touches the wall".to_owned());
    };
    let start = if *first == 0 { 0.0 } else { forces[first - 1].0 };
    Ok(forces[*last].0 - start)
}

fn plateau_force(evidence: &Evidence, arguments: &ObservableArguments) -> Result<f64, String> {
    let (from, to) = (arguments.get("from"), arguments.get("to"));
    let inside: Vec<f64> = forces(evidence)
        .into_iter()
        .filter(|(time, _)| (from..=to).contains(time))
        .map(|(_, force)| force)
        .collect();
    if inside.is_empty() {
        return Err("no sampling interval ends in the window".to_owned());
    }
    Ok(inside.iter().sum::<f64>() / inside.len() as f64)
}
