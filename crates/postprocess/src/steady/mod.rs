//! Is the cut steady, and how well is its mean known?
//!
//! A force record starts with a run-in, fluctuates with a correlation that is not known
//! beforehand, and may drift slowly long after it looks calm: a rule like "stop at the first
//! interval of 2 %" fires far too early. [`detect`] is therefore strict: a state is called
//! steady only if every one of these tests passes, on the whole record and again on the record
//! cut off at 90 %, 80 % and 70 % of its length:
//!
//! 1. **Travel** of at least [`SteadyOptions::minimum_travel`].
//! 2. **Run-in**: the window begins where the marginal standard error of the mean is smallest
//!    (MSER-5: White, Simulation 69 (1997) 323); a minimum in the later half of the record means
//!    that the run-in is not over.
//! 3. **Length**: the window holds at least [`MINIMUM_CORRELATION_LENGTHS`] correlation lengths.
//!    The correlation length is the integrated autocorrelation time tau = 1 + 2 sum rho(k) in
//!    metres of travel, summed up to a self-consistent window and corrected for the bias of a
//!    short record (Wolff, Computer Physics Communications 156 (2004) 143); the larger of that
//!    of the steady window and that of the whole record since the force first reached its mean
//!    counts.
//! 4. **Drift**: the slope of ten batch means of the window is not significant at
//!    [`DRIFT_SIGNIFICANCE`], nor is the difference between the first half and the second,
//!    nor that between the last quarter and the rest. A difference below [`NEGLIGIBLE_DRIFT`]
//!    times the wanted half width does not count, however significant, nor one that is below twice the
//!    wanted half width with 95 % confidence: a regular force has no noise to hide it in, and shall not be cut for longer
//!    than a noisy one. Half of it counts as an error of the mean.
//! 5. **Evidence of absence**: not only is no drift seen, but with 95 % confidence the drift
//!    over the window is below [`DRIFT_ALLOWANCE`] times the wanted half width. A noisy short
//!    record in which a drift could hide fails here.
//! 6. **Precision**: the half width of the 95 % interval of the mean, with half of a drift that is significant, is at most
//!    [`SteadyOptions::relative_half_width`] of the mean.
//!
//! The interval is the wider of two: ten batch means with nine degrees of freedom (Schmeiser,
//! Operations Research 30 (1982) 556), and the integrated autocorrelation time with as many
//! degrees of freedom as that estimate has. Both use Student's t quantiles.
//!
//! No test on a record can exclude a change that is slower than the record; the minimum travel
//! is the guard against that, and [`crate::evaluate`] watches the depth of the machined surface.

mod interval;
mod truncation;

pub use interval::{AutocorrelationTime, MeanInterval, autocorrelation_time, mean_interval};

pub use interval::t_quantile;

pub(crate) use truncation::window_start;

use interval::Batches;

/// Fewest correlation lengths in a steady window.
pub const MINIMUM_CORRELATION_LENGTHS: f64 = 12.0;
/// Error probability of the drift tests: a larger one is stricter.
pub const DRIFT_SIGNIFICANCE: f64 = 0.10;
/// Differences below this share of the wanted half width are no drift.
pub const NEGLIGIBLE_DRIFT: f64 = 0.25;
/// Largest drift over the window that may remain possible, in terms of the wanted half width.
pub const DRIFT_ALLOWANCE: f64 = 4.0;
/// Share of the least travel that a record may fall short of: its first sample ends an interval later than
/// it begins.
const MISSING_TRAVEL: f64 = 5e-3;
/// Least share of a record of forces that a window holds.
const LEAST_WINDOW: f64 = 0.25;
/// Fewest samples in a window.
const MINIMUM_SAMPLES: usize = 40;
/// The shares of the record on which the verdict must be the same.
const REPEATED_ON: [f64; 3] = [0.9, 0.8, 0.7];

/// What counts as steady.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyOptions {
    /// Wanted half width of the 95 % interval of the mean in terms of the mean.
    pub relative_half_width: f64,
    /// Travel in m before which nothing is steady.
    pub minimum_travel: f64,
}

impl SteadyOptions {
    /// What a finished run is judged by when its scenario does not say: 3 % after ten uncut
    /// chip thicknesses.
    #[must_use]
    pub fn for_chip_thickness(uncut_chip_thickness: f64) -> Self {
        Self { relative_half_width: 0.03, minimum_travel: 10.0 * uncut_chip_thickness }
    }
}

/// A force over travel, at equal distances.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Travel of the tool in m, ascending, one value for each force.
    pub travel: &'a [f64],
    /// The force, mean over the interval that ends at that travel.
    pub force: &'a [f64],
}

/// The verdict on a record and the mean over its window.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyState {
    /// Whether every test passed.
    pub reached: bool,
    /// The verdict in words with its numbers.
    pub reason: Reason,
    /// Travel in m at which the window begins; it ends with the record.
    pub window_start: f64,
    /// Travel in m at the end of the record.
    pub window_end: f64,
    /// Index of the first sample of the window.
    pub first_sample: usize,
    /// Mean over the window, in the unit of the force.
    pub mean: f64,
    /// Half width of its 95 % interval, with half of a drift that is significant; infinite where nothing can be said.
    pub ci95: f64,
    /// Correlation length in m.
    pub correlation_length: f64,
    /// Drift over the window, from the slope of the batch means, in the unit of the force.
    pub drift: f64,
}

/// Why a record is or is not steady. Lengths in m, shares of the mean.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Reason {
    /// Every test passed.
    #[error("steady: every test passed")]
    Steady,
    /// Fewer samples than any test needs.
    #[error("only {samples} samples in the window; {MINIMUM_SAMPLES} are needed")]
    TooFewSamples {
        /// Samples in the window.
        samples: usize,
    },
    /// A force that is not a number.
    #[error("sample {sample} is not a finite number")]
    NotFinite {
        /// Index of the sample.
        sample: usize,
    },
    /// Less travel than the minimum.
    #[error("{:.3} mm of travel are below the minimum of {:.3} mm", .travel * 1e3, .minimum * 1e3)]
    TooShort {
        /// Travel so far.
        travel: f64,
        /// The minimum.
        minimum: f64,
    },
    /// The best window begins in the later half of the record.
    #[error("the run-in lasts to {:.2} mm, into the later half of the record", .start * 1e3)]
    RunIn {
        /// Travel at which it would begin.
        start: f64,
    },
    /// The mean is not above its own uncertainty, so no share of it means anything.
    #[error("its mean does not differ from zero")]
    NoForce,
    /// The window holds too few correlation lengths.
    #[error(
        "the window holds {lengths:.1} correlation lengths of {MINIMUM_CORRELATION_LENGTHS} that are needed"
    )]
    Correlated {
        /// Their number.
        lengths: f64,
    },
    /// A drift is significant.
    #[error("it drifts by {:+.1} % ({test})", .share * 100.0)]
    Drift {
        /// The test that found it.
        test: DriftTest,
        /// The difference it found, as a share of the mean.
        share: f64,
    },
    /// No drift is seen, but one that matters cannot be excluded.
    #[error(
        "it may drift by up to {:.1} % over the window ({:.1} % is allowed)",
        .share * 100.0, .allowed * 100.0
    )]
    PossibleDrift {
        /// Largest possible drift as a share of the mean.
        share: f64,
        /// The largest one allowed.
        allowed: f64,
    },
    /// The interval is too wide.
    #[error(
        "its mean is known to \u{b1} {:.1} % (\u{b1} {:.1} % is wanted)",
        .share * 100.0, .wanted * 100.0
    )]
    Imprecise {
        /// Its half width as a share of the mean.
        share: f64,
        /// The wanted one.
        wanted: f64,
    },
    /// All tests pass now but not on an earlier part of the record.
    #[error("it is not yet steady over the first {:.0} % of the record", .part * 100.0)]
    Unsettled {
        /// The part of the record.
        part: f64,
    },
}

/// A test for drift.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DriftTest {
    /// Regression of the batch means over travel.
    #[error("slope of the batch means")]
    Slope,
    /// First half against second half.
    #[error("second half against first half")]
    Halves,
    /// Last quarter against the rest.
    #[error("last quarter against the rest")]
    LastQuarter,
}

/// Judges a force record. See the [module](self) for the tests.
#[must_use]
pub fn detect(series: Series<'_>, options: &SteadyOptions) -> SteadyState {
    let mut state = judge(series, options);
    if !state.reached {
        return state;
    }
    let unsettled = REPEATED_ON.into_iter().find(|&part| {
        let length = (part * series.force.len() as f64).round() as usize;
        let earlier = Series { travel: &series.travel[..length], force: &series.force[..length] };
        let relaxed = SteadyOptions {
            minimum_travel: part * options.minimum_travel,
            // The interval shrinks with the root of the length.
            relative_half_width: options.relative_half_width / part.sqrt(),
        };
        !judge(earlier, &relaxed).reached
    });
    if let Some(part) = unsettled {
        state.reached = false;
        state.reason = Reason::Unsettled { part };
    }
    state
}

/// What a record says about its steady part, without a verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Examination {
    /// Index of the first sample after the run-in.
    pub first: usize,
    /// Mean and interval over the samples from there on.
    pub mean: MeanInterval,
    /// Change over these samples, from the slope of ten batch means.
    pub drift: f64,
    /// Half width of its 95 % interval.
    pub drift_half_width: f64,
}

/// Run-in, mean and drift of a finished record by the rules of [`detect`], for another verdict.
#[must_use]
pub fn examine(force: &[f64]) -> Examination {
    let first = truncation::window_start(force, LEAST_WINDOW);
    let window = Window::new(force, first);
    Examination {
        first,
        mean: window.mean,
        drift: window.slope_drift.difference,
        drift_half_width: window.slope_drift.half_width,
    }
}

/// Mean and 95 % interval over the samples from `first` on, by the same rules as [`detect`]: the
/// correlation is that of the window or of the whole record since the force first reached its
/// mean, whichever is longer.
#[must_use]
pub fn window_mean(force: &[f64], first: usize) -> MeanInterval {
    let first = first.min(force.len());
    let record = autocorrelation_time(&force[truncation::first_reach(force, first)..]);
    mean_interval(&force[first..], Some(record))
}

/// How much a record changes over a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Change over the window, from the slope of ten batch means.
    pub change: f64,
    /// Half width of its 95 % interval; infinite where nothing can be said.
    pub half_width: f64,
}

impl Drift {
    /// The largest change in either direction that cannot be excluded.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.change.abs() + self.half_width
    }

    /// Whether the change is more than its uncertainty.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.change.abs() > self.half_width
    }
}

/// Change over the samples from `first` on and what of it is uncertain: the wider of the residuals of ten batch means about
/// their line, and of `sqrt(12)` half widths of the mean of the samples without this line, the error of a slope through
/// noise of many correlation lengths. The second counts where batches are so short that neighbours are correlated.
#[must_use]
pub fn window_drift(force: &[f64], first: usize) -> Drift {
    let samples = &force[first.min(force.len())..];
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count.max(1.0);
    let slope = slope_drift(samples, mean);
    let line = |k: usize| slope.difference * ((k as f64 + 0.5) / count - 0.5);
    let rest: Vec<f64> = samples.iter().enumerate().map(|(k, x)| x - line(k)).collect();
    let scatter = 12.0_f64.sqrt() * mean_interval(&rest, None).half_width;
    Drift { change: slope.difference, half_width: slope.half_width.max(scatter) }
}

/// The tests on one record.
fn judge(series: Series<'_>, options: &SteadyOptions) -> SteadyState {
    let length = series.force.len().min(series.travel.len());
    let (travel, force) = (&series.travel[..length], &series.force[..length]);
    let mut state = SteadyState {
        reached: false,
        reason: Reason::TooFewSamples { samples: length },
        window_start: travel.first().copied().unwrap_or(0.0),
        window_end: travel.last().copied().unwrap_or(0.0),
        first_sample: 0,
        mean: 0.0,
        ci95: f64::INFINITY,
        correlation_length: 0.0,
        drift: 0.0,
    };
    if let Some(sample) = force.iter().position(|value| !value.is_finite()) {
        state.reason = Reason::NotFinite { sample };
        return state;
    }
    if length < 2 {
        return state;
    }
    let first = truncation::window_start(force, LEAST_WINDOW);
    let window = Window::new(force, first);
    let spacing = (travel[length - 1] - travel[0]) / (length - 1) as f64;
    state.first_sample = first;
    // A sample is the mean over the interval before its travel.
    state.window_start = travel[first] - spacing;
    state.mean = window.mean.mean;
    let drift = window.slope_drift;
    let seen = if drift.is_significant() { 0.5 * drift.difference.abs() } else { 0.0 };
    state.ci95 = window.mean.half_width + seen;
    state.correlation_length = window.mean.correlation_samples * spacing;
    state.drift = window.slope_drift.difference;
    let whole_travel = state.window_end - (travel[0] - spacing);
    state.reason = first_failure(&window, whole_travel, &state, options);
    state.reached = state.reason == Reason::Steady;
    state
}

/// The first of the tests that fails, in the order of the module's list.
fn first_failure(
    window: &Window,
    travel: f64,
    state: &SteadyState,
    options: &SteadyOptions,
) -> Reason {
    let mean = window.mean.mean.abs();
    let share = |value: f64| value.abs() / mean;
    // Rounding of the travel must not decide.
    if travel < options.minimum_travel * (1.0 - MISSING_TRAVEL) {
        return Reason::TooShort { travel, minimum: options.minimum_travel };
    }
    if 2 * window.first > window.first + window.samples {
        return Reason::RunIn { start: state.window_start };
    }
    if window.samples < MINIMUM_SAMPLES {
        return Reason::TooFewSamples { samples: window.samples };
    }
    if mean == 0.0 || window.mean.half_width >= mean {
        return Reason::NoForce;
    }
    let lengths = window.samples as f64 / window.mean.correlation_samples;
    if lengths < MINIMUM_CORRELATION_LENGTHS {
        return Reason::Correlated { lengths };
    }
    for (test, found) in window.drift_tests() {
        let negligible = share(found.difference) <= NEGLIGIBLE_DRIFT * options.relative_half_width
            || share(found.difference) + share(found.half_width)
                <= 2.0 * options.relative_half_width;
        if found.is_significant() && !negligible {
            return Reason::Drift { test, share: found.difference / window.mean.mean };
        }
    }
    let possible = share(window.slope_drift.difference) + share(window.slope_drift.half_width);
    let allowed = DRIFT_ALLOWANCE * options.relative_half_width;
    if possible > allowed {
        return Reason::PossibleDrift { share: possible, allowed };
    }
    let half_width = share(state.ci95);
    if half_width > options.relative_half_width {
        return Reason::Imprecise { share: half_width, wanted: options.relative_half_width };
    }
    Reason::Steady
}

/// A difference between parts of a window and its uncertainty.
#[derive(Debug, Clone, Copy)]
struct Difference {
    difference: f64,
    /// Of the 95 % interval.
    half_width: f64,
    /// Of the interval that the drift tests use.
    test_half_width: f64,
}

impl Difference {
    fn new(difference: f64, standard_error: f64, degrees_of_freedom: f64) -> Self {
        let width = |significance: f64| {
            t_quantile(1.0 - significance / 2.0, degrees_of_freedom) * standard_error
        };
        Self { difference, half_width: width(0.05), test_half_width: width(DRIFT_SIGNIFICANCE) }
    }

    fn is_significant(&self) -> bool {
        self.difference.abs() > self.test_half_width
    }
}

/// The samples after the run-in and what the tests need of them.
struct Window {
    first: usize,
    samples: usize,
    mean: MeanInterval,
    slope_drift: Difference,
    halves: Difference,
    last_quarter: Difference,
}

impl Window {
    fn new(force: &[f64], first: usize) -> Self {
        let samples = &force[first..];
        let mean = window_mean(force, first);
        let part = |range: std::ops::Range<usize>| {
            let part = &samples[range];
            let average = part.iter().sum::<f64>() / part.len().max(1) as f64;
            // The variance of the mean of a part is that of the whole times the inverse share.
            let share = part.len() as f64 / samples.len() as f64;
            (average, mean.standard_error.powi(2) / share.max(f64::MIN_POSITIVE))
        };
        let between = |early: (f64, f64), late: (f64, f64)| {
            // Rounding of a constant force is no drift.
            let rounding = 1e-12 * mean.mean.abs();
            let error = (early.1 + late.1).sqrt() + rounding;
            Difference::new(late.0 - early.0, error, mean.degrees_of_freedom)
        };
        let (length, half, quarter) =
            (samples.len(), samples.len() / 2, samples.len() - samples.len() / 4);
        Self {
            first,
            samples: length,
            slope_drift: slope_drift(samples, mean.mean),
            halves: between(part(0..half), part(half..length)),
            last_quarter: between(part(0..quarter), part(quarter..length)),
            mean,
        }
    }

    fn drift_tests(&self) -> [(DriftTest, Difference); 3] {
        [
            (DriftTest::Slope, self.slope_drift),
            (DriftTest::Halves, self.halves),
            (DriftTest::LastQuarter, self.last_quarter),
        ]
    }
}

/// Change over the window by linear regression of the batch means, with the residuals of the
/// batches as its error.
fn slope_drift(samples: &[f64], mean: f64) -> Difference {
    let batches = Batches::new(samples);
    let count = batches.means.len() as f64;
    if count < 3.0 {
        return Difference {
            difference: 0.0,
            half_width: f64::INFINITY,
            test_half_width: f64::INFINITY,
        };
    }
    // Batch k has its centre at (k + 1/2) / count of the window.
    let position = |k: usize| (k as f64 + 0.5) / count - 0.5;
    let centre = batches.means.iter().sum::<f64>() / count;
    let spread: f64 = (0..batches.means.len()).map(|k| position(k).powi(2)).sum();
    let moment: f64 =
        batches.means.iter().enumerate().map(|(k, m)| position(k) * (m - centre)).sum();
    let slope = moment / spread;
    let residual: f64 = batches
        .means
        .iter()
        .enumerate()
        .map(|(k, m)| (m - centre - slope * position(k)).powi(2))
        .sum();
    let error = (residual / (count - 2.0) / spread).sqrt() + 1e-12 * mean.abs();
    Difference::new(slope, error, count - 2.0)
}
