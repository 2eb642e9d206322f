//! Cases of diagnoses: recordings and a scenario that lacks something, and what the diagnosis says of them.
//!
//! The folder holds `diagnoses.toml`: files of `sphcut diagnose` (`[[diagnosis]]`) and expectations about their verdicts. They are
//! made with the closed-form model, in seconds, and anew every time.

mod judge;
mod score;

pub use judge::DiagnosisMeasure;
pub use score::{score_edge_radius, score_wear};

use crate::error::CaseError;
use crate::expectation::Expected;
use crate::head::{CaseHead, CaseKind, Tier, rendered, text_of, toml_of};
use crate::verdict::Judgement;
use serde::Deserialize;
use sphcut_diagnose::{
    ClosedForm, Diagnosis, Predictor, WearGrowth, WearSegment, closed_form_cut, diagnose_case,
    grows, load_diagnosis,
};
use sphcut_input::read_series_table;
use sphcut_scenario::LoadOptions;
use std::path::{Path, PathBuf};

/// What is diagnosed, and what is expected of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnoses {
    /// What is diagnosed.
    pub diagnoses: Vec<DiagnosisSpecification>,
    /// Series of which is told what grows: their files are tables of `sphcut wear`.
    pub series: Vec<DiagnosisSpecification>,
    /// Its expectations.
    pub expectations: Vec<Expected<DiagnosisMeasure>>,
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
    kind: CaseKind,
    tier: Tier,
    claim: String,
    #[serde(default)]
    diagnosis: Vec<DiagnosisSpecification>,
    #[serde(default)]
    series: Vec<DiagnosisSpecification>,
    expect: Vec<Expected<DiagnosisMeasure>>,
}

/// What came of one diagnosis.
pub struct JudgedDiagnosis {
    /// Name of the diagnosis.
    pub name: String,
    /// What was found.
    pub found: Diagnosis,
    /// The model.
    pub model: ClosedForm,
}

impl Diagnoses {
    /// Reads and checks `diagnoses.toml`.
    pub(crate) fn read(path: &Path) -> Result<(CaseHead, Self), CaseError> {
        let raw: RawCase = toml_of(path)?;
        let head = CaseHead::new(path, raw.title, raw.kind, raw.tier, raw.claim);
        let (diagnoses, series) = (raw.diagnosis, raw.series);
        let case = Self { diagnoses, series, expectations: raw.expect };
        case.check().map_err(|reason| CaseError::invalid(path, reason))?;
        Ok((head, case))
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
            expectation.check_diagnosis()?;
            if all().any(|d| d.name == expectation.of()) {
                return Ok(());
            }
            Err(expectation.wrong("no diagnosis has this name"))
        })
    }

    /// Makes the diagnoses.
    ///
    /// # Errors
    /// A file with mistakes; recordings that cannot be diagnosed.
    pub fn diagnosed(&self, head: &CaseHead) -> Result<Vec<JudgedDiagnosis>, CaseError> {
        let one = |asked: &DiagnosisSpecification| {
            let path = head.folder.join(&asked.file);
            let case = load_diagnosis(&path, &LoadOptions::default())
                .map_err(|problems| CaseError::invalid(&path, rendered(&problems)))?;
            let failed =
                |error: sphcut_diagnose::DiagnoseError| CaseError::failed(&asked.name, error);
            let cut = closed_form_cut(&case.base).map_err(failed)?;
            let model = ClosedForm::new(cut, &case.scatter());
            let (_, found) = diagnose_case(&case, &model).map_err(failed)?;
            Ok(JudgedDiagnosis { name: asked.name.clone(), found, model })
        };
        self.diagnoses.iter().map(one).collect()
    }

    /// Says what grows in the series.
    ///
    /// # Errors
    /// A table with mistakes or with too little.
    pub fn grown(&self, head: &CaseHead) -> Result<Vec<(String, WearGrowth)>, CaseError> {
        let one = |asked: &DiagnosisSpecification| {
            let path = head.folder.join(&asked.file);
            let rows = read_series_table(&text_of(&path)?)
                .map_err(|problem| CaseError::invalid(&path, problem.to_string()))?;
            let segment = |row: sphcut_input::SeriesRow| WearSegment {
                tool: row.tool,
                time: row.time,
                forces: row.forces,
                land: row.land,
            };
            let segments: Vec<WearSegment> = rows.into_iter().map(segment).collect();
            let found =
                grows(&segments, 1).map_err(|error| CaseError::failed(&asked.name, error))?;
            Ok((asked.name.clone(), found))
        };
        self.series.iter().map(one).collect()
    }

    /// Makes the diagnoses and judges them.
    pub(crate) fn judge(&self, head: &CaseHead) -> Result<Vec<Judgement>, CaseError> {
        let (all, grown) = (self.diagnosed(head)?, self.grown(head)?);
        self.expectations.iter().map(|one| one.judge_diagnosis(&all, &grown)).collect()
    }

    /// What is diagnosed and by which command, as Markdown.
    #[must_use]
    pub fn questions(&self, head: &CaseHead) -> String {
        let line = |asked: &DiagnosisSpecification, command: &str, option: &str| {
            format!(
                "- {}: {}; `sphcut {command} validation/{}/{} --out DIR{option}`\n",
                asked.name,
                asked.title,
                head.name,
                asked.file.display()
            )
        };
        let diagnoses =
            self.diagnoses.iter().map(|asked| line(asked, "diagnose", " --closed-form"));
        let series = self.series.iter().map(|asked| line(asked, "wear", ""));
        let lines: String = diagnoses.chain(series).collect();
        format!("\nDiagnoses and commands:\n\n{lines}")
    }
}

impl JudgedDiagnosis {
    /// The place of an effect among those of the model.
    fn effect(&self, key: &str) -> Option<usize> {
        self.model.effects().iter().position(|effect| effect.key == key)
    }
}

#[cfg(test)]
mod tests;
