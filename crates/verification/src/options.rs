//! How cases are run, and how it is told how far they are.

use crate::store::CaseStore;
use sphcut_scenario::LoadOptions;

/// How cases are run.
#[derive(Debug, Clone, Default)]
pub struct CaseOptions {
    /// Where values of finished runs are kept, so that a long case can go on after an
    /// interruption; nothing is kept without it.
    pub store: Option<CaseStore>,
    /// Whether a scenario may read outside its own folder.
    pub load: LoadOptions,
}

/// Where a case is.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseProgress<'case> {
    /// Name of the case.
    pub case: &'case str,
    /// Name of the run.
    pub run: &'case str,
    /// Share of the run that is done.
    pub fraction: f64,
}

/// Is told how far a case is, from any thread.
pub type ProgressWatch<'a> = dyn Fn(&CaseProgress<'_>) + Sync + 'a;
