//! Mean forces and the part of a run they are taken over.

/// The part of the run (of several passes: of one) over which means are taken: the steady window, or
/// at most the later half where no steady state is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyWindow {
    /// Index of the first sample.
    pub first_sample: usize,
    /// Index after the last sample.
    pub last_sample: usize,
    /// Travel in m at its start.
    pub start: f64,
    /// Travel in m at its end, which is that of the run or the pass.
    pub end: f64,
    /// Time in s at its start.
    pub start_time: f64,
    /// Drift of the cutting force over the steady window, from the slope of its batch means, per
    /// metre of width of cut in N/m.
    pub drift_per_width: f64,
}

/// A force in N, with the half width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// Mean over the window in N.
    pub mean: f64,
    /// Half width of the 95 % interval in N; infinite where too few samples were taken.
    pub ci95: f64,
    /// The mean per metre of width of cut in N/m.
    pub mean_per_width: f64,
    /// The half width per metre of width of cut in N/m.
    pub ci95_per_width: f64,
}

/// Mean forces of the tool on the workpiece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forces {
    /// F_c.
    pub cutting: Force,
    /// F_f.
    pub feed: Force,
    /// F_p; zero in a plane run.
    pub passive: Force,
}
