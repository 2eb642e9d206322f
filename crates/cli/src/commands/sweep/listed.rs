//! Runs that a command lists, through a store like any sweep.

use super::{local, tables};
use crate::failure::Failure;
use crate::progress::OutputStyle;
use crate::{files, interrupt, terminal};
use sphcut_physics::Channel;
use sphcut_sweep::{Execution, Retry, State, Store, Sweep, SweepRow, SweepTable};
use std::path::PathBuf;

/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// mm in m.
const MM: f64 = 1e-3;

/// Where runs and their results go.
pub struct RunPlace {
    /// Folder of table and page.
    pub folder: PathBuf,
    /// Folder of the store.
    pub store: PathBuf,
    /// Threads of all runs together.
    pub threads: usize,
    /// What is missing is written as a sweep for elsewhere, and nothing is computed.
    pub only_list: bool,
    /// The patch of the scenario, which that sweep needs as well.
    pub patch: Option<PathBuf>,
}

/// What became of the runs.
pub enum ListedRuns {
    /// The rows with a result.
    Finished(Vec<SweepRow>),
    /// The user stopped them, or they are to be computed elsewhere; the same command goes on.
    Stopped,
}

/// The file of the sweep in its folder.
const FILE: &str = "runs.toml";

/// Computes what the store does not have, or lists it for elsewhere, and writes table and page; tells what stopped it.
pub fn compute(sweep: &Sweep, place: &RunPlace) -> Result<ListedRuns, Failure> {
    let plan = local::planned(sweep, place.threads)?;
    files::create_folder(&place.folder)?;
    let store = Store::create(&place.store)?;
    local::note_needs(&store, &place.folder, &plan)?;
    interrupt::install();
    let is_there = |address| store.entry(address).ok().flatten().is_some();
    let left = plan.runs.iter().filter(|run| !is_there(&run.address)).count();
    if place.only_list && left > 0 {
        list(sweep, place, (plan.runs.len(), left))?;
        return Ok(ListedRuns::Stopped);
    }
    if left > 0 {
        terminal::note(&format!(
            "{}: {} runs of the particle solver, {left} of them to be computed (results in {})",
            sweep.title,
            plan.runs.len(),
            place.store.display()
        ));
    }
    let execution = Execution { threads: place.threads, retry: Retry::Never };
    let style = if left > 0 { OutputStyle::Human } else { OutputStyle::Quiet };
    let states = local::run((sweep, None), &plan, &store, execution, style)?;
    tables::write(&place.folder, sweep, &plan, &store, (&states, &[]))?;
    if states.iter().any(|state| matches!(state, State::Stopped)) {
        terminal::note("interrupted: checkpoints are written; the same command goes on");
        return Ok(ListedRuns::Stopped);
    }
    let table = SweepTable::new(sweep, &plan, &store, &states, &tables::summary);
    let failed = states.iter().filter(|state| matches!(state, State::Failed(_))).count();
    if failed > 0 {
        terminal::note(&format!("{failed} of the runs failed; it goes on without them"));
    }
    Ok(ListedRuns::Finished(table.rows.into_iter().filter(SweepRow::has_result).collect()))
}

/// The sweep as a file that `sphcut sweep` takes, here or on a cluster, with the store where the results are looked for.
fn list(sweep: &Sweep, place: &RunPlace, (runs, left): (usize, usize)) -> Result<(), Failure> {
    let base = files::absolute(sweep.base_path())?;
    let file = place.folder.join(FILE);
    files::save(&file, sweep.file_text(&base).as_bytes())?;
    // The base lies outside the folder of this file.
    let mut command = format!(
        "sphcut sweep {} --out {} --store {} --allow-outside",
        file.display(),
        place.folder.display(),
        place.store.display()
    );
    if let Some(patch) = &place.patch {
        command += &format!(" --patch {}", patch.display());
    }
    terminal::line(&format!("{}: {runs} runs, {left} of them to be computed", sweep.title));
    terminal::report(
        &file,
        &format!("`{command}`, on a cluster with `--executor slurm`; then the same command again"),
    );
    Ok(())
}

/// Means and their standard deviations, SI units. A run in the plane has no passive force.
pub fn means(row: &SweepRow) -> [Option<(f64, Option<f64>)>; Channel::RECORDED.len()] {
    let number = |name: &str| row.summary.get(name).copied();
    let force = |place: usize| {
        let [mean, half] = row.forces[place]?;
        (mean != 0.0).then_some((mean, Some(half / NORMAL_95)))
    };
    Channel::RECORDED.map(|channel| match channel {
        Channel::CuttingForce => force(0),
        Channel::FeedForce => force(1),
        Channel::PassiveForce => force(2),
        Channel::InterfaceTemperature => {
            let half = number("temperature.interface_ci95_k");
            Some((number("temperature.interface_mean_k")?, half.map(|half| half / NORMAL_95)))
        }
        Channel::ChipThickness => Some((number("chip.thickness_mm")? * MM, None)),
        Channel::ContactLength => Some((number("interface.contact_length_mm")? * MM, None)),
        _ => None,
    })
}
