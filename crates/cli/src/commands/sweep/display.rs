//! The progress of a sweep: every run's state and the time left.

use super::tally::SweepTally;
use crate::progress::{OutputStyle, emit};
use crate::terminal::note;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use sphcut_sweep::{News, State, Sweep, SweepPlan};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Parts into which the bar divides a sweep.
const TICKS: u64 = 1000;
/// Time between two drawings or lines of progress.
const BETWEEN: [Duration; 3] =
    [Duration::from_millis(200), Duration::from_secs(30), Duration::from_secs(1)];
/// More runs than this in a pipe are told by their number alone, not each by its end.
const MOST_LINES: usize = 200;

/// Shows the news of a sweep; threads take turns.
pub struct SweepDisplay<'a> {
    sweep: &'a Sweep,
    plan: &'a SweepPlan,
    style: OutputStyle,
    start: Instant,
    inner: Mutex<Inner>,
}

struct Inner {
    tally: SweepTally,
    last: Option<Instant>,
    terminal: Option<Terminal>,
}

/// A bar, a picture of all runs.
struct Terminal {
    _all: MultiProgress,
    bar: ProgressBar,
    picture: ProgressBar,
}

impl Terminal {
    fn new() -> Self {
        let all = MultiProgress::with_draw_target(ProgressDrawTarget::stderr_with_hz(5));
        let style = |template: &str| {
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
        };
        let bar = all.add(ProgressBar::new(TICKS));
        bar.set_style(style("{bar:16} {percent:>3} %  {wide_msg}").progress_chars("=> "));
        let picture = all.add(ProgressBar::new(TICKS));
        picture.set_style(style("{msg}"));
        Self { _all: all, bar, picture }
    }
}

impl<'a> SweepDisplay<'a> {
    /// Before the first news.
    pub fn new(sweep: &'a Sweep, plan: &'a SweepPlan, style: OutputStyle) -> Self {
        let terminal =
            (style == OutputStyle::Human && std::io::stderr().is_terminal()).then(Terminal::new);
        let inner = Mutex::new(Inner { tally: SweepTally::new(plan), last: None, terminal });
        Self { sweep, plan, style, start: Instant::now(), inner }
    }

    /// Shows `news`, if it is time to.
    pub fn take(&self, news: &News) {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        inner.tally.note(news);
        if let News::State { index, state } = news {
            self.tell(&inner, *index, state);
        }
        let between = match (self.style, &inner.terminal) {
            (OutputStyle::Quiet, _) => return,
            (OutputStyle::Json, _) => BETWEEN[2],
            (OutputStyle::Human, Some(_)) => BETWEEN[0],
            (OutputStyle::Human, None) => BETWEEN[1],
        };
        if inner.last.get_or_insert_with(Instant::now).elapsed() >= between {
            inner.last = Some(Instant::now());
            self.show(&inner);
        }
    }

    fn show(&self, inner: &Inner) {
        let elapsed = self.start.elapsed().as_secs_f64();
        let line = inner.tally.line(elapsed);
        match (&inner.terminal, self.style) {
            (Some(terminal), _) => {
                terminal.bar.set_position((inner.tally.share() * TICKS as f64) as u64);
                terminal.bar.set_message(line);
                terminal.picture.set_message(inner.tally.picture());
            }
            (None, OutputStyle::Json) => emit(&json!({
                "event": "progress",
                "share": inner.tally.share(),
                "remaining_s": inner.tally.remaining(elapsed),
                "wall_s": elapsed,
                "runs": line,
            })),
            (None, _) => {
                note(&format!("{:>3.0} %  {line}", 100.0 * inner.tally.share()));
                let picture = inner.tally.picture();
                if !picture.is_empty() {
                    note(&format!("       {picture}"));
                }
            }
        }
    }

    /// A run has begun or ended.
    fn tell(&self, inner: &Inner, index: usize, state: &State) {
        let run = &self.plan.runs[index];
        let values: Vec<&str> = run.values.iter().map(String::as_str).collect();
        let word = match state {
            State::Waiting => "waiting",
            State::Running(_) => "running",
            State::Elsewhere => "elsewhere",
            State::Reused => "reused",
            State::Finished => "finished",
            State::Failed(_) => "failed",
            State::Stopped => "stopped",
        };
        if self.style == OutputStyle::Json {
            let reason = if let State::Failed(reason) = state { Some(reason) } else { None };
            emit(&json!({
                "event": "run",
                "run": run.number,
                "state": word,
                "settings": self.sweep.settings(&values),
                "address": run.address.to_string(),
                "reason": reason,
            }));
            return;
        }
        let line = match state {
            State::Failed(reason) => {
                format!("run {} failed: {}: {reason}", run.number, self.sweep.settings(&values))
            }
            State::Finished
                if self.style == OutputStyle::Human
                    && inner.terminal.is_none()
                    && self.plan.runs.len() <= MOST_LINES =>
            {
                let share = 100.0 * inner.tally.share();
                format!(
                    "{share:>3.0} %  run {} finished: {}",
                    run.number,
                    self.sweep.settings(&values)
                )
            }
            _ => return,
        };
        match &inner.terminal {
            Some(terminal) => terminal.bar.suspend(|| note(&line)),
            None => note(&line),
        }
    }

    /// Leaves the terminal clean for what follows.
    pub fn finish(&self) {
        let inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(terminal) = &inner.terminal {
            terminal.picture.finish_and_clear();
            terminal.bar.finish_and_clear();
        }
    }
}
