//! A measured frequency response: comma-separated, a header with units.

use crate::response::Response;
use sphcut_input::columns::{self, ColumnRule, column};
use sphcut_input::files::{LARGEST_OUTLINE, Surroundings, file_mistake};
use sphcut_input::findings::Findings;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;

const COLUMNS: [ColumnRule; 3] = [
    column("frequency", Quantity::Frequency, "Hz", (true, false)),
    column("gain", Quantity::Dimensionless, "", (true, true)),
    column("phase", Quantity::Angle, "deg", (true, false)),
];

/// The response of a channel, without its regularisation; `Some(None)` without one, `None` after a mistake.
pub(super) fn read_response(
    findings: &mut Findings,
    channel: &Record<'_>,
    surroundings: &Surroundings,
) -> Option<Option<Response>> {
    let Some(named) = channel.text("response") else { return Some(None) };
    let read = surroundings.read(named, LARGEST_OUTLINE).and_then(|text| {
        response(&text).map_err(|reason| {
            file_mistake(named, reason, "its header is frequency [Hz],gain,phase [deg]")
        })
    });
    findings.accept(channel, "response", read).map(Some)
}

fn response(text: &str) -> Result<Response, String> {
    let rows = columns::read(text, &COLUMNS, "no line follows the header")
        .map_err(|problem| problem.to_string())?;
    let mut found = Response::default();
    for row in rows {
        let [frequency, gain, phase] = row.all();
        if frequency < 0.0 || found.frequency.last().is_some_and(|last| frequency <= *last) {
            return Err(row.problem("the frequencies do not rise").to_string());
        }
        found.frequency.push(frequency);
        found.gain.push(gain);
        found.phase.push(phase);
    }
    if found.gain.len() < 2 { Err("two lines at least are needed".to_owned()) } else { Ok(found) }
}
