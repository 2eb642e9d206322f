//! Many runs of one scenario: which ones ([`SweepPlan`]), where their results are kept ([`Store`]), how they are
//! computed: on this machine ([`execute()`]) or as a job array ([`slurm`]).
//!
//! A run is known by its [`Address`]: the same resolved scenario and the same solver have the same address,
//! however the scenario is written.

mod address;
mod coefficients;
mod cost;
mod design;
mod execute;
pub mod file;
mod plan;
mod random;
pub mod slurm;
mod store;
mod table;
mod trends;

pub use address::{Address, address};
pub use coefficients::{
    ForceCoefficients, Kienzle, coefficients_csv, coefficients_json, force_coefficients,
};
pub use cost::{Cost, measure};
pub use execute::{Computed, Execution, News, Retry, State, Trouble, Watch, Worker, execute};
pub use file::{ConstraintCheck, Design, Levels, Sweep, SweepAxis, Unfit, load_sweep, multiple};
pub use plan::{CutSize, LeftOutRun, PlanError, PlannedRun, SweepPlan, plan, plan_only};
pub use store::{
    Claim, Integrity, Leftover, Needs, ResultEntry, RunFailure, Store, StoreContents, StoreError,
    StoredFile, Work,
};
pub use table::{SweepRow, SweepTable, results_of};
pub use trends::{
    ForcePoint, PowerLaw, ThicknessLine, TrendEstimate, line_over_thickness, power_law,
};
