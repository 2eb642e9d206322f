//! The mean of a correlated series and how well it is known.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Number of batches.
const BATCHES: usize = 10;
/// The sum of the autocorrelation is self-consistent at the first lag above this many correlation times.
const WINDOW_FACTOR: f64 = 2.5;

/// The mean of a series with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanInterval {
    /// The mean.
    pub mean: f64,
    /// Half width of the 95 % interval; infinite for fewer samples than two batches each.
    pub half_width: f64,
    /// Standard error of the mean that the wider interval uses.
    pub standard_error: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Integrated autocorrelation time tau = 1 + 2 sum rho(k) in samples.
    pub correlation_samples: f64,
}

/// The integrated autocorrelation time of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutocorrelationTime {
    /// tau in samples, at least 1.
    pub samples: f64,
    /// Degrees of freedom of the estimate: 2 over its squared relative error.
    pub degrees_of_freedom: f64,
}

/// Mean and 95 % interval of a correlated series: the wider of that of batch means and that of
/// the integrated autocorrelation time, for which the larger of the series' own and that of the
/// longer `record` it is a part of counts.
#[must_use]
pub fn mean_interval(samples: &[f64], record: Option<AutocorrelationTime>) -> MeanInterval {
    let count = samples.len() as f64;
    let own = autocorrelation_time(samples);
    let time = match record {
        Some(record) if record.samples > own.samples => record,
        _ => own,
    };
    let mean = if samples.is_empty() { 0.0 } else { samples.iter().sum::<f64>() / count };
    if samples.len() < 2 * BATCHES {
        return MeanInterval {
            mean,
            half_width: f64::INFINITY,
            standard_error: f64::INFINITY,
            degrees_of_freedom: 1.0,
            correlation_samples: time.samples,
        };
    }
    let correlated = Estimate {
        standard_error: correlated_error(samples, mean, time.samples),
        degrees_of_freedom: time.degrees_of_freedom,
    };
    let batched = Batches::new(samples).estimate();
    let wider = if correlated.half_width() > batched.half_width() { correlated } else { batched };
    MeanInterval {
        mean,
        half_width: wider.half_width(),
        standard_error: wider.standard_error,
        degrees_of_freedom: wider.degrees_of_freedom,
        correlation_samples: time.samples,
    }
}

struct Estimate {
    standard_error: f64,
    degrees_of_freedom: f64,
}

impl Estimate {
    fn half_width(&self) -> f64 {
        t_quantile(0.975, self.degrees_of_freedom) * self.standard_error
    }
}

/// s sqrt(tau / n), with s^2 corrected for the correlation of the samples with their mean.
fn correlated_error(samples: &[f64], mean: f64, time: f64) -> f64 {
    let count = samples.len() as f64;
    let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    (variance / (1.0 - time / count).max(0.1) * time / count).sqrt()
}

/// Means of consecutive parts of equal length; what is left over is dropped at the beginning.
pub(super) struct Batches {
    pub means: Vec<f64>,
}

impl Batches {
    pub fn new(samples: &[f64]) -> Self {
        let length = samples.len() / BATCHES;
        if length == 0 {
            return Self { means: Vec::new() };
        }
        let rest = samples.len() - length * BATCHES;
        let mean = |batch: &[f64]| batch.iter().sum::<f64>() / length as f64;
        Self { means: samples[rest..].chunks_exact(length).map(mean).collect() }
    }

    fn estimate(&self) -> Estimate {
        let count = self.means.len() as f64;
        let mean = self.means.iter().sum::<f64>() / count;
        let variance = self.means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (count - 1.0);
        Estimate { standard_error: (variance / count).sqrt(), degrees_of_freedom: count - 1.0 }
    }
}

/// tau = 1 + 2 sum_{k <= K} (1 - k / (K + 1)) rho(k), with the bias of a mean taken from the same
/// samples corrected by 1 + (K + 1) / n. The relative variance of this estimate is 4 K / (3 n)
/// (Priestley, Spectral Analysis and Time Series (1981), table 6.1).
///
/// K is three times the first lag W of at least 2.5 (1 + 2 sum_{k <= W} rho(k)), the
/// self-consistent window (Wolff, Computer Physics Communications 156 (2004) 143), but at least a
/// twentieth of the record, so that the taper averages over the periods of a serrated chip. What
/// the taper loses of an exponential correlation, W / (5 K), is given back.
///
/// A record of more than 1024 samples is averaged over blocks first, which bounds the cost: the
/// long-run variance tau s^2 per sample is that of the blocks times the length of a block.
#[must_use]
pub fn autocorrelation_time(samples: &[f64]) -> AutocorrelationTime {
    let length = samples.len().div_ceil(MOST_BLOCKS);
    if length <= 1 {
        return time_of_blocks(samples);
    }
    // What is left over is dropped at the beginning.
    let rest = samples.len() % length;
    let mean = |block: &[f64]| block.iter().sum::<f64>() / length as f64;
    let blocks: Vec<f64> = samples[rest..].chunks_exact(length).map(mean).collect();
    let time = time_of_blocks(&blocks);
    let (fine, coarse) = (variance(samples), variance(&blocks));
    if fine <= 0.0 {
        return time;
    }
    let longer = time.samples * coarse / fine * length as f64;
    AutocorrelationTime { samples: longer.max(1.0), ..time }
}

/// Most samples or blocks whose correlation is computed.
const MOST_BLOCKS: usize = 1024;

/// Variance about the mean of the same values.
fn variance(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count
}

fn time_of_blocks(samples: &[f64]) -> AutocorrelationTime {
    let count = samples.len();
    let mean = samples.iter().sum::<f64>() / count.max(1) as f64;
    let offsets: Vec<f64> = samples.iter().map(|x| x - mean).collect();
    let covariance = |lag: usize| -> f64 {
        offsets.iter().zip(&offsets[lag..]).map(|(a, b)| a * b).sum::<f64>() / count as f64
    };
    let variance = if count > 0 { covariance(0) } else { 0.0 };
    // A force that varies only by rounding is uncorrelated.
    if variance <= (1e-12 * mean).powi(2) {
        return AutocorrelationTime {
            samples: 1.0,
            degrees_of_freedom: count.saturating_sub(1).max(1) as f64,
        };
    }
    let mut correlations = Vec::new();
    let mut time = 1.0;
    let mut consistent = 1;
    // A longer correlation is too long for any verdict: see MINIMUM_CORRELATION_LENGTHS.
    for lag in 1..count.div_ceil(4) {
        correlations.push(covariance(lag) / variance);
        time += 2.0 * correlations[lag - 1];
        consistent = lag;
        if lag as f64 >= WINDOW_FACTOR * time {
            break;
        }
    }
    let last = (3 * consistent).max(count / 20).clamp(1, count / 2);
    correlations.extend((correlations.len() + 1..=last).map(|lag| covariance(lag) / variance));
    let size = (last + 1) as f64;
    let taper = |index: usize| 1.0 - (index + 1) as f64 / size;
    let tapered: f64 = correlations[..last].iter().enumerate().map(|(k, rho)| taper(k) * rho).sum();
    let lost = 0.2 * consistent as f64 / size;
    let corrected = (1.0 + 2.0 * tapered) * (1.0 + size / count as f64) / (1.0 - lost);
    AutocorrelationTime {
        samples: corrected.max(1.0),
        degrees_of_freedom: (1.5 * count as f64 / last as f64).max(1.0),
    }
}

/// Quantile of Student's t distribution; that of one degree of freedom below one.
pub fn t_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    // At 1e4 degrees of freedom the quantile is within 2e-4 of that of the normal distribution.
    let degrees_of_freedom = degrees_of_freedom.clamp(1.0, 1e4);
    StudentsT::new(0.0, 1.0, degrees_of_freedom)
        .expect("scale and degrees of freedom are positive")
        .inverse_cdf(probability)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;

    #[test]
    fn t_quantiles_are_those_of_the_tables() {
        for (freedom, expected) in [(1.0, 12.706), (9.0, 2.2622), (30.0, 2.0423), (1e9, 1.9602)] {
            let quantile = t_quantile(0.975, freedom);
            // The tables print five digits.
            assert!((quantile / expected - 1.0).abs() < 3e-5, "{freedom}: {quantile}");
        }
    }

    #[test]
    fn the_time_of_autoregressive_noise_is_found() {
        // rho(k) = a^k: tau = (1 + a) / (1 - a), 19 at a = 0.9 and 1 for white noise.
        for (memory, expected) in [(0.9, 19.0), (0.0, 1.0)] {
            // With blocks of four samples, and without blocks.
            for count in [4000, 1000] {
                let series = |seed| Noise::new(seed).autoregressive(memory, count);
                let time = |seed| autocorrelation_time(&series(seed)).samples;
                let mean = (0..40).map(time).sum::<f64>() / 40.0;
                // K is a twentieth of the record or 7.5 tau: a relative error of at most
                // sqrt(4 * 150 / 3000 / 40) = 7 %, three times that. The lower limit of 1 raises
                // the mean for white noise by 0.4 of the single error of 26 %.
                assert!((mean / expected - 1.0).abs() < 0.21, "memory {memory}, {count}: {mean}");
            }
        }
    }

    #[test]
    fn a_regular_oscillation_leaves_the_mean_certain() {
        let samples: Vec<f64> = (0..1600).map(|k| (k % 40) as f64).collect();
        // 40 whole periods; the limit of tau is one sample.
        assert!(autocorrelation_time(&samples).samples < 2.0);
    }

    #[test]
    fn independent_samples_have_the_textbook_interval() {
        let samples = Noise::new(3).autoregressive(0.0, 40_000);
        let interval = mean_interval(&samples, None);
        // sigma / sqrt(n) = 0.005, times a quantile between 1.96 and 2.26, times the error of the
        // batch estimate with nine degrees of freedom (at most 1.5).
        assert!(interval.half_width > 0.0095 && interval.half_width < 0.017, "{interval:?}");
    }

    #[test]
    fn few_samples_tell_nothing() {
        assert!(mean_interval(&[1.0; 19], None).half_width.is_infinite());
        assert_eq!(mean_interval(&[], None).mean, 0.0);
    }
}
