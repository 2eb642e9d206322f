//! What every case says of itself, whatever its kind.

use crate::error::CaseError;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use sphcut_input::{Colours, Problem};
use std::fs;
use std::path::{Path, PathBuf};

/// What kind of evidence a case is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaseKind {
    /// Against an exact or published solution of the same equations.
    Verification,
    /// Against measurements, with provenance and uncertainty.
    Validation,
    /// Against our own frozen output.
    Regression,
}

impl CaseKind {
    /// Name as in the file of the case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Verification => "verification",
            Self::Validation => "validation",
            Self::Regression => "regression",
        }
    }
}

/// How long a case takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// Seconds; part of `cargo test`.
    Quick,
    /// Minutes.
    Standard,
    /// Up to hours.
    Long,
}

impl Tier {
    /// All of them, the shortest first.
    pub const ALL: [Self; 3] = [Self::Quick, Self::Standard, Self::Long];

    /// Name as in the file of the case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Standard => "standard",
            Self::Long => "long",
        }
    }
}

/// Name, place and claim of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseHead {
    /// Name of the folder.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Title.
    pub title: String,
    /// Kind of evidence.
    pub kind: CaseKind,
    /// How long it takes.
    pub tier: Tier,
    /// What it claims.
    pub claim: String,
}

impl CaseHead {
    /// The head that the file at `path` states.
    pub(crate) fn new(
        path: &Path,
        title: String,
        kind: CaseKind,
        tier: Tier,
        claim: String,
    ) -> Self {
        let folder = folder_of(path);
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_default();
        Self { name, folder: folder.to_owned(), title, kind, tier, claim }
    }
}

/// The folder of the file at `path`.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// The text of the file at `path`.
pub(crate) fn text_of(path: &Path) -> Result<String, CaseError> {
    fs::read_to_string(path).map_err(|error| CaseError::unreadable(path, &error))
}

/// What the TOML file at `path` says.
pub(crate) fn toml_of<T: DeserializeOwned>(path: &Path) -> Result<T, CaseError> {
    toml::from_str(&text_of(path)?).map_err(|error| CaseError::invalid(path, error.to_string()))
}

/// `problems` as a page without colours.
pub(crate) fn rendered(problems: &[Problem]) -> String {
    problems.iter().map(|problem| problem.render(Colours::Plain)).collect()
}
