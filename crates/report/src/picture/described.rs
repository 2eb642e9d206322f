//! Pictures with what they show in words.

use super::field::ParticleField;
use crate::kit::numbers::three_digits;
use sphcut_sph::Snapshot;

/// Width of a picture on a page in pixels.
pub(super) const PICTURE_WIDTH: u32 = 1000;

/// A picture file with what it shows.
#[derive(Clone)]
pub(crate) struct Picture {
    pub title: String,
    /// For people who cannot see it.
    pub description: String,
    pub media_type: &'static str,
    pub bytes: Vec<u8>,
}

/// Everything a report shows of the particles; empty for a run without snapshots.
#[derive(Default)]
pub(crate) struct Pictures {
    pub animation: Option<Picture>,
    /// All of the last snapshot, where the animation cannot be seen.
    pub whole: Option<Picture>,
    pub fields: Vec<Picture>,
    pub layers: Option<Picture>,
}

/// Ends of a colour bar for the tool alone; `None` where it does not conduct heat.
pub(super) fn tool_range(snapshot: &Snapshot) -> Option<(f64, f64)> {
    let temperatures = || snapshot.tool_temperature.iter().copied();
    let low = temperatures().reduce(f64::min)?;
    let high = temperatures().reduce(f64::max)?;
    // A tool that nothing has heated yet still needs a bar.
    Some((low, high.max(low + 1.0)))
}

/// What a picture says in one sentence.
pub(super) fn description(field: ParticleField, snapshot: &Snapshot) -> String {
    let (low, high) = field.range([snapshot]);
    format!(
        "{} of the particles and the tool at the end of the run; 99.8 % of the particles lie \
         between {} and {}.",
        field.title(),
        three_digits(low),
        three_digits(high)
    )
}
