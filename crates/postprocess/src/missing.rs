//! Why a measure is not given.

/// The reason why a measure has no value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Missing {
    /// No uncut chip thickness or no moving tool.
    #[error("the run is no cut")]
    NoCut,
    /// In space.
    #[error("the uncut chip of this section is thinner than two spacings")]
    ThinSection,
    /// No snapshot in the window.
    #[error("the run has no snapshots")]
    NoSnapshots,
    /// No snapshot of the window holds a chip that is long enough.
    #[error(
        "the chip is too short: in no snapshot of the window is it 0.55 times as long as thick (a larger `behind` \
         in [window] leaves more of it)"
    )]
    ChipTooShort,
    /// The tool has no side as high as the uncut chip thickness that faces the cut.
    #[error("the tool has no rake face as high as the uncut chip")]
    NoRakeFace,
    /// No snapshot of the window shows a particle touching the rake side.
    #[error("nothing touches the rake side in the window")]
    NoContact,
    /// The record does not tell sticking from sliding.
    #[error("the record is older than the channel that tells sticking from sliding")]
    StickingNotRecorded,
    /// Nothing ahead of the tool shears.
    #[error("nothing ahead of the tool shears faster than 5 % of v_c / h")]
    NoShearZone,
    /// The shear zone has no side towards the chip: it runs into the flow around the edge.
    #[error("the shear zone does not end before the tool: it is one with the flow around the edge")]
    OpenShearZone,
    /// The places of fastest shear lie on no line that rises from the edge.
    #[error("the places of fastest shear lie on no line that rises from the cutting edge")]
    NoShearLine,
    /// Fewer particles of the uncut surface are found on the chip than needed.
    #[error(
        "{found} particles of the uncut surface are on the chip that was cut in the window; {needed} are needed"
    )]
    TooFewSurfaceParticles {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The free side of the chip has no teeth.
    #[error("the chip is continuous: its free side has no teeth higher than {:.3} mm", .least_height * 1e3)]
    Continuous {
        /// Least height of a tooth in m.
        least_height: f64,
    },
    /// Fewer teeth than needed.
    #[error("the chip has {found} teeth; a pitch needs {needed}")]
    TooFewTeeth {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Teeth without a pitch.
    #[error("the teeth follow no pitch: their distances scatter by {:.0} %", 100.0 * .scatter)]
    Irregular {
        /// Standard deviation of the distances between teeth over their mean.
        scatter: f64,
    },
    /// The machined surface does not give it; the words say why.
    #[error("{0}")]
    Surface(String),
}
