//! Runs the cases under `validation/` and judges them.
//!
//! A case is a folder: `case.toml` states a claim and what is expected of named
//! observables, scenario files say what is run, `reference.csv` with
//! `PROVENANCE.toml` holds figures of others. [`cases`] finds the folders,
//! [`run_case`] runs one and returns a plain [`Verdict`]; nothing here prints.
//!
//! To add a case: one folder. To add an observable: one file in `observable/`
//! and its line in [`observable::ALL`].

mod any_case;
mod case;
pub mod diagnoses;
mod error;
mod evidence;
pub mod grey_box;
mod judge;
pub mod ledger;
pub mod observable;
mod overrides;
mod replicates;
mod runner;
pub mod store;
pub mod sweep_trends;
mod table;
mod variants;
mod verdict;

pub use any_case::{AnyCase, all_cases};
pub use case::{Case, Expectation, Kind, Metric, Mode, Reference, RunSpecification, Tier, cases};
pub use error::CaseError;
pub use evidence::Evidence;
pub use runner::{Progress, RunOptions, adopt, check_scenarios, judge_stored, run_case};
pub use table::Table;
pub use verdict::{Finding, Outcome, Verdict};
