//! From columns of a file to channels on one even clock.

use super::Fault;
use sphcut_postprocess::statistics::median;

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RawColumn {
    /// Its name.
    pub name: String,
    /// Its numbers; what is missing or no number is not a number here either.
    pub values: Vec<f64>,
    /// First time and interval in s if the file states them for the column.
    pub clock: Option<(f64, f64)>,
}

/// The columns of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RawTable {
    /// In the order of the file.
    pub columns: Vec<RawColumn>,
}

/// How the samples of a file get their times.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeSource {
    /// Column with the time, and the seconds that its number 1 means.
    pub column: Option<(String, f64)>,
    /// Samples per second, as stated by the user.
    pub sampling_rate: Option<f64>,
    /// Longest gap in s that is bridged by a straight line.
    pub longest_gap: f64,
}

/// Channels on one even clock, as numbers of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// Samples per second.
    pub rate: f64,
    /// One series for each channel asked for; all of the same length.
    pub values: Vec<Vec<f64>>,
    /// What the user has to know.
    pub faults: Vec<Fault>,
}

/// Fewest samples of a record.
const FEWEST: usize = 100;
/// Relative difference of clocks that is rounding.
const SAME_CLOCK: f64 = 1e-6;
/// Relative difference between stated and found sampling rate that is tolerated: quartz clocks differ by
/// 1e-4, and what is left shifts the end of a record of 1 s by less than 1 ms.
const SAME_RATE: f64 = 1e-3;
/// Distance from the even clock in intervals beyond which time stamps are uneven.
const UNEVEN: f64 = 0.6;
/// Distance below which it is not worth a word.
const EVEN: f64 = 0.02;

impl RawTable {
    /// The column `name`.
    fn column(&self, name: &str) -> Result<&RawColumn, Fault> {
        self.columns.iter().find(|column| column.name == name).ok_or_else(|| {
            Fault::MissingChannel {
                channel: name.to_owned(),
                present: self.columns.iter().map(|column| column.name.clone()).collect(),
            }
        })
    }

    /// The channels `names` on one clock.
    ///
    /// # Errors
    /// Everything that leaves no clock or no numbers, all at once.
    pub fn channels(&self, names: &[&str], time: &TimeSource) -> Result<Channels, Vec<Fault>> {
        let found: Vec<Result<&RawColumn, Fault>> =
            names.iter().map(|name| self.column(name)).collect();
        let missing: Vec<Fault> = found.iter().filter_map(|c| c.clone().err()).collect();
        let columns: Vec<&RawColumn> = found.into_iter().flatten().collect();
        let stamps = time.column.as_ref().map(|(name, scale)| Ok((self.column(name)?, *scale)));
        let stamps = match stamps.transpose() {
            Ok(stamps) if missing.is_empty() => stamps,
            Ok(_) => return Err(missing),
            Err(fault) => return Err(missing.into_iter().chain([fault]).collect()),
        };
        let all: Vec<&RawColumn> =
            columns.iter().copied().chain(stamps.map(|(column, _)| column)).collect();
        same_length(&all).map_err(|fault| vec![fault])?;
        let samples = all.first().map_or(0, |column| column.values.len());
        if samples < FEWEST {
            return Err(vec![Fault::TooFewSamples { samples }]);
        }
        let mut values: Vec<Vec<f64>> = columns.iter().map(|c| c.values.clone()).collect();
        let mut faults = Vec::new();
        let interval = match stamps {
            Some((column, scale)) => {
                let times: Vec<f64> = column.values.iter().map(|t| t * scale).collect();
                even_clock(&times, &mut values, &mut faults)?
            }
            None => file_clock(&columns, time.sampling_rate)?,
        };
        let rate = 1.0 / interval;
        if let Some(stated) = time.sampling_rate
            && (rate / stated - 1.0).abs() > SAME_RATE
        {
            faults.push(Fault::RateDiffers { stated, found: rate });
        }
        for (name, series) in names.iter().zip(&mut values) {
            faults.extend(bridge(name, series, interval, time.longest_gap));
        }
        let (fatal, told): (Vec<Fault>, Vec<Fault>) = faults.into_iter().partition(Fault::refuses);
        if fatal.is_empty() { Ok(Channels { rate, values, faults: told }) } else { Err(fatal) }
    }
}

fn same_length(columns: &[&RawColumn]) -> Result<(), Fault> {
    let entry = |column: &RawColumn| (column.name.clone(), column.values.len());
    match columns.iter().find(|column| column.values.len() != columns[0].values.len()) {
        Some(other) => Err(Fault::UnequalLengths { channels: [entry(columns[0]), entry(other)] }),
        None => Ok(()),
    }
}

/// The interval that the columns themselves state, or the user.
fn file_clock(columns: &[&RawColumn], stated: Option<f64>) -> Result<f64, Vec<Fault>> {
    let clocks: Vec<(&str, f64, f64)> =
        columns.iter().filter_map(|c| c.clock.map(|(t, d)| (c.name.as_str(), t, d))).collect();
    let Some(&(name, start, interval)) = clocks.first() else {
        return stated.map(|rate| 1.0 / rate).ok_or_else(|| vec![Fault::NoClock]);
    };
    let differs = |clock: &&(&str, f64, f64)| {
        (clock.2 / interval - 1.0).abs() > SAME_CLOCK || (clock.1 - start).abs() > 0.01 * interval
    };
    if let Some(&(other, begin, step)) = clocks.iter().find(differs) {
        let channels = [(name.to_owned(), start, interval), (other.to_owned(), begin, step)];
        return Err(vec![Fault::UnequalClocks { channels }]);
    }
    if interval > 0.0 && interval.is_finite() { Ok(interval) } else { Err(vec![Fault::NoClock]) }
}

/// The even clock through `times`; where samples are missing, places for them are put into `values`.
fn even_clock(
    times: &[f64],
    values: &mut [Vec<f64>],
    faults: &mut Vec<Fault>,
) -> Result<f64, Vec<Fault>> {
    if let Some(sample) = times.iter().position(|t| !t.is_finite()) {
        let gap = Fault::Gap { channel: String::new(), start: f64::NAN, length: 0.0, samples: 1 };
        return Err(vec![gap, Fault::TimeNotRising { sample }]);
    }
    if let Some(sample) = times.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(vec![Fault::TimeNotRising { sample: sample + 1 }]);
    }
    // Over a stride the rounding of single stamps does not count, and few strides hold a gap.
    let stride = (times.len() / 20).clamp(1, 256);
    let steps: Vec<f64> =
        (0..times.len() - stride).map(|k| (times[k + stride] - times[k]) / stride as f64).collect();
    let coarse = median(&steps);
    if coarse <= 0.0 {
        return Err(vec![Fault::TimeNotRising { sample: 1 }]);
    }
    let places = places(times, coarse);
    let last = *places.last().unwrap_or(&0);
    // Least squares through time over place.
    let count = times.len() as f64;
    let centre = places.iter().map(|&p| p as f64).sum::<f64>() / count;
    let middle = times.iter().sum::<f64>() / count;
    let (mut above, mut below) = (0.0, 0.0);
    for (&place, time) in places.iter().zip(times) {
        above += (place as f64 - centre) * (time - middle);
        below += (place as f64 - centre).powi(2);
    }
    let interval = above / below;
    let intervals = places
        .iter()
        .zip(times)
        .map(|(&place, time)| ((time - middle) / interval - (place as f64 - centre)).abs())
        .fold(0.0, f64::max);
    if intervals > UNEVEN {
        return Err(vec![Fault::UnevenClock { intervals }]);
    }
    if intervals > EVEN {
        faults.push(Fault::CoarseTime { intervals });
    }
    if last + 1 > places.len() {
        for series in values {
            let mut filled = vec![f64::NAN; last + 1];
            places.iter().zip(series.iter()).for_each(|(&place, value)| filled[place] = *value);
            *series = filled;
        }
    }
    Ok(interval)
}

/// The number of each sample on a clock with this interval: one more than that of the sample before, or
/// more behind a gap. A long interval is a gap only if its neighbours do not make up for it.
fn places(times: &[f64], interval: f64) -> Vec<usize> {
    const AROUND: usize = 4;
    // No gap is longer than the record: bounds the memory for absurd times.
    let most = 10 * times.len();
    let mut place = 0;
    let mut places = vec![0];
    for k in 1..times.len() {
        let step = (times[k] - times[k - 1]) / interval;
        let (from, to) = (k.saturating_sub(AROUND), (k + AROUND - 1).min(times.len() - 1));
        let around = (times[to] - times[from]) / interval - (to - from) as f64;
        let missing = if step > 1.5 && around > 0.75 { (step - 1.0).round() as usize } else { 0 };
        place += 1 + missing.min(most.saturating_sub(place));
        places.push(place);
    }
    places
}

/// Fills gaps up to `longest` in s by straight lines; says what was filled and what was not.
fn bridge(name: &str, values: &mut [f64], interval: f64, longest: f64) -> Vec<Fault> {
    let mut faults = Vec::new();
    let (mut filled, mut left, mut worst) = (0, 0, (0, 0));
    let mut at = 0;
    while at < values.len() {
        if values[at].is_finite() {
            at += 1;
            continue;
        }
        let end = values[at..].iter().position(|v| v.is_finite()).map_or(values.len(), |n| at + n);
        let samples = end - at;
        let inside = at > 0 && end < values.len();
        // A gap of n missing samples is n + 1 intervals wide.
        if inside && (samples + 1) as f64 * interval <= longest * (1.0 + 1e-9) {
            let (before, after) = (values[at - 1], values[end]);
            for k in at..end {
                let share = (k + 1 - at) as f64 / (samples + 1) as f64;
                values[k] = before + share * (after - before);
            }
            filled += samples;
        } else {
            left += samples;
            if samples > worst.1 {
                worst = (at, samples);
            }
        }
        at = end;
    }
    let channel = name.to_owned();
    if filled > 0 {
        faults.push(Fault::Bridged { channel: channel.clone(), samples: filled });
    }
    if left > 0 {
        let (start, length) = (worst.0 as f64 * interval, worst.1 as f64 * interval);
        faults.push(Fault::Gap { channel, start, length, samples: left });
    }
    faults
}
