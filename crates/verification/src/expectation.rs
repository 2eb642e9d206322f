//! Expectations about single figures, whatever the kind of case that gives them, and their judge.

use crate::error::CaseError;
use crate::metric::{Metric, band};
use crate::verdict::Judgement;
use serde::Deserialize;
use sphcut_greybox::ForceKind;

/// A figure that can be judged.
pub trait Measure: Copy {
    /// The keys that say which figure is meant, of those of [`Expected`].
    const KEYS: &'static [&'static str];

    /// For people.
    fn words(self) -> &'static str;

    /// Its unit.
    fn unit(self) -> &'static str {
        ""
    }
}

/// What is expected of a figure: `at_least`, `at_most` or both, or `reference` with `tolerance`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expected<M> {
    /// What is judged.
    pub measure: M,
    /// Name of the fit, comparison, diagnosis or series.
    pub of: Option<String>,
    /// F_c or F_f.
    pub force: Option<ForceKind>,
    /// In m/min, for a line over h.
    pub cutting_speed: Option<f64>,
    /// The effect, by its key.
    pub effect: Option<String>,
    /// The channel, by its key.
    pub channel: Option<String>,
    /// A value of others.
    pub reference: Option<f64>,
    /// How far from the reference, as a share of it.
    pub tolerance: Option<f64>,
    /// The least value that holds.
    pub at_least: Option<f64>,
    /// The largest value that holds.
    pub at_most: Option<f64>,
    /// Why this limit.
    pub because: String,
    /// Why it is known not to hold yet.
    pub known_gap: Option<String>,
}

impl<M: Measure> Expected<M> {
    /// Name of what it is about; empty where a case has only one.
    pub(crate) fn of(&self) -> &str {
        self.of.as_deref().unwrap_or_default()
    }

    /// Place of the force: 0 for F_c, 1 for F_f.
    pub(crate) fn force_index(&self) -> usize {
        usize::from(self.force == Some(ForceKind::Feed))
    }

    /// Refuses keys that the measure does not have, one of `of` and `force` that it lacks, limits that say nothing or
    /// too much, and a limit without a reason.
    pub(crate) fn check(&self) -> Result<(), String> {
        let given = [
            ("of", self.of.is_some()),
            ("force", self.force.is_some()),
            ("cutting_speed", self.cutting_speed.is_some()),
            ("effect", self.effect.is_some()),
            ("channel", self.channel.is_some()),
        ];
        for (key, is_given) in given {
            let has = M::KEYS.contains(&key);
            if is_given && !has {
                return Err(self.wrong(&format!("no measure of this kind of case has a `{key}`")));
            }
            if !is_given && has && ["of", "force"].contains(&key) {
                return Err(self.wrong(&format!("`{key}` is missing")));
            }
        }
        let has_limit = self.at_least.is_some() || self.at_most.is_some();
        if self.reference.is_some() != self.tolerance.is_some()
            || self.reference.is_some() == has_limit
        {
            return Err(self.wrong(
                "`at_least` or `at_most` is needed, or `reference` with `tolerance` instead",
            ));
        }
        if self.because.trim().is_empty() { Err(self.wrong("`because` is empty")) } else { Ok(()) }
    }

    /// `reason` with the name of what is judged.
    pub(crate) fn wrong(&self, reason: &str) -> String {
        match &self.of {
            Some(of) => format!("expectation of `{of}`: {reason}"),
            None => format!("`{}`: {reason}", self.measure.words()),
        }
    }

    /// Judges the figure; `None` if there is none, with what is `missing`. `about` says which figure of `run` it is.
    pub(crate) fn judge(
        &self,
        run: &str,
        about: &str,
        value: Option<f64>,
        missing: &str,
    ) -> Result<Judgement, CaseError> {
        let words = self.measure.words();
        let value = value.ok_or_else(|| CaseError::unobservable(words, missing))?;
        // `check` has refused all others.
        let (metric, ends) = match (self.at_least, self.at_most, self.reference) {
            (Some(low), Some(high), _) => (Metric::Within, (low, high)),
            (Some(low), ..) => (Metric::AtLeast, (low, low)),
            (_, Some(high), _) => (Metric::AtMost, (high, high)),
            (.., reference) => {
                let reference = reference.unwrap_or(f64::NAN);
                (Metric::RelativeError, (reference, reference))
            }
        };
        let tolerance = self.tolerance.unwrap_or(0.0);
        let (result, holds) = metric.compare(value, ends, tolerance);
        Ok(Judgement {
            run: run.to_owned(),
            observable: about.to_owned(),
            unit: self.measure.unit().to_owned(),
            metric,
            values: vec![value],
            reference: band(ends.0, ends.1),
            result,
            tolerance,
            holds,
            known_gap: self.known_gap.clone(),
            because: self.because.clone(),
        })
    }
}
