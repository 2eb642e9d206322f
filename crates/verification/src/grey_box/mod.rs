//! Cases of the grey box: tables of simulated and measured forces instead of scenarios.
//!
//! The folder holds `grey_box.toml`: fits (`[[fit]]`: what `sphcut greybox fit` is given), comparisons of a fit with
//! measurements it was not taught with (`[[comparison]]`, as `sphcut greybox compare`), and expectations about them.
//! What the fits give is kept in `results/`, one file per fit, with the hashes of the tables it belongs to.

mod figures;
mod judge;
mod section;

pub use figures::{ComparisonFigures, FitFigures, ForceCompared, ForceFigures, LevelsLeftOut};
pub use judge::GreyBoxMeasure;

use crate::error::CaseError;
use crate::expectation::Expected;
use crate::head::{CaseHead, CaseKind, Tier, toml_of};
use crate::options::ProgressWatch;
use crate::store::CaseStore;
use crate::verdict::Judgement;
use serde::Deserialize;
use sphcut_greybox::regressor::Method;
use std::path::{Path, PathBuf};

/// Corrections that are fitted and compared, and what is expected of them.
#[derive(Debug, Clone, PartialEq)]
pub struct GreyBoxFits {
    /// The fits.
    pub fits: Vec<FitSpecification>,
    /// Fits against other measurements.
    pub comparisons: Vec<ComparisonSpecification>,
    /// Its expectations.
    pub expectations: Vec<Expected<GreyBoxMeasure>>,
}

/// What is fitted.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSpecification {
    /// Name, unique in the case.
    pub name: String,
    /// What the measured table holds, for people.
    pub title: String,
    /// The simulated forces, relative to the folder.
    #[serde(default = "simulated")]
    pub simulated: PathBuf,
    /// The measured forces, relative to the folder.
    pub measured: PathBuf,
    /// For tables that are not in the repository: how they are made. Without them the kept figures stand.
    pub made_by: Option<String>,
    /// Regressors to compare; without it, all.
    pub regressors: Option<Vec<Method>>,
}

/// A fit against measurements it was not taught with.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComparisonSpecification {
    /// Name, unique in the case.
    pub name: String,
    /// What the measured table holds, for people.
    pub title: String,
    /// Name of the fit.
    pub fit: String,
    /// The simulated forces, relative to the folder.
    #[serde(default = "simulated")]
    pub simulated: PathBuf,
    /// The measured forces, relative to the folder.
    pub measured: PathBuf,
}

fn simulated() -> PathBuf {
    "simulated.csv".into()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: CaseKind,
    tier: Tier,
    claim: String,
    fit: Vec<FitSpecification>,
    #[serde(default)]
    comparison: Vec<ComparisonSpecification>,
    expect: Vec<Expected<GreyBoxMeasure>>,
}

impl GreyBoxFits {
    /// Reads and checks `grey_box.toml`.
    pub(crate) fn read(path: &Path) -> Result<(CaseHead, Self), CaseError> {
        let raw: RawCase = toml_of(path)?;
        let head = CaseHead::new(path, raw.title, raw.kind, raw.tier, raw.claim);
        let case = Self { fits: raw.fit, comparisons: raw.comparison, expectations: raw.expect };
        case.check().map_err(|reason| CaseError::invalid(path, reason))?;
        Ok((head, case))
    }

    fn check(&self) -> Result<(), String> {
        let fits = self.fits.iter().map(|fit| &fit.name);
        let mut names: Vec<&String> =
            fits.chain(self.comparisons.iter().map(|c| &c.name)).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        if self.fits.is_empty() || names.len() < count {
            return Err("a case needs a fit, and every fit and comparison a name of its own".into());
        }
        if let Some(other) = self.comparisons.iter().find(|c| self.fit(&c.fit).is_none()) {
            return Err(format!("comparison `{}`: no fit `{}`", other.name, other.fit));
        }
        self.expectations.iter().try_for_each(|expectation| self.check_expectation(expectation))
    }

    fn check_expectation(&self, expectation: &Expected<GreyBoxMeasure>) -> Result<(), String> {
        expectation.check()?;
        let of = expectation.of();
        let comparison = self.comparisons.iter().find(|c| c.name == of);
        let fit = self.fit(comparison.map_or(of, |comparison| &comparison.fit));
        match fit {
            None => Err(expectation.wrong("no fit or comparison has this name")),
            Some(fit) if fit.made_by.is_some() => {
                Err(expectation.wrong("its tables are not in the repository: shown, not judged"))
            }
            _ if expectation.measure.is_of_comparison() != comparison.is_some() => {
                Err(expectation
                    .wrong("this measure is not one of a fit, or not one of a comparison"))
            }
            _ => Ok(()),
        }
    }

    fn fit(&self, name: &str) -> Option<&FitSpecification> {
        self.fits.iter().find(|fit| fit.name == name)
    }

    /// Fits what is not kept in `store` and judges. A fit whose tables are not in the repository and not there is
    /// passed over.
    pub(crate) fn run(
        &self,
        head: &CaseHead,
        store: Option<&CaseStore>,
        progress: &ProgressWatch<'_>,
    ) -> Result<Vec<Judgement>, CaseError> {
        let figures = self.fits.iter().map(|fit| self.obtain(head, fit, store, progress));
        let figures = figures.collect::<Result<Vec<_>, _>>()?;
        self.judge(&figures.into_iter().flatten().collect::<Vec<_>>())
    }

    /// The kept figures of all fits, as far as they belong to the tables that are there.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn stored(&self, head: &CaseHead, store: &CaseStore) -> Result<Vec<FitFigures>, CaseError> {
        let kept = self.fits.iter().map(|fit| self.kept(head, fit, store));
        Ok(kept.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    /// Judges figures; `None` if one that is expected something of is missing.
    pub(crate) fn judge_stored(
        &self,
        figures: &[FitFigures],
    ) -> Option<Result<Vec<Judgement>, CaseError>> {
        let there = |fit: &FitSpecification| figures.iter().any(|found| found.fit == fit.name);
        let complete = self.fits.iter().all(|fit| fit.made_by.is_some() || there(fit));
        complete.then(|| self.judge(figures))
    }
}

#[cfg(test)]
mod tests;
