//! Cases of sweeps: the condensed table of many runs instead of scenarios.
//!
//! The folder holds `trends.toml` (how the sweep is run, and expectations about slopes, exponents and errors), the
//! condensed table of the sweep (`simulated.csv`) and, where there is one, a table of measured forces. The runs take hours and
//! are not repeated here: the table is judged, and the command that makes it is told.

mod judge;

pub use judge::{SweepExpectation, SweepMeasure};

use crate::case::{Kind, Tier};
use crate::error::CaseError;
use crate::table::Table;
use crate::verdict::{Outcome, Verdict};
use serde::Deserialize;
use sphcut_sweep::ForcePoint;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a case.
const FILE: &str = "trends.toml";
/// The condensed table of the sweep.
const SIMULATED: &str = "simulated.csv";

/// A case of a sweep, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepCase {
    /// Name of the folder.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Title.
    pub title: String,
    /// Kind of evidence.
    pub kind: Kind,
    /// What it claims.
    pub claim: String,
    /// The command that makes the table.
    pub command: String,
    /// What it took, on which machine.
    pub took: String,
    /// Version of the solver's results in the table.
    pub results_version: u32,
    /// Its expectations.
    pub expectations: Vec<SweepExpectation>,
    simulated: [Vec<ForcePoint>; 2],
    measured: [Vec<ForcePoint>; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: Kind,
    claim: String,
    command: String,
    took: String,
    results_version: u32,
    measured: Option<PathBuf>,
    expect: Vec<SweepExpectation>,
}

/// All cases of sweeps below `root`, by name.
///
/// # Errors
/// A folder that cannot be read, the first case that is not well formed.
pub fn sweep_cases(root: &Path) -> Result<Vec<SweepCase>, CaseError> {
    let entries = fs::read_dir(root).map_err(|error| CaseError::unreadable(root, &error))?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| CaseError::unreadable(root, &error))?.path();
        if path.join(FILE).is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    folders.iter().map(|folder| SweepCase::read(folder)).collect()
}

impl SweepCase {
    /// How long judging it takes: the runs are not repeated.
    pub const TIER: Tier = Tier::Quick;

    /// Reads and checks one folder.
    ///
    /// # Errors
    /// A missing or malformed file; a table without forces; an expectation without a limit or about measured forces where there are none.
    pub fn read(folder: &Path) -> Result<Self, CaseError> {
        let path = folder.join(FILE);
        let text =
            fs::read_to_string(&path).map_err(|error| CaseError::unreadable(&path, &error))?;
        let raw: RawCase =
            toml::from_str(&text).map_err(|error| CaseError::invalid(&path, error.to_string()))?;
        let simulated = forces(&folder.join(SIMULATED))?;
        let measured = match &raw.measured {
            Some(file) => forces(&folder.join(file))?,
            None => [Vec::new(), Vec::new()],
        };
        let case = Self {
            name: folder
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
                .unwrap_or_default(),
            folder: folder.to_owned(),
            title: raw.title,
            kind: raw.kind,
            claim: raw.claim,
            command: raw.command,
            took: raw.took,
            results_version: raw.results_version,
            expectations: raw.expect,
            simulated,
            measured,
        };
        case.expectations
            .iter()
            .try_for_each(|expectation| expectation.check(raw.measured.is_some()))
            .map_err(|reason| CaseError::invalid(&path, reason))?;
        Ok(case)
    }

    /// Judges the table.
    #[must_use]
    pub fn judge(&self) -> Verdict {
        let findings: Result<Vec<_>, _> = self
            .expectations
            .iter()
            .map(|expectation| expectation.judge(&self.simulated, &self.measured))
            .collect();
        let (findings, outcome) = match findings {
            Ok(findings) => {
                let outcome = Verdict::outcome_of(&findings);
                (findings, outcome)
            }
            Err(error) => (Vec::new(), Outcome::Broken { reason: error.to_string() }),
        };
        Verdict {
            case: self.name.clone(),
            title: self.title.clone(),
            kind: self.kind,
            tier: Self::TIER,
            claim: self.claim.clone(),
            findings,
            earlier: if self.results_version == sphcut_sph::RESULTS_VERSION {
                Vec::new()
            } else {
                vec!["the table".to_owned()]
            },
            outcome,
        }
    }

    /// How the table came about, as Markdown.
    #[must_use]
    pub fn origin(&self) -> String {
        format!(
            "\nThe table has {} runs of results version {}, made by `{}`: {}.\n",
            self.simulated[0].len(),
            self.results_version,
            self.command,
            self.took.trim()
        )
    }
}

/// F_c and F_f in N over v_c in m/s and h in m, of a table with `v_c [m/min],h [mm],F_c [N],F_f [N]` among its columns.
fn forces(path: &Path) -> Result<[Vec<ForcePoint>; 2], CaseError> {
    let table = Table::read(path)?;
    let column =
        |name: &str| table.numbers(name).map_err(|reason| CaseError::invalid(path, reason));
    let (speeds, thicknesses) = (column("v_c [m/min]")?, column("h [mm]")?);
    let of = |name: &str| -> Result<Vec<ForcePoint>, CaseError> {
        let at = speeds.iter().zip(&thicknesses).map(|(v, h)| [v / 60.0, h / 1e3]);
        Ok(at.zip(column(name)?).map(|(at, force)| ForcePoint { at, force }).collect())
    };
    Ok([of("F_c [N]")?, of("F_f [N]")?])
}

#[cfg(test)]
mod tests;
