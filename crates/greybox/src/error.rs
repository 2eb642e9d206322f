//! Why a correction cannot be fitted or used.

/// What is wrong with tables or a stored model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GreyBoxError {
    /// Too few different conditions for a cross-validation.
    #[error(
        "{found} different conditions (v_c, h): at least {needed} are needed to fit a correction and to \
         test it on conditions it has not seen; repeats of a condition do not count"
    )]
    TooFewConditions {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// More different conditions than the regressors can take.
    #[error(
        "{found} different conditions (v_c, h): at most {limit} can be taken; conditions within 1 % in \
         both are one. Leave out some, or give means"
    )]
    TooManyConditions {
        /// How many there are.
        found: usize,
        /// How many can be taken.
        limit: usize,
    },
    /// Measured conditions that were not simulated.
    #[error(
        "{count} of {of} measured conditions have no simulation (within 1 %):{}",
        listed(.first, *.count, *.of)
    )]
    NotSimulated {
        /// The first of them: v_c in m/s, h in m.
        first: Vec<[f64; 2]>,
        /// How many there are.
        count: usize,
        /// Measured conditions in all.
        of: usize,
    },
    /// Several materials or widths in one table.
    #[error("{first} and {second} in one table: a correction holds for one; make a table of each")]
    Mixed {
        /// The first.
        first: String,
        /// The one that differs.
        second: String,
    },
    /// A simulation of another width than the measurements.
    #[error("simulated are {simulated}, measured {measured}: forces in N cannot be compared")]
    OtherWidth {
        /// Of the simulation.
        simulated: String,
        /// Of the measurements.
        measured: String,
    },
    /// Cuts that the correction was not fitted to.
    #[error(
        "the correction was fitted to {fitted}, these are of {given}: it says nothing of them. Fit one to these cuts"
    )]
    OtherSetting {
        /// Of the correction.
        fitted: String,
        /// Of the table.
        given: String,
    },
    /// A comparison with the rows of the fit.
    #[error(
        "all {0} measured rows are those that the correction was fitted to: that tests nothing. Compare with other measurements"
    )]
    NothingNew(usize),
    /// A table that cannot be read.
    #[error("{0}")]
    Table(String),
    /// A stored model that cannot be used.
    #[error("{0}")]
    Model(String),
}

/// Conditions listed by name in a message.
pub(crate) const LISTED: usize = 5;

/// The first conditions without a simulation, and what to do.
fn listed(first: &[[f64; 2]], count: usize, of: usize) -> String {
    let named = |[speed, thickness]: &[f64; 2]| {
        format!(" v_c {:.4} m/min, h {:.4} mm;", speed * 60.0, thickness * 1e3)
    };
    let mut text: String = first.iter().map(named).collect();
    if count > first.len() {
        text += &format!(" and {} more;", count - first.len());
    }
    text + if count == of {
        " not one has: are the units of both tables right?"
    } else {
        " simulate them, or take them out of the measured table"
    }
}
