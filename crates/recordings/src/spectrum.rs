//! Spectra: power density, the line of the revolution, and resonances.

use realfft::RealFftPlanner;
use sphcut_postprocess::statistics::median;
use std::f64::consts::PI;

/// Longest segment of a Welch estimate.
const LONGEST_SEGMENT: usize = 1 << 15;
/// Segments without overlap that a record should hold.
const SEGMENTS: usize = 6;
/// Bins on each side that the background of a bin is taken from.
const NEIGHBOURS: usize = 24;
/// A peak is this many times its background. With six segments and half overlap the estimate has about
/// 18 degrees of freedom: one bin in 10^7 of noise alone comes so high.
const PEAK: f64 = 5.0;
/// Most resonances that are named.
const MOST_PEAKS: usize = 6;

/// One-sided power density of a series about its mean: its integral is the variance.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectrum {
    /// Frequencies in Hz.
    pub frequency: Vec<f64>,
    /// Density in the unit of the series squared per Hz.
    pub density: Vec<f64>,
}

/// A peak of a spectrum that stands out of its neighbourhood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Hz.
    pub frequency: f64,
    /// Density over that of the neighbourhood.
    pub prominence: f64,
    /// Share of the variance within two bins of it.
    pub share: f64,
}

/// The oscillation at the revolution and at twice and three times its frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RevolutionLine {
    /// Revolutions per second.
    pub frequency: f64,
    /// Amplitudes of the first three orders, in the unit of the series.
    pub amplitudes: [f64; 3],
    /// Amplitude that noise alone exceeds once in twenty times, at the first order.
    pub noise: f64,
    /// Whole revolutions in the window.
    pub revolutions: f64,
}

impl RevolutionLine {
    /// Whether the first order is more than noise.
    #[must_use]
    pub fn stands_out(&self) -> bool {
        self.amplitudes[0] > self.noise
    }
}

impl Spectrum {
    /// Welch's estimate with a length of segment that follows from that of the series. Empty for fewer than 64 samples.
    #[must_use]
    pub fn welch(values: &[f64], rate: f64) -> Self {
        let longest = (values.len() / SEGMENTS).clamp(1, LONGEST_SEGMENT);
        let length = 1_usize << longest.ilog2();
        if values.len() < 64 { Self::default() } else { Self::averaged(values, rate, length).0 }
    }

    /// Welch's estimate: Hann windows of `length` samples with half overlap, each freed of its mean (Welch, IEEE Trans.
    /// Audio Electroacoust. 15 (1967) 70), and how many were averaged. Empty where none of at least 8 samples fits.
    #[must_use]
    pub fn averaged(values: &[f64], rate: f64, length: usize) -> (Self, usize) {
        if length < 8 || values.len() < length {
            return (Self::default(), 0);
        }
        let window: Vec<f64> =
            (0..length).map(|k| 0.5 - 0.5 * (2.0 * PI * k as f64 / length as f64).cos()).collect();
        let power: f64 = window.iter().map(|w| w * w).sum();
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
        let mut scratch = transform.make_scratch_vec();
        let mut density = vec![0.0; output.len()];
        let starts: Vec<usize> = (0..=values.len() - length).step_by(length / 2).collect();
        for &start in &starts {
            let part = &values[start..start + length];
            let mean = part.iter().sum::<f64>() / length as f64;
            for ((x, value), w) in input.iter_mut().zip(part).zip(&window) {
                *x = (value - mean) * w;
            }
            transform
                .process_with_scratch(&mut input, &mut output, &mut scratch)
                .expect("the buffers come from the plan");
            for (sum, value) in density.iter_mut().zip(&output) {
                *sum += value.norm_sqr();
            }
        }
        let last = density.len() - 1;
        for (k, value) in density.iter_mut().enumerate() {
            // Of an odd length the last line has a mirror image too.
            let sides = if k == 0 || (k == last && length.is_multiple_of(2)) { 1.0 } else { 2.0 };
            *value *= sides / (rate * power * starts.len() as f64);
        }
        let frequency = (0..density.len()).map(|k| k as f64 * rate / length as f64).collect();
        (Self { frequency, density }, starts.len())
    }

    /// Width of a bin in Hz.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.frequency.get(1).copied().unwrap_or(0.0)
    }

    /// Density around `frequency`: the median of the neighbouring bins.
    fn background(&self, bin: usize) -> f64 {
        let from = bin.saturating_sub(NEIGHBOURS).max(1);
        let to = (bin + NEIGHBOURS + 1).min(self.density.len());
        let near: Vec<f64> =
            (from..to).filter(|k| k.abs_diff(bin) > 3).map(|k| self.density[k]).collect();
        median(&near)
    }

    /// Peaks above three bins that are no multiple of `revolution` (in Hz), the strongest first.
    #[must_use]
    pub fn resonances(&self, revolution: Option<f64>) -> Vec<Peak> {
        let variance: f64 = self.density.iter().sum();
        let bins = self.density.len();
        if bins < 16 || variance <= 0.0 {
            return Vec::new();
        }
        let width = self.resolution();
        let multiple = |frequency: f64| {
            revolution.is_some_and(|revolution| {
                let order = (frequency / revolution).round();
                // Where the orders are closer than the bins no peak can be told from them.
                (1.0..=10.0).contains(&order)
                    && (frequency - order * revolution).abs() <= 2.0 * width
            })
        };
        let mut peaks: Vec<Peak> = (4..bins - 4)
            .filter(|&k| (k - 3..=k + 3).all(|other| self.density[other] <= self.density[k]))
            .filter(|&k| !multiple(self.frequency[k]))
            .map(|k| Peak {
                frequency: self.frequency[k],
                prominence: self.density[k] / self.background(k).max(f64::MIN_POSITIVE),
                share: self.density[k - 2..=k + 2].iter().sum::<f64>() / variance,
            })
            .filter(|peak| peak.prominence > PEAK)
            .collect();
        peaks.sort_by(|a, b| b.share.total_cmp(&a.share));
        peaks.truncate(MOST_PEAKS);
        peaks
    }

    /// Amplitudes at the first three multiples of `revolution` by least squares over `values`; `None`
    /// for less than two revolutions or where the third is not below half the sampling rate.
    #[must_use]
    pub fn revolution(&self, values: &[f64], rate: f64, revolution: f64) -> Option<RevolutionLine> {
        let revolutions = values.len() as f64 / rate * revolution;
        if !(revolutions >= 2.0 && 6.0 * revolution < rate) {
            return None;
        }
        // Over whole revolutions the waves are orthogonal.
        let count = (revolutions.floor() * rate / revolution).round() as usize;
        let values = &values[..count.min(values.len())];
        let bin = (revolution / self.resolution().max(f64::MIN_POSITIVE)).round() as usize;
        let background = self.background(bin.min(self.density.len().saturating_sub(1)));
        // Sine and cosine part have the variance S / T each: the sum of squares exceeds 5.99 S / T
        // in 5 % of all cases.
        let noise = (5.99 * background * rate / values.len() as f64).sqrt();
        let amplitudes = orders(values, rate, revolution).map(|[a, b]| a.hypot(b));
        Some(RevolutionLine { frequency: revolution, amplitudes, noise, revolutions })
    }
}

/// Cosine and sine parts of the first three multiples of `revolution`; over whole revolutions the waves
/// are orthogonal and these are the least-squares amplitudes.
fn orders(values: &[f64], rate: f64, revolution: f64) -> [[f64; 2]; 3] {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    [1.0, 2.0, 3.0].map(|order| {
        let (mut a, mut b) = (0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let (sine, cosine) = (2.0 * PI * order * revolution * k as f64 / rate).sin_cos();
            a += (value - mean) * cosine;
            b += (value - mean) * sine;
        }
        [a, b].map(|sum| 2.0 / values.len().max(1) as f64 * sum)
    })
}

/// The series without the oscillation at the first three multiples of the revolution, fitted over the
/// last whole revolutions; as it is for less than two.
pub(super) fn without_revolution(values: &[f64], rate: f64, revolution: f64) -> Vec<f64> {
    let whole = (values.len() as f64 / rate * revolution).floor();
    let count = (whole * rate / revolution).round() as usize;
    if whole < 2.0 || 6.0 * revolution >= rate || count > values.len() {
        return values.to_vec();
    }
    let first = values.len() - count;
    let waves = orders(&values[first..], rate, revolution);
    let wave = |k: usize| -> f64 {
        let turn = 2.0 * PI * revolution * (k as f64 - first as f64) / rate;
        waves
            .iter()
            .zip([1.0, 2.0, 3.0])
            .map(|([a, b], order)| a * (order * turn).cos() + b * (order * turn).sin())
            .sum()
    };
    values.iter().enumerate().map(|(k, value)| value - wave(k)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_postprocess::synthetic::Noise;

    #[test]
    fn the_integral_of_the_density_is_the_variance() {
        let values = Noise::new(4).autoregressive(0.0, 60_000);
        let spectrum = Spectrum::welch(&values, 2000.0);
        let integral = spectrum.density.iter().sum::<f64>() * spectrum.resolution();
        // Variance 1 of 60 000 samples is known to sqrt(2 / 60 000) = 0.6 %: three times that.
        assert!((integral - 1.0).abs() < 0.018, "{integral}");
        // White: no peak, and one half of the density in each half.
        assert!(spectrum.resonances(None).is_empty(), "{:?}", spectrum.resonances(None));
    }

    #[test]
    fn revolution_and_resonance_are_found_where_they_are() {
        let rate = 5000.0;
        let noise = Noise::new(7).autoregressive(0.0, 25_000);
        let values: Vec<f64> = noise
            .iter()
            .enumerate()
            .map(|(k, noise)| {
                let t = k as f64 / rate;
                400.0
                    + 12.0 * (2.0 * PI * 8.0 * t).sin()
                    + 3.0 * (2.0 * PI * 16.0 * t).cos()
                    + 5.0 * (2.0 * PI * 830.0 * t).sin()
                    + noise
            })
            .collect();
        let spectrum = Spectrum::welch(&values, rate);
        let line = spectrum.revolution(&values, rate, 8.0).unwrap();
        // Standard deviation of an amplitude: sqrt(2 / 25 000) = 0.009.
        assert!((line.amplitudes[0] - 12.0).abs() < 0.04, "{line:?}");
        assert!((line.amplitudes[1] - 3.0).abs() < 0.04, "{line:?}");
        assert!(line.amplitudes[2] < 0.04 && line.stands_out(), "{line:?}");
        // Without the revolution the rest is the same, and its own line is gone.
        let rest = without_revolution(&values, rate, 8.0);
        assert!(orders(&rest[..25_000], rate, 8.0)[0][0].abs() < 1e-9);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean(&rest) - mean(&values)).abs() < 1e-9);
        let peaks = spectrum.resonances(Some(8.0));
        assert_eq!(peaks.len(), 1, "{peaks:?}");
        assert!((peaks[0].frequency - 830.0).abs() <= spectrum.resolution(), "{peaks:?}");
        // 12.5 of 12.5 + 72 + 4.5 + 1.
        assert!((peaks[0].share - 12.5 / 90.0).abs() < 0.02, "{peaks:?}");
    }

    #[test]
    fn short_series_have_no_spectrum() {
        assert!(Spectrum::welch(&[1.0; 63], 1.0).frequency.is_empty());
        let flat = Spectrum::welch(&[1.0; 640], 1.0);
        assert!(flat.resonances(Some(0.1)).is_empty());
        assert!(flat.revolution(&[1.0; 640], 1.0, 0.5).is_none());
    }
}
