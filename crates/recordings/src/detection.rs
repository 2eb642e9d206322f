//! Where in a record the cut is.

use super::Fault;
use sphcut_postprocess::statistics::{mean, quantile};

/// How the cut is found in a record.
#[derive(Debug, Clone, PartialEq)]
pub enum Detection {
    /// From the cutting force itself.
    Automatic {
        /// Length of the moving mean in s.
        smoothing: f64,
    },
    /// From a channel that rises above `level` while the tool cuts.
    Trigger {
        /// In the numbers of the file.
        level: f64,
    },
    /// As the user says for each cut.
    Given,
}

/// Entry and exit as indices of samples; the record holds the whole of `entry..exit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// First sample of the cut.
    pub entry: usize,
    /// First sample behind it.
    pub exit: usize,
}

/// The two levels of the smoothed force must be this many standard deviations of the air cut apart.
const APART_FROM_AIR: f64 = 6.0;
/// And this many of the cut. Two halves of one normal distribution are 2.2 apart, those of a ramp 2.9.
const APART_FROM_CUT: f64 = 3.2;
/// Share of the rise at which the cut begins.
const EDGE: f64 = 0.05;

/// The cut in the force: the smoothed record has two levels, told apart by the threshold that minimises
/// the variance within both classes (Otsu, IEEE Trans. Syst. Man Cybern. 9 (1979) 62); from there the
/// edges are followed down to 5 % of the rise.
///
/// # Errors
/// No two levels, several cuts, a force that falls when the cut begins.
pub(super) fn automatic(
    force: &[f64],
    rate: f64,
    smoothing: f64,
    pause: f64,
) -> Result<Span, Fault> {
    let width = ((smoothing * rate).round() as usize).clamp(1, force.len().max(1));
    let smooth = moving_mean(force, width);
    let (threshold, [low, high]) = otsu(&smooth);
    let class = |upper: bool| -> Vec<f64> {
        smooth.iter().copied().filter(|v| (*v > threshold) == upper).collect()
    };
    let (below, above) = (class(false), class(true));
    if below.is_empty() || above.is_empty() {
        return Err(Fault::NoCut { levels: [low, high] });
    }
    let rise = high - low;
    let upper_at_ends =
        [smooth.first(), smooth.last()].map(|end| end.is_some_and(|v| *v > threshold));
    // The outer parts of the record are air: if they lie above, the force falls in the cut.
    if upper_at_ends == [true, true] && separated(&below, &above, rise) {
        return Err(Fault::WrongSign { channel: String::new(), mean: -rise });
    }
    if !separated(&below, &above, rise) {
        return Err(Fault::NoCut { levels: [low, high] });
    }
    let break_length = ((pause * rate).round() as usize).max(width);
    let spans = runs(&smooth, threshold, break_length);
    let longest = spans.iter().map(|s| s.exit - s.entry).max().unwrap_or(0);
    let long: Vec<Span> = spans.into_iter().filter(|s| 5 * (s.exit - s.entry) >= longest).collect();
    let &[span] = long.as_slice() else {
        let time = |index: usize| index as f64 / rate;
        let cuts = long.iter().map(|s| [time(s.entry), time(s.exit)]).collect();
        return Err(Fault::SeveralCuts { cuts });
    };
    let edge = low + EDGE * rise;
    let entry = smooth[..span.entry].iter().rposition(|v| *v < edge).map_or(0, |k| k + 1);
    let exit = smooth[span.exit..].iter().position(|v| *v < edge);
    Ok(Span { entry, exit: exit.map_or(force.len(), |k| span.exit + k) })
}

/// Whether two classes of the smoothed force are more than the two halves of one noise. The spread of each
/// is taken on its outer side: entry and exit lie between them.
fn separated(lower: &[f64], upper: &[f64], rise: f64) -> bool {
    let air = quantile(lower, 0.5) - quantile(lower, 0.159);
    let cut = quantile(upper, 0.841) - quantile(upper, 0.5);
    rise > 0.0 && rise > APART_FROM_AIR * air && rise > APART_FROM_CUT * cut
}

/// Stretches above the threshold, those with breaks up to `pause` samples taken together.
fn runs(values: &[f64], threshold: f64, pause: usize) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for (index, value) in values.iter().enumerate() {
        if *value <= threshold {
            continue;
        }
        match spans.last_mut() {
            Some(last) if index - last.exit <= pause => last.exit = index + 1,
            _ => spans.push(Span { entry: index, exit: index + 1 }),
        }
    }
    spans
}

/// Centred mean over `width` samples, shorter at the ends.
pub(super) fn moving_mean(values: &[f64], width: usize) -> Vec<f64> {
    // About a middle value, so that the running sum loses no digits to an offset.
    let offset = mean(values);
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + (value - offset));
    }
    let (before, after) = (width / 2, width - width / 2);
    (0..values.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(before), (k + after).min(values.len()));
            offset + (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}

/// Otsu's threshold over 256 bins, and the means of both classes.
fn otsu(values: &[f64]) -> (f64, [f64; 2]) {
    const BINS: usize = 256;
    let (low, high) = (quantile(values, 0.0), quantile(values, 1.0));
    let width = (high - low) / BINS as f64;
    if width <= 0.0 || !width.is_finite() {
        return (high, [low, high]);
    }
    let mut counts = [0.0; BINS];
    let mut sums = [0.0; BINS];
    for value in values {
        let bin = (((value - low) / width) as usize).min(BINS - 1);
        counts[bin] += 1.0;
        sums[bin] += value;
    }
    let (all, total) = (counts.iter().sum::<f64>(), sums.iter().sum::<f64>());
    let (mut count, mut sum) = (0.0, 0.0);
    let mut best = (-1.0, high, [low, high]);
    for bin in 0..BINS - 1 {
        count += counts[bin];
        sum += sums[bin];
        if count == 0.0 || count == all {
            continue;
        }
        let means = [sum / count, (total - sum) / (all - count)];
        let between = count * (all - count) * (means[1] - means[0]).powi(2);
        if between > best.0 {
            best = (between, low + (bin + 1) as f64 * width, means);
        }
    }
    (best.1, best.2)
}

/// The cut as the time for which the trigger is above its level.
pub(super) fn triggered(trigger: &[f64], level: f64) -> Result<Span, Fault> {
    let missing =
        || Fault::NoTrigger { level, range: [quantile(trigger, 0.0), quantile(trigger, 1.0)] };
    let entry = trigger
        .windows(2)
        .position(|pair| pair[0] <= level && pair[1] > level)
        .map(|k| k + 1)
        .ok_or_else(missing)?;
    let exit = trigger[entry..].iter().position(|v| *v <= level);
    Ok(Span { entry, exit: exit.map_or(trigger.len(), |k| entry + k) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_postprocess::synthetic::Noise;

    fn record(offset: f64, force: f64, noise: f64) -> Vec<f64> {
        let mut source = Noise::new(3);
        (0..10_000)
            .map(|k| {
                let cut = if (3000..8000).contains(&k) { force } else { 0.0 };
                offset + cut + noise * source.normal()
            })
            .collect()
    }

    #[test]
    fn a_cut_is_found_between_its_edges() {
        for offset in [0.0, -500.0, 2000.0] {
            let span = automatic(&record(offset, 300.0, 20.0), 1000.0, 0.02, 0.05).unwrap();
            // A moving mean of 20 samples spreads an edge over 10 samples on each side.
            assert!(span.entry.abs_diff(3000) <= 11, "{span:?}");
            assert!(span.exit.abs_diff(8000) <= 11, "{span:?}");
        }
    }

    #[test]
    fn what_is_no_cut_is_named() {
        let found = automatic(&record(10.0, 0.0, 20.0), 1000.0, 0.02, 0.05);
        assert!(matches!(found, Err(Fault::NoCut { .. })), "{found:?}");
        let found = automatic(&record(10.0, -300.0, 20.0), 1000.0, 0.02, 0.05);
        assert!(matches!(found, Err(Fault::WrongSign { .. })), "{found:?}");
        let mut twice = record(10.0, 300.0, 20.0);
        twice[5000..6000].fill(10.0);
        let found = automatic(&twice, 1000.0, 0.02, 0.05);
        assert!(matches!(&found, Err(Fault::SeveralCuts { cuts }) if cuts.len() == 2), "{found:?}");
        assert!(automatic(&[1.0; 500], 1000.0, 0.02, 0.05).is_err());
    }

    #[test]
    fn a_trigger_is_followed_or_missed() {
        let trigger: Vec<f64> = (0..100).map(|k| f64::from((20..60).contains(&k)) * 5.0).collect();
        assert_eq!(triggered(&trigger, 2.5).unwrap(), Span { entry: 20, exit: 60 });
        assert!(matches!(triggered(&trigger, 6.0), Err(Fault::NoTrigger { .. })));
    }
}
