//! False alarms: noise with nothing in it through the same steps.
//!
//! For every cut and channel a series of the same length and rate, normal, white or of first order (x_k = phi x_(k-1) + e_k) with phi of 0.7, 0.95
//! or 0.99 in turn: red noise whose spectrum falls over the band. An alarm is any line in any of them, or any trend or run-in. With nothing in the data,
//! Benjamini and Hochberg's rule raises a line in at most 5 % of the sets, and a trend or a run-in in at most 10 %, 5 % for each.

use super::spectrum::BroadBand;
use super::{SeriesChannel, SeriesCut, lines, time};
use crate::check::self_test::Rate;
use rayon::prelude::*;
use sphcut_greybox::Random;

/// Coefficients of the noise.
const MEMORIES: [f64; 4] = [0.0, 0.7, 0.95, 0.99];

/// The shares of `trials` sets of noise, of the design of `cuts`, in which a line is found, and in which a trend or a run-in is.
#[must_use]
pub fn false_alarms(cuts: &[SeriesCut], resolution: f64, trials: usize, seed: u64) -> [Rate; 2] {
    let found: Vec<[bool; 2]> = (0..trials)
        .into_par_iter()
        .map(|trial| {
            let simulated: Vec<SeriesCut> =
                cuts.iter().enumerate().map(|(c, cut)| simulated(cut, [trial, c], seed)).collect();
            let spectra: Vec<BroadBand> =
                simulated.iter().flat_map(|cut| super::of_cut(cut, resolution)).collect();
            [lines::is_any(&spectra), time::is_any(&simulated)]
        })
        .collect();
    [0, 1].map(|k| Rate { hits: found.iter().filter(|own| own[k]).count(), trials })
}

/// `cut` with noise instead of its forces.
fn simulated(cut: &SeriesCut, [trial, number]: [usize; 2], seed: u64) -> SeriesCut {
    let channels = cut.channels.iter().enumerate().map(|(k, channel)| {
        let tags = [7, trial as u64, number as u64, k as u64];
        let memory = MEMORIES[(trial + number + k) % MEMORIES.len()];
        let force = noise(Random::new(seed, &tags), memory, channel.force.len());
        SeriesChannel { component: channel.component, force, zero: None }
    });
    SeriesCut { channels: channels.collect(), ..cut.clone() }
}

/// Normal noise of first order with variance 1.
pub(super) fn noise(mut random: Random, memory: f64, length: usize) -> Vec<f64> {
    let fresh = (1.0 - memory * memory).sqrt();
    let mut value = random.normal();
    (0..length)
        .map(|_| {
            value = memory * value + fresh * random.normal();
            value
        })
        .collect()
}
