//! Several passes of a tool: when each begins and ends, and what earlier ones took away.

use crate::tensor::Vector;

/// Grooves along the first axis of boxes, cut before the run: no particle lies above their line.
#[derive(Debug, Clone, PartialEq)]
pub struct Grooves {
    /// (z, y) in m before any rotation, by increasing z; there is no groove beyond its ends.
    pub line: Vec<[f64; 2]>,
}

impl Grooves {
    /// Whether a point of an unrotated box lies above the line.
    #[must_use]
    pub fn contain(&self, point: &Vector) -> bool {
        let [_, y, z] = *point;
        self.line.windows(2).any(|pair| {
            let [[from, low], [to, high]] = [pair[0], pair[1]];
            (from..to).contains(&z) && y > low + (z - from) / (to - from) * (high - low)
        })
    }
}

/// One of several passes of the tool; between them it returns through the air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    /// When it begins in s.
    pub start: f64,
    /// When it ends in s.
    pub end: f64,
}

impl Pass {
    /// Whether it begins at a time in s or after it, but for rounding.
    #[must_use]
    pub fn begins_from(&self, time: f64) -> bool {
        not_after(time, self.start)
    }

    /// Whether it ends at a time in s or after it, but for rounding.
    #[must_use]
    pub fn ends_from(&self, time: f64) -> bool {
        not_after(time, self.end)
    }
}

/// The time of a run is a sum of steps, the ends of passes are one of legs: they differ by rounding.
fn not_after(time: f64, limit: f64) -> bool {
    time <= limit * (1.0 + 1e-9)
}
