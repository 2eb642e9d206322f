//! What changes within a cut: run-in and trend of the mean force, beyond what a correlated force does by chance.
//!
//! The force from entry to exit is averaged over blocks that are longer than five correlation times and hold whole revolutions, so that
//! their means y_j scatter independently about
//!
//! ```text
//! y(x) = c + b (x - 1/2) + a exp(-x / T)      x from 0 at entry to 1 at exit
//! ```
//!
//! The line (a = 0) is compared with the whole by the F test for a and T; T runs over a grid from two blocks to 0.3, beyond which
//! an exponential is a line. b, the change over the cut, has the interval of Student's t. The correlation time (integrated autocorrelation: Wolff, Comput. Phys.
//! Commun. 156 (2004) 143-153) is that of the second half of the cut freed of its line, in which the run-in is over.
//!
//! Limits: a cut of fewer than ten blocks or a hundred correlation times is not tested. Changes slower than the cut are seen only as a trend.

use super::{SeriesCut, t_quantile};
use nalgebra::{Matrix3, Vector3};
use sphcut_physics::Channel;
use sphcut_postprocess::steady::{autocorrelation_time, mean_interval};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// Correlation times in a block.
const CORRELATED: f64 = 5.0;
/// Fewest and most blocks.
const BLOCKS: [usize; 2] = [10, 80];
/// Fewest correlation times in a cut.
const INDEPENDENT: f64 = 100.0;
/// Time constants that are tried, as the longest share of the cut and the number of steps down to two blocks.
const LONGEST: f64 = 0.3;
const STEPS: usize = 24;
/// Share of the largest force of the cut below which a force is small.
const SMALL: f64 = 0.1;
/// How far beyond the grid a time constant at its end may lie.
const OPEN: f64 = 3.0;

/// The force decays to its level: a exp(-x / T).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunIn {
    /// a in N: how far above the level the force begins.
    pub amplitude: f64,
    /// T in s with its 95 % interval.
    pub time: [f64; 3],
    /// Chance of an improvement like this over a line.
    pub chance: f64,
}

/// A force of a cut over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// Number of the cut.
    pub cut: usize,
    /// Which force.
    pub component: Channel,
    /// Mean in N.
    pub mean: f64,
    /// What shares refer to in N: the size of the mean, but no less than a tenth of the largest force of the cut.
    pub scale: f64,
    /// Correlation time in s.
    pub correlation: f64,
    /// Length of the cut over its correlation time: how many samples count as independent.
    pub independent: f64,
    /// Blocks.
    pub blocks: usize,
    /// Change over the cut in N with its 95 % interval, run-in apart if there is one.
    pub change: [f64; 3],
    /// Chance of a change this large.
    pub chance: f64,
    /// Change that would be claimed if the run-in is none: the same for a line alone.
    pub line: ([f64; 3], f64),
    /// The run-in that fits best.
    pub run_in: Option<RunIn>,
    /// Last third of the cut less the first in N, and the half width of its 95 % interval.
    pub thirds: [f64; 2],
    /// Change of the zero from the air before to the air after the cut in N, and its standard error and degrees of freedom; `None`
    /// with air on one side.
    pub zero: Option<[f64; 3]>,
}

/// The trends of a cut; none of channels that have too few blocks.
#[must_use]
pub fn trends(number: usize, cut: &SeriesCut) -> Vec<Trend> {
    let of = |channel: &super::SeriesChannel| {
        let found = fit(&channel.force, cut.rate, cut.revolution)?;
        Some(Trend { cut: number, component: channel.component, zero: channel.zero, ..found })
    };
    let mut found: Vec<Trend> = cut.channels.iter().filter_map(of).collect();
    let largest = found.iter().map(|trend| trend.mean.abs()).fold(f64::MIN_POSITIVE, f64::max);
    found.iter_mut().for_each(|trend| trend.scale = trend.mean.abs().max(SMALL * largest));
    found
}

fn fit(force: &[f64], rate: f64, revolution: Option<f64>) -> Option<Trend> {
    let later = without_line(&force[force.len() / 2..]);
    let correlation = autocorrelation_time(&later).samples.max(1.0);
    let least = (CORRELATED * correlation).max(force.len() as f64 / BLOCKS[1] as f64);
    let turn = revolution.map_or(1.0, |n| rate / n);
    let length = (least / turn).ceil() * turn;
    let count = (force.len() as f64 / length) as usize;
    // The correlation time of a short cut is too uncertain, and too short on average.
    if count < BLOCKS[0] || (force.len() as f64) < INDEPENDENT * correlation {
        return None;
    }
    // Neighbouring blocks of a force whose correlation falls exponentially have a correlation of tau / (4 L).
    let neighbours = 1.0 + 0.5 * correlation / length;
    let edge = |j: usize| (j as f64 * length).round() as usize;
    let means: Vec<f64> = (0..count).map(|j| mean(&force[edge(j)..edge(j + 1)])).collect();
    let places: Vec<f64> = (0..count).map(|j| (j as f64 + 0.5) / count as f64).collect();
    let line = Fitted::new(&places, &means, None)?;
    let shortest = 2.0 / count as f64;
    let grid: Vec<f64> = (0..STEPS)
        .map(|k| shortest * (LONGEST / shortest).powf(k as f64 / (STEPS - 1) as f64))
        .collect();
    let tried: Vec<(f64, Fitted)> = grid
        .into_iter()
        .filter(|time| *time <= LONGEST * 1.0001)
        .filter_map(|time| Some((time, Fitted::new(&places, &means, Some(time))?)))
        .collect();
    let duration = edge(count) as f64 / rate;
    let run_in = run_in(&tried, &line, (count, neighbours), duration);
    let freedom = count as f64;
    let change = |fitted: &Fitted, parameters: f64| {
        let left = freedom - parameters;
        let error = (neighbours * fitted.squares / left * fitted.slope_variance).sqrt();
        let half = t_quantile(left) * error;
        let chance = two_sided(fitted.slope / error, left);
        ([fitted.slope, fitted.slope - half, fitted.slope + half], chance)
    };
    let alone = change(&line, 2.0);
    let (with, chance) =
        profile(&tried, &|fitted| change(fitted, 4.0), neighbours / (freedom - 4.0));
    let (with, chance) = if tried.is_empty() { alone } else { (with, chance) };
    let third = force.len() / 3;
    let ends =
        [mean_interval(&force[..third], None), mean_interval(&force[force.len() - third..], None)];
    Some(Trend {
        cut: 0,
        component: Channel::CuttingForce,
        mean: mean(force),
        scale: f64::NAN,
        correlation: correlation / rate,
        independent: force.len() as f64 / correlation,
        blocks: count,
        change: with,
        chance,
        line: alone,
        run_in,
        thirds: [ends[1].mean - ends[0].mean, ends[0].half_width.hypot(ends[1].half_width)],
        zero: None,
    })
}

fn run_in(
    tried: &[(f64, Fitted)],
    line: &Fitted,
    (count, neighbours): (usize, f64),
    duration: f64,
) -> Option<RunIn> {
    let (time, best) = tried.iter().min_by(|a, b| a.1.squares.total_cmp(&b.1.squares))?;
    let left = count as f64 - 4.0;
    let ratio = (line.squares - best.squares) / 2.0 / (neighbours * best.squares / left);
    let chance = FisherSnedecor::new(2.0, left).map_or(1.0, |law| law.sf(ratio.max(0.0)));
    // All T that are not worse than chance allows for one number.
    let allowed = best.squares * (1.0 + neighbours * t_quantile(left).powi(2) / left);
    let inside = || tried.iter().filter(|(_, fitted)| fitted.squares <= allowed).map(|(t, _)| *t);
    // At an end of the grid nothing is known beyond it.
    let open = |end: f64, t: f64, factor: f64| if t == end { t * factor } else { t };
    let low = open(tried[0].0, inside().fold(f64::INFINITY, f64::min), 1.0 / OPEN);
    let high = open(tried[tried.len() - 1].0, inside().fold(0.0, f64::max), OPEN);
    let time = [*time, low, high].map(|t| t * duration);
    Some(RunIn { amplitude: best.decay, time, chance })
}

/// The change beside the best run-in; its interval and its chance are the widest of all time constants that chance allows.
fn profile(
    tried: &[(f64, Fitted)],
    change: &dyn Fn(&Fitted) -> ([f64; 3], f64),
    unit: f64,
) -> ([f64; 3], f64) {
    let best = tried.iter().map(|(_, fitted)| fitted.squares).fold(f64::INFINITY, f64::min);
    let mut found = ([f64::NAN, f64::INFINITY, f64::NEG_INFINITY], 0.0_f64);
    for (_, fitted) in tried.iter().filter(|(_, f)| f.squares <= best * (1.0 + 4.0 * unit)) {
        let ([value, low, high], chance) = change(fitted);
        let ([best_value, least, most], largest) = &mut found;
        if fitted.squares == best {
            *best_value = value;
        }
        (*least, *most, *largest) = (least.min(low), most.max(high), largest.max(chance));
    }
    found
}

/// A least-squares fit of c + b (x - 1/2) + a exp(-x / T).
struct Fitted {
    squares: f64,
    slope: f64,
    /// Over the variance of the noise.
    slope_variance: f64,
    decay: f64,
}

impl Fitted {
    fn new(places: &[f64], means: &[f64], time: Option<f64>) -> Option<Self> {
        let row = |x: f64| Vector3::new(1.0, x - 0.5, time.map_or(0.0, |time| (-x / time).exp()));
        // Without a run-in the third coefficient is held at 0.
        let mut normal = Matrix3::zeros();
        normal[(2, 2)] = if time.is_none() { 1.0 } else { 0.0 };
        let centre = mean(means);
        let mut right = Vector3::zeros();
        for (x, y) in places.iter().zip(means) {
            let row = row(*x);
            normal += row * row.transpose();
            right += row * (y - centre);
        }
        let inverse = normal.try_inverse()?;
        let found = inverse * right;
        let squares =
            places.iter().zip(means).map(|(x, y)| (y - centre - row(*x).dot(&found)).powi(2));
        Some(Self {
            squares: squares.sum::<f64>().max(f64::MIN_POSITIVE),
            slope: found[1],
            slope_variance: inverse[(1, 1)],
            decay: found[2],
        })
    }
}

/// P(|t| this large).
pub(super) fn two_sided(t: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |law| 2.0 * law.sf(t.abs()))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Values less their least-squares line.
fn without_line(values: &[f64]) -> Vec<f64> {
    let centre = 0.5 * (values.len() as f64 - 1.0);
    let average = mean(values);
    let (mut above, mut below) = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let x = k as f64 - centre;
        above += x * (value - average);
        below += x * x;
    }
    let slope = above / below.max(f64::MIN_POSITIVE);
    values.iter().enumerate().map(|(k, v)| v - average - slope * (k as f64 - centre)).collect()
}
