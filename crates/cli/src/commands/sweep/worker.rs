//! Computes each run of a sweep in a process of its own: one that aborts, or that the system ends, ends no other.
//!
//! The process gets the text of the scenario by standard input, after a line with its length, and stops with a checkpoint
//! when that is closed; so it does when the sweep ends in whatever way. It answers by lines of JSON.

use super::one::PROGRESS;
use crate::{interrupt, program};
use serde_json::Value;
use sphcut_scenario::Scenario;
use sphcut_sweep::{Computed, Sweep, Trouble, Watch, Worker};
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// What a program in Rust ends with after a panic.
const PANIC: i32 = 101;

/// Computes runs until the user stops it.
#[derive(Debug)]
pub struct Apart<'a> {
    /// Whose runs.
    pub sweep: &'a Sweep,
    /// Most wall-clock time of a run.
    pub time_limit: Option<Duration>,
}

impl Worker for Apart<'_> {
    fn compute(
        &self,
        scenario: &Scenario,
        folder: &Path,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Computed, Trouble> {
        let passing = |error: io::Error| Trouble::Passing(format!("its process: {error}"));
        let mut child = self.start(folder, threads).map_err(passing)?;
        let mut input = child.stdin.take();
        if let Some(input) = &mut input {
            // A process that has ended already says below why.
            let _ = write!(input, "{}\n{}", scenario.text.len(), scenario.text);
        }
        let mut ended = None;
        for line in child.stdout.take().into_iter().flat_map(|out| BufReader::new(out).lines()) {
            let line = serde_json::from_str::<Value>(&line.map_err(passing)?);
            match line.as_ref().map(|line| (line[PROGRESS].as_f64(), line)) {
                Ok((Some(share), line)) => watch(share, line["remaining"].as_f64()),
                Ok((None, line)) => ended = outcome(line),
                Err(_) => {}
            }
            if self.stopping() {
                input = None;
            }
        }
        drop(input);
        let status = child.wait().map_err(passing)?;
        ended.unwrap_or_else(|| {
            Err(if status.code() == Some(PANIC) {
                Trouble::Lasting("sphcut has a bug: the run panicked".to_owned())
            } else {
                Trouble::Passing(format!("its process ended with {status}"))
            })
        })
    }

    fn stopping(&self) -> bool {
        interrupt::requested()
    }
}

impl Apart<'_> {
    fn start(&self, folder: &Path, threads: usize) -> io::Result<Child> {
        let words = program::words()?;
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]).args(["sweep", "one"]).arg(self.sweep.base_path()).arg(folder);
        command.arg(threads.to_string());
        if self.sweep.reads_outside() {
            command.arg("--allow-outside");
        }
        if let Some(limit) = self.time_limit {
            command.arg("--time-limit").arg((limit.as_secs_f64() / 60.0).to_string());
        }
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()
    }
}

/// What the last line of the process says.
fn outcome(line: &Value) -> Option<Result<Computed, Trouble>> {
    let text = |key: &str| line[key].as_str().map(str::to_owned);
    let number = |key: &str| line[key].as_u64();
    Some(match line["ended"].as_str()? {
        "finished" => Ok(Computed::Finished {
            particles: usize::try_from(number("particles")?).ok()?,
            steps: number("steps")?,
            wall_seconds: line["wall_s"].as_f64()?,
        }),
        "interrupted" => Ok(Computed::Interrupted),
        "failed" => Err(Trouble::Lasting(text("reason")?)),
        _ => Err(Trouble::Passing(text("reason")?)),
    })
}
