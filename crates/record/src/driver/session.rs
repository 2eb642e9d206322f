//! One call of [`super::run`]: the loop over the steps and what is saved when.

use super::{Control, Moment, Progress, RunOptions, Source, Stepper};
use crate::files::partial::{Partial, SavedSnapshots};
use crate::files::{self, RunBody, RunFiles};
use crate::{
    Facts, Outcome, Performance, Provenance, Run, RunError, Samples, SnapshotInfo, Snapshots,
    resources,
};
use sphcut_sph::{CheckpointState, Diverged, StepReport};
use std::time::{Duration, Instant};

/// Wall-clock time between two calls at [`Moment::Clock`].
const CALL_INTERVAL: Duration = Duration::from_millis(100);

/// A run being computed and recorded.
pub(super) struct Session<'a, S: Source> {
    pub(super) source: &'a S,
    pub(super) provenance: &'a Provenance,
    pub(super) facts: Facts,
    pub(super) options: &'a RunOptions,
    pub(super) files: RunFiles,
    pub(super) partial: Partial,
    pub(super) stepper: S::Stepper,
    pub(super) samples: Samples,
    pub(super) snapshots: Vec<SnapshotInfo>,
    /// Numbers of the snapshots whose files were damaged when the run was taken up.
    pub(super) lost: Vec<usize>,
    pub(super) meter: Meter,
}

/// Measures what the run takes.
pub(super) struct Meter {
    /// Before this process took the run up.
    earlier: Performance,
    start: Instant,
    start_cpu: Option<f64>,
    start_step: u64,
    start_time: f64,
}

/// Why the loop ended.
enum End {
    Reached(Outcome),
    Diverged(Diverged),
}

impl Meter {
    pub(super) fn start<S: Stepper>(stepper: &S, earlier: Performance) -> Self {
        Self {
            earlier,
            start: Instant::now(),
            start_cpu: resources::cpu_seconds(),
            start_step: stepper.steps(),
            start_time: stepper.time(),
        }
    }

    fn wall_seconds(&self) -> f64 {
        self.earlier.wall_seconds + self.start.elapsed().as_secs_f64()
    }

    fn cpu_seconds(&self) -> Option<f64> {
        let here = resources::cpu_seconds()? - self.start_cpu?;
        // Of a run resumed from another platform only the later part would be known: say nothing.
        let earlier = if self.earlier.steps == 0 { Some(0.0) } else { self.earlier.cpu_seconds };
        Some(here + earlier?)
    }
}

impl<S: Source> Session<'_, S> {
    /// Steps to the end and puts the record together.
    pub(super) fn run(
        mut self,
        control: &mut dyn FnMut(&Progress) -> Control,
    ) -> Result<Run, RunError> {
        let end = self.step_to_end(control).map_err(|error| error.keeping(&self.kept()))?;
        let saved = self.write_end(&end).map_err(|error| error.keeping(&self.kept()))?;
        self.deliver(end, saved)
    }

    fn step_to_end(
        &mut self,
        control: &mut dyn FnMut(&Progress) -> Control,
    ) -> Result<End, RunError> {
        let mut last_call = Instant::now();
        let mut last_checkpoint = Instant::now();
        // A run interrupted at a sample has not been judged there yet.
        if !self.samples.is_empty()
            && let Some(end) = self.consult(Moment::Sample, control)
        {
            return Ok(End::Reached(end));
        }
        while !self.stepper.is_finished() {
            if self.snapshot_is_due() {
                self.save_snapshot()?;
            }
            let report = match self.stepper.step() {
                Ok(report) => report,
                Err(diverged) => return Ok(End::Diverged(diverged)),
            };
            if let Some(end) = self.take_sample(report, control)? {
                return Ok(End::Reached(end));
            }
            if last_call.elapsed() >= CALL_INTERVAL {
                last_call = Instant::now();
                if let Some(end) = self.consult(Moment::Clock, control) {
                    return Ok(End::Reached(end));
                }
            }
            if last_checkpoint.elapsed() >= self.options.checkpoint_interval {
                self.save_checkpoint()?;
                last_checkpoint = Instant::now();
            }
        }
        Ok(End::Reached(Outcome::Finished))
    }

    fn take_sample(
        &mut self,
        report: StepReport,
        control: &mut dyn FnMut(&Progress) -> Control,
    ) -> Result<Option<Outcome>, RunError> {
        let Some(sample) = report.sample else { return Ok(None) };
        self.partial.append(self.samples.len(), &sample)?;
        self.samples.push(&sample);
        Ok(self.consult(Moment::Sample, control))
    }

    /// Asks the caller whether to go on; tells how the run ends if not.
    fn consult(
        &self,
        moment: Moment,
        control: &mut dyn FnMut(&Progress) -> Control,
    ) -> Option<Outcome> {
        match (control(&self.progress(moment)), moment) {
            (Control::Interrupt, _) => Some(Outcome::Interrupted),
            (Control::Stop, Moment::Sample) => Some(Outcome::Steady),
            (Control::Stop, Moment::Clock) | (Control::Continue, _) => None,
        }
    }

    fn progress(&self, moment: Moment) -> Progress<'_> {
        let (time, step) = (self.stepper.time(), self.stepper.steps());
        let elapsed = self.meter.start.elapsed().as_secs_f64();
        let particles = self.stepper.particle_count();
        let updates = particles as f64 * (step - self.meter.start_step) as f64;
        let advanced = time - self.meter.start_time;
        let speed = self.facts.cutting_speed();
        Progress {
            moment,
            step,
            time,
            travel: speed * self.facts.cutting_time(time),
            end_time: self.facts.end_time,
            end_travel: speed * self.facts.cutting_time(self.facts.end_time),
            particles,
            facts: &self.facts,
            samples: &self.samples,
            updates_per_second: if elapsed > 0.0 { updates / elapsed } else { 0.0 },
            wall_seconds: self.meter.wall_seconds(),
            remaining_seconds: (advanced > 0.0)
                .then(|| (self.facts.end_time - time).max(0.0) * elapsed / advanced),
        }
    }

    /// Snapshots are due at evenly spaced times; which one a time belongs to depends on that time
    /// alone, so that a resumed run takes the same ones.
    fn snapshot_is_due(&self) -> bool {
        let Some(intervals) = self.options.snapshots.checked_sub(1).filter(|n| *n > 0) else {
            return false;
        };
        let slot = |time: f64| (time / self.facts.end_time * f64::from(intervals)).floor();
        let last = self.snapshots.last();
        last.is_none_or(|last| slot(self.stepper.time()) > slot(last.time))
    }

    fn save_snapshot(&mut self) -> Result<(), RunError> {
        let snapshot = self.stepper.snapshot();
        self.partial.save_snapshot(self.snapshots.len(), &snapshot)?;
        self.snapshots.push(SnapshotInfo::of(&snapshot));
        Ok(())
    }

    /// The snapshot at the end of the run, unless one was just taken or none are wanted.
    fn save_last_snapshot(&mut self) -> Result<(), RunError> {
        let step = self.stepper.steps();
        if self.options.snapshots == 0 || self.snapshots.last().is_some_and(|s| s.step == step) {
            return Ok(());
        }
        self.save_snapshot()
    }

    fn save_checkpoint(&self) -> Result<(), RunError> {
        let (performance, state) = (self.performance(), self.stepper.checkpoint());
        let body = self.body(&performance, &Outcome::Interrupted, &state);
        self.partial.save_checkpoint(&body, &self.snapshots)
    }

    fn body<'b>(
        &'b self,
        performance: &'b Performance,
        outcome: &'b Outcome,
        state: &'b CheckpointState,
    ) -> RunBody<'b> {
        RunBody {
            provenance: self.provenance,
            facts: &self.facts,
            samples: &self.samples,
            performance,
            outcome,
            state: Some(state),
        }
    }

    fn performance(&self) -> Performance {
        let peaks = [resources::peak_memory_bytes(), self.meter.earlier.peak_memory_bytes];
        Performance {
            particles: self.stepper.particle_count(),
            steps: self.stepper.steps(),
            wall_seconds: self.meter.wall_seconds(),
            cpu_seconds: self.meter.cpu_seconds(),
            peak_memory_bytes: peaks.into_iter().flatten().max(),
            threads: self.options.threads,
        }
    }

    /// Saves what the end of the loop leaves and puts the record together.
    fn write_end(&mut self, end: &End) -> Result<Run, RunError> {
        let outcome = match end {
            End::Reached(outcome) => outcome.clone(),
            End::Diverged(diverged) => Outcome::Diverged(diverged.clone()),
        };
        if let End::Diverged(diverged) = end {
            self.go_back_before(diverged)?;
        }
        if outcome == Outcome::Interrupted {
            self.save_checkpoint()?;
        } else {
            self.save_last_snapshot()?;
        }
        let (performance, state) = (self.performance(), self.stepper.checkpoint());
        let saved = self.saved_snapshots();
        let mut provenance = self.provenance.clone();
        provenance.warnings.extend(saved.loss());
        let body = RunBody { provenance: &provenance, ..self.body(&performance, &outcome, &state) };
        files::assemble(&self.files, &self.partial, &body, &saved, self.options.export)?;
        Ok(Run {
            provenance,
            facts: self.facts.clone(),
            samples: std::mem::take(&mut self.samples),
            snapshots: Snapshots::in_file(self.files.record(), saved.index()),
            performance,
            outcome,
        })
    }

    fn saved_snapshots(&self) -> SavedSnapshots {
        let numbered = self.snapshots.iter().copied().enumerate();
        let whole = numbered.filter(|(number, _)| !self.lost.contains(number)).collect();
        SavedSnapshots { whole, lost: self.lost.clone() }
    }

    /// A simulation that diverged is of no further use. Its last good state is computed once more
    /// from the last checkpoint: the same steps give the same bits.
    fn go_back_before(&mut self, diverged: &Diverged) -> Result<(), RunError> {
        let checkpoint = self.partial.checkpoint(self.provenance)?;
        let mut stepper = match &checkpoint {
            Some(saved) => self.source.restore(&saved.state)?,
            None => self.source.start()?,
        };
        while stepper.steps() + 1 < diverged.step {
            stepper.step().map_err(|earlier| RunError::Damaged {
                path: self.files.partial(),
                reason: format!(
                    "the run {diverged}, but repeated from its checkpoint it {earlier}"
                ),
            })?;
        }
        self.stepper = stepper;
        Ok(())
    }

    /// The record is on disk: what the unfinished run had saved is not needed any more.
    fn deliver(self, end: End, run: Run) -> Result<Run, RunError> {
        drop(self.partial);
        if run.outcome != Outcome::Interrupted {
            files::partial::remove(&self.files)?;
        }
        if let End::Diverged(diverged) = end {
            let record = self.files.record();
            return Err(RunError::Diverged { divergence: diverged, record });
        }
        Ok(run)
    }

    /// What a run that cannot go on leaves, in words for the user.
    fn kept(&self) -> String {
        format!(
            "`{}` keeps {} samples, {} snapshots and {}; go on with --resume when the cause is \
             removed",
            self.files.partial().display(),
            self.samples.len(),
            self.snapshots.len(),
            if self.partial.has_checkpoint() { "the last checkpoint" } else { "no checkpoint yet" }
        )
    }
}
