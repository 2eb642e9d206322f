//! Temperatures of a run; that of the contact over a steady window of its own.
//!
//! The contact warms for longer than the forces run in: its mean over the window of the cutting force would
//! contain the heating. Its run-in is cut off by the same rule as that of a force, MSER-5, and the same tests
//! say whether it is steady ([`crate::steady`]). They look at its rise above the lowest temperature of the run, so
//! that their relative bounds do not depend on the zero of the scale.

use crate::steady::{Drift, Series, SteadyOptions, SteadyState, detect, window_drift};
use sphcut_record::Samples;
use sphcut_sph::ChannelId;
use std::ops::Range;

/// Temperatures in K.
#[derive(Debug, Clone, PartialEq)]
pub struct Temperatures {
    /// Highest of any particle over the run.
    pub max: f64,
    /// Lowest of any particle over the run.
    pub min: f64,
    /// The temperature in contact, weighted with the contact force; `None` without contact.
    pub interface: Option<InterfaceTemperature>,
    /// Highest mean temperature in contact of any interval; 0 without contact.
    pub interface_max: f64,
}

/// The mean temperature in contact over its own window.
#[derive(Debug, Clone, PartialEq)]
pub struct InterfaceTemperature {
    /// Mean over the window in K.
    pub mean: f64,
    /// Half width of its 95 % interval in K; infinite where too few samples were taken.
    pub half_width: f64,
    /// Travel in m at the start of the window.
    pub start: f64,
    /// Travel in m at its end, which is that of the run or the pass.
    pub end: f64,
    /// Verdict on the rise above the lowest temperature of the run.
    pub steady: SteadyState,
    /// Change over the window in K.
    pub drift: Drift,
}

/// Temperatures of a run, that of the contact in the samples of `range` by `criterion`.
pub(crate) fn temperatures(
    samples: &Samples,
    range: &Range<usize>,
    criterion: &SteadyOptions,
) -> Temperatures {
    let min = samples.channel(ChannelId::MinTemperature).iter().copied().reduce(f64::min);
    let interface = samples.channel(ChannelId::InterfaceTemperature);
    let min = min.unwrap_or(0.0);
    Temperatures {
        max: largest(samples.channel(ChannelId::MaxTemperature)),
        min,
        interface: in_contact(samples, range, criterion, min),
        interface_max: largest(interface),
    }
}

fn in_contact(
    samples: &Samples,
    range: &Range<usize>,
    criterion: &SteadyOptions,
    zero: f64,
) -> Option<InterfaceTemperature> {
    let travel = &samples.channel(ChannelId::Travel)[range.clone()];
    let temperature = &samples.channel(ChannelId::InterfaceTemperature)[range.clone()];
    // The channel is 0 without contact.
    let touching = |pair: &(&f64, &f64)| *pair.1 > 0.0;
    let (travel, rise): (Vec<f64>, Vec<f64>) = travel
        .iter()
        .zip(temperature)
        .filter(touching)
        .map(|(travel, temperature)| (*travel, temperature - zero))
        .unzip();
    if rise.is_empty() {
        return None;
    }
    let steady = detect(Series { travel: &travel, force: &rise }, criterion);
    let mean = crate::steady::window_mean(&rise, steady.first_sample);
    Some(InterfaceTemperature {
        mean: zero + mean.mean,
        half_width: mean.half_width,
        start: steady.window_start,
        end: steady.window_end,
        drift: window_drift(&rise, steady.first_sample),
        steady,
    })
}

/// Largest value; 0 for none.
fn largest(values: &[f64]) -> f64 {
    values.iter().copied().reduce(f64::max).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{AMBIENT, Noise, SyntheticCut};

    const CRITERION: SteadyOptions =
        SteadyOptions { relative_half_width: 0.02, minimum_travel: 1e-3 };

    /// Samples every 2 um whose contact has the given temperatures.
    fn record(temperatures: &[f64]) -> Samples {
        let mut samples = Samples::default();
        let rows = SyntheticCut::default().samples(temperatures.len(), 2e-6, &[]);
        for (mut row, temperature) in rows.into_iter().zip(temperatures) {
            row.values[ChannelId::InterfaceTemperature as usize] = *temperature;
            samples.push(&row);
        }
        samples
    }

    fn found(temperatures: &[f64]) -> InterfaceTemperature {
        let samples = record(temperatures);
        super::temperatures(&samples, &(0..samples.len()), &CRITERION).interface.unwrap()
    }

    /// A rise of 800 K with a length of `heating`, and 15 K of noise.
    fn warming(seed: u64, heating: f64, count: usize) -> Vec<f64> {
        let noise = Noise::new(seed).autoregressive(0.8, count);
        let rise = |k: usize| 800.0 * (1.0 - (-(k as f64 + 1.0) * 2e-6 / heating).exp());
        noise.iter().enumerate().map(|(k, noise)| AMBIENT + rise(k) + 15.0 * noise).collect()
    }

    #[test]
    fn the_heating_up_is_not_in_the_mean() {
        // 6 mm, of which the first heats: 800 exp(-x / 0.4 mm) falls below 1 K at 2.7 mm.
        let found: Vec<_> = (0..20).map(|seed| found(&warming(seed, 0.4e-3, 3000))).collect();
        for one in &found {
            assert!(one.start > 1e-3 && one.start < 4.6e-3, "{one:?}");
            assert!((one.end - 6e-3).abs() < 1e-5, "{one:?}");
            // Two half widths of 95 %, and the mean of 800 exp(-x / 0.4 mm) from 1 mm on: 800 exp(-2.5) 0.4 / 5 = 5 K. The mean
            // of the whole misses 800 * 0.4 / 6 = 53 K.
            let miss = (one.mean - AMBIENT - 800.0).abs();
            assert!(miss < 2.0 * one.half_width + 5.3 && one.half_width < 12.0, "{one:?}");
        }
        // The tests are strict, also of records without any drift: a third of these pass; none that still warms may.
        let steady = found.iter().filter(|one| one.steady.reached).count();
        assert!(steady >= 4, "{steady} of 20");
        let warms = |seed: u64| self::found(&warming(seed, 4e-3, 1500)).steady.reached;
        assert!(!(0..20).any(warms));
    }

    #[test]
    fn a_contact_that_still_warms_is_told() {
        let found = found(&warming(7, 4e-3, 1500));
        assert!(!found.steady.reached);
        assert!(found.drift.change > 0.0 && found.drift.is_seen(), "{found:?}");
        // Over the last quarter and more of 3 mm: at least 800 (exp(-2.25 / 4) - exp(-3 / 4)) = 78 K, and at most all of it.
        assert!(found.drift.bound() > 78.0 && found.drift.change < 425.0, "{found:?}");
    }

    #[test]
    fn the_zero_of_the_scale_does_not_decide() {
        let warm = warming(7, 0.4e-3, 3000);
        let samples = record(&warm);
        let mut columns = samples.columns().to_vec();
        for id in [ChannelId::InterfaceTemperature, ChannelId::MinTemperature] {
            columns[id as usize].iter_mut().for_each(|value| *value += 1024.0);
        }
        let shifted = Samples::from_columns(columns).unwrap();
        let range = 0..samples.len();
        let here = super::temperatures(&samples, &range, &CRITERION).interface.unwrap();
        let there = super::temperatures(&shifted, &range, &CRITERION).interface.unwrap();
        assert_eq!(here.start, there.start);
        // Rounding of 2000 K.
        assert!((there.mean - here.mean - 1024.0).abs() < 1e-9);
        assert!((there.half_width - here.half_width).abs() < 1e-9);
    }

    #[test]
    fn without_contact_there_is_none() {
        let samples = record(&[0.0; 100]);
        let none = super::temperatures(&samples, &(0..100), &CRITERION);
        assert_eq!((none.interface, none.interface_max), (None, 0.0));
    }
}
