//! What a springback is worth, and why there may be none.

use crate::steady::MeanInterval;
use sphcut_record::RunError;

/// Error of the recovered height of a surface in terms of the spacing: twice the largest error against
/// known answers at three and four spacings (`validation/springback_resolution`,
/// `validation/springback_cylinder` and `validation/springback_indentation`, table in
/// `docs/springback.md`), rounded up, because they are few.
pub const RESOLUTION_SHARE: f64 = 0.01;

/// Error of the overlap in terms of itself: twice what the springback of one cut moves by between contacts of three
/// stiffnesses, in terms of what their overlaps move by (`validation/springback_cut`, table in `docs/springback.md`). Neglected
/// is that a slope g' of the overlap along an edge of radius R lowers what it adds by `R g'^2 / 2`.
pub const OVERLAP_SHARE: f64 = 0.2;

/// The overlap of the surface with the tool at the tool's lowest point, by which a contact with a penalty shifts
/// the surface and a hard one does not. In m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Mean of the touched particles.
    pub mean: f64,
    /// Twice its standard error: overlaps of neighbours are not correlated; infinite with fewer than two particles.
    pub half_width: f64,
}

impl Overlap {
    pub(super) fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count.max(1.0);
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let half_width = match values.len() {
            0 | 1 => f64::INFINITY,
            _ => 2.0 * (squares / (count - 1.0) / count).sqrt(),
        };
        Self { mean, half_width }
    }
}

/// What the mean springback is worth, in m. The parts are added: the last two are no random errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBar {
    /// Half width of the 95 % interval of the mean; infinite with fewer than twenty particles.
    pub statistical: f64,
    /// [`OVERLAP_SHARE`] times the overlap.
    pub overlap: f64,
    /// [`RESOLUTION_SHARE`] times the spacing.
    pub resolution: f64,
}

impl ErrorBar {
    pub(super) fn new(mean: Option<MeanInterval>, overlap: Overlap, spacing: f64) -> Self {
        Self {
            statistical: mean.map_or(f64::INFINITY, |mean| mean.half_width),
            overlap: OVERLAP_SHARE * overlap.mean.abs(),
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
