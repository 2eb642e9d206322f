//! False alarms: noise with nothing in it through the same steps.
//!
//! For every cut and channel a series of the same length and rate, normal, white or of first order (x_k = phi x_(k-1) + e_k) with phi of 0.7, 0.95
//! or 0.99 in turn: red noise whose spectrum falls over the band. An alarm is any line in any of them. With nothing in the data,
//! Benjamini and Hochberg's rule raises one in at most 5 % of the sets.

use super::lines::is_any;
use super::spectrum::BroadBand;
use super::{FEWEST_SEGMENTS, SeriesCut};
use crate::self_test::Rate;
use rayon::prelude::*;
use sphcut_greybox::Random;

/// Coefficients of the noise.
const MEMORIES: [f64; 4] = [0.0, 0.7, 0.95, 0.99];

/// The share of `trials` sets of noise, of the design of `cuts`, in which a line is found.
#[must_use]
pub fn false_alarms(cuts: &[SeriesCut], resolution: f64, trials: usize, seed: u64) -> Rate {
    let hits = (0..trials)
        .into_par_iter()
        .filter(|&trial| {
            let mut spectra = Vec::new();
            for (c, cut) in cuts.iter().enumerate() {
                let length = cut.window[1] - cut.window[0];
                for k in 0..cut.channels.len() {
                    let random = Random::new(seed, &[7, trial as u64, c as u64, k as u64]);
                    let memory = MEMORIES[(trial + c + k) % MEMORIES.len()];
                    let force = noise(random, memory, length);
                    spectra.extend(BroadBand::new(&force, cut.rate, resolution, FEWEST_SEGMENTS));
                }
            }
            is_any(&spectra)
        })
        .count();
    Rate { hits, trials }
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
