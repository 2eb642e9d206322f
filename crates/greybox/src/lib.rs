//! Grey box: a white-box simulation corrected by what measurements say about its error.
//!
//! For a force y at the cutting conditions x = (v_c, h), with the simulation f_T and a regressor f_D,
//!
//! ```text
//! y(x) = f_T(x) + f_D(x)                                                      (7)
//! min over Theta of  1/n sum_i (y_i - (f_T(x_i) + f_D(x_i, Theta)))^2         (8), (9)
//! ```
//!
//! The architecture is serial in this sense: the simulation comes first and is left as it is, the regressor
//! comes after it and is taught the residual y - f_T. It sees the cutting conditions alone; f_T enters through
//! its target and through the sum. A force therefore needs a simulation at its condition.
//!
//! All numbers are SI. Everything follows from the tables, the seed and the version; the number of threads
//! changes nothing.
//!
//! Equations (7) to (16): Wolf et al., "A grey-box approach based on Johnson-Cook constitutive model to improve
//! predictions of mechanical loads of cutting simulations for normalized AISI 1045".

mod compare;
mod error;
mod files;
mod fit;
mod folds;
mod hull;
mod importance;
mod metrics;
mod model_file;
mod noise;
mod pairing;
mod random;
pub mod regressor;
mod samples;
mod setting;
pub mod validation;

pub use compare::{ForceComparison, TableComparison, compare};
pub use error::GreyBoxError;
pub use files::{comparison_json, fit_json, points_csv, predictions_csv};
pub use fit::{
    BlackBox, Choice, Extrapolated, FitOptions, ForceFit, ForceTable, GreyBoxFit, LearningPoint,
    MethodFit, Outlier, Report, TableOrigin, Validated, fit,
};
pub use folds::grouped_folds;
pub use hull::Hull;
pub use importance::{Permutation, Sobol};
pub use metrics::{BootstrapEstimate, Outcomes, Scores, bias, difference, scores};
pub use model_file::{Correction, GreyBox, Prediction, Taught};
pub use noise::{FloorSource, NoiseFloor, noise_floor};
pub use pairing::{ForceKind, ForceRow, PairedCondition, PairedRow, Pairs, pair};
pub use random::Random;
pub use samples::{Input, TrainingRows};
pub use setting::{CutSetting, TableKind};
