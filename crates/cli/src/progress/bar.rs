//! The progress bar of a terminal.

use super::Status;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Parts into which the bar divides a run.
const TICKS: u64 = 1000;

/// A bar with the state of the run behind it.
#[derive(Debug)]
pub struct TerminalBar {
    bar: ProgressBar,
}

impl TerminalBar {
    /// An empty bar on standard error.
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(TICKS), ProgressDrawTarget::stderr_with_hz(5));
        let style = ProgressStyle::with_template("{bar:16} {percent:>3} %  {wide_msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        Self { bar }
    }

    /// Moves the bar and renews the text.
    pub fn update(&self, status: &Status) {
        self.bar.set_position((status.share() * TICKS as f64) as u64);
        self.bar.set_message(status.line());
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
