//! Cases of sweeps: the condensed table of many runs instead of scenarios.
//!
//! The folder holds `trends.toml` (how the sweep is run, and expectations about slopes, exponents and errors), the
//! condensed table of the sweep (`simulated.csv`) and, where there is one, a table of measured forces. The runs take hours and
//! are not repeated here: the table is judged, and the command that makes it is told.

mod judge;

pub use judge::SweepMeasure;

use crate::error::CaseError;
use crate::expectation::Expected;
use crate::head::{CaseHead, CaseKind, Tier, toml_of};
use crate::table::ReferenceTable;
use crate::verdict::Judgement;
use serde::Deserialize;
use sphcut_sweep::ForcePoint;
use std::path::{Path, PathBuf};

/// The condensed table of the sweep.
const SIMULATED: &str = "simulated.csv";

/// The forces of a sweep and what is expected of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTrends {
    /// The command that makes the table.
    pub command: String,
    /// What it took, on which machine.
    pub took: String,
    /// Version of the solver's results in the table.
    pub results_version: u32,
    /// Its expectations.
    pub expectations: Vec<Expected<SweepMeasure>>,
    simulated: [Vec<ForcePoint>; 2],
    measured: [Vec<ForcePoint>; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCase {
    title: String,
    kind: CaseKind,
    claim: String,
    command: String,
    took: String,
    results_version: u32,
    measured: Option<PathBuf>,
    expect: Vec<Expected<SweepMeasure>>,
}

impl SweepTrends {
    /// Reads and checks `trends.toml`. Judging takes no time: the runs are not repeated.
    pub(crate) fn read(path: &Path) -> Result<(CaseHead, Self), CaseError> {
        let raw: RawCase = toml_of(path)?;
        let head = CaseHead::new(path, raw.title, raw.kind, Tier::Quick, raw.claim);
        let measured = match &raw.measured {
            Some(file) => forces(&head.folder.join(file))?,
            None => Default::default(),
        };
        let case = Self {
            command: raw.command,
            took: raw.took,
            results_version: raw.results_version,
            expectations: raw.expect,
            simulated: forces(&head.folder.join(SIMULATED))?,
            measured,
        };
        case.expectations
            .iter()
            .try_for_each(|expectation| expectation.check_trend(raw.measured.is_some()))
            .map_err(|reason| CaseError::invalid(path, reason))?;
        Ok((head, case))
    }

    /// Judges the table.
    pub(crate) fn judge(&self) -> Result<Vec<Judgement>, CaseError> {
        let judge = |one: &Expected<SweepMeasure>| one.judge_trend(&self.simulated, &self.measured);
        self.expectations.iter().map(judge).collect()
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
    let table = ReferenceTable::read(path)?;
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
