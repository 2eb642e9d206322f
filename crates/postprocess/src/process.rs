//! From the record of a run to the numbers an engineer asks for.

use crate::balances::{self, EnergyBalance, HeatBalance, MomentumBalances};
use crate::geometry::{self, Geometry};
use crate::known::KnownForce;
use crate::missing::Missing;
use crate::springback::{self, SpringbackError, StressBin};
use crate::steady::{Series, SteadyOptions, SteadyState, detect, window_mean};
use crate::temperature::{Temperatures, temperatures};
use crate::warnings::{self, Warning};
use sphcut_record::{Facts, Outcome, Performance, Run, RunError, Samples};
use sphcut_sph::ChannelId;
use std::ops::Range;

/// What a run says about the process.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessResult {
    /// The laws and effects that acted: kind, and name with its parameters where it is an effect.
    pub laws: Vec<(String, String)>,
    /// What counts as steady.
    pub criterion: SteadyOptions,
    /// Verdict on the cutting force.
    pub steady: SteadyState,
    /// Verdict on the feed force, by the criterion that the scenario has for it or by the same.
    pub feed_steady: SteadyState,
    /// What is known of the feed force over the window of the means.
    pub feed_known: KnownForce,
    /// Over which part of the run means are taken.
    pub window: Window,
    /// Mean forces of the tool on the workpiece.
    pub forces: Forces,
    /// Each pass of a run of several; verdict, window and forces above are those of the last of them.
    pub passes: Vec<PassResult>,
    /// Chip, contact and machined surface from the snapshots.
    pub geometry: Geometry,
    /// Residual stress below the machined surface against depth.
    pub residual_stress: Result<Vec<StressBin>, Missing>,
    /// Temperatures.
    pub temperature: Temperatures,
    /// Smallest and largest values over the run.
    pub extremes: Extremes,
    /// Energy at the end of the run; `None` for a run without samples.
    pub energy: Option<EnergyBalance>,
    /// Momentum over the window.
    pub momentum: Option<MomentumBalances>,
    /// Heat at the end of the run.
    pub heat: Option<HeatBalance>,
    /// How finely the cut is resolved.
    pub resolution: Resolution,
    /// What it took to compute.
    pub performance: Performance,
    /// What to keep in mind before the numbers are used, the most serious first.
    pub warnings: Vec<Warning>,
}

/// The part of the run (of several passes: of one) over which means are taken: the steady window, or
/// at most the later half where no steady state is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Index of the first sample.
    pub first_sample: usize,
    /// Index after the last sample.
    pub last_sample: usize,
    /// Travel in m at its start.
    pub start: f64,
    /// Travel in m at its end, which is that of the run or the pass.
    pub end: f64,
    /// Time in s at its start.
    pub start_time: f64,
    /// Drift of the cutting force over the steady window, from the slope of its batch means, per
    /// metre of width of cut in N/m.
    pub drift_per_width: f64,
}

/// One of several passes.
#[derive(Debug, Clone, PartialEq)]
pub struct PassResult {
    /// Counted from 1.
    pub number: usize,
    /// Verdict on the cutting force within the pass.
    pub steady: SteadyState,
    /// Over which part of the pass means are taken.
    pub window: Window,
    /// Mean forces of the tool on the workpiece.
    pub forces: Forces,
}

/// A force in N, with the half width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// Mean over the window in N.
    pub mean: f64,
    /// Half width of the 95 % interval in N; infinite where too few samples were taken.
    pub ci95: f64,
    /// The mean per metre of width of cut in N/m.
    pub mean_per_width: f64,
    /// The half width per metre of width of cut in N/m.
    pub ci95_per_width: f64,
}

/// Mean forces of the tool on the workpiece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forces {
    /// F_c.
    pub cutting: Force,
    /// F_f.
    pub feed: Force,
    /// F_p; zero in a plane run.
    pub passive: Force,
}

/// Smallest and largest values over the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// Largest equivalent plastic strain.
    pub max_plastic_strain: f64,
    /// Smallest density over initial density.
    pub min_density_ratio: f64,
    /// Largest density over initial density.
    pub max_density_ratio: f64,
    /// Smallest number of neighbours of any particle over the run.
    pub min_neighbours: f64,
}

/// How finely the cut is resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// dx in m.
    pub particle_spacing: f64,
    /// h / dx.
    pub across_chip_thickness: Option<f64>,
    /// r_n / dx.
    pub across_edge_radius: Option<f64>,
}

/// Evaluates a run by the criterion of its scenario (`[stop.steady]`), or by
/// [`SteadyOptions::for_chip_thickness`] where it has none.
///
/// # Errors
/// A snapshot of the record that cannot be read.
pub fn evaluate(run: &Run) -> Result<ProcessResult, RunError> {
    let criterion = criterion_of(run);
    let wanted = stated(run, "feed_relative_half_width");
    let feed = SteadyOptions {
        relative_half_width: wanted.unwrap_or(criterion.relative_half_width),
        ..criterion
    };
    evaluate_by(run, &criterion, &feed)
}

/// Evaluates a run by a criterion of one's own.
///
/// # Errors
/// As [`evaluate`].
pub fn evaluate_with(run: &Run, criterion: &SteadyOptions) -> Result<ProcessResult, RunError> {
    evaluate_by(run, criterion, criterion)
}

fn evaluate_by(
    run: &Run,
    criterion: &SteadyOptions,
    feed_criterion: &SteadyOptions,
) -> Result<ProcessResult, RunError> {
    let samples = &run.samples;
    let verdict = |id: ChannelId, range: &Range<usize>, criterion: &SteadyOptions| {
        let travel = &samples.channel(ChannelId::Travel)[range.clone()];
        let mut state =
            detect(Series { travel, force: &samples.channel(id)[range.clone()] }, criterion);
        state.first_sample += range.start;
        state
    };
    let of_pass = |(index, range): (usize, Range<usize>)| {
        let steady = verdict(ChannelId::CuttingForce, &range, criterion);
        let window = window(samples, &steady, &range, &run.facts);
        let forces = forces(samples, &window, &range, &run.facts);
        PassResult { number: index + 1, steady, window, forces }
    };
    let ranges = passes(run);
    let last = ranges.last().cloned().unwrap_or(0..samples.len());
    let PassResult { steady, window, forces, .. } = of_pass((0, last.clone()));
    let mut result = ProcessResult {
        laws: run.provenance.effects.clone(),
        criterion: *criterion,
        feed_steady: verdict(ChannelId::FeedForce, &last, feed_criterion),
        feed_known: KnownForce::feed(samples, &window, &last, &run.facts, &forces.feed),
        forces,
        passes: ranges.into_iter().enumerate().map(of_pass).collect(),
        geometry: geometry::measure(run, &window)?,
        residual_stress: Err(Missing::NoCut),
        temperature: temperatures(samples, &last, criterion),
        extremes: extremes(samples),
        energy: balances::energy(samples, &run.facts),
        momentum: balances::momentum(samples, window.first_sample),
        heat: balances::heat(samples, &run.facts).map(|heat| HeatBalance {
            friction_share: setting(run, "heat", "friction_heat_share"),
            ..heat
        }),
        resolution: resolution(&run.facts),
        performance: run.performance,
        warnings: Vec::new(),
        steady,
        window,
    };
    result.residual_stress = residual_stress(run, &result)?;
    result.warnings = warnings::collect(run, &result);
    Ok(result)
}

/// The profile that `sphcut springback` shows, or why there is none.
fn residual_stress(
    run: &Run,
    result: &ProcessResult,
) -> Result<Result<Vec<StressBin>, Missing>, RunError> {
    Ok(match springback::measure(run, result) {
        Ok(found) if found.stress.is_empty() => {
            Err(Missing::Surface("no material was found below the machined surface".to_owned()))
        }
        Ok(found) => Ok(found.stress),
        Err(SpringbackError::Record(error)) => return Err(error),
        Err(SpringbackError::SeveralPasses) => Err(Missing::SeveralPasses),
        Err(SpringbackError::NoCut) => Err(Missing::NoCut),
        Err(SpringbackError::NoSnapshots) => Err(Missing::NoSnapshots),
        Err(reason) => Err(Missing::Surface(reason.to_string())),
    })
}

impl ProcessResult {
    /// Whether the run is that of a cut: only then do forces, chip and steady state mean anything.
    #[must_use]
    pub fn is_cut(run: &Run) -> bool {
        run.facts.uncut_chip_thickness.is_some() && run.facts.tool_velocity.is_some()
    }

    /// Whether the run ended as intended.
    #[must_use]
    pub fn is_complete(run: &Run) -> bool {
        matches!(run.outcome, Outcome::Finished | Outcome::Steady)
    }
}

/// The criterion the scenario states, or the default.
fn criterion_of(run: &Run) -> SteadyOptions {
    // Without a chip there is no length to compare with: the whole travel then has to be steady.
    let default = SteadyOptions::for_chip_thickness(run.facts.uncut_chip_thickness.unwrap_or(0.0));
    SteadyOptions {
        relative_half_width: stated(run, "relative_half_width")
            .unwrap_or(default.relative_half_width),
        minimum_travel: stated(run, "minimum_travel").unwrap_or(default.minimum_travel),
    }
}

/// What the scenario states under `key` of its section `stop.steady`.
fn stated(run: &Run, key: &str) -> Option<f64> {
    setting(run, "stop.steady", key)
}

/// A number of the resolved scenario.
fn setting(run: &Run, section: &str, key: &str) -> Option<f64> {
    run.provenance
        .settings
        .iter()
        .find(|setting| setting.section == section && setting.key == key)
        .and_then(|setting| setting.value.parse::<f64>().ok())
}

/// The samples of each pass that the run has come to, where there are several: those whose interval
/// ends within the pass.
fn passes(run: &Run) -> Vec<Range<usize>> {
    let time = run.samples.channel(ChannelId::Time);
    // Sums of steps and of legs differ by rounding.
    let until = |end: f64| time.partition_point(|time| *time <= end * (1.0 + 1e-9));
    let ranges = run.facts.passes.iter().map(|pass| until(pass.start)..until(pass.end));
    ranges.filter(|range| !range.is_empty()).collect()
}

fn window(samples: &Samples, steady: &SteadyState, range: &Range<usize>, facts: &Facts) -> Window {
    let first_sample = steady.first_sample.min(range.start + range.len() / 2);
    // A sample is the mean over the interval that begins with the sample before.
    let before = |id: ChannelId| {
        first_sample.checked_sub(1).and_then(|k| samples.channel(id).get(k)).copied().unwrap_or(0.0)
    };
    Window {
        first_sample,
        last_sample: range.end,
        start: before(ChannelId::Travel),
        end: samples.channel(ChannelId::Travel)[range.clone()].last().copied().unwrap_or(0.0),
        start_time: before(ChannelId::Time),
        drift_per_width: steady.drift * facts.force_factor() / facts.width_of_cut,
    }
}

fn forces(samples: &Samples, window: &Window, range: &Range<usize>, facts: &Facts) -> Forces {
    let factor = facts.force_factor();
    let force = |id: ChannelId| {
        let interval =
            window_mean(&samples.channel(id)[range.clone()], window.first_sample - range.start);
        Force {
            mean: interval.mean * factor,
            ci95: interval.half_width * factor,
            mean_per_width: interval.mean * factor / facts.width_of_cut,
            ci95_per_width: interval.half_width * factor / facts.width_of_cut,
        }
    };
    Forces {
        cutting: force(ChannelId::CuttingForce),
        feed: force(ChannelId::FeedForce),
        passive: force(ChannelId::PassiveForce),
    }
}

fn extremes(samples: &Samples) -> Extremes {
    Extremes {
        max_plastic_strain: largest(samples.channel(ChannelId::MaxPlasticStrain)),
        min_density_ratio: smallest(samples.channel(ChannelId::MinDensityRatio)),
        max_density_ratio: largest(samples.channel(ChannelId::MaxDensityRatio)),
        min_neighbours: smallest(samples.channel(ChannelId::MinNeighbours)),
    }
}

fn resolution(facts: &Facts) -> Resolution {
    let across = |length: Option<f64>| length.map(|length| length / facts.particle_spacing);
    Resolution {
        particle_spacing: facts.particle_spacing,
        across_chip_thickness: across(facts.uncut_chip_thickness),
        across_edge_radius: across(facts.edge_radius),
    }
}

/// Largest value; 0 for none.
fn largest(values: &[f64]) -> f64 {
    values.iter().copied().reduce(f64::max).unwrap_or(0.0)
}

/// Smallest value; 0 for none.
fn smallest(values: &[f64]) -> f64 {
    values.iter().copied().reduce(f64::min).unwrap_or(0.0)
}
