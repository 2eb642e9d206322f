//! Why a correction cannot be fitted or used.

use std::fmt;

/// What is wrong with tables or a stored model.
#[derive(Debug, Clone, PartialEq)]
pub enum GreyBoxError {
    /// Too few different conditions for a cross-validation.
    TooFewConditions {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// More different conditions than the regressors can take.
    TooManyConditions {
        /// How many there are.
        found: usize,
        /// How many can be taken.
        limit: usize,
    },
    /// Measured conditions that were not simulated.
    NotSimulated {
        /// The first of them: v_c in m/s, h in m.
        first: Vec<[f64; 2]>,
        /// How many there are.
        count: usize,
        /// Measured conditions in all.
        of: usize,
    },
    /// A stored model that cannot be used.
    Model(String),
}

/// Conditions listed by name in a message.
pub(crate) const LISTED: usize = 5;

impl fmt::Display for GreyBoxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewConditions { found, needed } => write!(
                f,
                "{found} different conditions (v_c, h): at least {needed} are needed to fit a correction and to \
                 test it on conditions it has not seen; repeats of a condition do not count"
            ),
            Self::TooManyConditions { found, limit } => write!(
                f,
                "{found} different conditions (v_c, h): at most {limit} can be taken; conditions within 1 % in \
                 both are one. Leave out some, or give means"
            ),
            Self::NotSimulated { first, count, of } => {
                write!(f, "{count} of {of} measured conditions have no simulation (within 1 %):")?;
                for [speed, thickness] in first {
                    write!(f, " v_c {:.4} m/min, h {:.4} mm;", speed * 60.0, thickness * 1e3)?;
                }
                if *count > first.len() {
                    write!(f, " and {} more;", count - first.len())?;
                }
                if count == of {
                    return write!(f, " not one has: are the units of both tables right?");
                }
                write!(f, " simulate them, or take them out of the measured table")
            }
            Self::Model(reason) => write!(f, "{reason}"),
        }
    }
}

impl std::error::Error for GreyBoxError {}
