//! From the record of a run to the numbers an engineer asks for.

use crate::balances::{self, HeatBalance};
use crate::forces::{Force, Forces, SteadyWindow};
use crate::known::KnownForce;
use crate::missing::Missing;
use crate::result::{Extremes, ParticleResolution, PassResult, ProcessResult, StressBin};
use crate::space;
use crate::springback::{self, SpringbackError};
use crate::steady::{Series, SteadyOptions, SteadyState, detect, window_mean};
use crate::temperature::temperatures;
use crate::{checks, geometry};
use sphcut_record::{Facts, Run, RunError, Samples};
use sphcut_sph::ChannelId;
use std::ops::Range;

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
    let passes: Vec<PassResult> = ranges.into_iter().enumerate().map(of_pass).collect();
    // What the particles show is measured where the tool meets a surface that no pass has cut.
    let first_pass = run.first_pass();
    let cut = first_pass.as_ref().unwrap_or(run);
    let cut_window = passes.first().map_or(&window, |pass| &pass.window);
    let mut result = ProcessResult {
        laws: run.provenance.effects.clone(),
        criterion: *criterion,
        feed_steady: verdict(ChannelId::FeedForce, &last, feed_criterion),
        feed_known: KnownForce::feed(samples, &window, &last, &run.facts, &forces.feed),
        forces,
        geometry: match cut.facts.dimension {
            2 => geometry::measure(cut, cut_window)?,
            _ => space::measure(cut, cut_window)?,
        },
        passes,
        residual_stress: Err(Missing::NoCut),
        temperature: temperatures(samples, &last, criterion),
        extremes: extremes(samples),
        energy: balances::energy(samples, &run.facts),
        momentum: balances::momentum(samples, window.first_sample),
        heat: balances::heat(samples, &run.facts).map(|heat| HeatBalance {
            friction_share: run.provenance.number("heat", "friction_heat_share"),
            ..heat
        }),
        resolution: resolution(&run.facts),
        performance: run.performance,
        warnings: Vec::new(),
        steady,
        window,
    };
    result.residual_stress = residual_stress(run, &result)?;
    result.warnings = checks::warnings(run, &result);
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
        Err(SpringbackError::NoCut) => Err(Missing::NoCut),
        Err(SpringbackError::NoSnapshots) => Err(Missing::NoSnapshots),
        Err(reason) => Err(Missing::Surface(reason.to_string())),
    })
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
    run.provenance.number("stop.steady", key)
}

/// The samples of each pass that the run has come to, where there are several: those whose interval
/// ends within the pass.
fn passes(run: &Run) -> Vec<Range<usize>> {
    let time = run.samples.channel(ChannelId::Time);
    let ranges = run.facts.passes.iter().map(|pass| {
        let before = time.partition_point(|time| pass.begins_from(*time));
        before..time.partition_point(|time| pass.ends_from(*time))
    });
    ranges.filter(|range| !range.is_empty()).collect()
}

fn window(
    samples: &Samples,
    steady: &SteadyState,
    range: &Range<usize>,
    facts: &Facts,
) -> SteadyWindow {
    let first_sample = steady.first_sample.min(range.start + range.len() / 2);
    // A sample is the mean over the interval that begins with the sample before.
    let before = |id: ChannelId| {
        first_sample.checked_sub(1).and_then(|k| samples.channel(id).get(k)).copied().unwrap_or(0.0)
    };
    SteadyWindow {
        first_sample,
        last_sample: range.end,
        start: before(ChannelId::Travel),
        end: samples.channel(ChannelId::Travel)[range.clone()].last().copied().unwrap_or(0.0),
        start_time: before(ChannelId::Time),
        drift_per_width: steady.drift * facts.force_factor() / facts.width_of_cut,
    }
}

fn forces(samples: &Samples, window: &SteadyWindow, range: &Range<usize>, facts: &Facts) -> Forces {
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

fn resolution(facts: &Facts) -> ParticleResolution {
    let across = |length: Option<f64>| length.map(|length| length / facts.particle_spacing);
    ParticleResolution {
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
