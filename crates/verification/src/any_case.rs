//! Cases of scenarios, of the grey box, of sweeps and of diagnoses under one name.

use crate::case::{Case, Tier, cases};
use crate::diagnoses::{DiagnosesCase, diagnoses_cases};
use crate::error::CaseError;
use crate::grey_box::{GreyBoxCase, Watch, grey_box_cases};
use crate::runner::{RunOptions, run_case};
use crate::sweep_trends::{SweepCase, sweep_cases};
use crate::verdict::Verdict;
use std::path::Path;

/// A case of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyCase {
    /// Scenarios are run.
    Scenarios(Case),
    /// Corrections are fitted.
    GreyBox(GreyBoxCase),
    /// The table of a sweep is judged.
    Sweep(SweepCase),
    /// Recordings are diagnosed.
    Diagnoses(DiagnosesCase),
}

/// All cases below `root`, by name.
///
/// # Errors
/// A folder that cannot be read, the first case that is not well formed.
pub fn all_cases(root: &Path) -> Result<Vec<AnyCase>, CaseError> {
    let scenarios = cases(root)?.into_iter().map(AnyCase::Scenarios);
    let grey_boxes = grey_box_cases(root)?.into_iter().map(AnyCase::GreyBox);
    let sweeps = sweep_cases(root)?.into_iter().map(AnyCase::Sweep);
    let diagnoses = diagnoses_cases(root)?.into_iter().map(AnyCase::Diagnoses);
    let mut all: Vec<AnyCase> =
        scenarios.chain(grey_boxes).chain(sweeps).chain(diagnoses).collect();
    all.sort_by(|a, b| a.name().cmp(b.name()));
    Ok(all)
}

impl AnyCase {
    /// Name of the folder.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Scenarios(case) => &case.name,
            Self::GreyBox(case) => &case.name,
            Self::Sweep(case) => &case.name,
            Self::Diagnoses(case) => &case.name,
        }
    }

    /// Title.
    #[must_use]
    pub fn title(&self) -> &str {
        match self {
            Self::Scenarios(case) => &case.title,
            Self::GreyBox(case) => &case.title,
            Self::Sweep(case) => &case.title,
            Self::Diagnoses(case) => &case.title,
        }
    }

    /// How long it takes.
    #[must_use]
    pub fn tier(&self) -> Tier {
        match self {
            Self::Scenarios(case) => case.tier,
            Self::GreyBox(case) => case.tier,
            Self::Sweep(_) => SweepCase::TIER,
            Self::Diagnoses(case) => case.tier,
        }
    }

    /// Runs and judges it.
    pub fn run(&self, options: &RunOptions, progress: &Watch<'_>) -> Verdict {
        match self {
            Self::Scenarios(case) => run_case(case, options, &mut |told| progress(told)),
            Self::GreyBox(case) => case.run(options, progress),
            Self::Sweep(case) => case.judge(),
            Self::Diagnoses(case) => case.judge(),
        }
    }
}
