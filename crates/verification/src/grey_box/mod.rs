//! Cases of the grey box: tables of simulated and measured forces instead of scenarios.
//!
//! The folder holds `grey_box.toml`: fits (`[[fit]]`: what `sphcut greybox fit` is given), comparisons of a fit with
//! measurements it was not taught with (`[[comparison]]`, as `sphcut greybox compare`), and expectations about them.
//! What the fits give is kept in `results/`, one file per fit, with the hashes of the tables it belongs to.

mod figures;
mod judge;
mod section;

pub use figures::{ComparisonFigures, FitFigures, ForceCompared, ForceFigures, LevelsLeftOut};
pub use judge::Measure;

use crate::case::{Kind, Tier};
use crate::error::CaseError;
use crate::store::Store;
use crate::verdict::{Outcome, Verdict};
use crate::{Progress, RunOptions};
use serde::Deserialize;
use sphcut_greybox::ForceKind;
use sphcut_greybox::regressor::Method;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a case.
const FILE: &str = "grey_box.toml";

/// A case of the grey box, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct GreyBoxCase {
    /// Name of the folder.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Title.
    pub title: String,
    /// Kind of evidence.
    pub kind: Kind,
    /// How long it takes.
    pub tier: Tier,
    /// What it claims.
    pub claim: String,
    /// Its fits.
    pub fits: Vec<FitSpecification>,
    /// Fits against other measurements.
    pub comparisons: Vec<ComparisonSpecification>,
    /// Its expectations.
    pub expectations: Vec<GreyBoxExpectation>,
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

/// What is expected of a fit or a comparison.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GreyBoxExpectation {
    /// Name of the fit or comparison.
    pub of: String,
    /// F_c or F_f.
    pub force: ForceKind,
    /// What is judged.
    pub measure: Measure,
    /// The least value that holds.
    pub at_least: Option<f64>,
    /// The largest value that holds.
    pub at_most: Option<f64>,
    /// Why this limit.
    pub because: String,
    /// Why it is known not to hold yet.
    pub known_gap: Option<String>,
}

/// Is told how far a case is, from any thread.
pub type Watch<'a> = dyn Fn(&Progress<'_>) + Sync + 'a;

fn simulated() -> PathBuf {
    "simulated.csv".into()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: Kind,
    tier: Tier,
    claim: String,
    fit: Vec<FitSpecification>,
    #[serde(default)]
    comparison: Vec<ComparisonSpecification>,
    expect: Vec<GreyBoxExpectation>,
}

/// All cases of the grey box below `root`, by name.
///
/// # Errors
/// A folder that cannot be read, the first case that is not well formed.
pub fn grey_box_cases(root: &Path) -> Result<Vec<GreyBoxCase>, CaseError> {
    let entries = fs::read_dir(root).map_err(|error| CaseError::unreadable(root, &error))?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| CaseError::unreadable(root, &error))?.path();
        if path.join(FILE).is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    folders.iter().map(|folder| GreyBoxCase::read(folder)).collect()
}

impl GreyBoxCase {
    /// Reads and checks one folder.
    ///
    /// # Errors
    /// A missing or malformed file; names that are not unique or not there; an expectation without a limit; one about
    /// tables that are not in the repository.
    pub fn read(folder: &Path) -> Result<Self, CaseError> {
        let path = folder.join(FILE);
        let text =
            fs::read_to_string(&path).map_err(|error| CaseError::unreadable(&path, &error))?;
        let raw: RawCase =
            toml::from_str(&text).map_err(|error| CaseError::invalid(&path, error.to_string()))?;
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
        let case = Self {
            name: name.unwrap_or_default(),
            folder: folder.to_owned(),
            title: raw.title,
            kind: raw.kind,
            tier: raw.tier,
            claim: raw.claim,
            fits: raw.fit,
            comparisons: raw.comparison,
            expectations: raw.expect,
        };
        case.check().map_err(|reason| CaseError::invalid(&path, reason))?;
        Ok(case)
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

    fn check_expectation(&self, expectation: &GreyBoxExpectation) -> Result<(), String> {
        let wrong = |reason: &str| Err(format!("expectation of `{}`: {reason}", expectation.of));
        let comparison = self.comparisons.iter().find(|c| c.name == expectation.of);
        let fit = self.fit(comparison.map_or(&expectation.of, |comparison| &comparison.fit));
        match fit {
            None => return wrong("no fit or comparison has this name"),
            Some(fit) if fit.made_by.is_some() => {
                return wrong("its tables are not in the repository: shown, not judged");
            }
            Some(_) => {}
        }
        if expectation.measure.is_of_comparison() != comparison.is_some() {
            return wrong("this measure is not one of a fit, or not one of a comparison");
        }
        if expectation.at_least.is_some() == expectation.at_most.is_some() {
            return wrong("one of `at_least` and `at_most` is needed");
        }
        if expectation.because.trim().is_empty() {
            return wrong("`because` is empty");
        }
        Ok(())
    }

    fn fit(&self, name: &str) -> Option<&FitSpecification> {
        self.fits.iter().find(|fit| fit.name == name)
    }

    /// Fits what is not kept in the store of `options` and judges. What goes wrong becomes [`Outcome::Broken`]. A fit
    /// whose tables are not in the repository and not there is passed over.
    pub fn run(&self, options: &RunOptions, progress: &Watch<'_>) -> Verdict {
        let figures: Result<Vec<_>, _> = self
            .fits
            .iter()
            .map(|fit| figures::obtain(self, fit, options.store.as_ref(), progress))
            .collect();
        match figures {
            Ok(figures) => self.judge(&figures.into_iter().flatten().collect::<Vec<_>>()),
            Err(error) => self.verdict(Vec::new(), Outcome::Broken { reason: error.to_string() }),
        }
    }

    /// The kept figures of all fits, as far as they belong to the tables that are there.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn stored(&self, store: &Store) -> Result<Vec<FitFigures>, CaseError> {
        let kept = self.fits.iter().map(|fit| figures::kept(self, fit, store));
        Ok(kept.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    /// Judges figures; `None` if one that is expected something of is missing.
    #[must_use]
    pub fn judge_stored(&self, figures: &[FitFigures]) -> Option<Verdict> {
        let there = |fit: &FitSpecification| figures.iter().any(|found| found.fit == fit.name);
        let complete = self.fits.iter().all(|fit| fit.made_by.is_some() || there(fit));
        complete.then(|| self.judge(figures))
    }

    /// Tables of errors before and after, beyond the plan and of the comparisons, as Markdown.
    #[must_use]
    pub fn tables(&self, figures: &[FitFigures]) -> String {
        section::tables(self, figures)
    }

    fn judge(&self, figures: &[FitFigures]) -> Verdict {
        match judge::judge(self, figures) {
            Ok(findings) => {
                let outcome = Verdict::outcome_of(&findings);
                self.verdict(findings, outcome)
            }
            Err(error) => self.verdict(Vec::new(), Outcome::Broken { reason: error.to_string() }),
        }
    }

    fn verdict(&self, findings: Vec<crate::Finding>, outcome: Outcome) -> Verdict {
        Verdict {
            case: self.name.clone(),
            title: self.title.clone(),
            kind: self.kind,
            tier: self.tier,
            claim: self.claim.clone(),
            findings,
            earlier: Vec::new(),
            outcome,
        }
    }
}

#[cfg(test)]
mod tests;
