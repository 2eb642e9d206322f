//! Where a mismatch lives in frequency and in time, from the force over time of each cut.
//!
//! The other modules of this crate read means. Here the records themselves are read, as `sphcut recordings` prepares them: on an even
//! clock, in newtons, zero taken out, without low-pass, with the window that is steady.
//!
//! 1. [`BroadBand`]: averaged periodogram, smooth background, chance of every bin.
//! 2. [`lines()`]: discoveries over all bins, channels and cuts, with frequency and amplitude.
//! 3. [`tracks()`]: lines of different cuts that belong together, and the law they follow: mains, one frequency, rotation, chip, chatter,
//!    or none of these; laws that these cuts cannot tell apart are not told apart.
//! 4. [`combs()`]: lines that are multiples of one frequency, as one finding; a stated frequency is recognised in a single record.
//! 5. [`over_time`]: trend and run-in within each cut, and what they go with; [`growth`]: what changes from cut to cut.
//! 6. [`false_alarms`]: the same steps on noise with nothing in it.
//!
//! Nothing here asks a model of the cut. Limits: `docs/diagnosis_method.md`.

mod advice;
mod combs;
mod error;
mod files;
mod laws;
mod lines;
mod null;
mod repeats;
mod spectrum;
#[cfg(test)]
mod tests;
mod time;
mod time_words;
mod tracks;
mod trend;
mod words;

pub use advice::{Advice, CutChange};
pub use combs::{Comb, CombBase, combs};
pub use error::SeriesError;
pub use files::{series_csv, series_json, trends_csv, with_series};
pub use laws::{Explanation, LineLaw, PITCH};
pub use lines::{FALSE_SHARE, SpectralLine, lines};
pub use null::false_alarms;
pub use repeats::{ForceGrowth, growth};
pub use spectrum::{BroadBand, LOWEST_BIN, effective_freedom};
pub use time::{OverTime, RunInLaw, over_time};
pub use time_words::time_words;
pub use tracks::{CutLine, Named, Track, tracks};
pub use trend::{RunIn, Trend, trends};
pub use words::{comb_words, hint, law_title, series_words, track_words};

use crate::check::self_test::Rate;
use sphcut_physics::Channel;
use sphcut_recordings::{ComponentResult, CutResult};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Segments without overlap that a cut should hold.
const SEGMENTS: f64 = 8.0;
/// Fewest averaged segments.
const FEWEST_SEGMENTS: usize = 8;
/// Longest segment in samples.
const LONGEST: f64 = 16_384.0;
/// A cut shorter than this share of the median one does not decide the resolution.
const SHORT: f64 = 0.5;
/// A line of the air is the one of the cut if it has this share of its amplitude.
const SAME_LINE: f64 = 0.5;

/// A force of a cut.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesChannel {
    /// Which.
    pub component: Channel,
    /// In N from entry to exit, both a guard away, zero taken out.
    pub force: Vec<f64>,
    /// Change of the zero from the air before to the air after the cut in N, its standard error and degrees of freedom; `None` with air on
    /// one side only.
    pub zero: Option<[f64; 3]>,
}

/// The forces of one cut over time. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesCut {
    /// What the user calls it.
    pub name: String,
    /// Cutting speed.
    pub cutting_speed: f64,
    /// Uncut chip thickness.
    pub uncut_chip_thickness: f64,
    /// Revolutions per second.
    pub revolution: Option<f64>,
    /// Samples per second.
    pub rate: f64,
    /// Place in the order of the experiments.
    pub order: u32,
    /// First sample of the steady window and the first behind it, in the forces.
    pub window: [usize; 2],
    /// The forces.
    pub channels: Vec<SeriesChannel>,
}

impl SeriesCut {
    /// Of an evaluated record, `guard` in s away from entry and exit; `None` if it has no cut.
    #[must_use]
    pub fn of(cut: &CutResult, guard: f64) -> Option<Self> {
        let (span, window) = (cut.span?, cut.window?);
        let guard = (guard * cut.rate).round() as usize;
        let (entry, exit) = (span.entry + guard, span.exit.checked_sub(guard)?);
        let to = window.exit.min(exit);
        let from = window.entry.max(entry).min(to);
        let channels = cut.components.iter().map(|c| {
            let force = c.force.get(entry..exit)?.to_vec();
            Some(SeriesChannel { component: c.component, force, zero: drift(c) })
        });
        Some(Self {
            name: cut.conditions.name.clone(),
            cutting_speed: cut.conditions.cutting_speed,
            uncut_chip_thickness: cut.conditions.uncut_chip_thickness,
            revolution: cut.conditions.revolution,
            rate: cut.rate,
            order: cut.conditions.order,
            window: [from.checked_sub(entry)?, to.checked_sub(entry)?],
            channels: channels.collect::<Option<_>>()?,
        })
    }

    /// Length of the steady window in s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        (self.window[1] - self.window[0]) as f64 / self.rate
    }
}

/// Change of the zero over the record, its standard error and degrees of freedom (the smaller of those of both levels).
fn drift(component: &ComponentResult) -> Option<[f64; 3]> {
    let (before, after) = (component.zero.before?, component.zero.after?);
    let error = before.standard_error.hypot(after.standard_error);
    let freedom = before.degrees_of_freedom.min(after.degrees_of_freedom);
    (error > 0.0).then_some([after.mean - before.mean, error, freedom])
}

/// The free-running machine: nothing is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct AirSeries {
    /// Samples per second.
    pub rate: f64,
    /// Revolutions per second.
    pub revolution: Option<f64>,
    /// In N, in the order of the channels of the cuts.
    pub forces: Vec<Vec<f64>>,
}

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesOptions {
    /// Width of a bin in Hz; from the length of the cuts if not stated.
    pub resolution: Option<f64>,
    /// Frequencies of the mains in Hz.
    pub mains: Vec<f64>,
    /// Natural frequencies that are known, in Hz.
    pub natural: Vec<f64>,
    /// Simulated sets of noise for the rate of false alarms.
    pub self_test: usize,
    /// Their seed.
    pub seed: u64,
    /// Whether there is a recording of the free-running machine; set by [`diagnose_series`].
    pub has_air: bool,
}

/// What is found.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesDiagnosis {
    /// The cuts.
    pub cuts: Vec<SeriesCut>,
    /// Width of a bin in Hz.
    pub resolution: f64,
    /// For each cut the spectra of its channels; none for a cut that is too short.
    pub spectra: Vec<Vec<BroadBand>>,
    /// Names of the cuts that are too short, and their lengths in s.
    pub too_short: Vec<(String, f64)>,
    /// Spectra of the free-running machine and their lines.
    pub air: Vec<(BroadBand, Vec<SpectralLine>)>,
    /// Bins that were tested.
    pub tests: usize,
    /// Lines of all cuts.
    pub lines: Vec<CutLine>,
    /// Lines that belong together, and what they follow.
    pub tracks: Vec<Track>,
    /// Lines that are multiples of one frequency.
    pub combs: Vec<Comb>,
    /// Least pitch of a segmented chip over h that every cut could show, and the least that any could.
    pub visible_pitch: [f64; 2],
    /// Whether the rotation of every cut is known.
    pub knows_rotation: bool,
    /// The share of simulated sets of noise with a line in them.
    pub false_alarms: Option<Rate>,
    /// What changes within the cuts, by force.
    pub time: Vec<OverTime>,
    /// What changes from cut to cut.
    pub growth: Vec<ForceGrowth>,
    /// The share of simulated sets of noise with a trend or a run-in in them.
    pub time_false_alarms: Option<Rate>,
}

impl SeriesDiagnosis {
    /// The tracks that belong to no comb, each with its number.
    pub fn single_tracks(&self) -> impl Iterator<Item = (usize, &Track)> {
        let in_comb = |number: usize| {
            self.combs.iter().any(|comb| comb.members.iter().any(|(k, _)| *k == number))
        };
        self.tracks.iter().enumerate().filter(move |(number, _)| !in_comb(*number))
    }

    /// The combs of stated frequencies.
    pub fn stated_combs(&self) -> impl Iterator<Item = &Comb> {
        self.combs.iter().filter(|comb| !matches!(comb.base, CombBase::Track(_)))
    }
}

/// Looks for lines in the cuts and for what they follow.
///
/// # Errors
/// See [`SeriesError`].
pub fn diagnose_series(
    cuts: Vec<SeriesCut>,
    air: Option<&AirSeries>,
    options: &SeriesOptions,
) -> Result<SeriesDiagnosis, SeriesError> {
    let options = SeriesOptions { has_air: air.is_some(), ..options.clone() };
    let slowest = cuts.iter().map(|cut| cut.rate).fold(f64::INFINITY, f64::min);
    if let Some(&frequency) = options.natural.iter().find(|f| **f >= 0.5 * slowest) {
        return Err(SeriesError::BeyondNyquist { frequency, nyquist: 0.5 * slowest });
    }
    let resolution = resolution(&cuts, &options)?;
    let mut too_short = Vec::new();
    let spectra: Vec<Vec<BroadBand>> = cuts
        .iter()
        .map(|cut| {
            let own = of_cut(cut, resolution);
            if own.is_empty() {
                too_short.push((cut.name.clone(), cut.duration()));
            }
            own
        })
        .collect();
    if spectra.iter().all(Vec::is_empty) {
        return Err(none_fits(&cuts, resolution, slowest));
    }
    let of_air = air_spectra(air, resolution)?;
    let mut all: Vec<BroadBand> = spectra.iter().flatten().cloned().collect();
    all.extend(of_air.iter().cloned());
    let tests = all.iter().map(|s| s.chances.len()).sum();
    let mut found = lines(&all).into_iter();
    let per_cut: Vec<Vec<Vec<SpectralLine>>> =
        spectra.iter().map(|own| found.by_ref().take(own.len()).collect()).collect();
    let air_lines: Vec<(BroadBand, Vec<SpectralLine>)> = of_air.into_iter().zip(found).collect();
    let mut merged: Vec<CutLine> = per_cut
        .iter()
        .enumerate()
        .flat_map(|(cut, channels)| tracks::merge(cut, channels, resolution))
        .collect();
    for line in &mut merged {
        line.in_air = stands_in_air(line, &cuts[line.cut], air, &air_lines);
    }
    let bands: Vec<[f64; 2]> = spectra
        .iter()
        .map(|own| {
            own.first().map_or([f64::NAN; 2], |s| [LOWEST_BIN as f64 * s.resolution, s.nyquist])
        })
        .collect();
    let tracks = tracks(&merged, &cuts, &bands, &options);
    let band = bands.iter().flatten().filter(|f| f.is_finite());
    let band =
        [band.clone().copied().fold(f64::INFINITY, f64::min), band.copied().fold(0.0, f64::max)];
    let combs = combs(&tracks, &merged, &cuts, band, &options);
    let pitch = cuts.iter().map(|c| 2.0 * c.cutting_speed / (c.uncut_chip_thickness * c.rate));
    let visible_pitch = [pitch.clone().fold(0.0, f64::max), pitch.fold(f64::INFINITY, f64::min)];
    let knows_rotation = cuts.iter().all(|cut| cut.revolution.is_some());
    let alarms = (options.self_test > 0)
        .then(|| false_alarms(&cuts, resolution, options.self_test, options.seed));
    let (time, growth) = (over_time(&cuts), growth(&cuts));
    Ok(SeriesDiagnosis {
        resolution,
        spectra,
        too_short,
        air: air_lines,
        tests,
        lines: merged,
        tracks,
        combs,
        visible_pitch,
        knows_rotation,
        false_alarms: alarms.map(|[lines, _]| lines),
        time_false_alarms: alarms.map(|[_, time]| time),
        time,
        growth,
        cuts,
    })
}

/// The spectra of the channels of a cut; none if it is too short.
fn of_cut(cut: &SeriesCut, resolution: f64) -> Vec<BroadBand> {
    let [from, to] = cut.window;
    cut.channels
        .iter()
        .map(|c| BroadBand::new(&c.force[from..to], cut.rate, resolution, FEWEST_SEGMENTS))
        .collect::<Option<Vec<_>>>()
        .unwrap_or_default()
}

/// The bins that the cuts allow.
fn resolution(cuts: &[SeriesCut], options: &SeriesOptions) -> Result<f64, SeriesError> {
    if cuts.is_empty() {
        return Err(SeriesError::NoCut);
    }
    if let Some(stated) = options.resolution {
        return Ok(stated);
    }
    let mut lengths: Vec<f64> = cuts.iter().map(SeriesCut::duration).collect();
    lengths.sort_by(f64::total_cmp);
    let enough = SHORT * lengths[lengths.len() / 2];
    let shortest = lengths.into_iter().find(|length| *length >= enough).unwrap_or(f64::NAN);
    let fastest = cuts.iter().map(|cut| cut.rate).fold(0.0, f64::max);
    Ok((SEGMENTS / shortest).max(fastest / LONGEST))
}

fn none_fits(cuts: &[SeriesCut], resolution: f64, slowest: f64) -> SeriesError {
    let longest = cuts.iter().map(SeriesCut::duration).fold(0.0, f64::max);
    let needed = needed(resolution);
    if longest < needed {
        SeriesError::TooShort { longest, resolution, needed }
    } else {
        SeriesError::TooCoarse { resolution, nyquist: 0.5 * slowest }
    }
}

/// Length in s of the fewest segments with half overlap.
fn needed(resolution: f64) -> f64 {
    0.5 * (FEWEST_SEGMENTS as f64 + 1.0) / resolution
}

fn air_spectra(air: Option<&AirSeries>, resolution: f64) -> Result<Vec<BroadBand>, SeriesError> {
    let Some(air) = air else { return Ok(Vec::new()) };
    air.forces
        .iter()
        .map(|force| {
            BroadBand::new(force, air.rate, resolution, FEWEST_SEGMENTS).ok_or_else(|| {
                let length = force.len() as f64 / air.rate;
                SeriesError::AirTooShort { length, needed: needed(resolution) }
            })
        })
        .collect()
}

/// Whether the free-running machine has the line too: at the same frequency, or at the same multiple of the rotation.
fn stands_in_air(
    line: &CutLine,
    cut: &SeriesCut,
    air: Option<&AirSeries>,
    found: &[(BroadBand, Vec<SpectralLine>)],
) -> bool {
    let rotations = cut.revolution.zip(air.and_then(|air| air.revolution));
    line.channels.iter().zip(found).any(|(own, (spectrum, lines))| {
        let Some(own) = own else { return false };
        lines.iter().any(|other| {
            let tolerance = (2.0 * spectrum.resolution).max(2.0 * (own.error + other.error));
            let turned = rotations.map(|(here, there)| other.frequency * here / there);
            let near = |f: f64| (f - line.frequency).abs() < tolerance;
            other.amplitude > SAME_LINE * own.amplitude
                && (near(other.frequency) || turned.is_some_and(near))
        })
    })
}

/// Quantile of Student's t for a 95 % interval.
pub(crate) fn t_quantile(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(1.96, |law| law.inverse_cdf(0.975))
}
