//! What keeps series from being diagnosed.

use super::FEWEST_SEGMENTS;
use std::fmt;

/// Why series cannot be diagnosed.
#[derive(Debug, Clone, PartialEq)]
pub enum SeriesError {
    /// No record has a cut.
    NoCut,
    /// No cut is long enough for the bins that are wanted.
    TooShort {
        /// Length of the longest in s.
        longest: f64,
        /// Width of a bin in Hz.
        resolution: f64,
        /// Length that is needed in s.
        needed: f64,
    },
    /// So few samples per second that the bins wanted are too few.
    TooCoarse {
        /// Width of a bin in Hz.
        resolution: f64,
        /// Half the sampling rate in Hz.
        nyquist: f64,
    },
    /// A stated natural frequency that cannot be seen.
    BeyondNyquist {
        /// The frequency in Hz.
        frequency: f64,
        /// Half the lowest sampling rate in Hz.
        nyquist: f64,
    },
    /// The free-running machine was recorded too shortly.
    AirTooShort {
        /// Its length in s.
        length: f64,
        /// Length that is needed in s.
        needed: f64,
    },
}

impl fmt::Display for SeriesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCut => write!(f, "no record has a cut in it: there is no series to look at"),
            Self::TooShort { longest, resolution, needed } => write!(
                f,
                "the longest steady cut lasts {longest:.3} s: bins of {resolution:.3} Hz need {needed:.3} s, so that \
                 {FEWEST_SEGMENTS} segments can be averaged; cut longer, or state a wider `resolution`"
            ),
            Self::TooCoarse { resolution, nyquist } => write!(
                f,
                "bins of {resolution:.3} Hz up to half the sampling rate, {nyquist:.1} Hz, are too few for a background; sample \
                 faster, or state a narrower `resolution`"
            ),
            Self::BeyondNyquist { frequency, nyquist } => write!(
                f,
                "the natural frequency of {frequency:.1} Hz lies beyond half the sampling rate, {nyquist:.1} Hz: it would show at a wrong \
                 place; sample faster, or remove it"
            ),
            Self::AirTooShort { length, needed } => write!(
                f,
                "the recording of the free-running machine lasts {length:.3} s: {needed:.3} s are needed"
            ),
        }
    }
}

impl std::error::Error for SeriesError {}
