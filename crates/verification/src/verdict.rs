//! What came out of a case, as plain data.

use crate::head::CaseHead;
use crate::metric::Metric;

/// How a case ended.
#[derive(Debug, Clone, PartialEq)]
pub enum CaseOutcome {
    /// Every expectation holds and none is marked as a known gap.
    Passed,
    /// Everything holds but the expectations marked as known gaps, which fail as stated.
    KnownGap,
    /// An expectation does not hold, or one marked as a known gap holds.
    Failed,
    /// The case could not be run or judged.
    Broken {
        /// Why.
        reason: String,
    },
}

impl CaseOutcome {
    /// One word for people.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::KnownGap => "known gap",
            Self::Failed => "FAILED",
            Self::Broken { .. } => "BROKEN",
        }
    }

    /// The outcome that `judgements` mean.
    pub(crate) fn of(judgements: &[Judgement]) -> Self {
        let gap = |judged: &Judgement| judged.known_gap.is_some();
        if judgements.iter().any(|judged| judged.holds == gap(judged)) {
            Self::Failed
        } else if judgements.iter().any(gap) {
            Self::KnownGap
        } else {
            Self::Passed
        }
    }

    /// Whether the case is as its author says it is: passed, or failing exactly as stated.
    #[must_use]
    pub fn is_as_stated(&self) -> bool {
        matches!(self, Self::Passed | Self::KnownGap)
    }
}

/// One judged expectation.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Name of the run, or of the runs joined with commas.
    pub run: String,
    /// Name of the observable with its arguments.
    pub observable: String,
    /// Its SI unit.
    pub unit: String,
    /// How it is compared.
    pub metric: Metric,
    /// What was computed, one value per run.
    pub values: Vec<f64>,
    /// The reference as text.
    pub reference: String,
    /// What the metric made of values and reference.
    pub result: f64,
    /// The limit of the result.
    pub tolerance: f64,
    /// Whether the expectation holds.
    pub holds: bool,
    /// Why it is known not to hold, if so.
    pub known_gap: Option<String>,
    /// Why the tolerance is what it is.
    pub because: String,
}

/// The judgement of one case.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseVerdict {
    /// The case.
    pub case: CaseHead,
    /// The judged expectations.
    pub judgements: Vec<Judgement>,
    /// Runs whose kept values an earlier version of the solver gave: they have to be run again.
    pub earlier: Vec<String>,
    /// The judgement.
    pub outcome: CaseOutcome,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(holds: bool, known_gap: Option<&str>) -> Judgement {
        Judgement {
            run: "run".into(),
            observable: "steps".into(),
            unit: String::new(),
            metric: Metric::AtMost,
            values: vec![1.0],
            reference: "1".into(),
            result: 1.0,
            tolerance: 0.0,
            holds,
            known_gap: known_gap.map(str::to_owned),
            because: "test".into(),
        }
    }

    #[test]
    fn a_known_gap_is_never_passed_and_must_keep_failing() {
        let outcome = |judgements: &[Judgement]| CaseOutcome::of(judgements);
        assert_eq!(outcome(&[judged(true, None)]), CaseOutcome::Passed);
        assert_eq!(outcome(&[judged(false, None)]), CaseOutcome::Failed);
        assert_eq!(
            outcome(&[judged(true, None), judged(false, Some("why"))]),
            CaseOutcome::KnownGap
        );
        assert_eq!(outcome(&[judged(true, Some("why"))]), CaseOutcome::Failed);
        assert_eq!(
            outcome(&[judged(false, None), judged(false, Some("why"))]),
            CaseOutcome::Failed
        );
    }
}
