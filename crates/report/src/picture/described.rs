//! Pictures with what they show in words.

use super::animation::Animation;
use super::field::ParticleField;
use crate::kit::numbers::three_digits;
use sphcut_record::TemperatureUnit;
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
    pub animation: Option<Animation>,
    /// All of the last snapshot.
    pub whole: Option<Picture>,
    pub fields: Vec<Picture>,
    pub layers: Option<Picture>,
    /// That a part of the chip has left the moving window.
    pub cut_off: Option<String>,
    /// That the pressure alternates from row to row.
    pub checkerboard: Option<String>,
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
pub(super) fn description(
    field: ParticleField,
    snapshot: &Snapshot,
    unit: TemperatureUnit,
) -> String {
    let (low, high) = field.range([snapshot]);
    format!(
        "{} of the particles and the tool at the end of the run; 99.8 % of the particles lie \
         between {} and {}.",
        field.title(unit),
        three_digits(field.shown(low, unit)),
        three_digits(field.shown(high, unit))
    )
}

/// `Temperature from 20 to 675 °C (293 to 948 K)`: what the ends of the colours are.
pub(super) fn colours_span(
    field: ParticleField,
    (low, high): (f64, f64),
    unit: TemperatureUnit,
) -> String {
    let title = field.title(unit);
    let (name, of) = title.rsplit_once(" in ").unwrap_or((title, ""));
    let [from, to] = [low, high].map(|value| three_digits(field.shown(value, unit)));
    let mut text = format!("{name} from {from} to {to} {of}");
    if field == ParticleField::Temperature && unit == TemperatureUnit::Celsius {
        text += &format!(" ({low:.0} to {high:.0} K)");
    }
    text.trim_end().to_owned()
}
