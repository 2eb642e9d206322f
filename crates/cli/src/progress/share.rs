//! Progress of a command that is no run: the share that is done, what is done now, and the time left.

use crate::terminal::note;
use crate::text;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Parts into which the bar divides the work.
const TICKS: u64 = 1000;
/// Work that is over sooner, in s, needs no lines.
const SHORT: f64 = 5.0;

/// A bar on a terminal, elsewhere a line per tenth of work that takes longer than five seconds. Threads take turns.
pub struct ShareDisplay {
    bar: Option<ProgressBar>,
    start: Instant,
    /// Tenths that were told; `None` where nothing is.
    told: Option<Mutex<u32>>,
}

impl ShareDisplay {
    /// At the beginning.
    pub fn new(quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = (terminal && !quiet).then(|| {
            let target = ProgressDrawTarget::stderr_with_hz(5);
            let template = "{bar:16} {percent:>3} %  {wide_msg}";
            let style = ProgressStyle::with_template(template);
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::with_draw_target(Some(TICKS), target)
                .with_style(style.progress_chars("=> "))
        });
        let told = (!terminal && !quiet).then(Mutex::default);
        Self { bar, start: Instant::now(), told }
    }

    /// Says that a share between 0 and 1 is done.
    pub fn update(&self, share: f64, what: &str) {
        let elapsed = self.start.elapsed().as_secs_f64();
        let line = || format!("{}{what}", left(share, elapsed));
        if let Some(bar) = &self.bar {
            bar.set_position((share * TICKS as f64) as u64);
            bar.set_message(line());
        }
        if let Some(told) = &self.told {
            let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
            if is_due(&mut told, share, elapsed) {
                note(&format!("{:>3.0} %  {}", 100.0 * share, line()));
            }
        }
    }

    /// Leaves the terminal clean for what follows.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Also where an error ends the work.
impl Drop for ShareDisplay {
    fn drop(&mut self) {
        self.finish();
    }
}

/// `12 s left, `, once it can be told.
fn left(share: f64, elapsed: f64) -> String {
    if share < 0.02 || elapsed < 1.0 {
        return String::new();
    }
    format!("{} left, ", text::seconds(elapsed * (1.0 - share) / share))
}

fn is_due(told: &mut u32, share: f64, elapsed: f64) -> bool {
    let tenths = (10.0 * share) as u32;
    let due = tenths > *told && elapsed >= SHORT && tenths < 10;
    *told = (*told).max(if due { tenths } else { 0 });
    due
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_per_tenth_of_what_takes_long() {
        let mut told = 0;
        assert!(!is_due(&mut told, 0.35, 2.0));
        assert!(is_due(&mut told, 0.35, 6.0));
        assert!(!is_due(&mut told, 0.39, 7.0));
        assert!(is_due(&mut told, 0.41, 7.0));
        // The end is told by the result.
        assert!(!is_due(&mut told, 1.0, 20.0));
        assert_eq!(left(0.25, 5.0), "15 s left, ");
        assert_eq!(left(0.01, 5.0), "");
    }
}
