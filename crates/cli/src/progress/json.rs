//! Progress for programs: one JSON object per line on standard output.

use super::Status;
use serde_json::{Value, json};

/// Wall-clock time between progress lines in s.
const INTERVAL: f64 = 1.0;

/// JSON lines on standard output.
#[derive(Debug)]
pub struct JsonLines {
    last_seconds: Option<f64>,
}

impl JsonLines {
    /// Before the first line.
    pub fn new() -> Self {
        Self { last_seconds: None }
    }

    /// Writes a line if a second has passed since the last one.
    pub fn update(&mut self, status: &Status) {
        let due = self.last_seconds.is_none_or(|last| status.wall_seconds >= last + INTERVAL);
        if due {
            self.last_seconds = Some(status.wall_seconds);
            emit(&progress(status));
        }
    }
}

/// The progress event; SI units except the forces of a plane cut, which are per mm of width.
fn progress(status: &Status) -> Value {
    let plane = status.forces.filter(|forces| forces.passive.is_none());
    let space = status.forces.filter(|forces| forces.passive.is_some());
    json!({
        "event": "progress",
        "step": status.step,
        "time_s": status.time,
        "end_time_s": status.end_time,
        "share": status.share(),
        "travel_m": status.travel.map(|travel| travel.now),
        "end_travel_m": status.travel.map(|travel| travel.end),
        "updates_per_second": status.updates_per_second,
        "wall_s": status.wall_seconds,
        "remaining_s": status.remaining_seconds,
        "cutting_force_n_per_mm": plane.map(|forces| forces.cutting),
        "feed_force_n_per_mm": plane.map(|forces| forces.feed),
        "cutting_force_n": space.map(|forces| forces.cutting),
        "feed_force_n": space.map(|forces| forces.feed),
        "passive_force_n": space.and_then(|forces| forces.passive),
    })
}

/// Writes one event; a reader that has gone away does not stop the run.
pub fn emit(event: &Value) {
    crate::terminal::line(&event.to_string());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_null() {
        let event = progress(&Status {
            step: 3,
            time: 0.5,
            end_time: 1.0,
            travel: None,
            updates_per_second: 1.0,
            wall_seconds: 2.0,
            remaining_seconds: None,
            forces: None,
        });
        assert_eq!(event["event"], "progress");
        assert_eq!(event["share"], 0.5);
        assert!(event["cutting_force_n_per_mm"].is_null());
        assert!(!event.to_string().contains('\n'));
    }
}
