//! A friction coefficient from measured forces.
//!
//! The coefficient is varied at one cutting speed and the run with the least error is taken:
//! ```text
//! e = sqrt( (d_c^2 + d_f^2) / 2 ),   d = F / F_measured - 1
//! ```
//! of the mean cutting and feed force: a relative error of 10 % in both is an error of 10 %. As a norm of
//! (d_c, d_f), e cannot change by more than that of the half widths of the intervals over the measured forces
//! (triangle inequality), which therefore is its own half width, at 95 % or better. Two runs are told apart if
//! their errors differ by more than the root of the sum of squares of both half widths.
//!
//! Neglected: errors of the measured forces, and anything but friction that could explain a difference.

mod files;

pub use files::{SCHEMA_VERSION, calibration_csv, calibration_json};

use crate::forces::Force;
use crate::result::ProcessResult;

/// Forces measured at one cutting speed. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredForces {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// F_c in N.
    pub cutting_force: f64,
    /// F_n, normal to the machined surface (the feed force of an orthogonal cut), in N.
    pub normal_force: f64,
}

/// A run with one coefficient at a measured cutting speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Folder of the run, as shown to the user.
    pub name: String,
    /// The friction coefficient.
    pub coefficient: f64,
    /// What was measured at its cutting speed.
    pub measured: MeasuredForces,
    /// Mean F_c.
    pub cutting: Force,
    /// Mean F_f.
    pub feed: Force,
    /// Whether the cutting force was steady.
    pub steady: bool,
}

/// An error with the half width of its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// e.
    pub error: f64,
    /// Its half width; infinite if a force has no interval.
    pub half_width: f64,
}

impl Trial {
    /// From the evaluation of a run.
    #[must_use]
    pub fn new(
        name: String,
        coefficient: f64,
        measured: MeasuredForces,
        result: &ProcessResult,
    ) -> Self {
        Self {
            name,
            coefficient,
            measured,
            cutting: result.forces.cutting,
            feed: result.forces.feed,
            steady: result.steady.reached,
        }
    }

    /// d_c and d_f.
    #[must_use]
    pub fn deviations(&self) -> [f64; 2] {
        [
            self.cutting.mean / self.measured.cutting_force - 1.0,
            self.feed.mean / self.measured.normal_force - 1.0,
        ]
    }

    /// e with its interval.
    #[must_use]
    pub fn misfit(&self) -> Misfit {
        let norm = |[a, b]: [f64; 2]| (0.5 * (a * a + b * b)).sqrt();
        let half_widths = [
            self.cutting.ci95 / self.measured.cutting_force,
            self.feed.ci95 / self.measured.normal_force,
        ];
        Misfit { error: norm(self.deviations()), half_width: norm(half_widths) }
    }
}

/// What a scan says about the coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Standing {
    /// The best coefficient and those that cannot be told from it lie inside the range scanned.
    Enclosed,
    /// The best coefficient is an end of the range: the minimum may lie beyond it.
    AtBorder,
    /// Coefficients up to an end of the range cannot be told from the best one.
    ReachesBorder,
    /// The best coefficient is one of those from which on more friction changes no force: the chip sticks, and its
    /// shear strength decides.
    Saturated,
    /// No coefficient of the range can be told from the best one.
    Undetermined,
}

/// The runs of a scan at one cutting speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    trials: Vec<Trial>,
    best: usize,
}

impl Scan {
    /// From its runs, in any order; `None` without one whose error is a number.
    #[must_use]
    pub fn new(mut trials: Vec<Trial>) -> Option<Self> {
        trials.sort_by(|a, b| a.coefficient.total_cmp(&b.coefficient));
        let error = |index: &usize| trials[*index].misfit().error;
        let best = (0..trials.len())
            .filter(|index| error(index).is_finite())
            .min_by(|a, b| error(a).total_cmp(&error(b)))?;
        Some(Self { trials, best })
    }

    /// The runs in the order of their coefficients.
    #[must_use]
    pub fn trials(&self) -> &[Trial] {
        &self.trials
    }

    /// The run with the least error.
    #[must_use]
    pub fn best(&self) -> &Trial {
        &self.trials[self.best]
    }

    /// Whether a run cannot be told from the best one.
    #[must_use]
    pub fn is_indistinct(&self, trial: &Trial) -> bool {
        let (best, other) = (self.best().misfit(), trial.misfit());
        let difference = other.error - best.error;
        // An infinite interval tells nothing apart.
        difference.is_nan() || difference <= best.half_width.hypot(other.half_width)
    }

    /// Indices of the first and the last of the neighbours that cannot be told from the best run.
    fn indistinct(&self) -> (usize, usize) {
        let indistinct = |index: &usize| self.is_indistinct(&self.trials[*index]);
        let first = (0..self.best).rev().take_while(indistinct).last();
        let last = (self.best + 1..self.trials.len()).take_while(indistinct).last();
        (first.unwrap_or(self.best), last.unwrap_or(self.best))
    }

    /// The smallest and the largest coefficient around the best one that cannot be told from it.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        let (first, last) = self.indistinct();
        [self.trials[first].coefficient, self.trials[last].coefficient]
    }

    /// The smallest of the largest coefficients, two at least, with the same forces within their intervals, if the best
    /// one is among them and the feed force levels off there: it ends further below the straight line through the first run
    /// and that of this coefficient than the intervals of the three explain.
    #[must_use]
    pub fn saturated_from(&self) -> Option<f64> {
        let (first, last) = (self.trials.first()?, self.trials.last()?);
        let same = |a: &Force, b: &Force| (a.mean - b.mean).abs() <= a.ci95.hypot(b.ci95);
        let level =
            |trial: &&Trial| same(&trial.cutting, &last.cutting) && same(&trial.feed, &last.feed);
        let count = self.trials.iter().rev().take_while(level).count();
        let from = self.trials.len() - count;
        if count < 2 || from == 0 || self.best < from {
            return None;
        }
        let start = &self.trials[from];
        let share =
            (last.coefficient - start.coefficient) / (start.coefficient - first.coefficient);
        let missing = (1.0 + share) * start.feed.mean - share * first.feed.mean - last.feed.mean;
        let known =
            ((1.0 + share) * start.feed.ci95).hypot(share * first.feed.ci95).hypot(last.feed.ci95);
        (missing > known).then_some(start.coefficient)
    }

    /// What the scan says.
    #[must_use]
    pub fn standing(&self) -> Standing {
        let (first, last) = self.indistinct();
        let end = self.trials.len() - 1;
        match (first == 0, last == end) {
            (true, true) => Standing::Undetermined,
            _ if self.saturated_from().is_some() => Standing::Saturated,
            _ if self.best == 0 || self.best == end => Standing::AtBorder,
            (false, false) => Standing::Enclosed,
            _ => Standing::ReachesBorder,
        }
    }
}

/// A finished calibration: the scan at one cutting speed, and what its coefficient predicts at the others.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Name of the scenario.
    pub scenario: String,
    /// Version of sphcut.
    pub version: String,
    /// Key of the friction law.
    pub law: String,
    /// The scan at the highest cutting speed.
    pub scan: Scan,
    /// Runs with the coefficient found at the other cutting speeds, not fitted.
    pub predictions: Vec<Trial>,
}

#[cfg(test)]
mod tests;
