//! Cases of diagnoses: recordings and a scenario that lacks something, and what the diagnosis says of them.
//!
//! The folder holds `diagnoses.toml`: files of `sphcut diagnose` (`[[diagnosis]]`) and expectations about their verdicts. They are
//! made with the closed-form model, in seconds, and anew every time.

mod judge;
mod score;

pub use judge::{DiagnosisExpectation, DiagnosisMeasure};
pub use score::{score_edge_radius, score_wear};

use crate::case::{Kind, Tier};
use crate::error::CaseError;
use crate::verdict::{Finding, Outcome, Verdict};
use serde::Deserialize;
use sphcut_diagnose::{
    ClosedForm, Diagnosis, Predictor, WearGrowth, WearSegment, closed_form_cut, diagnose_case,
    grows, load_diagnosis,
};
use sphcut_input::{Colours, read_series_table};
use sphcut_scenario::LoadOptions;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a case.
const FILE: &str = "diagnoses.toml";

/// A case of diagnoses, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct DiagnosesCase {
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
    /// What is diagnosed.
    pub diagnoses: Vec<DiagnosisSpecification>,
    /// Series of which is told what grows: their files are tables of `sphcut wear`.
    pub series: Vec<DiagnosisSpecification>,
    /// Its expectations.
    pub expectations: Vec<DiagnosisExpectation>,
}

/// What is diagnosed.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiagnosisSpecification {
    /// Name, unique in the case.
    pub name: String,
    /// What it asks, for people.
    pub title: String,
    /// The file of the diagnosis, relative to the folder.
    pub file: PathBuf,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: Kind,
    tier: Tier,
    claim: String,
    #[serde(default)]
    diagnosis: Vec<DiagnosisSpecification>,
    #[serde(default)]
    series: Vec<DiagnosisSpecification>,
    expect: Vec<DiagnosisExpectation>,
}

/// What came of one diagnosis.
pub struct Diagnosed {
    /// Name of the diagnosis.
    pub name: String,
    /// What was found.
    pub found: Diagnosis,
    /// The model.
    pub model: ClosedForm,
}

/// All cases of diagnoses below `root`, by name.
///
/// # Errors
/// A folder that cannot be read, the first case that is not well formed.
pub fn diagnoses_cases(root: &Path) -> Result<Vec<DiagnosesCase>, CaseError> {
    let entries = fs::read_dir(root).map_err(|error| CaseError::unreadable(root, &error))?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| CaseError::unreadable(root, &error))?.path();
        if path.join(FILE).is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    folders.iter().map(|folder| DiagnosesCase::read(folder)).collect()
}

impl DiagnosesCase {
    /// Reads and checks one folder.
    ///
    /// # Errors
    /// A missing or malformed file; names that are not unique or not there; an expectation without a limit.
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
            diagnoses: raw.diagnosis,
            series: raw.series,
            expectations: raw.expect,
        };
        case.check().map_err(|reason| CaseError::invalid(&path, reason))?;
        Ok(case)
    }

    fn check(&self) -> Result<(), String> {
        let all = || self.diagnoses.iter().chain(&self.series);
        let mut names: Vec<&String> = all().map(|d| &d.name).collect();
        names.sort();
        names.dedup();
        if names.is_empty() || names.len() < all().count() {
            return Err("a case needs a diagnosis, and every diagnosis a name of its own".into());
        }
        self.expectations.iter().try_for_each(|expectation| {
            expectation.check()?;
            if all().any(|d| d.name == expectation.of) {
                return Ok(());
            }
            Err(format!("expectation of `{}`: no diagnosis has this name", expectation.of))
        })
    }

    /// Makes the diagnoses.
    ///
    /// # Errors
    /// A file with mistakes; recordings that cannot be diagnosed.
    pub fn diagnosed(&self) -> Result<Vec<Diagnosed>, CaseError> {
        let one = |asked: &DiagnosisSpecification| {
            let path = self.folder.join(&asked.file);
            let case = load_diagnosis(&path, &LoadOptions::default()).map_err(|problems| {
                let text = problems.iter().map(|problem| problem.render(Colours::Plain));
                CaseError::invalid(&path, text.collect::<String>())
            })?;
            let failed = |error: sphcut_diagnose::DiagnoseError| CaseError::RunFailed {
                run: asked.name.clone(),
                reason: error.to_string(),
            };
            let cut = closed_form_cut(&case.base).map_err(failed)?;
            let model = ClosedForm::new(cut, &case.scatter);
            let (_, found) = diagnose_case(&case, &model).map_err(failed)?;
            Ok(Diagnosed { name: asked.name.clone(), found, model })
        };
        self.diagnoses.iter().map(one).collect()
    }

    /// Says what grows in the series.
    ///
    /// # Errors
    /// A table with mistakes or with too little.
    pub fn grown(&self) -> Result<Vec<(String, WearGrowth)>, CaseError> {
        let one = |asked: &DiagnosisSpecification| {
            let path = self.folder.join(&asked.file);
            let text =
                fs::read_to_string(&path).map_err(|error| CaseError::unreadable(&path, &error))?;
            let rows = read_series_table(&text)
                .map_err(|problem| CaseError::invalid(&path, problem.to_string()))?;
            let segment = |row: sphcut_input::SeriesRow| WearSegment {
                tool: row.tool,
                time: row.time,
                forces: row.forces,
            };
            let segments: Vec<WearSegment> = rows.into_iter().map(segment).collect();
            let found = grows(&segments, 1).map_err(|error| CaseError::RunFailed {
                run: asked.name.clone(),
                reason: error.to_string(),
            })?;
            Ok((asked.name.clone(), found))
        };
        self.series.iter().map(one).collect()
    }

    /// Makes the diagnoses and judges them. What goes wrong becomes [`Outcome::Broken`].
    #[must_use]
    pub fn judge(&self) -> Verdict {
        match self.diagnosed().and_then(|all| Ok((all, self.grown()?))) {
            Ok((all, grown)) => self.judge_these(&all, &grown),
            Err(error) => self.verdict(Vec::new(), Outcome::Broken { reason: error.to_string() }),
        }
    }

    /// Judges diagnoses that are made.
    fn judge_these(&self, all: &[Diagnosed], grown: &[(String, WearGrowth)]) -> Verdict {
        let findings: Result<Vec<Finding>, CaseError> =
            self.expectations.iter().map(|expectation| expectation.judge(all, grown)).collect();
        match findings {
            Ok(findings) => {
                let outcome = Verdict::outcome_of(&findings);
                self.verdict(findings, outcome)
            }
            Err(error) => self.verdict(Vec::new(), Outcome::Broken { reason: error.to_string() }),
        }
    }

    fn verdict(&self, findings: Vec<Finding>, outcome: Outcome) -> Verdict {
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

    /// What is diagnosed and by which command, as Markdown.
    #[must_use]
    pub fn questions(&self) -> String {
        let mut text = String::from("\nDiagnoses and commands:\n\n");
        for asked in &self.diagnoses {
            text += &format!(
                "- {}: {}; `sphcut diagnose validation/{}/{} --out DIR --closed-form`\n",
                asked.name,
                asked.title,
                self.name,
                asked.file.display()
            );
        }
        for asked in &self.series {
            text += &format!(
                "- {}: {}; `sphcut wear validation/{}/{} --out DIR`\n",
                asked.name,
                asked.title,
                self.name,
                asked.file.display()
            );
        }
        text
    }
}

impl Diagnosed {
    /// The place of an effect among those of the model.
    fn effect(&self, key: &str) -> Option<usize> {
        self.model.effects().iter().position(|effect| effect.key == key)
    }
}

#[cfg(test)]
mod tests;
