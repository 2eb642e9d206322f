//! What keeps series from being diagnosed.

use super::FEWEST_SEGMENTS;

/// Why series cannot be diagnosed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeriesError {
    /// No record has a cut.
    #[error("no record has a cut in it: there is no series to look at")]
    NoCut,
    /// No cut is long enough for the bins that are wanted.
    #[error(
        "the longest steady cut lasts {longest:.3} s: bins of {resolution:.3} Hz need {needed:.3} s, so that \
         {FEWEST_SEGMENTS} segments can be averaged; cut longer, or state a wider `resolution`"
    )]
    TooShort {
        /// Length of the longest in s.
        longest: f64,
        /// Width of a bin in Hz.
        resolution: f64,
        /// Length that is needed in s.
        needed: f64,
    },
    /// So few samples per second that the bins wanted are too few.
    #[error(
        "bins of {resolution:.3} Hz up to half the sampling rate, {nyquist:.1} Hz, are too few for a background; sample \
         faster, or state a narrower `resolution`"
    )]
    TooCoarse {
        /// Width of a bin in Hz.
        resolution: f64,
        /// Half the sampling rate in Hz.
        nyquist: f64,
    },
    /// A stated natural frequency that cannot be seen.
    #[error(
        "the natural frequency of {frequency:.1} Hz lies beyond half the sampling rate, {nyquist:.1} Hz: it would show at a wrong \
         place; sample faster, or remove it"
    )]
    BeyondNyquist {
        /// The frequency in Hz.
        frequency: f64,
        /// Half the lowest sampling rate in Hz.
        nyquist: f64,
    },
    /// The free-running machine was recorded too shortly.
    #[error(
        "the recording of the free-running machine lasts {length:.3} s: {needed:.3} s are needed"
    )]
    AirTooShort {
        /// Its length in s.
        length: f64,
        /// Length that is needed in s.
        needed: f64,
    },
}
