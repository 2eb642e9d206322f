//! What a run does not tell of a force, in one sentence: the drift that it cannot exclude, and what to do.
//!
//! A run ends by its travel or because its cutting force is known. That says nothing of another force:
//! F_f scatters more and runs in for longer. [`crate::steady::window_drift`] over the window of the means bounds what it may
//! still change: with 95 % confidence its drift over the window is less than [`Drift::bound`].

use crate::forces::{Force, SteadyWindow};
use crate::steady::{Drift, window_drift};
use sphcut_record::{Facts, Samples};
use sphcut_sph::ChannelId;
use std::fmt;
use std::ops::Range;

/// A mean force over a window of travel and what may still change. In N per metre of width in a plane run, else in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownForce {
    /// Its symbol.
    pub symbol: &'static str,
    /// Mean over the window.
    pub mean: f64,
    /// Half width of its 95 % interval; infinite where too few samples were taken.
    pub half_width: f64,
    /// Change over the window.
    pub drift: Drift,
    /// Travel in m at the start and at the end of the window.
    pub window: [f64; 2],
    /// Whether the unit is N/m.
    pub per_width: bool,
    /// b in m.
    pub width_of_cut: f64,
}

impl KnownForce {
    /// The feed force `mean` of a run over `window`, whose samples are those of `range`.
    pub(crate) fn feed(
        samples: &Samples,
        window: &SteadyWindow,
        range: &Range<usize>,
        facts: &Facts,
        mean: &Force,
    ) -> Self {
        let per_width = facts.dimension == 2;
        let factor = facts.force_factor() / if per_width { facts.width_of_cut } else { 1.0 };
        let feed = &samples.channel(ChannelId::FeedForce)[range.clone()];
        let drift = window_drift(feed, window.first_sample - range.start);
        let (mean, half_width) = if per_width {
            (mean.mean_per_width, mean.ci95_per_width)
        } else {
            (mean.mean, mean.ci95)
        };
        Self {
            symbol: "F_f",
            mean,
            half_width,
            drift: Drift { change: drift.change * factor, half_width: drift.half_width * factor },
            window: [window.start, window.end],
            per_width,
            width_of_cut: facts.width_of_cut,
        }
    }

    /// The drift per metre of width in N/m.
    #[must_use]
    pub fn drift_per_width(&self) -> Drift {
        let width = if self.per_width { 1.0 } else { self.width_of_cut };
        Drift { change: self.drift.change / width, half_width: self.drift.half_width / width }
    }

    /// [`Drift::bound`] over the mean; infinite without a force.
    #[must_use]
    pub fn possible_share(&self) -> f64 {
        self.drift.bound() / self.mean.abs()
    }
}

impl fmt::Display for KnownForce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unit, scale) = if self.per_width { ("N/mm", 1e-3) } else { ("N", 1.0) };
        let shown = |force: f64| {
            let force = force * scale;
            let digits = if force.abs() < 10.0 { 2 } else { 1 };
            format!("{force:.digits$}")
        };
        let [start, end] = self.window.map(|travel| travel * 1e3);
        let window = format!("from {start:.2} to {end:.2} mm of travel");
        if !(self.half_width.is_finite() && self.drift.half_width.is_finite()) {
            return write!(
                f,
                "{} has too few samples {window} to say whether it drifts: cut farther",
                self.symbol
            );
        }
        let share = match self.possible_share() {
            share if share.is_finite() => format!(" ({:.0} %)", 100.0 * share),
            _ => String::new(),
        };
        let bound = format!("{} {unit}{share}", shown(self.drift.bound()));
        if self.drift.is_seen() {
            let sign = if self.drift.change > 0.0 { "+" } else { "" };
            let change = shown(self.drift.change);
            write!(
                f,
                "{} drifts by {sign}{change}, at most {bound}, {window}: cut farther until it settles",
                self.symbol
            )
        } else {
            write!(
                f,
                "{} may drift by up to {bound} {window}: cut farther to narrow it",
                self.symbol
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: KnownForce = KnownForce {
        symbol: "F_f",
        mean: 68.2e3,
        half_width: 3.1e3,
        drift: Drift { change: -2.0e3, half_width: 4.82e3 },
        window: [1e-3, 4.2e-3],
        per_width: true,
        width_of_cut: 3e-3,
    };

    #[test]
    fn the_sentence_says_what_is_uncertain_and_what_to_do() {
        // 2.0 + 4.82 = 6.82 N/mm, a tenth of 68.2.
        assert_eq!(
            KNOWN.to_string(),
            "F_f may drift by up to 6.82 N/mm (10 %) from 1.00 to 4.20 mm of travel: cut farther to narrow it"
        );
        let in_space = KnownForce { per_width: false, mean: 0.0, ..KNOWN };
        let sentence = in_space.to_string();
        assert!(sentence.contains("up to 6820.0 N from 1.00"), "{sentence}");
    }

    #[test]
    fn a_drift_that_is_seen_is_said() {
        let drift = Drift { change: 12e3, half_width: 4e3 };
        // 16.0 of 68.2 are 23 %.
        assert_eq!(
            KnownForce { drift, ..KNOWN }.to_string(),
            "F_f drifts by +12.0, at most 16.0 N/mm (23 %), from 1.00 to 4.20 mm of travel: cut farther until it settles"
        );
    }

    #[test]
    fn too_few_samples_say_nothing_of_drift() {
        let sentence = KnownForce { half_width: f64::INFINITY, ..KNOWN }.to_string();
        assert!(sentence.contains("too few samples") && !sentence.contains("inf"), "{sentence}");
    }
}
