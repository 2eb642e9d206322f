//! Which runs a sweep consists of; every one is checked before the first starts.

use crate::address::{Address, address};
use crate::cost::Cost;
use crate::design::{MOST_RUNS, points};
use crate::{ConstraintCheck, Sweep, Unfit};
use rayon::prelude::*;
use sphcut_sph::{Setup, Simulation};
use std::collections::BTreeSet;
use std::fmt;

/// The runs of a sweep.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepPlan {
    /// Those that are to be run, in the order of the design.
    pub runs: Vec<PlannedRun>,
    /// Those that a constraint leaves out.
    pub left_out: Vec<LeftOutRun>,
    /// What the scenarios warn of, with the number of runs that do.
    pub warnings: Vec<(String, usize)>,
}

impl SweepPlan {
    fn warn(&mut self, text: String) {
        match self.warnings.iter_mut().find(|(known, _)| *known == text) {
            Some((_, runs)) => *runs += 1,
            None => self.warnings.push((text, 1)),
        }
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// Place in the design, from 1.
    pub number: usize,
    /// A value for every axis, as it is written into the scenario.
    pub values: Vec<String>,
    /// Its numbers in SI, for those that are numbers.
    pub numbers: Vec<Option<f64>>,
    /// Speed, thickness and width, of a cut.
    pub condition: Option<CutSize>,
    /// Name of the workpiece's material.
    pub material: String,
    /// Where its result is kept.
    pub address: Address,
    /// What it will take.
    pub cost: Cost,
}

/// The conditions of a cut in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutSize {
    /// v_c.
    pub cutting_speed: f64,
    /// h.
    pub uncut_chip_thickness: f64,
    /// b.
    pub width_of_cut: f64,
}

impl CutSize {
    fn of(setup: &Setup) -> Option<Self> {
        let velocity = setup.tool.as_ref()?.velocity;
        Some(Self {
            cutting_speed: velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
            uncut_chip_thickness: setup.uncut_chip_thickness?,
            width_of_cut: setup.width_of_cut,
        })
    }
}

/// A combination that is not run.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutRun {
    /// Its keys with their values.
    pub settings: String,
    /// The constraint that it breaks.
    pub constraint: String,
}

/// Why a sweep cannot run.
#[derive(Debug, Clone, PartialEq)]
pub enum PlanError {
    /// More runs than can be kept apart.
    TooMany(usize),
    /// Combinations that make no scenario.
    Unfit(Vec<Unfit>),
    /// A scenario in which nothing can be run: settings and reason.
    Unready(String, String),
    /// The constraints leave nothing.
    Nothing(Vec<LeftOutRun>),
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooMany(runs) => {
                write!(
                    f,
                    "the sweep has {runs} runs; {MOST_RUNS} are the most (65536 of a Sobol sequence)"
                )
            }
            Self::Unfit(unfit) => {
                for one in unfit.iter().take(3) {
                    writeln!(f, "with {}:", one.settings)?;
                    for problem in &one.problems {
                        writeln!(f, "{problem}")?;
                    }
                }
                write!(
                    f,
                    "{} combinations of values make no scenario; nothing was run",
                    unfit.len()
                )
            }
            Self::Unready(settings, reason) => write!(f, "with {settings}: {reason}"),
            Self::Nothing(left_out) => match left_out.first() {
                Some(first) => write!(
                    f,
                    "the constraints leave none of {} combinations; the first breaks `{}`",
                    left_out.len(),
                    first.constraint
                ),
                None => write!(f, "the sweep has no runs"),
            },
        }
    }
}

impl std::error::Error for PlanError {}

/// What became of a combination.
enum Checked {
    Run(PlannedRun, Vec<String>),
    Out(LeftOutRun),
    Unfit(Unfit),
    Unready(String, String),
}

/// Resolves and checks every run of `sweep`; on all threads of the present pool.
///
/// # Errors
/// See [`PlanError`].
pub fn plan(sweep: &Sweep) -> Result<SweepPlan, PlanError> {
    planned(sweep, |_| true)
}

/// As [`plan`], but only the runs with these numbers; the others are not even read.
///
/// # Errors
/// See [`PlanError`].
pub fn plan_only(sweep: &Sweep, numbers: &BTreeSet<usize>) -> Result<SweepPlan, PlanError> {
    planned(sweep, |number| numbers.contains(&number))
}

fn planned(sweep: &Sweep, wanted: impl Fn(usize) -> bool) -> Result<SweepPlan, PlanError> {
    let points = points(sweep).map_err(PlanError::TooMany)?;
    let points: Vec<(usize, Vec<String>)> =
        (1..).zip(points).filter(|(number, _)| wanted(*number)).collect();
    let checked: Vec<Checked> =
        points.into_par_iter().map(|(number, point)| check(sweep, number, point)).collect();
    let (mut plan, mut unfit) = (SweepPlan::default(), Vec::new());
    for one in checked {
        match one {
            Checked::Run(run, warnings) => {
                plan.runs.push(run);
                warnings.into_iter().for_each(|warning| plan.warn(warning));
            }
            Checked::Out(left_out) => plan.left_out.push(left_out),
            Checked::Unfit(mistakes) => unfit.push(mistakes),
            Checked::Unready(settings, reason) => return Err(PlanError::Unready(settings, reason)),
        }
    }
    if !unfit.is_empty() {
        return Err(PlanError::Unfit(unfit));
    }
    if plan.runs.is_empty() {
        return Err(PlanError::Nothing(plan.left_out));
    }
    Ok(plan)
}

fn check(sweep: &Sweep, number: usize, values: Vec<String>) -> Checked {
    let words: Vec<&str> = values.iter().map(String::as_str).collect();
    let scenario = match sweep.scenario(&words) {
        Ok(scenario) => scenario,
        Err(unfit) => return Checked::Unfit(unfit),
    };
    let settings = sweep.settings(&words);
    if let ConstraintCheck::No(constraint) = sweep.held(&scenario) {
        return Checked::Out(LeftOutRun { settings, constraint });
    }
    let estimate = match Simulation::new(scenario.setup.clone()) {
        Ok(simulation) => simulation.estimate(),
        Err(error) => return Checked::Unready(settings, error.to_string()),
    };
    let numbers = sweep.axes.iter().map(|axis| axis.number(&scenario)).collect();
    let cost = Cost::new(&scenario, &estimate);
    let (condition, address) = (CutSize::of(&scenario.setup), address(&scenario));
    let material =
        scenario.setup.materials.first().map_or_else(String::new, |first| first.name.clone());
    let run = PlannedRun { number, numbers, condition, material, address, cost, values };
    Checked::Run(run, scenario.warnings)
}
