//! Where a sweep is: the state of every run, how much is left.

use crate::text;
use sphcut_sweep::{News, State, SweepPlan};
use std::fmt::Write as _;

/// More runs than this are counted, not drawn.
const MOST_DRAWN: usize = 500;

/// The state of every run.
#[derive(Debug)]
pub struct SweepTally {
    states: Vec<State>,
    /// Share of each run that is done.
    shares: Vec<f64>,
    /// Particle updates that each run takes, as far as its first step tells.
    costs: Vec<f64>,
    /// Updates that this sweep has made itself.
    done: f64,
}

impl SweepTally {
    /// Before anything has happened.
    pub fn new(plan: &SweepPlan) -> Self {
        Self {
            states: vec![State::Waiting; plan.runs.len()],
            shares: vec![0.0; plan.runs.len()],
            costs: plan.runs.iter().map(|run| run.cost.updates()).collect(),
            done: 0.0,
        }
    }

    /// Takes note of news.
    pub fn note(&mut self, news: &News) {
        match news {
            News::Progress { index, share, .. } => self.advance(*index, *share),
            News::State { index, state } => {
                if *state == State::Finished {
                    self.advance(*index, 1.0);
                }
                self.states[*index] = state.clone();
            }
        }
    }

    fn advance(&mut self, index: usize, share: f64) {
        // What an earlier attempt has computed is not the work of this one.
        if self.shares[index] > 0.0 || share >= 1.0 {
            self.done += (share - self.shares[index]).max(0.0) * self.costs[index];
        }
        self.shares[index] = share;
    }

    /// Share of all updates that are there.
    pub fn share(&self) -> f64 {
        let all: f64 = self.costs.iter().sum();
        if all > 0.0 { 1.0 - self.left() / all } else { 1.0 }
    }

    fn left(&self) -> f64 {
        let left = |index: usize| match self.states[index] {
            State::Waiting | State::Running(_) | State::Elsewhere => {
                (1.0 - self.shares[index]) * self.costs[index]
            }
            _ => 0.0,
        };
        (0..self.states.len()).map(left).sum()
    }

    /// Seconds left at the speed of the last `elapsed` seconds, once that is known.
    pub fn remaining(&self, elapsed: f64) -> Option<f64> {
        (self.done > 0.0 && elapsed > 0.0).then(|| self.left() * elapsed / self.done)
    }

    /// Number of runs in each state that occurs: `42 finished, 2 running, 66 waiting`.
    pub fn counts(&self) -> String {
        let names = [
            "finished",
            "there already",
            "running",
            "running elsewhere",
            "waiting",
            "failed",
            "stopped",
        ];
        let place = |state: &State| match state {
            State::Finished => 0,
            State::Reused => 1,
            State::Running(_) => 2,
            State::Elsewhere => 3,
            State::Waiting => 4,
            State::Failed(_) => 5,
            State::Stopped => 6,
        };
        let parts: Vec<String> = names
            .iter()
            .enumerate()
            .map(|(index, name)| {
                (self.states.iter().filter(|state| place(state) == index).count(), name)
            })
            .filter(|(count, _)| *count > 0)
            .map(|(count, name)| format!("{} {name}", text::grouped(count as u64)))
            .collect();
        parts.join(", ")
    }

    /// Counts and time left.
    pub fn line(&self, elapsed: f64) -> String {
        let mut line = self.counts();
        if let Some(seconds) = self.remaining(elapsed).filter(|seconds| *seconds > 0.0) {
            let _ = write!(line, "; {} left", text::seconds(seconds));
        }
        line
    }

    /// One character for every run in the order of the plan: `#` finished, `=` there already, `1` to `9` running
    /// with so many tenths done, `~` elsewhere, `.` waiting, `x` failed, `-` stopped. Empty for very many runs.
    pub fn picture(&self) -> String {
        if self.states.len() > MOST_DRAWN {
            return String::new();
        }
        let sign = |(index, state): (usize, &State)| match state {
            State::Finished => '#',
            State::Reused => '=',
            State::Running(_) => {
                char::from_digit((10.0 * self.shares[index]).clamp(0.0, 9.0) as u32, 10)
                    .unwrap_or('0')
            }
            State::Elsewhere => '~',
            State::Waiting => '.',
            State::Failed(_) => 'x',
            State::Stopped => '-',
        };
        self.states.iter().enumerate().map(sign).collect()
    }
}
