//! A force history against a reference history.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_sph::ChannelId;

const ARGUMENTS: &[Argument] =
    &[argument("from", Some(0.0), "travel in m from which the bins of the reference count")];

/// Root mean square deviation of the cutting force.
pub(crate) const CUTTING_FORCE_DEVIATION: Observable = Observable {
    name: "cutting_force_deviation",
    unit: "",
    meaning: "root mean square deviation of F_c from reference.csv (travel_from, travel_to, \
              cutting_force) over its bins of travel, in terms of the reference's mean",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| {
        deviation(evidence, arguments, ChannelId::CuttingForce, "cutting_force")
    },
};

/// Root mean square deviation of the feed force.
pub(crate) const FEED_FORCE_DEVIATION: Observable = Observable {
    name: "feed_force_deviation",
    unit: "",
    meaning: "the same for F_f (feed_force)",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| {
        deviation(evidence, arguments, ChannelId::FeedForce, "feed_force")
    },
};

fn deviation(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    channel: ChannelId,
    column: &str,
) -> Result<f64, String> {
    let from = evidence.reference.numbers("travel_from")?;
    let to = evidence.reference.numbers("travel_to")?;
    let expected = evidence.reference.numbers(column)?;
    let (travel, force) = (evidence.series(ChannelId::Travel), evidence.series(channel));
    let (mut squares, mut sum, mut count) = (0.0, 0.0, 0.0);
    for bin in (0..expected.len()).filter(|bin| from[*bin] >= arguments.get("from")) {
        let inside: Vec<f64> = (0..travel.len())
            .filter(|index| travel[*index] > from[bin] && travel[*index] <= to[bin])
            .map(|index| force[index])
            .collect();
        if inside.is_empty() {
            return Err(format!("the run has no force between {} and {} m", from[bin], to[bin]));
        }
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        squares += (mean - expected[bin]).powi(2);
        sum += expected[bin];
        count += 1.0;
    }
    Ok((squares / count).sqrt() / (sum / count))
}
