//! The averaged periodogram of a force, its broadband background, and the chance of every bin.
//!
//! K segments of L samples under Hann windows with half overlap (Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73)
//! give a density S(f) whose ratio to the true one is chi^2 with nu degrees of freedom over nu,
//!
//! ```text
//! nu = 2 K / (1 + 2 (1 - 1/K) c),   c = (sum w_n w_(n + L/2) / sum w_n^2)^2 = 1/36
//! ```
//!
//! (Percival and Walden, Spectral Analysis for Physical Applications, Cambridge 1993, section 6.17). The background B is
//! smooth: a quadratic in ln f is fitted to ln S around each bin, first by least absolute deviations, which a line does not
//! move, then by least squares without the bins that lie above what chance allows. E ln(chi^2_nu / nu) = psi(nu/2) - ln(nu/2)
//! is taken off. B itself is uncertain as if from nu_B degrees of freedom, so that without a line S/B follows the law F(nu, nu_B),
//! which is chi^2_nu / nu where the background is known. Neighbouring bins of a Hann window are correlated (4/9 and 1/36 in power);
//! nu_B counts with that.
//!
//! Limits: the force is taken as stationary in the window and its background as smooth over a few dozen bins; what is narrower
//! counts as a line. The two lowest and the two highest bins are not tested.

use nalgebra::{Matrix3, Vector3};
use sphcut_recordings::Spectrum;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use statrs::function::gamma::digamma;

/// Lowest bin that is tested: the mean is taken out of the segments, and a Hann window reaches two bins far.
pub const LOWEST_BIN: usize = 2;
/// Bins on each side of the fit of the background at high and at low frequencies.
const HALF_WIDTH: (f64, f64) = (16.0, 56.0);
/// The same as a share of the number of the bin, in between.
const SHARE: f64 = 0.5;
/// Variance of a mean of neighbouring bins over that of independent ones: 1 + 2 (4/9 + 1/36).
const CORRELATED: f64 = 1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0);
/// Bins beyond this many standard deviations are no background.
const CLIP: f64 = 2.6;
/// Beyond this many their neighbours are none either: they have the skirt of a line.
const STRONG: f64 = 4.0;

/// What is known of a force over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct BroadBand {
    /// Width of a bin in Hz.
    pub resolution: f64,
    /// Half the sampling rate in Hz.
    pub nyquist: f64,
    /// Length of the series in s.
    pub duration: f64,
    /// Segments that were averaged.
    pub segments: usize,
    /// nu.
    pub freedom: f64,
    /// S in N^2/Hz, from the frequency 0.
    pub density: Vec<f64>,
    /// B in N^2/Hz; not a number where nothing is tested.
    pub background: Vec<f64>,
    /// P(S/B this large by chance) of the bins from [`LOWEST_BIN`] on; 1 where it is larger than 0.1.
    pub chances: Vec<f64>,
}

/// Effective degrees of freedom of a mean of `segments` periodograms with half overlap.
#[must_use]
pub fn effective_freedom(segments: usize) -> f64 {
    let count = segments as f64;
    2.0 * count / (1.0 + 2.0 * (1.0 - 1.0 / count) / 36.0)
}

impl BroadBand {
    /// Of `force`, sampled at `rate`, with bins of `resolution`; `None` for fewer than `fewest` segments or too few bins.
    #[must_use]
    pub fn new(force: &[f64], rate: f64, resolution: f64, fewest: usize) -> Option<Self> {
        let length = (rate / resolution).round() as usize;
        if force.len() < length {
            return None;
        }
        let (spectrum, segments) = Spectrum::averaged(force, rate, length);
        let bins = spectrum.density.len();
        if segments < fewest || bins < 2 * HALF_WIDTH.0 as usize + 2 * LOWEST_BIN {
            return None;
        }
        let freedom = effective_freedom(segments);
        let density = spectrum.density;
        let (background, spread) = background(&density, freedom);
        let chances = (LOWEST_BIN..bins - LOWEST_BIN)
            .map(|k| chance(density[k] / background[k], freedom, 2.0 / spread[k]))
            .collect();
        let duration = force.len() as f64 / rate;
        let resolution = rate / length as f64;
        Some(Self {
            resolution,
            nyquist: 0.5 * rate,
            duration,
            segments,
            freedom,
            density,
            background,
            chances,
        })
    }
}

/// P(F(nu, nu_B) > ratio).
fn chance(ratio: f64, freedom: f64, of_background: f64) -> f64 {
    let deviation = (2.0 / freedom + 2.0 / of_background).sqrt();
    // No bin within a standard deviation of its background is a discovery.
    if !(ratio.is_finite() && ratio.ln() > deviation) {
        return 1.0;
    }
    FisherSnedecor::new(freedom, of_background).map_or(1.0, |law| law.sf(ratio))
}

/// B and the variance of ln B at every bin.
fn background(density: &[f64], freedom: f64) -> (Vec<f64>, Vec<f64>) {
    let bins = density.len();
    let last = bins - 1 - LOWEST_BIN;
    let (mut log_level, mut spread) = (vec![f64::NAN; bins], vec![f64::NAN; bins]);
    let floor = density.iter().copied().fold(0.0, f64::max) * 1e-24 + f64::MIN_POSITIVE;
    let logs: Vec<f64> = density.iter().map(|s| s.max(floor).ln()).collect();
    let places: Vec<f64> = (0..bins).map(|k| (k.max(1) as f64).ln()).collect();
    // Trigamma at large arguments: 1/a + 1/(2 a^2) + 1/(6 a^3), a = nu/2, exact to 1e-4 from 12 degrees of freedom on.
    let half = 0.5 * freedom;
    let noise = (1.0 / half + 0.5 / (half * half) + 1.0 / (6.0 * half.powi(3))).sqrt();
    let mean = digamma(half) - half.ln();
    let mut before: Option<(usize, f64, f64)> = None;
    let mut node = LOWEST_BIN;
    loop {
        let width = (SHARE * node as f64).clamp(HALF_WIDTH.0, HALF_WIDTH.1) as usize;
        let from = node.saturating_sub(width).max(LOWEST_BIN);
        // At an end the window keeps its number of bins.
        let to = (from + 2 * width).min(last);
        let from = to.saturating_sub(2 * width).max(LOWEST_BIN);
        let window = (&places[from..=to], &logs[from..=to]);
        let (level, variance) = local(window, places[node], noise);
        (log_level[node], spread[node]) = (level - mean, variance);
        if let Some((old, old_level, old_spread)) = before {
            for k in old + 1..node {
                let share = (places[k] - places[old]) / (places[node] - places[old]);
                log_level[k] = old_level + share * (log_level[node] - old_level);
                spread[k] = old_spread.max(variance);
            }
        }
        before = Some((node, log_level[node], variance));
        if node == last {
            break;
        }
        node = (node + (width / 8).max(1)).min(last);
    }
    (log_level.iter().map(|level| level.exp()).collect(), spread)
}

/// Level of the logarithms at `place` and its variance.
fn local((places, logs): (&[f64], &[f64]), place: f64, noise: f64) -> (f64, f64) {
    let reach = places.iter().map(|x| (x - place).abs()).fold(0.0, f64::max).max(1e-9) * 1.001;
    let offset: Vec<f64> = places.iter().map(|x| (x - place) / reach).collect();
    let tricube: Vec<f64> = offset.iter().map(|u| (1.0 - u.abs().powi(3)).powi(3)).collect();
    let mut weights = tricube.clone();
    let mut curve = Vector3::zeros();
    let residual = |curve: &Vector3<f64>, k: usize| {
        logs[k] - (curve[0] + curve[1] * offset[k] + curve[2] * offset[k] * offset[k])
    };
    for _ in 0..12 {
        let Some((fitted, _)) = quadratic(&offset, logs, &weights) else { break };
        curve = fitted;
        for k in 0..logs.len() {
            weights[k] = tricube[k] / residual(&curve, k).abs().max(0.3 * noise);
        }
    }
    let mut variance = f64::NAN;
    for _ in 0..3 {
        let size: Vec<f64> = (0..logs.len()).map(|k| residual(&curve, k) / noise).collect();
        for k in 0..logs.len() {
            let near = &size[k.saturating_sub(2)..(k + 3).min(size.len())];
            let line = size[k] > CLIP || near.iter().any(|r| *r > STRONG);
            weights[k] = if line { 0.0 } else { tricube[k] };
        }
        let Some((fitted, inverse)) = quadratic(&offset, logs, &weights) else { break };
        curve = fitted;
        let squares: f64 = (0..logs.len())
            .map(|k| {
                let row = Vector3::new(1.0, offset[k], offset[k] * offset[k]);
                (weights[k] * (inverse.row(0) * row)[0]).powi(2)
            })
            .sum();
        variance = noise * noise * squares * CORRELATED;
    }
    (curve[0], variance)
}

type Normal = Matrix3<f64>;

/// Coefficients of the weighted least squares and the inverse of the normal matrix.
fn quadratic(offset: &[f64], logs: &[f64], weights: &[f64]) -> Option<(Vector3<f64>, Normal)> {
    let mut sums = [0.0; 5];
    let mut right = Vector3::zeros();
    for ((u, y), w) in offset.iter().zip(logs).zip(weights) {
        let squared = u * u;
        for (sum, power) in sums.iter_mut().zip([1.0, *u, squared, squared * u, squared * squared])
        {
            *sum += w * power;
        }
        right += Vector3::new(w * y, w * y * u, w * y * squared);
    }
    let [a, b, c, d, e] = sums;
    let inverse = Matrix3::new(a, b, c, b, c, d, c, d, e).try_inverse()?;
    Some((inverse * right, inverse))
}
