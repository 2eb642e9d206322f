//! Progress in a file or a pipe: a line at every tenth of the run and every half minute.

use super::Status;
use crate::terminal::note;

/// Wall-clock time between lines in s, if no tenth of the run is completed before.
const INTERVAL: f64 = 30.0;

/// Plain lines on standard error.
#[derive(Debug)]
pub struct Lines {
    tenths: u32,
    last_seconds: f64,
}

impl Lines {
    /// Before the first line.
    pub fn new() -> Self {
        Self { tenths: 0, last_seconds: 0.0 }
    }

    /// Prints a line if one is due.
    pub fn update(&mut self, status: &Status) {
        if self.is_due(status) {
            note(&format!("{:>3.0} %  {}", 100.0 * status.share(), status.line()));
        }
    }

    fn is_due(&mut self, status: &Status) -> bool {
        let tenths = (10.0 * status.share()) as u32;
        let due = tenths > self.tenths || status.wall_seconds >= self.last_seconds + INTERVAL;
        if due {
            self.tenths = tenths;
            self.last_seconds = status.wall_seconds;
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(share: f64, wall_seconds: f64) -> Status {
        Status {
            step: 1,
            time: share,
            end_time: 1.0,
            travel: None,
            updates_per_second: 1e6,
            wall_seconds,
            remaining_seconds: None,
            forces: None,
        }
    }

    #[test]
    fn a_line_for_every_tenth_and_every_half_minute() {
        let mut lines = Lines::new();
        assert!(!lines.is_due(&status(0.05, 1.0)));
        assert!(lines.is_due(&status(0.11, 2.0)));
        assert!(!lines.is_due(&status(0.12, 20.0)));
        assert!(lines.is_due(&status(0.13, 32.5)));
        assert!(!lines.is_due(&status(0.14, 40.0)));
    }
}
