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
}

/// Computes what the store does not have, writes table and page, and gives the rows with a result; `None` if the user stopped
/// it: the same command goes on.
pub fn compute(sweep: &Sweep, place: &RunPlace) -> Result<Option<Vec<SweepRow>>, Failure> {
    let plan = local::planned(sweep, place.threads)?;
    files::create_folder(&place.folder)?;
    let store = Store::create(&place.store)?;
    local::note_needs(&store, &place.folder, &plan)?;
    interrupt::install();
    let is_there = |address| store.entry(address).ok().flatten().is_some();
    let left = plan.runs.iter().filter(|run| !is_there(&run.address)).count();
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
        return Ok(None);
    }
    let table = SweepTable::new(sweep, &plan, &store, &states, &tables::summary);
    let failed = states.iter().filter(|state| matches!(state, State::Failed(_))).count();
    if failed > 0 {
        terminal::note(&format!("{failed} of the runs failed; it goes on without them"));
    }
    Ok(Some(table.rows.into_iter().filter(SweepRow::has_result).collect()))
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
