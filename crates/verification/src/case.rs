//! A case: a folder under `validation/` with a claim, what it is tested with, and what is expected.

use crate::diagnoses::Diagnoses;
use crate::error::CaseError;
use crate::grey_box::GreyBoxFits;
use crate::head::CaseHead;
use crate::options::{CaseOptions, ProgressWatch};
use crate::scenarios::{ScenarioRuns, variants};
use crate::store::CaseStore;
use crate::sweep_trends::SweepTrends;
use crate::verdict::{CaseOutcome, CaseVerdict, Judgement};
use sphcut_sph::RESULTS_VERSION;
use std::fs;
use std::path::Path;

/// A case folder, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name, claim, kind of evidence.
    pub head: CaseHead,
    /// What is judged.
    pub body: CaseBody,
}

/// What is judged, and what is expected of it.
#[derive(Debug, Clone, PartialEq)]
pub enum CaseBody {
    /// Scenarios are run.
    Scenarios(ScenarioRuns),
    /// Corrections are fitted.
    GreyBox(GreyBoxFits),
    /// The table of a sweep is judged.
    Sweep(SweepTrends),
    /// Recordings are diagnosed.
    Diagnoses(Diagnoses),
}

/// Reads the file of a case of one kind.
type ReadFile = fn(&Path) -> Result<Case, CaseError>;

/// The files that make a folder a case.
const FILES: [(&str, ReadFile); 4] = [
    ("case.toml", |path| {
        let (head, body) = ScenarioRuns::read(path)?;
        Ok(Case { head, body: CaseBody::Scenarios(body) })
    }),
    ("grey_box.toml", |path| {
        let (head, body) = GreyBoxFits::read(path)?;
        Ok(Case { head, body: CaseBody::GreyBox(body) })
    }),
    ("trends.toml", |path| {
        let (head, body) = SweepTrends::read(path)?;
        Ok(Case { head, body: CaseBody::Sweep(body) })
    }),
    ("diagnoses.toml", |path| {
        let (head, body) = Diagnoses::read(path)?;
        Ok(Case { head, body: CaseBody::Diagnoses(body) })
    }),
];

/// All cases below `root`, by name.
///
/// # Errors
/// A folder that cannot be read, the first case that is not well formed.
pub fn cases(root: &Path) -> Result<Vec<Case>, CaseError> {
    let unreadable = |error| CaseError::unreadable(root, &error);
    let mut folders = Vec::new();
    for entry in fs::read_dir(root).map_err(unreadable)? {
        folders.push(entry.map_err(unreadable)?.path());
    }
    folders.sort();
    folders.iter().filter_map(|folder| read_folder(folder)).collect()
}

/// The case in `folder`; `None` if there is none.
fn read_folder(folder: &Path) -> Option<Result<Case, CaseError>> {
    let there = |(file, read): &(&str, ReadFile)| {
        let path = folder.join(file);
        path.is_file().then(|| read(&path))
    };
    FILES.iter().find_map(there)
}

impl Case {
    /// Reads and checks one case folder.
    ///
    /// # Errors
    /// A folder without a case; a missing or malformed file; names that are not unique or not there; an expectation
    /// without limit or reason; validation without reference and provenance.
    pub fn read(folder: &Path) -> Result<Self, CaseError> {
        let missing = || Err(CaseError::invalid(folder, "the folder holds no case"));
        read_folder(folder).unwrap_or_else(missing)
    }

    /// Runs the case and judges it. What goes wrong becomes [`CaseOutcome::Broken`].
    pub fn run(&self, options: &CaseOptions, progress: &ProgressWatch<'_>) -> CaseVerdict {
        let judged = match &self.body {
            CaseBody::Scenarios(runs) => runs.run(&self.head, options, progress),
            CaseBody::GreyBox(fits) => fits.run(&self.head, options.store.as_ref(), progress),
            CaseBody::Sweep(trends) => trends.judge(),
            CaseBody::Diagnoses(diagnoses) => diagnoses.judge(&self.head),
        };
        self.verdict(judged)
    }

    /// Judges the case on the values kept in `store`, without running anything that takes long; `None` if values are
    /// missing there or belong to another scenario or table. Values of an earlier [`RESULTS_VERSION`] count, and are
    /// named in [`CaseVerdict::earlier`].
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn judge_stored(&self, store: &CaseStore) -> Result<Option<CaseVerdict>, CaseError> {
        let judged = match &self.body {
            CaseBody::Scenarios(runs) => {
                let Some((judged, earlier)) = runs.judge_stored(&self.head, store)? else {
                    return Ok(None);
                };
                return Ok(Some(CaseVerdict { earlier, ..self.verdict(judged) }));
            }
            CaseBody::GreyBox(fits) => fits.judge_stored(&fits.stored(&self.head, store)?),
            CaseBody::Sweep(trends) => Some(trends.judge()),
            CaseBody::Diagnoses(diagnoses) => Some(diagnoses.judge(&self.head)),
        };
        Ok(judged.map(|judged| self.verdict(judged)))
    }

    /// What the ledger shows below the judged values, as Markdown.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn shown_beside(
        &self,
        verdict: Option<&CaseVerdict>,
        store: &CaseStore,
    ) -> Result<String, CaseError> {
        Ok(match &self.body {
            CaseBody::Scenarios(runs) => {
                let judged = verdict.map_or(&[][..], |verdict| &verdict.judgements);
                variants::table(runs, judged)
            }
            CaseBody::GreyBox(fits) => fits.tables(&self.head, &fits.stored(&self.head, store)?),
            CaseBody::Sweep(trends) => trends.origin(),
            CaseBody::Diagnoses(diagnoses) => diagnoses.questions(&self.head),
        })
    }

    /// Reads the scenarios of all runs without running them; other kinds have read what they need.
    ///
    /// # Errors
    /// The first scenario that cannot be read, with all its mistakes.
    pub fn check(&self, options: &CaseOptions) -> Result<(), CaseError> {
        match &self.body {
            CaseBody::Scenarios(runs) => runs.check(&self.head, options),
            _ => Ok(()),
        }
    }

    fn verdict(&self, judged: Result<Vec<Judgement>, CaseError>) -> CaseVerdict {
        let (judgements, outcome) = match judged {
            Ok(judgements) => {
                let outcome = CaseOutcome::of(&judgements);
                (judgements, outcome)
            }
            Err(error) => (Vec::new(), CaseOutcome::Broken { reason: error.to_string() }),
        };
        let earlier = match &self.body {
            CaseBody::Sweep(trends) if trends.results_version != RESULTS_VERSION => {
                vec!["the table".to_owned()]
            }
            _ => Vec::new(),
        };
        CaseVerdict { case: self.head.clone(), judgements, earlier, outcome }
    }
}
