//! Lines that stand out of the background.
//!
//! Discoveries over all bins, channels and cuts: Benjamini and Hochberg, J. R. Stat. Soc. B 57 (1995) 289-300, at q = 0.05; it holds for
//! bins that are correlated like those of a Hann window (Benjamini and Yekutieli, Ann. Statist. 29 (2001) 1165-1188).
//! A line is a largest discovered bin. Its frequency follows from its neighbours: for a steady sine the amplitudes a of two
//! neighbouring bins of a Hann window give the offset (2 a_1/a_0 - 1)/(a_1/a_0 + 1) of a bin (Grandke, IEEE Trans. Instrum.
//! Meas. 32 (1983) 350-355); a wider hump has its centre of power. Its amplitude is that of the sine of the same power,
//! A^2/2 = sum (S - B) df.

use super::spectrum::{BroadBand, LOWEST_BIN};
use crate::inference::locate::benjamini_hochberg;

/// Share of the discoveries that may be false.
pub const FALSE_SHARE: f64 = 0.05;
/// Bins at half power up to which a line is as sharp as a sine in these segments; a sine has 1.44.
const SHARP: f64 = 2.5;
/// Bins within which there is one line only.
const APART: usize = 3;

/// A line of one channel of one cut.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralLine {
    /// Hz.
    pub frequency: f64,
    /// Its standard error in Hz.
    pub error: f64,
    /// Amplitude in N of the sine with the same power.
    pub amplitude: f64,
    /// Its standard error in N.
    pub amplitude_error: f64,
    /// Density over background at the largest bin.
    pub ratio: f64,
    /// Width at half power in Hz.
    pub width: f64,
    /// Whether it is as sharp as a sine.
    pub sharp: bool,
    /// Chance of its largest bin.
    pub chance: f64,
}

/// The lines of each spectrum.
#[must_use]
pub fn lines(spectra: &[BroadBand]) -> Vec<Vec<SpectralLine>> {
    let peaks: Vec<Vec<usize>> = spectra.iter().map(peaks).collect();
    let found = discoveries(spectra, &peaks);
    let mut found = found.iter();
    let per_spectrum = spectra.iter().zip(&peaks);
    per_spectrum
        .map(|(spectrum, peaks)| {
            let own = peaks.iter().zip(found.by_ref());
            own.filter(|(_, found)| **found).map(|(&k, _)| line(spectrum, k)).collect()
        })
        .collect()
}

/// Which of the peaks are discoveries. A line covers several bins, which must not count as several discoveries: only the largest
/// is ranked, against the number of all bins. Of noise, at most that number times p of peaks have a chance below p.
fn discoveries(spectra: &[BroadBand], peaks: &[Vec<usize>]) -> Vec<bool> {
    let mut chances: Vec<f64> = spectra
        .iter()
        .zip(peaks)
        .flat_map(|(s, own)| own.iter().map(|&k| s.chances[k - LOWEST_BIN]))
        .collect();
    let count = chances.len();
    chances.resize(spectra.iter().map(|s| s.chances.len()).sum(), 1.0);
    let mut found = benjamini_hochberg(&chances, FALSE_SHARE);
    found.truncate(count);
    found
}

/// Whether there is any line in `spectra`.
pub(super) fn is_any(spectra: &[BroadBand]) -> bool {
    let peaks: Vec<Vec<usize>> = spectra.iter().map(peaks).collect();
    discoveries(spectra, &peaks).contains(&true)
}

/// Bins that stand above their neighbours and out of the background, and are no side lobe.
fn peaks(spectrum: &BroadBand) -> Vec<usize> {
    let ratio = |k: usize| spectrum.density[k] / spectrum.background[k];
    let last = spectrum.chances.len() + LOWEST_BIN;
    let near = |k: usize| k.saturating_sub(APART).max(LOWEST_BIN)..(k + APART + 1).min(last);
    let mut peaks: Vec<usize> = (LOWEST_BIN..last)
        .filter(|&k| spectrum.chances[k - LOWEST_BIN] < FALSE_SHARE)
        .filter(|&k| near(k).all(|other| ratio(other) < ratio(k) || other == k))
        .collect();
    // A strong line leaks through the side lobes of the window.
    let strong = peaks.clone();
    peaks.retain(|&k| strong.iter().all(|&other| !leaks(spectrum, other, k)));
    peaks
}

/// Whether the side lobes of `strong` reach what stands at `bin`: the Hann kernel falls as 1 / (pi d (d^2 - 1)), with a factor 4 for
/// lines that are not steady.
fn leaks(spectrum: &BroadBand, strong: usize, bin: usize) -> bool {
    let d = strong.abs_diff(bin) as f64;
    if d < 2.0 {
        return false;
    }
    let envelope = 1.0 / (std::f64::consts::PI * d * (d * d - 1.0));
    4.0 * envelope * envelope * spectrum.density[strong] > spectrum.density[bin]
}

fn line(spectrum: &BroadBand, peak: usize) -> SpectralLine {
    let last = spectrum.chances.len() + LOWEST_BIN;
    let over = |k: usize| {
        if (LOWEST_BIN..last).contains(&k) {
            spectrum.density[k] - spectrum.background[k]
        } else {
            0.0
        }
    };
    let top = over(peak);
    // Bins around the peak while the power falls and stays above `share` of it.
    let reach = |share: f64| {
        let walk = |forward: bool| {
            let mut k = peak;
            loop {
                let next = if forward { k + 1 } else { k - 1 };
                let falls = over(next) <= 1.1 * over(k) || next.abs_diff(peak) <= 1;
                if !(LOWEST_BIN..last).contains(&next) || over(next) < share * top || !falls {
                    return k;
                }
                k = next;
            }
        };
        [walk(false), walk(true)]
    };
    let [low, high] = reach(0.5);
    // Half power between two bins.
    let beyond = |inside: usize, outside: usize| {
        let (a, b) = (over(inside), over(outside));
        if a > b { ((a - 0.5 * top) / (a - b)).clamp(0.0, 1.0) } else { 0.5 }
    };
    let width = (high - low) as f64 + beyond(low, low - 1) + beyond(high, high + 1);
    let sharp = width <= SHARP;
    // Of a sine and noise together: variance B^2 + 2 B (S - B), over nu/2.
    let mixed = 1.0 + 2.0 * top / spectrum.background[peak];
    let noise = spectrum.background[peak] * (2.0 / spectrum.freedom * mixed).sqrt();
    let [from, to] = if sharp {
        [(peak - 2).max(LOWEST_BIN), (peak + 2).min(last - 1)]
    } else {
        let [from, to] = reach((0.02_f64).max(spectrum.background[peak] / top));
        [from.min(peak - 2).max(LOWEST_BIN), to.max(peak + 2).min(last - 1)]
    };
    let power: f64 = (from..=to).map(over).sum::<f64>().max(0.0) * spectrum.resolution;
    let amplitude = (2.0 * power).sqrt();
    let (place, error) =
        if sharp { sine(peak, &over, noise) } else { hump([low, high], &over, spectrum.freedom) };
    SpectralLine {
        frequency: place * spectrum.resolution,
        error: error * spectrum.resolution,
        amplitude,
        // Of a sine in noise of the density B over the time T by least squares, and what a hump fluctuates by itself.
        amplitude_error: if sharp {
            (1.2 * spectrum.background[peak] / spectrum.duration).sqrt()
        } else {
            amplitude * (0.5 / spectrum.freedom).sqrt()
        },
        ratio: top / spectrum.background[peak] + 1.0,
        width: width * spectrum.resolution,
        sharp,
        chance: spectrum.chances[peak - LOWEST_BIN],
    }
}

/// Place of a sine in bins, and its standard error.
fn sine(peak: usize, over: &impl Fn(usize) -> f64, noise: f64) -> (f64, f64) {
    let amplitude = |k: usize| over(k).max(0.0).sqrt();
    let (side, sign) =
        if over(peak + 1) >= over(peak - 1) { (peak + 1, 1.0) } else { (peak - 1, -1.0) };
    let share = amplitude(side) / amplitude(peak);
    let offset = ((2.0 * share - 1.0) / (share + 1.0)).clamp(0.0, 0.6);
    let error = (0.75 * noise / over(peak)).max(0.005);
    (peak as f64 + sign * offset, error)
}

/// Centre of the power of a hump in bins, and its standard error.
fn hump([low, high]: [usize; 2], over: &impl Fn(usize) -> f64, freedom: f64) -> (f64, f64) {
    let power: f64 = (low..=high).map(over).sum();
    let centre = (low..=high).map(|k| k as f64 * over(k)).sum::<f64>() / power;
    let second = (low..=high).map(|k| (k as f64 - centre).powi(2) * over(k)).sum::<f64>() / power;
    let independent = ((high - low + 1) as f64 / 2.0).max(1.0) * 0.5 * freedom;
    (centre, (second / independent).sqrt().max(0.02))
}
