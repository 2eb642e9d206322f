//! Which physics a simulation left out, told from recordings over many cutting conditions.
//!
//! The logarithm of a measured quantity y of channel c at condition x_i is
//!
//! ```text
//! log y_ic = log M_c(x_i; theta, phi_k) + gain_c + offset_c / y_ic + drift_c o_i + bias_c(x_i) + noise
//! ```
//!
//! with the simulation M, its nuisances theta (scatter of material and friction from batch to batch), the parameters
//! phi_k of a hypothesis k about what is missing, and the run order o from -1/2 to 1/2. Nuisances are never a
//! discovery: they are fitted anew under every hypothesis, with their priors. In order:
//!
//! 1. [`Recordings`] become a [`RegressionProblem`]: logarithms, noise from repeats or stated deviations, instrument columns.
//! 2. [`fit`] finds the most probable nuisances when nothing is missing.
//! 3. [`Templates`] hold what each effect would change there, and all that is linear is integrated out.
//! 4. [`locate`] says where the residual is more than chance.
//! 5. [`attribute`] weighs the hypotheses, and [`judge`] says what may be claimed.
//! 6. [`does_it_help`] leaves out blocks of conditions, a [`Simulator`] conceals known answers, and [`next_experiment`]
//!    says which cuts would tell more.
//!
//! [`diagnose`] does all of it, [`diagnose_case`] for a file.
//!
//! The simulation enters through [`Predictor`] alone.
//!
//! All numbers are SI. Everything follows from the data, the priors and the seed; the number of threads changes
//! nothing. Method: Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425-464, for nuisances beside a discrepancy;
//! MacKay, Neural Computation 4 (1992) 415-447, for the evidence; `docs/diagnosis_scores.md` for what was measured with it.

mod case;
mod check;
mod data;
mod error;
pub mod file;
mod files;
mod inference;
mod model;
mod patch;
mod plan;
mod progress;
pub mod series;
mod session;
#[cfg(test)]
mod tests;
mod wear;

pub use case::{diagnose_case, diagnose_case_as};
pub use check::forecast::{Forecast, forecast};
pub use check::held_out::{Competitor, HeldOutErrors, HeldValue, Part, does_it_help};
pub use check::rerun::{
    Rerun, RerunChannel, STATES, compare_rerun, rerun_changes, rerun_conditions, unseen_fits,
};
pub use check::self_test::{PositiveControl, Rate, Simulator};
pub use data::mistakes::{wrong_unit_of_speed, wrong_unit_of_thickness};
pub use data::recordings::{ChannelNoise, NoiseSource, Recording, Recordings, same_cut};
pub use error::DiagnoseError;
pub use file::{
    AirRecord, DiagnosisCase, DiagnosisFile, PairedRunsPlan, ReferenceCuts, SeriesPlan,
    load_diagnosis, load_diagnosis_file,
};
pub use files::{
    DIAGNOSIS_SCHEMA_VERSION, DiagnosisProvenance, diagnosis_json, forecasts_csv, held_out_csv,
};
pub use inference::attribute::{Attribution, Hypothesis, Scored, attribute};
pub use inference::commissioning::{
    AmplitudeWeights, Batch, Bias, BiasOrigin, ReferenceComparison,
};
pub use inference::fit::{Fit, fit};
pub use inference::locate::{Contrast, Location, MapPoint, benjamini_hochberg, locate};
pub use inference::monotone::never_falling;
pub use inference::problem::{InstrumentPriors, RegressionProblem, RegressionRow, Site};
pub use inference::setups::SetupScatter;
pub use inference::templates::Templates;
pub use inference::verdict::{ClaimVerdict, Conclusion, Gate, Leading, judge};
pub use model::closed_form::ClosedForm;
pub use model::closed_form_cut::closed_form_cut;
pub use model::paired::{
    Change, EffectStrength, PairedRun, PairedRuns, PairedScenario, changes, effect_strengths,
    run_effects, support,
};
pub use model::predictor::{
    Active, CandidateEffect, EffectParameter, Nuisance, Predictor, Prior, RelationError,
};
pub use patch::{patch, scenario_patch};
pub use plan::next_experiment::{NextExperiment, Rival, next_experiment};
pub use progress::ProgressListener;
pub use session::{Diagnosis, DiagnosisRequest, ParameterEstimate, RankedEffect, diagnose};
pub use wear::files::{growth_csv, growth_json, growth_words};
pub use wear::growth::{Amount, Cause, Direction, LeftOutTool, WearGrowth, WearSegment, grows};
pub use wear::land::{Land, Lands, lands};
