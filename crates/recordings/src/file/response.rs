//! A measured frequency response: comma-separated, a header with units.

use sphcut_input::columns::{self, ColumnRule, column};
use sphcut_input::files::{LARGEST_OUTLINE, Surroundings, file_mistake};
use sphcut_input::findings::Findings;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;

/// A line of a frequency response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponseLine {
    /// Hz.
    pub frequency: f64,
    /// |H|, in any unit.
    pub gain: f64,
    /// rad.
    pub phase: f64,
}

const COLUMNS: [ColumnRule; 3] = [
    column("frequency", Quantity::Frequency, "Hz", (true, false)),
    column("gain", Quantity::Dimensionless, "", (true, true)),
    column("phase", Quantity::Angle, "deg", (true, false)),
];

/// The response of a channel; empty without one, `None` after a mistake.
pub(super) fn read_response(
    findings: &mut Findings,
    channel: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Vec<ResponseLine>> {
    let Some(named) = channel.text("response") else { return Some(Vec::new()) };
    let read = surroundings.read(named, LARGEST_OUTLINE).and_then(|text| {
        lines(&text).map_err(|reason| {
            file_mistake(named, reason, "its header is frequency [Hz],gain,phase [deg]")
        })
    });
    findings.accept(channel, "response", read)
}

fn lines(text: &str) -> Result<Vec<ResponseLine>, String> {
    let rows = columns::read(text, &COLUMNS, "no line follows the header")
        .map_err(|problem| problem.to_string())?;
    let mut lines: Vec<ResponseLine> = Vec::new();
    for row in rows {
        let [frequency, gain, phase] = row.all();
        if frequency < 0.0 || lines.last().is_some_and(|last| frequency <= last.frequency) {
            return Err(row.problem("the frequencies do not rise").to_string());
        }
        lines.push(ResponseLine { frequency, gain, phase });
    }
    if lines.len() < 2 { Err("two lines at least are needed".to_owned()) } else { Ok(lines) }
}
