//! From a diagnosis to findings.

use super::Diagnosed;
use crate::case::Metric;
use crate::error::CaseError;
use crate::judge::number;
use crate::verdict::Finding;
use serde::Deserialize;
use sphcut_diagnose::{Cause, ClaimVerdict, HeldOutErrors, Part, WearGrowth};

/// What is judged of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DiagnosisMeasure {
    /// Probability that nothing is missing.
    NothingMissing,
    /// 1 if `effect` is named, and nothing else.
    Named,
    /// 1 if `effect` belongs to the 95 % set of an alarm.
    InSet,
    /// Probability that `effect` is among what is missing.
    Probability,
    /// 1 if the verdict is that none of the effects explains the data.
    NoneOfThese,
    /// The most probable value of the first parameter of `effect` in the repair, in SI.
    Estimate,
    /// Error on the quarters left out, repair over fitting nuisances again; of one `channel` or of all.
    HeldOutRatio,
    /// The same on the highest speeds.
    HighestSpeedRatio,
    /// The same on the thinnest chips.
    ThinnestChipRatio,
    /// Upper end of the 95 % interval of the ratio on the quarters, all channels.
    HeldOutUpperEnd,
    /// Share of the self-test's recordings with nothing missing that raised an alarm.
    FalseAlarms,
    /// Of a series: probability that the edge wears, as a land or by rounding.
    Wear,
    /// Of a series: probability that it is a land.
    WearLand,
    /// Of a series: least probability of wear by the other tools, each left out in turn.
    WearByTheOthers,
    /// Of a series: error of F_c from F_f and F_p on tools left out, over its change.
    CuttingForceError,
}

/// What is expected of a diagnosis.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiagnosisExpectation {
    /// Name of the diagnosis.
    pub of: String,
    /// What is judged.
    pub measure: DiagnosisMeasure,
    /// The effect, by its key.
    pub effect: Option<String>,
    /// The channel, by its key.
    pub channel: Option<String>,
    /// The least value that holds.
    pub at_least: Option<f64>,
    /// The largest value that holds.
    pub at_most: Option<f64>,
    /// Why this limit.
    pub because: String,
    /// Why it is known not to hold yet.
    pub known_gap: Option<String>,
}

impl DiagnosisMeasure {
    fn needs_effect(self) -> bool {
        matches!(self, Self::Named | Self::InSet | Self::Probability | Self::Estimate)
    }

    fn words(self) -> &'static str {
        match self {
            Self::NothingMissing => "posterior probability of the null hypothesis",
            Self::Named => "named, and nothing else",
            Self::InSet => "in the 95 % set",
            Self::Probability => "probability to be among what is missing",
            Self::NoneOfThese => "verdict: unmodelled effect",
            Self::Estimate => "most probable size",
            Self::HeldOutRatio => "error on quarters left out, corrected over recalibrated",
            Self::HighestSpeedRatio => "error on the highest speeds, corrected over recalibrated",
            Self::ThinnestChipRatio => "error on the thinnest chips, corrected over recalibrated",
            Self::HeldOutUpperEnd => "upper end of the ratio on quarters left out",
            Self::FalseAlarms => "alarms in simulated recordings without a missing effect",
            Self::Wear => "probability that the edge wears",
            Self::WearLand => "probability that a wear land grows",
            Self::WearByTheOthers => "least probability of wear, each tool left out in turn",
            Self::CuttingForceError => "F_c by F_f and F_p on tools left out: error over change",
        }
    }
}

impl DiagnosisExpectation {
    pub(super) fn check(&self) -> Result<(), String> {
        let wrong = |reason: &str| Err(format!("expectation of `{}`: {reason}", self.of));
        if self.measure.needs_effect() != self.effect.is_some() {
            return wrong("this measure is one of an effect, or none is needed");
        }
        if self.at_least.is_none() && self.at_most.is_none() {
            return wrong("`at_least` or `at_most` is needed");
        }
        if self.because.trim().is_empty() {
            return wrong("`because` is empty");
        }
        Ok(())
    }

    pub(super) fn judge(
        &self,
        all: &[Diagnosed],
        grown: &[(String, WearGrowth)],
    ) -> Result<Finding, CaseError> {
        let diagnosed = all.iter().find(|one| one.name == self.of);
        let series = grown.iter().find(|(name, _)| *name == self.of);
        let value = diagnosed
            .and_then(|one| self.value(one))
            .or_else(|| series.and_then(|(_, found)| self.of_series(found)));
        let value = value.ok_or_else(|| CaseError::Unobservable {
            observable: self.measure.words().to_owned(),
            reason: format!("`{}` has no figure for it", self.of),
        })?;
        let above = self.at_least.is_none_or(|limit| value >= limit);
        let below = self.at_most.is_none_or(|limit| value <= limit);
        let (metric, reference) = match (self.at_least, self.at_most) {
            (Some(low), Some(high)) => {
                (Metric::Within, format!("{} to {}", number(low), number(high)))
            }
            (Some(low), None) => (Metric::AtLeast, number(low)),
            (None, high) => (Metric::AtMost, number(high.unwrap_or(f64::NAN))),
        };
        let about = [self.effect.as_deref(), self.channel.as_deref()].into_iter().flatten();
        let about: String = about.map(|key| format!("{key}: ")).collect();
        Ok(Finding {
            run: self.of.clone(),
            observable: format!("{about}{}", self.measure.words()),
            unit: String::new(),
            metric,
            values: vec![value],
            reference,
            result: value,
            tolerance: 0.0,
            holds: above && below,
            known_gap: self.known_gap.clone(),
            because: self.because.clone(),
        })
    }

    fn value(&self, one: &Diagnosed) -> Option<f64> {
        let finding = &one.found.finding;
        let effect = || one.effect(self.effect.as_deref()?);
        let held = |part: Part| one.found.help.iter().find(|held| held.part == part);
        match self.measure {
            DiagnosisMeasure::NothingMissing => Some(finding.nothing),
            DiagnosisMeasure::Named => {
                Some(f64::from(finding.verdict == ClaimVerdict::Named(vec![effect()?])))
            }
            DiagnosisMeasure::InSet => {
                Some(f64::from(finding.is_alarm() && finding.set.contains(&effect()?)))
            }
            DiagnosisMeasure::Probability => Some(finding.inclusion[effect()?]),
            DiagnosisMeasure::NoneOfThese => {
                Some(f64::from(finding.verdict == ClaimVerdict::NoneOfThese))
            }
            DiagnosisMeasure::Estimate => {
                let repair = &one.found.fits[one.found.repair?];
                let effect = effect()?;
                let all = one.found.estimates(&one.model, repair);
                all.iter().find(|e| e.effect == effect && e.parameter == 0).map(|e| e.value)
            }
            DiagnosisMeasure::HeldOutRatio => self.ratio(held(Part::Blocks)?),
            DiagnosisMeasure::HighestSpeedRatio => self.ratio(held(Part::HighestSpeed)?),
            DiagnosisMeasure::ThinnestChipRatio => self.ratio(held(Part::ThinnestChip)?),
            DiagnosisMeasure::HeldOutUpperEnd => Some(held(Part::Blocks)?.ratio[2]),
            DiagnosisMeasure::FalseAlarms => Some(one.found.false_alarms?.share()),
            _ => None,
        }
    }

    fn of_series(&self, found: &WearGrowth) -> Option<f64> {
        let land = [Cause::WearLand, Cause::WearLandAndStrength];
        match self.measure {
            DiagnosisMeasure::Wear => Some(found.wear()),
            DiagnosisMeasure::WearLand => {
                let own = found.causes.iter().filter(|(cause, _)| land.contains(cause));
                Some(own.map(|(_, p)| p).sum())
            }
            DiagnosisMeasure::WearByTheOthers => {
                Some(found.left_out.iter().map(|tool| tool.wear).fold(1.0, f64::min))
            }
            DiagnosisMeasure::CuttingForceError => Some(found.ratio()),
            _ => None,
        }
    }

    fn ratio(&self, held: &HeldOutErrors) -> Option<f64> {
        let Some(key) = &self.channel else { return Some(held.ratio[0]) };
        let (_, [again, repaired]) = held.channels.iter().find(|(c, _)| c.symbol() == key)?;
        Some(repaired / again)
    }
}
