//! The points of a design: a value of every varied key for every run.

use crate::random::DesignRandom;
use crate::{Design, Levels, Sweep, SweepAxis, multiple};

/// Most runs of one sweep.
pub(crate) const MOST_RUNS: usize = 100_000;
/// Most points of a Sobol sequence: the library's indices end there.
const MOST_SOBOL: usize = 1 << 16;

/// The points, or how many there would be if they are too many.
pub(crate) fn points(sweep: &Sweep) -> Result<Vec<Vec<String>>, usize> {
    let is_seed = |axis: &&SweepAxis| matches!(axis.levels, Levels::Replicates(_));
    // The seeds are the last axis, if there are replicates.
    let axes = &sweep.axes;
    let is_free = |axis: &&SweepAxis| !is_seed(axis) && axis.follows(axes).is_none();
    let keys: Vec<&SweepAxis> = axes.iter().filter(is_free).collect();
    let seeds = sweep.axes.iter().find(is_seed).map(levels);
    let total = count(sweep.design, &keys).saturating_mul(seeds.map_or(1, <[String]>::len));
    let sobol = matches!(sweep.design, Design::Sobol { runs, .. } if runs > MOST_SOBOL);
    if total > MOST_RUNS || sobol {
        return Err(total);
    }
    let points = match sweep.design {
        Design::FullFactorial => product(&keys),
        Design::List => together(&keys),
        Design::LatinHypercube { runs, seed } => latin_hypercube(&keys, runs, seed),
        Design::Sobol { runs, seed } => sobol_sequence(&keys, runs, seed),
    };
    let points: Vec<Vec<String>> = points.into_iter().map(|point| complete(axes, point)).collect();
    let Some(seeds) = seeds else { return Ok(points) };
    let with = |point: &Vec<String>, seed: &String| {
        [point.as_slice(), std::slice::from_ref(seed)].concat()
    };
    Ok(points.iter().flat_map(|point| seeds.iter().map(move |seed| with(point, seed))).collect())
}

/// The values of all keys but the seed, from those of the keys that follow no other.
fn complete(axes: &[SweepAxis], free: Vec<String>) -> Vec<String> {
    let mut free = free.into_iter();
    let own = |axis: &SweepAxis| {
        axis.follows(axes).is_none() && !matches!(axis.levels, Levels::Replicates(_))
    };
    let mut values: Vec<Option<String>> =
        axes.iter().map(|axis| if own(axis) { free.next() } else { None }).collect();
    for (place, axis) in axes.iter().enumerate() {
        if let Some((other, times)) = axis.follows(axes) {
            // The file was refused if the other key had no quantities.
            values[place] = values[other].as_deref().and_then(|value| multiple(times, value));
        }
    }
    values.into_iter().flatten().collect()
}

fn levels(axis: &SweepAxis) -> &[String] {
    match &axis.levels {
        Levels::Listed(values) | Levels::Replicates(values) => values,
        Levels::Interval { .. } | Levels::Multiple { .. } => &[],
    }
}

fn count(design: Design, keys: &[&SweepAxis]) -> usize {
    let lengths = keys.iter().map(|axis| levels(axis).len());
    match design {
        Design::FullFactorial => lengths.fold(1, usize::saturating_mul),
        Design::List => lengths.min().unwrap_or(0),
        Design::LatinHypercube { runs, .. } | Design::Sobol { runs, .. } => runs,
    }
}

/// All combinations; the last key varies fastest.
fn product(keys: &[&SweepAxis]) -> Vec<Vec<String>> {
    keys.iter().fold(vec![Vec::new()], |points, axis| {
        let with = |point: &Vec<String>, level: &String| {
            [point.as_slice(), std::slice::from_ref(level)].concat()
        };
        points
            .iter()
            .flat_map(|point| levels(axis).iter().map(move |level| with(point, level)))
            .collect()
    })
}

fn together(keys: &[&SweepAxis]) -> Vec<Vec<String>> {
    let runs = count(Design::List, keys);
    (0..runs).map(|run| keys.iter().map(|axis| levels(axis)[run].clone()).collect()).collect()
}

/// Each key is cut into as many parts as there are points, and each part has one (McKay, Beckman and
/// Conover 1979).
fn latin_hypercube(keys: &[&SweepAxis], runs: usize, seed: u64) -> Vec<Vec<String>> {
    let columns: Vec<Vec<String>> = keys
        .iter()
        .enumerate()
        .map(|(index, axis)| {
            let mut random = DesignRandom::new(seed, index);
            let parts = random.permutation(runs);
            parts
                .into_iter()
                .map(|part| axis.at((part as f64 + random.uniform()) / runs as f64))
                .collect()
        })
        .collect();
    (0..runs).map(|run| columns.iter().map(|column| column[run].clone()).collect()).collect()
}

/// A Sobol sequence with Owen's scrambling (Burley 2020).
fn sobol_sequence(keys: &[&SweepAxis], runs: usize, seed: u64) -> Vec<Vec<String>> {
    let value = |run: usize, index: usize, axis: &SweepAxis| {
        // Indices and seed fit: both were checked to be small.
        axis.at(f64::from(sobol_burley::sample(run as u32, index as u32, seed as u32)))
    };
    let point =
        |run| keys.iter().enumerate().map(|(index, axis)| value(run, index, axis)).collect();
    (0..runs).map(point).collect()
}
