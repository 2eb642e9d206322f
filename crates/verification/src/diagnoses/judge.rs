//! From a diagnosis to judgements.

use super::JudgedDiagnosis;
use crate::error::CaseError;
use crate::expectation::{Expected, Measure};
use crate::verdict::Judgement;
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

impl DiagnosisMeasure {
    fn needs_effect(self) -> bool {
        matches!(self, Self::Named | Self::InSet | Self::Probability | Self::Estimate)
    }
}

impl Measure for DiagnosisMeasure {
    const KEYS: &'static [&'static str] = &["of", "effect", "channel"];

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

impl Expected<DiagnosisMeasure> {
    pub(super) fn check_diagnosis(&self) -> Result<(), String> {
        if self.measure.needs_effect() != self.effect.is_some() {
            return Err(self.wrong("this measure is one of an effect, or none is needed"));
        }
        self.check()
    }

    pub(super) fn judge_diagnosis(
        &self,
        all: &[JudgedDiagnosis],
        grown: &[(String, WearGrowth)],
    ) -> Result<Judgement, CaseError> {
        let of = self.of();
        let diagnosed = all.iter().find(|one| one.name == of);
        let series = grown.iter().find(|(name, _)| *name == of);
        let value = diagnosed
            .and_then(|one| self.value(one))
            .or_else(|| series.and_then(|(_, found)| self.of_series(found)));
        let about = [self.effect.as_deref(), self.channel.as_deref()].into_iter().flatten();
        let about: String = about.map(|key| format!("{key}: ")).collect();
        let about = format!("{about}{}", self.measure.words());
        self.judge(of, &about, value, &format!("`{of}` has no figure for it"))
    }

    fn value(&self, one: &JudgedDiagnosis) -> Option<f64> {
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
