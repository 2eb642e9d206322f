//! Flow-stress laws from material tests.
//!
//! ```text
//! bar pulses, load and displacement -> flow curves -> Johnson-Cook by sequence and jointly
//!      -> intervals, correlations, where the law cannot follow -> tanh and table against it
//! ```
//!
//! `docs/identification.md` says what each step does and where it ends.

mod compare;
mod curve;
pub mod file;
mod fit;
mod law;
mod pulses;
mod sequence;
mod specimen;
mod table;
mod text;

pub use compare::{Bin, LawComparison, RivalLaw, compare, residual_map};
pub use curve::{Curve, CurveError, CurvePoint, points_of};
pub use file::{Identification, StatedMaterial, TestCurve, load_identification};
pub use fit::{Fitted, LawFit, fit};
pub use law::{LawChoice, References};
pub use pulses::{PressureBar, Pulses};
pub use sequence::{Sequence, SequenceError, sequence};
pub use specimen::{Cylinder, LoadPath};
pub use table::tabulate;
pub use text::{identification_json, material_toml, residuals_csv, table_csv};
