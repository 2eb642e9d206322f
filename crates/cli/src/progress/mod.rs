//! What the user sees while a run is going on: a bar, plain lines, JSON lines or nothing.

mod bar;
mod json;
mod lines;
mod share;

use crate::text;
pub use json::emit;
pub use share::ShareDisplay;
use std::io::IsTerminal;

/// Where a run is, in the units shown to the user.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Status {
    /// Steps since the start.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// End of the simulated time in s.
    pub end_time: f64,
    /// Path of the tool, if there is one.
    pub travel: Option<Travel>,
    /// Particle updates per second of wall-clock time.
    pub updates_per_second: f64,
    /// Wall-clock time spent in s.
    pub wall_seconds: f64,
    /// Wall-clock time still needed in s, once it can be told.
    pub remaining_seconds: Option<f64>,
    /// Latest cutting and feed force, if there is a tool and a sample.
    pub forces: Option<ShownForces>,
}

/// Path of the tool in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// So far.
    pub now: f64,
    /// At the end of the run.
    pub end: f64,
}

/// ShownForces: of a plane cut per width in N/mm, in space in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownForces {
    /// F_c.
    pub cutting: f64,
    /// F_f.
    pub feed: f64,
    /// F_p in space.
    pub passive: Option<f64>,
}

impl std::fmt::Display for ShownForces {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.passive {
            None => write!(f, "F_c {:.0} F_f {:.0} N/mm", self.cutting, self.feed),
            Some(passive) => {
                write!(f, "F_c {:.1} F_f {:.1} F_p {passive:.1} N", self.cutting, self.feed)
            }
        }
    }
}

impl Status {
    /// Share of the run that is done, between 0 and 1.
    pub fn share(&self) -> f64 {
        if self.end_time > 0.0 { (self.time / self.end_time).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// `0.420 of 1.500 mm, F_c 212 F_f 61 N/mm, 12 s left, 0.84 M updates/s, 1.700e-4 s`: what
    /// matters most comes first, because a narrow terminal cuts off the end.
    pub fn line(&self) -> String {
        let mut parts = Vec::new();
        if let Some(travel) = self.travel {
            parts.push(format!("{:.3} of {:.3} mm", travel.now * 1e3, travel.end * 1e3));
        }
        if let Some(forces) = self.forces {
            parts.push(forces.to_string());
        }
        if let Some(seconds) = self.remaining_seconds {
            parts.push(format!("{} left", text::seconds(seconds)));
        }
        parts.push(text::updates(self.updates_per_second));
        parts.push(format!("{:.3e} s", self.time));
        parts.join(", ")
    }
}

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputStyle {
    /// A bar on a terminal, plain lines elsewhere.
    Human,
    /// One JSON object per line on standard output.
    Json,
    /// Nothing.
    Quiet,
}

/// Shows the progress of one run.
#[derive(Debug)]
pub enum RunDisplay {
    /// A bar at the bottom of a terminal.
    Bar(bar::TerminalBar),
    /// A line now and then.
    Lines(lines::Lines),
    /// JSON lines.
    Json(json::JsonLines),
    /// Nothing.
    Nothing,
}

impl RunDisplay {
    /// The display that fits `style` and the place standard error goes to.
    pub fn new(style: OutputStyle) -> Self {
        match style {
            OutputStyle::Quiet => Self::Nothing,
            OutputStyle::Json => Self::Json(json::JsonLines::new()),
            OutputStyle::Human if std::io::stderr().is_terminal() => {
                Self::Bar(bar::TerminalBar::new())
            }
            OutputStyle::Human => Self::Lines(lines::Lines::new()),
        }
    }

    /// Shows `status`, if it is time to.
    pub fn update(&mut self, status: &Status) {
        match self {
            Self::Bar(bar) => bar.update(status),
            Self::Lines(lines) => lines.update(status),
            Self::Json(json) => json.update(status),
            Self::Nothing => {}
        }
    }

    /// Leaves the terminal clean for what follows.
    pub fn finish(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_has_units_and_leaves_out_what_is_not_there() {
        let mut status = Status {
            step: 10,
            time: 1e-4,
            end_time: 4e-4,
            travel: Some(Travel { now: 2.5e-4, end: 1e-3 }),
            updates_per_second: 8.4e5,
            wall_seconds: 3.0,
            remaining_seconds: Some(9.0),
            forces: Some(ShownForces { cutting: 211.6, feed: 60.9, passive: None }),
        };
        assert_eq!(
            status.line(),
            "0.250 of 1.000 mm, F_c 212 F_f 61 N/mm, 9.0 s left, 0.84 M updates/s, 1.000e-4 s"
        );
        // In space the forces are whole.
        status.forces = Some(ShownForces { cutting: 63.04, feed: 0.45, passive: Some(70.0) });
        assert!(status.line().contains(", F_c 63.0 F_f 0.5 F_p 70.0 N, "), "{}", status.line());
        status.travel = None;
        status.forces = None;
        status.remaining_seconds = None;
        assert_eq!(status.line(), "0.84 M updates/s, 1.000e-4 s");
        assert!((status.share() - 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_run_without_end_has_no_share() {
        let status = Status {
            step: 0,
            time: 0.0,
            end_time: 0.0,
            travel: None,
            updates_per_second: 0.0,
            wall_seconds: 0.0,
            remaining_seconds: None,
            forces: None,
        };
        assert_eq!(status.share(), 0.0);
    }
}
