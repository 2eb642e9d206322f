//! Constants of flow stress and friction from measured cuts.
//!
//! ```text
//! measured cuts + priors from published sets -> runs -> emulator about the closed form -> constants with intervals
//!      -> runs at the optimum -> ... -> patch, material, left-out errors beside a regression
//! ```
//!
//! `docs/calibration.md` says what each step does and where it ends.

mod closed_cut;
mod constants;
mod cuts;
mod emulator;
mod evaluator;
mod files;
mod left_out;
mod material_tests;
mod next;
mod posterior;
mod session;
#[cfg(test)]
mod tests;
mod words;

use sphcut_physics::{Channel, CuttingCondition};

pub use closed_cut::ClosedCut;
pub use constants::{
    CONSTANTS, ConstantError, ConstantRule, FreeConstant, PublishedSet, effect_constants,
    free_constants, published_sets,
};
pub use cuts::{MeasuredCut, cut_name, measured_cuts, mistakes};
pub use emulator::PriorModel;
pub use evaluator::{CutEvaluator, QuickEvaluator};
pub use files::{CalibrationSource, cut_calibration_json, material_file, next_csv, next_json};
pub use left_out::Foreseen;
pub use material_tests::MaterialTests;
pub use next::{NextCut, NextCuts, NextRequest, grid, next_cuts};
pub use posterior::{DISCREPANCIES, Discrepancy, MeasuredValue, Posterior};
pub use session::{
    CalibrationRequest, ComparedValue, ContradictingTool, CutCalibration, LeftOutErrors, calibrate,
    expected,
};
pub use words::{ConstantStanding, cut_calibration_words, expected_words, next_words, standings};

/// Half width of a 95 % interval in standard deviations.
pub(crate) const NORMAL_95: f64 = 1.96;

/// A value for every channel of [`Channel::RECORDED`].
pub type Channels<T> = [T; Channel::RECORDED.len()];

/// What a run gave: logarithms of means in SI units and the variances of these.
pub type CutValues = Channels<Option<(f64, f64)>>;

/// A cut to be computed.
#[derive(Debug, Clone, PartialEq)]
pub struct RunPoint {
    /// Where.
    pub condition: CuttingCondition,
    /// With which constants, in standard deviations of their priors.
    pub t: Vec<f64>,
}
