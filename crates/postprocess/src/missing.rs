//! Why a measure is not given.

use std::fmt;

/// The reason why a measure has no value.
#[derive(Debug, Clone, PartialEq)]
pub enum Missing {
    /// No uncut chip thickness or no moving tool.
    NoCut,
    /// Measured in plane runs only.
    NotPlane,
    /// Measured where one pass meets an uncut surface.
    SeveralPasses,
    /// No snapshot in the window.
    NoSnapshots,
    /// No snapshot of the window holds a chip that is long enough.
    ChipTooShort,
    /// The tool has no side as high as the uncut chip thickness that faces the cut.
    NoRakeFace,
    /// No snapshot of the window shows a particle touching the rake side.
    NoContact,
    /// The record does not tell sticking from sliding.
    StickingNotRecorded,
    /// Nothing ahead of the tool shears.
    NoShearZone,
    /// The shear zone has no side towards the chip: it runs into the flow around the edge.
    OpenShearZone,
    /// The places of fastest shear lie on no line that rises from the edge.
    NoShearLine,
    /// Fewer particles of the uncut surface are found on the chip than needed.
    TooFewSurfaceParticles {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The free side of the chip has no teeth.
    Continuous {
        /// Least height of a tooth in m.
        least_height: f64,
    },
    /// Fewer teeth than needed.
    TooFewTeeth {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Teeth without a pitch.
    Irregular {
        /// Standard deviation of the distances between teeth over their mean.
        scatter: f64,
    },
    /// The machined surface does not give it; the words say why.
    Surface(String),
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCut => write!(f, "the run is no cut"),
            Self::NotPlane => write!(f, "measured in plane runs only"),
            Self::SeveralPasses => write!(f, "measured in runs of a single pass only"),
            Self::NoSnapshots => write!(f, "the run has no snapshots"),
            Self::ChipTooShort => {
                write!(
                    f,
                    "the chip is too short: in no snapshot of the window is it 0.55 times as long as thick (a larger `behind` \
                     in [window] leaves more of it)"
                )
            }
            Self::NoRakeFace => write!(f, "the tool has no rake face as high as the uncut chip"),
            Self::NoContact => write!(f, "nothing touches the rake side in the window"),
            Self::StickingNotRecorded => {
                write!(f, "the record is older than the channel that tells sticking from sliding")
            }
            Self::NoShearZone => {
                write!(f, "nothing ahead of the tool shears faster than 5 % of v_c / h")
            }
            Self::OpenShearZone => write!(
                f,
                "the shear zone does not end before the tool: it is one with the flow around the edge"
            ),
            Self::NoShearLine => write!(
                f,
                "the places of fastest shear lie on no line that rises from the cutting edge"
            ),
            Self::TooFewSurfaceParticles { found, needed } => write!(
                f,
                "{found} particles of the uncut surface are on the chip that was cut in the window; \
                 {needed} are needed"
            ),
            Self::Continuous { least_height } => write!(
                f,
                "the chip is continuous: its free side has no teeth higher than {:.3} mm",
                least_height * 1e3
            ),
            Self::TooFewTeeth { found, needed } => {
                write!(f, "the chip has {found} teeth; a pitch needs {needed}")
            }
            Self::Irregular { scatter } => write!(
                f,
                "the teeth follow no pitch: their distances scatter by {:.0} %",
                100.0 * scatter
            ),
            Self::Surface(reason) => write!(f, "{reason}"),
        }
    }
}
