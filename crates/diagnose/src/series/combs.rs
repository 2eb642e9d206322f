//! Lines that are multiples of one frequency: one finding, and one record is enough where the frequency is stated.
//!
//! A line at f is taken for a multiple m of f_0 if it is no farther from m f_0 than its tolerance t: two standard errors, or the share of
//! f by which f_0 itself may be wrong (0.5 % of a stated rotation, 0.1 % of the mains, 1 % of a stated natural frequency, which has no
//! multiples). A line that has nothing to do with f_0 has a frequency that is even over the logarithm of the band, and lies so close to
//! one of the first m multiples with the chance p. Of L lines K and more do so with
//!
//! ```text
//! p = 2 t / (f_0 ln(high / low)) (1 + 1/2 + ... + 1/m)
//! chance <= min over K of C(L, K) p_1 p_2 ... p_K,   p_1 <= p_2 <= ... the smallest
//! ```
//!
//! at most (union bound). Below 5 % over the number of stated frequencies, or where a track already follows the law over three cuts, the
//! lines are said to belong to f_0; those are left out to which the next multiples are as near as ten tolerances. Lines of tracks that
//! follow another law are none.
//!
//! Multiples of a track's own frequency, cut by cut, are the same wave, which is no sine.

use super::laws::LineLaw;
use super::tracks::{CutLine, FEWEST_CUTS, Named, Track};
use super::{SeriesCut, SeriesOptions};

/// Chance below which lines are said to belong to a stated frequency.
const RARE: f64 = 0.05;
/// Share of the way from multiple to multiple above which the tolerance of a line says nothing.
const COMMON: f64 = 0.2;
/// Highest multiple that is looked for.
const MOST_MULTIPLES: f64 = 60.0;
/// Share of a frequency by which a track's multiples may miss it.
const OWN_SHARE: f64 = 0.003;

/// What lines are multiples of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CombBase {
    /// The stated rotation of each cut.
    Rotation,
    /// The mains, in Hz.
    Mains(f64),
    /// A stated natural frequency in Hz.
    Natural(f64),
    /// The frequency of this track, cut by cut.
    Track(usize),
}

impl CombBase {
    /// The law that its lines follow; that of a track is its own.
    #[must_use]
    pub const fn law(self) -> Option<LineLaw> {
        match self {
            Self::Rotation => Some(LineLaw::Rotation),
            Self::Mains(_) => Some(LineLaw::Mains),
            Self::Natural(_) => Some(LineLaw::Constant),
            Self::Track(_) => None,
        }
    }

    /// Its frequency in a cut, by how much of itself it may be wrong, and its highest multiple.
    fn stated(self, cut: &SeriesCut) -> Option<(f64, f64, f64)> {
        match self {
            Self::Rotation => cut.revolution.map(|n| (n, 5e-3, MOST_MULTIPLES)),
            Self::Mains(f) => Some((f, 1e-3, MOST_MULTIPLES)),
            Self::Natural(f) => Some((f, 1e-2, 1.0)),
            Self::Track(_) => None,
        }
    }
}

/// Lines that are multiples of one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Comb {
    /// Of what.
    pub base: CombBase,
    /// Numbers of the tracks, each with its multiple, in the order of these.
    pub members: Vec<(usize, u32)>,
    /// Chance that so many lines lie there that have nothing to do with it; of multiples of a track `None`.
    pub chance: Option<f64>,
    /// Another stated frequency that the same lines belong to as well.
    pub rival: Option<CombBase>,
}

/// The stated frequencies, then the tracks, that other lines are multiples of.
#[must_use]
pub fn combs(
    tracks: &[Track],
    lines: &[CutLine],
    cuts: &[SeriesCut],
    band: [f64; 2],
    options: &SeriesOptions,
) -> Vec<Comb> {
    let mut bases = vec![CombBase::Rotation];
    bases.extend(options.mains.iter().map(|f| CombBase::Mains(*f)));
    bases.extend(options.natural.iter().map(|f| CombBase::Natural(*f)));
    let rare = RARE / bases.len() as f64;
    let mut free = vec![true; tracks.len()];
    let mut found: Vec<Comb> = Vec::new();
    loop {
        let mut stated: Vec<Comb> = bases
            .iter()
            .filter_map(|base| of_stated(*base, tracks, &free, (lines, cuts), (band, rare)))
            .collect();
        stated.sort_by(|a, b| a.chance.unwrap_or(0.0).total_cmp(&b.chance.unwrap_or(0.0)));
        let mut all = stated.into_iter();
        let Some(mut best) = all.next() else { break };
        let numbers = |comb: &Comb| comb.members.iter().map(|(k, _)| *k).collect::<Vec<_>>();
        let mut own = numbers(&best);
        own.sort_unstable();
        best.rival = all
            .find(|other| {
                let theirs = numbers(other);
                own.iter().all(|k| theirs.contains(k))
            })
            .map(|other| other.base);
        own.iter().for_each(|&k| free[k] = false);
        found.push(best);
    }
    for base in 0..tracks.len() {
        if free[base] && tracks[base].lines.len() >= FEWEST_CUTS {
            free[base] = false;
            let members: Vec<(usize, u32)> = (0..tracks.len())
                .filter(|&k| free[k])
                .filter_map(|k| Some((k, multiple_of_track(&tracks[base], &tracks[k], lines)?)))
                .collect();
            if members.is_empty() {
                free[base] = true;
                continue;
            }
            members.iter().for_each(|&(k, _)| free[k] = false);
            found.push(Comb { base: CombBase::Track(base), members, chance: None, rival: None });
        }
    }
    for comb in &mut found {
        comb.members.sort_unstable_by_key(|&(k, multiple)| (multiple, k));
    }
    found
}

fn of_stated(
    base: CombBase,
    tracks: &[Track],
    free: &[bool],
    (lines, cuts): (&[CutLine], &[SeriesCut]),
    ([low, high], rare): ([f64; 2], f64),
) -> Option<Comb> {
    let follows = |track: &Track| matches!(track.named, Named::Law(law) if Some(law) == base.law());
    let may = |k: &usize| {
        free[*k] && (follows(&tracks[*k]) || !matches!(tracks[*k].named, Named::Law(_)))
    };
    let candidates: Vec<usize> = (0..tracks.len()).filter(may).collect();
    // Track, multiple, chance p, and twice the tolerance over the way to the next multiple.
    let mut near: Vec<(usize, u32, f64, f64)> = candidates
        .iter()
        .filter_map(|&k| {
            let mut multiple = None;
            let (mut chance, mut share_of_way) = (0.0_f64, 0.0_f64);
            for line in tracks[k].lines.iter().map(|&line| &lines[line]) {
                let (f0, share, most) = base.stated(&cuts[line.cut])?;
                let m = (line.frequency / f0).round();
                let tolerance = (2.0 * line.error).max(share * line.frequency);
                let is_near = m >= 1.0 && m <= most && (line.frequency - m * f0).abs() <= tolerance;
                if !is_near || multiple.is_some_and(|other| other != m) {
                    return None;
                }
                multiple = Some(m);
                let own = 2.0 * tolerance / f0;
                let multiples: f64 = (1..=m as u32).map(|k| 1.0 / f64::from(k)).sum();
                chance = chance.max(own * multiples / (high / low).ln());
                share_of_way = share_of_way.max(if most > 1.0 { own } else { 0.0 });
            }
            Some((k, multiple? as u32, chance.min(1.0), share_of_way))
        })
        .collect();
    near.sort_by(|a, b| a.2.total_cmp(&b.2));
    let count = candidates.len() as f64;
    let mut bound = 1.0;
    let mut chance = 1.0_f64;
    for (k, (_, _, p, _)) in near.iter().enumerate() {
        bound *= p * (count - k as f64) / (k as f64 + 1.0);
        chance = chance.min(bound);
    }
    let known = near.iter().any(|(k, ..)| follows(&tracks[*k]));
    if !known && chance >= rare {
        return None;
    }
    near.retain(|(k, _, _, way)| *way < COMMON || follows(&tracks[*k]));
    // A track that follows the law by itself is no comb.
    let alone = near.len() == 1 && tracks[near[0].0].named != Named::TooFewCuts;
    (!near.is_empty() && !alone).then(|| Comb {
        base,
        members: near.into_iter().map(|(k, multiple, ..)| (k, multiple)).collect(),
        chance: Some(chance),
        rival: None,
    })
}

/// The whole number of times that `other` is faster than `base` in every cut of its own.
fn multiple_of_track(base: &Track, other: &Track, lines: &[CutLine]) -> Option<u32> {
    let mut multiple = None;
    for line in other.lines.iter().map(|&k| &lines[k]) {
        let own = base.lines.iter().map(|&k| &lines[k]).find(|own| own.cut == line.cut)?;
        let m = (line.frequency / own.frequency).round();
        let errors = 2.0 * (m * own.error).hypot(line.error);
        let tolerance = errors.max(OWN_SHARE * line.frequency);
        let is_near = m >= 2.0 && (line.frequency - m * own.frequency).abs() <= tolerance;
        let says_something =
            other.lines.len() >= FEWEST_CUTS || 2.0 * tolerance < RARE * own.frequency;
        if !is_near || !says_something || multiple.is_some_and(|other| other != m) {
            return None;
        }
        multiple = Some(m);
    }
    multiple.map(|m| m as u32)
}
