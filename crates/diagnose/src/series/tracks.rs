//! Lines of different cuts that belong together, and what may be said of them.
//!
//! Under a law (constant, rotation, chip) every line has a constant u = ln f - g. Lines of different cuts whose u agree make a track.
//! A track is worth
//!
//! ```text
//! sum over cuts with a line but the first  ln(1 / P(a line this close by chance)) - 1.6 per cut without one where the law has one in the band
//! ```
//!
//! (1.6 = -ln 0.2: a line is taken to show in four of five cuts). The most valuable track is taken, its lines are removed, and so on
//! while it is worth more than chance over all seeds. Then every law is asked of the track's lines ([`super::laws`]).

use super::laws::{self, Explanation, Known, LineLaw, Seen, TOLD_APART};
use super::{SeriesCut, SeriesOptions};
use crate::series::lines::SpectralLine;

/// Probability above which a law is named.
pub const CLAIM: f64 = 0.9;
/// Fewest cuts over which a law may be named.
pub(super) const FEWEST_CUTS: usize = 3;
/// Penalty of a cut without the line.
const MISSED: f64 = 1.6;
/// What a track has to be worth beyond the logarithm of the number of seeds.
const WORTH: f64 = 3.0;
/// Highest multiple of the rotation for which a coincidence counts as proof where another law predicts the same.
const SAFE_MULTIPLE: f64 = 5.0;
/// Rise of an amplitude from cut to cut that is a jump.
const JUMP: f64 = 5.0;

/// A line of a cut, its channels taken together.
#[derive(Debug, Clone, PartialEq)]
pub struct CutLine {
    /// Number of the cut.
    pub cut: usize,
    /// The line of each channel, in the order of the cut's channels; `None` where it does not stand out.
    pub channels: Vec<Option<SpectralLine>>,
    /// Frequency in Hz, of the channel with the smallest error.
    pub frequency: f64,
    /// Its standard error.
    pub error: f64,
    /// Whether the free-running machine has it too.
    pub in_air: bool,
}

impl CutLine {
    /// Largest amplitude of the channels in N.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        self.channels.iter().flatten().map(|line| line.amplitude).fold(0.0, f64::max)
    }
}

/// What may be said of a track.
#[derive(Debug, Clone, PartialEq)]
pub enum Named {
    /// It follows this law.
    Law(LineLaw),
    /// One of these: the cuts cannot tell them apart.
    NotToldApart(Vec<LineLaw>),
    /// No law has more than 90 %.
    Unsure,
    /// Too few cuts.
    TooFewCuts,
}

/// A line followed over the cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Indices of its lines, one per cut.
    pub lines: Vec<usize>,
    /// The laws, the most probable first.
    pub explanations: Vec<Explanation>,
    /// What may be said.
    pub named: Named,
    /// Cuts that would tell what these cannot.
    pub advice: Option<super::advice::Advice>,
    /// Largest amplitude over the median of the cuts without a jump, where it jumps.
    pub jump: Option<f64>,
    /// Number of cuts whose line the free-running machine has too; `None` without a recording of it.
    pub in_air: Option<usize>,
}

/// The lines of the channels of a cut, those within two bins or two standard errors taken together.
#[must_use]
pub fn merge(cut: usize, channels: &[Vec<SpectralLine>], resolution: f64) -> Vec<CutLine> {
    let mut all: Vec<(usize, &SpectralLine)> = channels
        .iter()
        .enumerate()
        .flat_map(|(c, lines)| lines.iter().map(move |l| (c, l)))
        .collect();
    all.sort_by(|a, b| a.1.chance.total_cmp(&b.1.chance));
    let mut merged: Vec<CutLine> = Vec::new();
    for (channel, line) in all {
        let near = merged.iter_mut().find(|m| {
            let tolerance =
                (2.0 * resolution).max(0.5 * line.width).max(2.0 * (m.error + line.error));
            (m.frequency - line.frequency).abs() < tolerance
        });
        match near {
            Some(found) => {
                let own = &mut found.channels[channel];
                if own.is_none() {
                    *own = Some(line.clone());
                    if line.error < found.error {
                        (found.frequency, found.error) = (line.frequency, line.error);
                    }
                }
            }
            None => {
                let mut own = vec![None; channels.len()];
                own[channel] = Some(line.clone());
                let (frequency, error) = (line.frequency, line.error);
                merged.push(CutLine { cut, channels: own, frequency, error, in_air: false });
            }
        }
    }
    merged.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    merged
}

/// The coordinates in which tracks are looked for: a law, and by how much ln f may scatter about it.
const COORDINATES: [(LineLaw, f64); 4] = [
    (LineLaw::Constant, 0.015),
    (LineLaw::Rotation, 0.008),
    (LineLaw::Chip, 0.1),
    (LineLaw::Constant, 0.07),
];

struct Candidate {
    lines: Vec<usize>,
    worth: f64,
}

/// Tracks over all cuts, the most valuable first, with what each follows.
#[must_use]
pub fn tracks(
    lines: &[CutLine],
    cuts: &[SeriesCut],
    bands: &[[f64; 2]],
    options: &SeriesOptions,
) -> Vec<Track> {
    let mut free = vec![true; lines.len()];
    let mut found: Vec<Vec<usize>> = Vec::new();
    let seeds = (lines.len().max(1) * COORDINATES.len()) as f64;
    loop {
        let best = (0..lines.len())
            .filter(|&k| free[k])
            .flat_map(|seed| COORDINATES.map(|coordinate| (seed, coordinate)))
            .filter_map(|(seed, coordinate)| follow(seed, coordinate, lines, &free, (cuts, bands)))
            .max_by(|a, b| a.worth.total_cmp(&b.worth));
        let Some(best) = best.filter(|b| b.worth > seeds.ln() + WORTH) else { break };
        best.lines.iter().for_each(|&k| free[k] = false);
        found.push(best.lines);
    }
    // What no other cut has stands for itself.
    found.extend((0..lines.len()).filter(|&k| free[k]).map(|k| vec![k]));
    judge(found, lines, cuts, bands, options)
}

fn seen(line: &CutLine, cut: &SeriesCut) -> Seen {
    Seen {
        cutting_speed: cut.cutting_speed,
        uncut_chip_thickness: cut.uncut_chip_thickness,
        revolution: cut.revolution,
        frequency: line.frequency,
        error: line.error,
    }
}

fn follow(
    seed: usize,
    (law, tolerance): (LineLaw, f64),
    lines: &[CutLine],
    free: &[bool],
    (cuts, bands): (&[SeriesCut], &[[f64; 2]]),
) -> Option<Candidate> {
    let of = |k: usize| {
        Some(lines[k].frequency.ln() - laws::place(law, &seen(&lines[k], &cuts[lines[k].cut]))?)
    };
    let mut centre = of(seed)?;
    let mut members = Vec::new();
    let mut worth = 0.0;
    for _ in 0..3 {
        members.clear();
        worth = 0.0;
        // The line that started the track is where it is.
        let mut own_worth = f64::INFINITY;
        for (c, band) in bands.iter().enumerate() {
            let reach = |k: usize| tolerance.max(2.0 * lines[k].error / lines[k].frequency);
            let own = || (0..lines.len()).filter(|&k| free[k] && lines[k].cut == c);
            let near = own()
                .filter_map(|k| Some((k, (of(k)? - centre).abs())))
                .filter(|(k, d)| *d <= reach(*k))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((k, _)) = near {
                let density = own().count() as f64 / (band[1] / band[0]).ln();
                let value = -(1.0 - (-2.0 * reach(k) * density).exp()).ln();
                (worth, own_worth) = (worth + value, own_worth.min(value));
                members.push(k);
            } else if expected(law, centre, &cuts[c]).is_some_and(|f| band[0] < f && f < band[1]) {
                worth -= MISSED;
            }
        }
        worth -= own_worth;
        let mut places: Vec<f64> = members.iter().filter_map(|&k| of(k)).collect();
        places.sort_by(f64::total_cmp);
        centre = *places.get(places.len() / 2)?;
    }
    // A single cut is no track.
    (members.len() > 1).then_some(Candidate { lines: members, worth })
}

fn expected(law: LineLaw, centre: f64, cut: &SeriesCut) -> Option<f64> {
    let place = match law {
        LineLaw::Constant => 0.0,
        LineLaw::Rotation => cut.revolution?.ln(),
        _ => (cut.cutting_speed / cut.uncut_chip_thickness).ln(),
    };
    Some((place + centre).exp())
}

fn judge(
    found: Vec<Vec<usize>>,
    lines: &[CutLine],
    cuts: &[SeriesCut],
    bands: &[[f64; 2]],
    options: &SeriesOptions,
) -> Vec<Track> {
    let band = bands
        .iter()
        .fold([f64::INFINITY, 0.0_f64], |[low, high], b| [low.min(b[0]), high.max(b[1])]);
    let mut known = Known { band, mains: options.mains.clone(), natural: options.natural.clone() };
    let data = |track: &[usize]| -> Vec<Seen> {
        track.iter().map(|&k| seen(&lines[k], &cuts[lines[k].cut])).collect()
    };
    // Constant lines are natural frequencies for what lies above them.
    let own: Vec<(f64, usize)> = found
        .iter()
        .enumerate()
        .filter(|(_, track)| track.len() >= FEWEST_CUTS)
        .filter_map(|(k, track)| {
            let weighed = laws::weigh(&data(track), &known);
            let first = weighed.first().filter(|e| e.law == LineLaw::Constant)?;
            Some((first.constant?[0], k))
        })
        .collect();
    found
        .iter()
        .enumerate()
        .map(|(k, track)| {
            known.natural = options.natural.clone();
            known.natural.extend(own.iter().filter(|(_, other)| *other != k).map(|(f, _)| *f));
            let seen = data(track);
            let explanations = laws::weigh(&seen, &known);
            let named = name(&explanations, &seen);
            let advice = match &named {
                Named::NotToldApart(rivals) => {
                    super::advice::advise(rivals, &explanations, &seen, band)
                }
                _ => None,
            };
            let in_air =
                options.has_air.then(|| track.iter().filter(|&&line| lines[line].in_air).count());
            let amplitudes: Vec<f64> = track.iter().map(|&line| lines[line].amplitude()).collect();
            Track {
                lines: track.clone(),
                explanations,
                named,
                advice,
                jump: jump(amplitudes),
                in_air,
            }
        })
        .collect()
}

/// The largest gap between amplitudes in rising order, if it is a jump: the largest over the median below the gap.
fn jump(mut amplitudes: Vec<f64>) -> Option<f64> {
    amplitudes.sort_by(f64::total_cmp);
    let gap = amplitudes.windows(2).position(|pair| pair[1] > JUMP * pair[0])?;
    Some(amplitudes.last()? / amplitudes[gap / 2])
}

/// What may be said of a track with these explanations.
#[must_use]
pub fn name(explanations: &[Explanation], seen: &[Seen]) -> Named {
    let mut conditions: Vec<[u64; 3]> = seen
        .iter()
        .map(|s| {
            [s.cutting_speed, s.uncut_chip_thickness, s.revolution.unwrap_or(0.0)].map(f64::to_bits)
        })
        .collect();
    conditions.sort_unstable();
    conditions.dedup();
    let first = &explanations[0];
    // The mains keep their frequency: every cut with another rotation says so again, and one cut is enough for no law.
    if seen.len() < FEWEST_CUTS {
        return Named::TooFewCuts;
    }
    let coincidence = match first.law {
        LineLaw::Mains => true,
        LineLaw::Rotation => first.constant.is_some_and(|c| c[0] <= SAFE_MULTIPLE),
        _ => false,
    };
    let mut rivals: Vec<LineLaw> = Vec::new();
    if !coincidence && laws::place(first.law, &seen[0]).is_some() {
        rivals.extend(
            [LineLaw::Constant, LineLaw::Ratio, LineLaw::Chip]
                .into_iter()
                .filter(|law| {
                    *law != first.law && !(first.law == LineLaw::Rotation && *law == LineLaw::Ratio)
                })
                // A law that cannot have the constant it needs is no rival.
                .filter(|law| {
                    explanations.iter().any(|e| e.law == *law && e.log_evidence.is_some())
                })
                .filter(|law| {
                    laws::distance(first.law, *law, seen).is_some_and(|d| d < TOLD_APART)
                }),
        );
    }
    if !rivals.is_empty() {
        rivals.insert(0, first.law);
        let together: f64 =
            explanations.iter().filter(|e| rivals.contains(&e.law)).map(|e| e.probability).sum();
        return if together > CLAIM { Named::NotToldApart(rivals) } else { Named::Unsure };
    }
    if first.probability > CLAIM { Named::Law(first.law) } else { Named::Unsure }
}
