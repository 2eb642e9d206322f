//! From a file name to a scenario, and to the threads that compute it.

use crate::common_arguments::{PatchableArguments, ScenarioArguments};
use crate::failure::{ExitCode, Failure};
use crate::terminal::note;
use sphcut_diagnose::DiagnosisFile;
use sphcut_identify::Identification;
use sphcut_input::{Colours, Mistake, OutsideFiles, Problem};
use sphcut_record::{Provenance, Run, RunFiles, Setting, has_checksums};
use sphcut_recordings::RecordingPlan;
use sphcut_scenario::{LoadOptions, Scenario, ScenarioPatch};
use sphcut_sweep::Sweep;
use std::io::IsTerminal;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// More only wait for each other.
const MOST_THREADS_PER_CORE: usize = 4;

/// Reads, patches and checks the scenario.
pub fn scenario(arguments: &PatchableArguments) -> Result<Scenario, Failure> {
    let file = &arguments.file;
    sphcut_scenario::load(&file.scenario, &patched_options(arguments)?)
        .map_err(|problems| refused_patched(arguments, &problems))
}

/// Reads and checks a file of recordings.
pub fn recordings(arguments: &ScenarioArguments) -> Result<RecordingPlan, Failure> {
    sphcut_recordings::load_recordings(&arguments.scenario, options(arguments).outside_files)
        .map_err(|problems| refused(arguments, &problems))
}

/// Reads and checks a file of material tests.
pub fn identification(arguments: &ScenarioArguments) -> Result<Identification, Failure> {
    sphcut_identify::load_identification(&arguments.scenario, options(arguments).outside_files)
        .map_err(|problems| refused(arguments, &problems))
}

/// Reads and checks a file of a diagnosis.
pub fn diagnosis(arguments: &ScenarioArguments) -> Result<DiagnosisFile, Failure> {
    sphcut_diagnose::load_diagnosis_file(&arguments.scenario, &options(arguments))
        .map_err(|problems| refused(arguments, &problems))
}

/// Reads and checks a file of a sweep, its scenario patched.
pub fn sweep(arguments: &PatchableArguments) -> Result<Sweep, Failure> {
    let file = &arguments.file;
    sphcut_sweep::load_sweep(&file.scenario, &patched_options(arguments)?)
        .map_err(|problems| refused_patched(arguments, &problems))
}

/// Reads and checks `text` as if it stood in the file of the scenario.
pub fn varied(arguments: &ScenarioArguments, text: &str) -> Result<Scenario, Failure> {
    let path = &arguments.scenario;
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let directory = parent.unwrap_or(Path::new("."));
    let shown = path.display().to_string();
    sphcut_scenario::parse(text, &shown, Some(directory), &options(arguments))
        .map_err(|problems| refused(arguments, &problems))
}

/// What the files of a scenario may read.
pub fn options(arguments: &ScenarioArguments) -> LoadOptions {
    let outside_files =
        if arguments.allow_outside { OutsideFiles::Allowed } else { OutsideFiles::Refused };
    LoadOptions { outside_files, patch: None }
}

/// The same with the patch.
fn patched_options(arguments: &PatchableArguments) -> Result<LoadOptions, Failure> {
    let Some(path) = &arguments.patch else { return Ok(options(&arguments.file)) };
    let patch = ScenarioPatch::read(path).map_err(|problems| {
        let unreadable = problems.iter().any(|p| matches!(p.mistake, Mistake::File { .. }));
        let code = if unreadable { ExitCode::InputOutput } else { ExitCode::BadInput };
        let pages: Vec<String> = problems.iter().map(|p| p.render(colours())).collect();
        Failure::rendered(code, pages.join("\n\n"))
    })?;
    Ok(LoadOptions { patch: Some(Arc::new(patch)), ..options(&arguments.file) })
}

fn colours() -> Colours {
    if std::io::stderr().is_terminal() { Colours::Terminal } else { Colours::Plain }
}

/// All mistakes, each with its place, and their number.
fn refused(arguments: &ScenarioArguments, problems: &[Problem]) -> Failure {
    let colours = colours();
    let mut pages: Vec<String> = problems.iter().map(|problem| problem.render(colours)).collect();
    if problems.len() > 1 {
        let name = arguments.scenario.display();
        pages.push(format!("{} mistakes in `{name}`; nothing was run", problems.len()));
    }
    // A scenario that is not there is an unreadable file, not a mistake inside one.
    let unreadable = !arguments.scenario.exists()
        || problems.iter().all(|problem| is_unreadable(arguments, problem));
    let code = if unreadable { ExitCode::InputOutput } else { ExitCode::BadInput };
    Failure::rendered(code, pages.join("\n\n"))
}

/// The same of a patched scenario: the lines shown are those after the patch.
fn refused_patched(arguments: &PatchableArguments, problems: &[Problem]) -> Failure {
    let failure = refused(&arguments.file, problems);
    match &arguments.patch {
        Some(patch) => failure
            .advise(format!("lines are those of the scenario as `{}` patches it", patch.display())),
        None => failure,
    }
}

/// Whether the scenario file itself could not be read.
fn is_unreadable(arguments: &ScenarioArguments, problem: &Problem) -> bool {
    let shown = arguments.scenario.display().to_string();
    matches!(&problem.mistake, Mistake::File { path, .. } if *path == shown)
}

/// Where the results of `scenario` come from.
pub fn provenance(scenario: &Scenario) -> Provenance {
    let settings = scenario.description.iter().map(|entry| Setting {
        section: entry.section.clone(),
        key: entry.key.clone(),
        text: entry.text.clone(),
        value: entry.value.clone(),
        unit: entry.unit.to_owned(),
    });
    Provenance {
        scenario_text: scenario.text.clone(),
        scenario_name: scenario.name.clone(),
        title: scenario.title.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        seed: scenario.setup.seed,
        effects: scenario.effects.clone(),
        settings: settings.collect(),
        warnings: scenario.warnings.clone(),
    }
}

/// The run in `folder`; says so where its record cannot be verified.
pub fn run(folder: &Path) -> Result<Run, Failure> {
    let record = RunFiles::in_dir(folder).record();
    let explain = |error| Failure::of_run(&error, folder);
    let run = Run::load(&record).map_err(explain)?;
    if !has_checksums(&record).map_err(explain)? {
        note(&not_verified(&record));
    }
    Ok(run)
}

/// What is said of a file from before there were checksums.
pub fn not_verified(path: &Path) -> String {
    format!(
        "note: `{}` was written before there were checksums; it cannot be verified",
        path.display()
    )
}

/// The number of threads asked for, or that of the cores.
pub fn threads(wanted: Option<NonZeroUsize>) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    wanted.map_or_else(cores, NonZeroUsize::get)
}

/// The pool on which the solver works.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    let most = MOST_THREADS_PER_CORE * self::threads(None);
    if threads > most {
        let message =
            format!("{threads} threads are more than the {most} this machine is good for");
        return Err(Failure::input(message).advise("leave out --threads: one per core is used"));
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::output(format!("cannot start {threads} threads"), &error))
}
