//! A sweep becomes a job array.

use super::super::arguments::{Executor, SweepArguments};
use super::super::{local, tables};
use super::collect;
use super::submitted::{state, tasks};
use crate::failure::{ExitCode, Failure};
use crate::files::absolute;
use crate::progress::{OutputStyle, emit};
use crate::{program, terminal, text};
use serde_json::json;
use sphcut_sweep::Sweep;
use sphcut_sweep::slurm::{
    self, JobRequest, Script, Submission, Task, TaskRun, array_script, collecting_script,
};
use sphcut_sweep::{State, Store, SweepPlan};
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::Path;

/// Options of the cluster that make no sense here.
pub fn check_options(arguments: &SweepArguments) -> Result<(), Failure> {
    if arguments.executor == Executor::Local {
        let slurms = !arguments.slurm_option.is_empty() || arguments.at_once.is_some();
        return if slurms {
            Err(Failure::input("--slurm-option and --at-once need --executor slurm"))
        } else {
            Ok(())
        };
    }
    if arguments.time_limit.is_some() {
        return Err(Failure::input("--time-limit is for runs on this machine; see --slurm-option"));
    }
    if arguments.task_minutes == 0 {
        return Err(Failure::input("--task-minutes has to be 1 at least"));
    }
    let unfit = arguments.slurm_option.iter().find_map(|option| slurm::refused_option(option));
    if let Some(reason) = unfit {
        return Err(Failure::input(reason));
    }
    // A machine that is none of a cluster is told before anything is written.
    if arguments.dry_run { Ok(()) } else { Ok(slurm::is_possible()?) }
}

/// How the missing runs become tasks.
struct Array {
    tasks: Vec<Task>,
    request: JobRequest,
    /// Different runs of the plan.
    runs: usize,
    /// Those with a result.
    there: usize,
    /// Those that are known to fail, and are not tried again.
    failing: usize,
}

fn arranged(
    arguments: &SweepArguments,
    plan: &SweepPlan,
    store: Option<&Store>,
    speed: f64,
) -> Result<Array, Failure> {
    let (mut seen, mut wanted) = (BTreeSet::new(), Vec::new());
    let (mut there, mut failing) = (0, 0);
    for (at, run) in plan.runs.iter().enumerate() {
        if !seen.insert(run.address) {
            continue;
        }
        match store.map_or(Ok(State::Stopped), |store| state(store, &run.address))? {
            State::Reused => there += 1,
            State::Failed(_) if !arguments.retry_failed => failing += 1,
            _ => wanted.push(at),
        }
    }
    let task_seconds = 60.0 * f64::from(arguments.task_minutes);
    let tasks = slurm::deal(&plan.runs, &wanted, speed, (task_seconds, slurm::most_tasks()));
    let threads = arguments.threads.map_or(1, NonZeroUsize::get);
    let request = slurm::request(&tasks, &plan.runs, speed, threads);
    Ok(Array { tasks, request, runs: seen.len(), there, failing })
}

impl Array {
    /// `9 tasks of 12 to 13 runs, each with 1 processor, 300 MiB and at most 40 min`.
    fn told(&self) -> String {
        let counts = || self.tasks.iter().map(|task| task.runs.len());
        let (least, most) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
        let runs = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        format!(
            "{} task{} of {runs} run{}, each with {} processor{}, {} MiB and at most {} min",
            text::grouped(self.tasks.len() as u64),
            plural(self.tasks.len()),
            plural(most),
            self.request.threads,
            plural(self.request.threads),
            self.request.mebibytes,
            text::grouped(self.request.minutes),
        )
    }
}

/// What a submission would ask for.
pub fn announced(
    arguments: &SweepArguments,
    plan: &SweepPlan,
    speed: f64,
) -> Result<String, Failure> {
    let root = arguments.store_folder();
    let store = if root.exists() { Some(Store::open(&root)?) } else { None };
    let array = arranged(arguments, plan, store.as_ref(), speed)?;
    Ok(format!("on Slurm: {}; {} runs there already\n", array.told(), array.there))
}

/// Submits what is missing.
pub fn submit(
    arguments: &SweepArguments,
    sweep: &Sweep,
    plan: &SweepPlan,
    store: &Store,
    style: OutputStyle,
) -> Result<ExitCode, Failure> {
    tables::measured(arguments.measured.as_deref())?;
    refuse_second(&arguments.folder())?;
    if arguments.retry_failed {
        for run in &plan.runs {
            store.forget_failure(&run.address)?;
        }
    }
    let speed = local::speed(sweep, plan)?;
    let array = arranged(arguments, plan, Some(store), speed)?;
    let mut submission = recorded(arguments, sweep, store, &array)?;
    if array.tasks.is_empty() {
        say(style, "nothing to submit: every run has its result, or is known to fail");
        return collect::write(&submission, (sweep, plan, store));
    }
    submission.folder = Submission::prepare(&submission.out)?;
    let sent = send(arguments, sweep, &mut submission, &shares(&array, plan), array.request);
    if let Err(failure) = sent {
        // Nothing of it is left in the queue.
        let _ = std::fs::remove_dir_all(&submission.folder);
        return Err(failure);
    }
    tell(arguments, sweep, &submission, &array, style);
    Ok(ExitCode::Done)
}

/// Two arrays for the same folder would wait for each other.
fn refuse_second(out: &Path) -> Result<(), Failure> {
    let Some(earlier) = Submission::last(out)? else {
        return Ok(());
    };
    let queued = tasks(&earlier)?;
    let living = queued.iter().filter(|task| task.is_alive()).count();
    if living == 0 {
        return Ok(());
    }
    let (shown, array) = (out.display(), earlier.array.unwrap_or(0));
    let verb = if living == 1 { "task is" } else { "tasks are" };
    Err(Failure::input(format!("{living} {verb} in the queue already (array {array})"))
        .advise(format!("`sphcut sweep status {shown}` tells how far they are, `sphcut sweep cancel {shown}` ends them")))
}

/// The record before the cluster has answered.
fn recorded(
    arguments: &SweepArguments,
    sweep: &Sweep,
    store: &Store,
    array: &Array,
) -> Result<Submission, Failure> {
    let measured = arguments.measured.as_deref().map(absolute).transpose()?;
    Ok(Submission {
        sweep: absolute(&arguments.scene.file.scenario)?,
        allow_outside: arguments.scene.file.allow_outside,
        patch: arguments.scene.patch.as_deref().map(absolute).transpose()?,
        title: sweep.title.clone(),
        out: absolute(&arguments.folder())?,
        store: store.root().to_owned(),
        measured,
        runs: array.runs,
        there: array.there,
        failing: array.failing,
        threads: array.request.threads,
        tasks: array.tasks.len(),
        ..Submission::default()
    })
}

fn shares(array: &Array, plan: &SweepPlan) -> Vec<TaskRun> {
    let of = |(index, task): (usize, &Task)| {
        let share = |at: &usize| {
            let run = &plan.runs[*at];
            TaskRun {
                task: index + 1,
                run: run.number,
                address: run.address,
                updates: run.cost.updates(),
            }
        };
        task.runs.iter().map(share).collect::<Vec<_>>()
    };
    array.tasks.iter().enumerate().flat_map(of).collect()
}

/// Hands array and collecting job to the cluster.
fn send(
    arguments: &SweepArguments,
    sweep: &Sweep,
    submission: &mut Submission,
    shares: &[TaskRun],
    request: JobRequest,
) -> Result<(), Failure> {
    let words = program::words()
        .map_err(|error| Failure::output("cannot find the program itself", &error))?;
    let [program] = words.as_slice() else {
        return Err(Failure::input("a job of a cluster runs the program `sphcut` itself")
            .advise("submit it with the program that `cargo install --path crates/cli` makes"));
    };
    let script = Script {
        program: program.into(),
        folder: submission.folder.clone(),
        name: sweep.name.clone(),
        tasks: submission.tasks,
        at_once: arguments.at_once.map(NonZeroUsize::get),
        request,
        options: arguments.slurm_option.clone(),
    };
    let kept = |submission: &Submission| submission.write().map_err(Failure::from);
    let put = |submission: &Submission, name, text: String| {
        submission.write_script(name, &text).map_err(Failure::from)
    };
    let mut paths = [&script.program, &script.folder, &submission.out].into_iter();
    if let Some(reason) = paths.find_map(|path| slurm::refused_path(path)) {
        return Err(Failure::input(reason));
    }
    submission.write_shares(shares)?;
    let array = put(submission, "array.sh", array_script(&script))?;
    let collecting = put(submission, "collect.sh", collecting_script(&script, &submission.out))?;
    // Before the first task can start.
    kept(submission)?;
    let number = slurm::submit(&array, None)?;
    submission.array = Some(number);
    let after = kept(submission)
        .and_then(|()| slurm::submit(&collecting, Some(number)).map_err(Failure::from));
    match after {
        Ok(job) => {
            submission.collecting = Some(job);
            kept(submission)
        }
        Err(failure) => {
            let _ = slurm::cancel(&[number]);
            Err(failure)
        }
    }
}

fn say(style: OutputStyle, text: &str) {
    if style == OutputStyle::Human {
        terminal::line(text);
    }
}

fn tell(
    arguments: &SweepArguments,
    sweep: &Sweep,
    submission: &Submission,
    array: &Array,
    style: OutputStyle,
) {
    let (number, job) = (submission.array.unwrap_or(0), submission.collecting.unwrap_or(0));
    if style == OutputStyle::Json {
        return emit(&json!({
            "event": "submitted",
            "title": sweep.title,
            "runs": array.runs,
            "there": array.there,
            "failing": array.failing,
            "tasks": array.tasks.len(),
            "array": number,
            "collecting": job,
            "minutes": array.request.minutes,
            "memory_mib": array.request.mebibytes,
            "threads": array.request.threads,
            "folder": submission.folder,
        }));
    }
    let folder = arguments.folder();
    let shown = folder.display();
    say(
        style,
        &format!(
            "{}: {} runs, {} there already\narray {number}: {}\njob {job} writes table and page when they have \
             ended\n`sphcut sweep status {shown}` tells how far they are",
            sweep.title,
            text::grouped(array.runs as u64),
            text::grouped(array.there as u64),
            array.told(),
        ),
    );
}
