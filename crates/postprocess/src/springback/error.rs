//! What a springback is worth, and why there may be none.

use crate::steady::MeanInterval;
use sphcut_record::{Run, RunError};

/// Error of the recovered height of a surface in terms of the spacing: twice the largest error against
/// known answers at three and four spacings (`validation/springback_resolution`,
/// `validation/springback_cylinder` and `validation/springback_indentation`, table in
/// `docs/springback.md`), rounded up, because they are few.
pub const RESOLUTION_SHARE: f64 = 0.01;

/// What the mean springback is worth, in m. The parts are added: the last two are no random errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBar {
    /// Half width of the 95 % interval of the mean; infinite with fewer than twenty particles.
    pub statistical: f64,
    /// Half of the mean overlap of the touched particles with the tool, `g / 2 = f / (2 kappa M)`, f the contact
    /// force per width (2D) normal to the machined plane, M the p-wave modulus. While it was pressed the material lay less deep than a
    /// hard contact would have it, by nothing to g where it left the tool: the mean is less by g / 2, and known to that.
    pub overlap: f64,
    /// [`RESOLUTION_SHARE`] times the spacing.
    pub resolution: f64,
}

impl ErrorBar {
    pub(super) fn new(
        run: &Run,
        contact_force: f64,
        mean: Option<MeanInterval>,
        spacing: f64,
    ) -> Self {
        let stiffness = run.provenance.number("contact", "stiffness");
        let stiffness = stiffness.filter(|stiffness| *stiffness > 0.0).unwrap_or(1.0);
        let modulus = run
            .facts
            .materials
            .first()
            .map_or(0.0, |m| m.bulk_modulus + 4.0 / 3.0 * m.shear_modulus);
        let overlap = if modulus > 0.0 { 0.5 * contact_force / (stiffness * modulus) } else { 0.0 };
        Self {
            statistical: mean.map_or(f64::INFINITY, |mean| mean.half_width),
            overlap,
            resolution: RESOLUTION_SHARE * spacing,
        }
    }

    /// All parts together.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.statistical + self.overlap + self.resolution
    }
}

/// Why a run has no springback.
#[derive(Debug, thiserror::Error)]
pub enum SpringbackError {
    /// A run without a tool and an uncut chip thickness.
    #[error("the run is no cut: it has no tool that cuts")]
    NoCut,
    /// A run without snapshots.
    #[error("the run has no snapshots")]
    NoSnapshots,
    /// A cut that leaves too little machined surface clear of the tool. Lengths in m.
    #[error(
        "the cut is too short: {:.3} mm of travel leave too little machined surface clear of the tool; {:.3} mm are needed",
        .travel * 1e3, .needed * 1e3
    )]
    TooShort {
        /// Travel of the tool.
        travel: f64,
        /// Travel from which on there is enough.
        needed: f64,
    },
    /// A moving window that gives up the surface before it is clear of the tool. Lengths in m.
    #[error(
        "the moving window keeps {:.3} mm behind the tool; {:.3} mm are needed: `behind` in [window]",
        .kept * 1e3, .needed * 1e3
    )]
    WindowTooShort {
        /// Workpiece behind the tool at the end.
        kept: f64,
        /// What is needed.
        needed: f64,
    },
    /// The record cannot be read.
    #[error("{0}")]
    Record(#[from] RunError),
}
