//! Mean forces over the last part of a run.

use crate::evidence::Evidence;
use crate::observable::{Argument, Observable, ObservableArguments, argument};
use sphcut_sph::ChannelId;

const ARGUMENTS: &[Argument] =
    &[argument("share", Some(0.5), "share of the run that counts, from its end")];

/// Number of batches of the confidence interval.
const BATCHES: usize = 8;
/// Student's t for 7 degrees of freedom at 95 %.
const STUDENT: f64 = 2.365;

/// F_c.
pub(crate) const CUTTING_FORCE: Observable = Observable {
    name: "cutting_force",
    unit: "N/m",
    meaning: "mean cutting force per width over the last part of the run",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| mean(evidence, arguments, ChannelId::CuttingForce),
};

/// F_f.
pub(crate) const FEED_FORCE: Observable = Observable {
    name: "feed_force",
    unit: "N/m",
    meaning: "mean feed (thrust) force per width over the last part of the run",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| mean(evidence, arguments, ChannelId::FeedForce),
};

/// Half-width of the 95 % interval of F_c.
pub(crate) const CUTTING_FORCE_INTERVAL: Observable = Observable {
    name: "cutting_force_interval",
    unit: "N/m",
    meaning: "half-width of the 95 % interval of the mean cutting force from 8 batch means",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| interval(evidence, arguments, ChannelId::CuttingForce),
};

/// Half-width of the 95 % interval of F_f.
pub(crate) const FEED_FORCE_INTERVAL: Observable = Observable {
    name: "feed_force_interval",
    unit: "N/m",
    meaning: "the same for the feed force",
    arguments: ARGUMENTS,
    evaluate: |evidence, arguments| interval(evidence, arguments, ChannelId::FeedForce),
};

fn tail(evidence: &Evidence, arguments: &ObservableArguments, channel: ChannelId) -> Vec<f64> {
    let series = evidence.series(channel);
    let count = (series.len() as f64 * arguments.get("share")).round() as usize;
    series[series.len() - count.min(series.len())..].to_vec()
}

fn mean(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    channel: ChannelId,
) -> Result<f64, String> {
    let tail = tail(evidence, arguments, channel);
    if tail.is_empty() {
        return Err("the run closed no sampling interval".to_owned());
    }
    Ok(tail.iter().sum::<f64>() / tail.len() as f64)
}

fn interval(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    channel: ChannelId,
) -> Result<f64, String> {
    let tail = tail(evidence, arguments, channel);
    let length = tail.len() / BATCHES;
    if length == 0 {
        return Err(format!("{} intervals are too few for {BATCHES} batches", tail.len()));
    }
    let means: Vec<f64> = tail
        .chunks_exact(length)
        .take(BATCHES)
        .map(|batch| batch.iter().sum::<f64>() / length as f64)
        .collect();
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let variance = means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Ok(STUDENT * (variance / count).sqrt())
}
