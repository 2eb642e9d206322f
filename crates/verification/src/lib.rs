//! Runs the cases under `validation/` and judges them.
//!
//! A case is a folder: `case.toml` states a claim and what is expected of named
//! observables, scenario files say what is run, `reference.csv` with
//! `PROVENANCE.toml` holds figures of others. [`cases`] finds the folders,
//! [`Case::run`] runs one and returns a plain [`CaseVerdict`]; nothing here prints.
//! Other files than `case.toml` make other kinds of cases: [`CaseBody`].
//!
//! To add a case: one folder. To add an observable: one file in `observable/`
//! and its line in [`observable::ALL`].

pub mod blind;
mod case;
pub mod diagnoses;
mod error;
mod evidence;
mod expectation;
pub mod grey_box;
mod head;
pub mod ledger;
mod metric;
pub mod observable;
mod options;
pub mod scenarios;
mod store;
pub mod sweep_trends;
mod table;
mod verdict;

pub use case::{Case, CaseBody, cases};
pub use error::CaseError;
pub use evidence::{Evidence, RunMode};
pub use expectation::{Expected, Measure};
pub use head::{CaseHead, CaseKind, Tier};
pub use metric::{Metric, ReferenceValue};
pub use options::{CaseOptions, CaseProgress, ProgressWatch};
pub use store::{CaseStore, StoredRun};
pub use table::ReferenceTable;
pub use verdict::{CaseOutcome, CaseVerdict, Judgement};
