//! One record of a cut: from channels to forces.

use super::detection::{self, Detection, Span};
use super::raw::{RawTable, TimeSource};
use super::spectrum::{Peak, RevolutionLine, Spectrum, without_revolution};
use super::zero::{self, ZeroLine, combine};
use super::{Fault, LowPass, NotSteady, Response};
use sphcut_physics::Channel;
use sphcut_postprocess::statistics::mean;
use sphcut_postprocess::steady::{
    Examination, MINIMUM_CORRELATION_LENGTHS, examine, mean_interval, t_quantile,
};

/// A channel of the record.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceChannel {
    /// What it measures.
    pub component: Channel,
    /// Its name in the file.
    pub name: String,
    /// Force in N that the number 1 of the file means.
    pub scale: f64,
    /// End of the range in N, if known: values at or beyond it are clipped.
    pub full_scale: Option<f64>,
    /// Frequency response to be undone.
    pub response: Option<Response>,
}

/// What to do with a cut that is not steady.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unsteady {
    /// It gives no force.
    #[default]
    Refuse,
    /// It gives a force, with a warning.
    Keep,
}

/// How records are evaluated. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluationSettings {
    /// The clock of the files.
    pub time: TimeSource,
    /// The forces; the cutting force is among them.
    pub channels: Vec<ForceChannel>,
    /// Name of the trigger channel.
    pub trigger: Option<String>,
    /// How the cut is found.
    pub detection: Detection,
    /// Time in s next to entry and exit that is neither air nor cut.
    pub guard: f64,
    /// Shortest air cut in s.
    pub shortest_air: f64,
    /// Order and cut-off in Hz.
    pub low_pass: Option<(usize, f64)>,
    /// Wanted half width of the 95 % interval as a share of the mean.
    pub precision: f64,
    /// Largest drift over the window that may remain possible, as a share of the mean.
    pub largest_drift: f64,
    /// What to do with a cut that is not steady.
    pub unsteady: Unsteady,
}

/// What is known of one cut. SI units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Conditions {
    /// What the user calls it.
    pub name: String,
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// b in m.
    pub width_of_cut: Option<f64>,
    /// Revolutions per second.
    pub revolution: Option<f64>,
    /// Place in the order of the experiments.
    pub order: u32,
    /// Time of the experiment in s, from any zero.
    pub time: Option<f64>,
    /// Entry and exit in s from the start of the record, if given.
    pub given: Option<[f64; 2]>,
}

/// One component of a cut.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentResult {
    /// Which.
    pub component: Channel,
    /// Mean force in N.
    pub mean: f64,
    /// Half width of its 95 % interval: correlation of the force and error of the zero.
    pub ci95: f64,
    /// Standard error of the mean in N.
    pub standard_error: f64,
    /// Standard deviation of the force in the window in N, after the low-pass.
    pub deviation: f64,
    /// Correlation time in s.
    pub correlation_time: f64,
    /// The zero line that was taken out.
    pub zero: ZeroLine,
    /// Force in N over the record, zero taken out, response undone, low-pass applied.
    pub force: Vec<f64>,
    /// Density of the force in the window, before response and low-pass.
    pub spectrum: Spectrum,
    /// The line of the revolution.
    pub revolution: Option<RevolutionLine>,
    /// Resonances.
    pub resonances: Vec<Peak>,
}

/// A record of a cut, evaluated as far as its faults allow.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CutResult {
    /// What is known of the cut.
    pub conditions: Conditions,
    /// Everything the user has to know.
    pub faults: Vec<Fault>,
    /// Samples per second; 0 if the record has no clock.
    pub rate: f64,
    /// Cut in the record.
    pub span: Option<Span>,
    /// Samples of the steady window.
    pub window: Option<Span>,
    /// The components; empty if there is no cut.
    pub components: Vec<ComponentResult>,
    /// Whether it counts.
    pub accepted: bool,
}

impl CutResult {
    /// One component.
    #[must_use]
    pub fn component(&self, component: Channel) -> Option<&ComponentResult> {
        self.components.iter().find(|found| found.component == component)
    }
}

/// Equal extreme samples in a row that are no chance.
const CLIPPED_RUN: usize = 5;
/// Share of the force beyond which a change of the zero is told.
const LARGE_DRIFT: f64 = 0.05;
/// Fewest revolutions over which run-out averages out.
const FEWEST_REVOLUTIONS: f64 = 2.0;
/// Shortest window in samples.
const SHORTEST_WINDOW: usize = 20;

/// Evaluates one record.
#[must_use]
pub fn evaluate_cut(
    table: &RawTable,
    settings: &EvaluationSettings,
    conditions: &Conditions,
) -> CutResult {
    let mut result = CutResult { conditions: conditions.clone(), ..CutResult::default() };
    match follow(table, settings, &mut result) {
        Ok(()) => {}
        Err(faults) => result.faults.extend(faults),
    }
    let unsteady = |fault: &Fault| matches!(fault, Fault::Unsteady { .. });
    result.accepted = !result.components.is_empty()
        && !result.faults.iter().any(|fault| {
            fault.refuses() || (settings.unsteady == Unsteady::Refuse && unsteady(fault))
        });
    result
}

fn follow(
    table: &RawTable,
    settings: &EvaluationSettings,
    result: &mut CutResult,
) -> Result<(), Vec<Fault>> {
    let mut names: Vec<&str> = settings.channels.iter().map(|c| c.name.as_str()).collect();
    names.extend(settings.trigger.as_deref());
    let mut channels = table.channels(&names, &settings.time)?;
    result.rate = channels.rate;
    result.faults.append(&mut channels.faults);
    let rate = channels.rate;
    let low_pass = low_pass(settings, rate).map_err(|fault| vec![fault])?;
    let forces: Vec<Vec<f64>> = settings
        .channels
        .iter()
        .zip(&channels.values)
        .map(|(channel, values)| values.iter().map(|v| v * channel.scale).collect())
        .collect();
    let clipped: Vec<Fault> = settings
        .channels
        .iter()
        .zip(&forces)
        .filter_map(|(channel, force)| clipping(channel, force, rate))
        .collect();
    result.faults.extend(clipped);
    let trigger = settings.trigger.as_ref().and_then(|_| channels.values.last());
    let span = find_cut(&forces, trigger, settings, &result.conditions, rate)
        .map_err(|fault| vec![fault])?;
    result.span = Some(span);
    let samples = forces[0].len();
    let guard = (settings.guard * rate).round() as usize;
    let shortest = (settings.shortest_air * rate).ceil() as usize;
    let air = zero::air(span, samples, guard, shortest, rate).map_err(|fault| vec![fault])?;
    if span.entry == 0 {
        result.faults.push(Fault::BeginsInCut);
    }
    if span.exit >= samples {
        result.faults.push(Fault::EndsInCut);
    }
    if air.iter().any(Option::is_none) {
        result.faults.push(Fault::DriftUnknown);
    }
    let prepared: Vec<Prepared> = settings
        .channels
        .iter()
        .zip(forces)
        .map(|(channel, force)| Prepared::new(channel, force, air, rate, low_pass.as_ref()))
        .collect();
    let inside = Span { entry: span.entry, exit: span.exit.saturating_sub(guard).max(span.entry) };
    let window = steady_window(&prepared, inside, settings, result);
    result.window = Some(window);
    for part in prepared {
        let name = part.name.clone();
        let finished = part.finish(window, rate, result.conditions.revolution);
        result.faults.extend(judge(&finished, &name));
        result.components.push(finished);
    }
    Ok(())
}

/// The filter, and whether the responses reach as far as it lets pass.
fn low_pass(settings: &EvaluationSettings, rate: f64) -> Result<Option<LowPass>, Fault> {
    let passes = settings.low_pass.map_or(0.5 * rate, |(_, cut_off)| cut_off);
    for channel in &settings.channels {
        let Some(response) = &channel.response else { continue };
        // A rate fitted to time stamps has rounding in it.
        if response.highest() < passes * (1.0 - 1e-9) {
            let (highest, channel) = (response.highest(), channel.name.clone());
            return Err(Fault::ResponseTooShort { channel, highest, needed: passes });
        }
    }
    let Some((order, cut_off)) = settings.low_pass else { return Ok(None) };
    LowPass::new(order, cut_off, rate).map(Some).ok_or(Fault::LowPassTooHigh { cut_off, rate })
}

/// Samples at the end of the range; without a known range, extreme values that repeat exactly.
fn clipping(channel: &ForceChannel, force: &[f64], rate: f64) -> Option<Fault> {
    let found = |level: f64, start: usize, samples: usize| Fault::Clipped {
        channel: channel.name.clone(),
        level,
        start: start as f64 / rate,
        samples,
    };
    if let Some(limit) = channel.full_scale {
        let beyond = |value: &&f64| value.abs() >= limit * (1.0 - 1e-9);
        let samples = force.iter().filter(beyond).count();
        let start = force.iter().position(|value| beyond(&value))?;
        return Some(found(limit, start, samples));
    }
    let (low, high) =
        force.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    if low == high {
        return None;
    }
    [high, low].into_iter().find_map(|level| {
        let run = force.windows(CLIPPED_RUN).position(|w| w.iter().all(|v| *v == level))?;
        let samples = force.iter().filter(|v| **v == level).count();
        Some(found(level, run, samples))
    })
}

fn find_cut(
    forces: &[Vec<f64>],
    trigger: Option<&Vec<f64>>,
    settings: &EvaluationSettings,
    conditions: &Conditions,
    rate: f64,
) -> Result<Span, Fault> {
    let samples = forces[0].len();
    if let Some([entry, exit]) = conditions.given {
        let index = |time: f64| ((time * rate).round().max(0.0) as usize).min(samples);
        return Ok(Span { entry: index(entry), exit: index(exit) });
    }
    let cutting = settings.channels.iter().position(|c| c.component == Channel::CuttingForce);
    let cutting = cutting.unwrap_or(0);
    match (&settings.detection, trigger) {
        (Detection::Trigger { level }, Some(trigger)) => detection::triggered(trigger, *level),
        (Detection::Automatic { smoothing }, _) => {
            let pause = conditions.revolution.map_or(0.0, |revolution| 1.0 / revolution);
            detection::automatic(&forces[cutting], rate, *smoothing, pause).map_err(|fault| {
                match fault {
                    Fault::WrongSign { mean, .. } => {
                        Fault::WrongSign { channel: settings.channels[cutting].name.clone(), mean }
                    }
                    other => other,
                }
            })
        }
        _ => Err(Fault::NoCut { levels: [f64::NAN; 2] }),
    }
}

/// A channel with its zero taken out.
struct Prepared {
    component: Channel,
    name: String,
    zero: ZeroLine,
    /// Zero taken out, nothing else.
    plain: Vec<f64>,
    /// Response undone, low-pass applied.
    force: Vec<f64>,
}

impl Prepared {
    fn new(
        channel: &ForceChannel,
        mut plain: Vec<f64>,
        air: [Option<(usize, usize)>; 2],
        rate: f64,
        low_pass: Option<&LowPass>,
    ) -> Self {
        let zero = zero::zero_line(&plain, air);
        plain.iter_mut().enumerate().for_each(|(k, value)| *value -= zero.at(k as f64));
        let undone = channel.response.as_ref().map(|response| response.invert(&plain, rate));
        let force = undone.unwrap_or_else(|| plain.clone());
        let force = low_pass.map_or_else(|| force.clone(), |filter| filter.zero_phase(&force));
        let name = channel.name.clone();
        Self { component: channel.component, name, zero, plain, force }
    }

    /// Mean, interval and spectrum over `window`. Over whole revolutions run-out is no part of the error
    /// of the mean: the interval is that of the force without it.
    fn finish(self, window: Span, rate: f64, revolution: Option<f64>) -> ComponentResult {
        let part = &self.force[window.entry..window.exit];
        let interval = mean_interval(&without(part, rate, revolution), None);
        let middle = 0.5 * (window.entry + window.exit) as f64;
        let (zero_error, zero_freedom) = self.zero.error_at(middle);
        let own = (interval.standard_error, interval.degrees_of_freedom);
        let (standard_error, freedom) = combine(&[own, (zero_error, zero_freedom)]);
        let ci95 = t_quantile(0.975, freedom) * standard_error;
        let average = mean(part);
        let count = part.len() as f64;
        let squares: f64 = part.iter().map(|v| (v - average).powi(2)).sum();
        let plain = &self.plain[window.entry..window.exit];
        let spectrum = Spectrum::welch(plain, rate);
        ComponentResult {
            component: self.component,
            mean: average,
            ci95,
            standard_error,
            deviation: (squares / (count - 1.0).max(1.0)).sqrt(),
            correlation_time: interval.correlation_samples / rate,
            revolution: revolution.and_then(|r| spectrum.revolution(plain, rate, r)),
            resonances: spectrum.resonances(revolution),
            zero: self.zero,
            force: self.force,
            spectrum,
        }
    }
}

/// The force without the oscillation of the revolution, where that is known.
fn without(force: &[f64], rate: f64, revolution: Option<f64>) -> Vec<f64> {
    match revolution {
        Some(revolution) => without_revolution(force, rate, revolution),
        None => force.to_vec(),
    }
}

/// The steady window of all channels together: from where the last of them has run in to the end of the
/// cut, in whole revolutions where these are known; what is left over is dropped at the beginning.
fn steady_window(
    channels: &[Prepared],
    inside: Span,
    settings: &EvaluationSettings,
    result: &mut CutResult,
) -> Span {
    let (rate, conditions) = (result.rate, &result.conditions);
    let tested = || channels.iter().filter(|c| c.component != Channel::PassiveForce);
    let part = |channel: &Prepared| channel.force[inside.entry..inside.exit].to_vec();
    let levels = tested().map(|channel| mean(&part(channel)).abs());
    // A small feed force need not be known better, in newtons, than the cutting force.
    let largest = levels.fold(f64::MIN_POSITIVE, f64::max);
    let mut first = 0;
    let mut faults = Vec::new();
    for channel in tested() {
        let force = without(&part(channel), rate, conditions.revolution);
        let found = examine(&force);
        first = first.max(found.first);
        if let Some(reason) = not_steady(&found, force.len(), largest, settings, rate) {
            faults.push(Fault::Unsteady { channel: channel.name.clone(), reason });
        }
    }
    let mut window = Span { entry: inside.entry + first, exit: inside.exit };
    if let Some(revolution) = conditions.revolution {
        let samples = (window.exit - window.entry) as f64;
        let revolutions = samples * revolution / rate;
        if revolutions < FEWEST_REVOLUTIONS {
            faults.push(Fault::FewRevolutions { revolutions });
        } else {
            let whole = (revolutions.floor() * rate / revolution).round() as usize;
            window.entry = window.exit.saturating_sub(whole).max(window.entry);
        }
    }
    if window.exit - window.entry < SHORTEST_WINDOW {
        faults.push(Fault::TooFewSamples { samples: window.exit - window.entry });
    }
    result.faults.extend(faults);
    window
}

/// The first of the tests that fails. All are tests of equivalence: what is asked is that the opposite
/// can be excluded, so a short or noisy record fails rather than passes.
fn not_steady(
    found: &Examination,
    samples: usize,
    largest: f64,
    settings: &EvaluationSettings,
    rate: f64,
) -> Option<NotSteady> {
    if 2 * found.first > samples {
        return Some(NotSteady::RunIn { time: found.first as f64 / rate });
    }
    let times = (samples - found.first) as f64 / found.mean.correlation_samples;
    if times < MINIMUM_CORRELATION_LENGTHS {
        return Some(NotSteady::Correlated { times, needed: MINIMUM_CORRELATION_LENGTHS });
    }
    let possible = (found.drift.abs() + found.drift_half_width) / largest;
    if possible.is_nan() || possible > settings.largest_drift {
        return Some(NotSteady::Drift {
            found: found.drift / largest,
            possible,
            allowed: settings.largest_drift,
        });
    }
    let share = found.mean.half_width / largest;
    (share > settings.precision)
        .then_some(NotSteady::Imprecise { share, wanted: settings.precision })
}

/// What the forces themselves give away.
fn judge(found: &ComponentResult, name: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    let (channel, mean) = (name.to_owned(), found.mean);
    if mean + found.ci95 < 0.0 {
        match found.component {
            Channel::CuttingForce => {
                faults.push(Fault::WrongSign { channel: channel.clone(), mean });
            }
            Channel::FeedForce => {
                faults.push(Fault::NegativeFeed { channel: channel.clone(), mean })
            }
            _ => {}
        }
    }
    if let Some(drift) = found.zero.drift().filter(|drift| drift.abs() > LARGE_DRIFT * mean.abs()) {
        faults.push(Fault::LargeDrift { channel, drift, mean });
    }
    faults
}
