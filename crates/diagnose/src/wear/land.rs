//! The wear land in metres, from a few readings of it beside the forces.

use crate::inference::monotone::never_falling;
use crate::wear::growth::{Amount, WearGrowth};
use nalgebra::{DMatrix, DVector};

/// Readings above 0 that are needed.
const FEWEST: usize = 4;
/// Tools with readings from which on whole tools are left out, and not single readings.
const FEWEST_TOOLS: usize = 3;
/// Scatter of ln VB between tools that is compared by its evidence: strength of the work, shape of the land.
const BETWEEN: [f64; 4] = [0.05, 0.1, 0.2, 0.4];
/// And along the life of a tool.
const ALONG: [f64; 4] = [0.03, 0.1, 0.2, 0.4];
/// Over this share of a life it is correlated.
const MEMORY: f64 = 0.5;
/// Scatter of a reading: a share, and a length in m.
const READING: (f64, f64) = (0.05, 5e-6);
/// VB rises with the force in proportion, up to this deviation of the exponent.
const EXPONENT: f64 = 0.3;
/// ln of the factor between them is known to this before a reading.
const LEVEL: f64 = 3.0;
/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.96;

/// The land on a segment, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Land {
    /// VB.
    pub length: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}

/// What readings say of the lands of all tools.
#[derive(Debug, Clone, PartialEq)]
pub struct Lands {
    /// Of every tool and segment, in the order of [`WearGrowth::left_out`].
    pub tools: Vec<Vec<Land>>,
    /// Number of readings above 0.
    pub readings: usize,
    /// Whether whole tools were left out, or single readings.
    pub by_tool: bool,
    /// Mean absolute error of readings that were left out, in m.
    pub error: f64,
    /// The same of a straight line of VB over the change of F_c.
    pub rival: f64,
    /// How many of them lie in their 95 % intervals.
    pub covered: usize,
}

/// A place where the land is read or wanted.
#[derive(Debug, Clone, Copy)]
struct Place {
    tool: usize,
    /// Share of the tool's life.
    age: f64,
    /// ln of the normal force of wear.
    force: f64,
    /// Variance of that by the noise of the forces.
    noise: f64,
}

struct Reading {
    place: Place,
    length: f64,
    /// Change of F_c in N.
    cutting: f64,
}

/// The lands, from the readings in `found`; `None` without any.
///
/// ```text
/// ln VB = a + p ln W + u_tool + f_tool(age) + e,   p ~ N(1, 0.3^2),   u ~ N(0, s_u^2),   f ~ N(0, s_f^2 exp(-|age - age'|/0.5))
/// ```
///
/// W is the isotonic fit of the normal force of wear in the direction that the other tools taught: the land rubs with a pressure that is the same for
/// all, so that W grows in proportion to VB (Waldorf, Kapoor and DeVor, J. Manuf. Sci. Eng. 121 (1999) 548-555), but for a factor of each tool and what
/// changes along its life; ln W has the noise of the forces, which is large where W is small. s_u and s_f are weighed by their evidence; land and ends of its interval are isotonic fits. A reading of 0 says nothing of the factor
/// and is left out.
///
/// # Errors
/// Fewer than four readings above 0: how many there are.
pub fn lands(found: &WearGrowth) -> Result<Option<Lands>, usize> {
    let mut readings = Vec::new();
    let mut any = false;
    let places: Vec<Vec<Place>> = (0..found.left_out.len()).map(|k| places(found, k)).collect();
    for (tool, own) in found.left_out.iter().zip(&places) {
        for (amount, &place) in tool.amounts.iter().zip(own) {
            let Some(length) = amount.segment.land else { continue };
            any = true;
            if length > 0.0 {
                readings.push(Reading { place, length, cutting: amount.cutting_change[0] });
            }
        }
    }
    if !any {
        return Ok(None);
    }
    if readings.len() < FEWEST {
        return Err(readings.len());
    }
    let all: Vec<&Reading> = readings.iter().collect();
    let of_tool = |own: &Vec<Place>| {
        let logs = predicted(&all, own);
        let weights = vec![1.0; logs.len()];
        // The isotonic fit keeps the order of courses: the land stays between its ends.
        let course = |z: f64| {
            let one: Vec<f64> = logs.iter().map(|(mean, s)| mean + z * s).collect();
            never_falling(&one, &weights)
        };
        let (low, middle, high) = (course(-NORMAL_95), course(0.0), course(NORMAL_95));
        let land =
            |k: usize| Land { length: middle[k].exp(), interval: [low[k].exp(), high[k].exp()] };
        (0..logs.len()).map(land).collect()
    };
    let mut with_readings: Vec<usize> = readings.iter().map(|r| r.place.tool).collect();
    with_readings.dedup();
    let by_tool = with_readings.len() >= FEWEST_TOOLS;
    let (mut error, mut rival, mut covered) = (0.0, 0.0, 0);
    for (k, one) in readings.iter().enumerate() {
        let is_out = |j: usize| {
            if by_tool { readings[j].place.tool == one.place.tool } else { j == k }
        };
        let others: Vec<&Reading> =
            (0..readings.len()).filter(|&j| !is_out(j)).map(|j| &readings[j]).collect();
        let (mean, deviation) = predicted(&others, &[one.place])[0];
        let scatter = (deviation * deviation + own_scatter(one.length)).sqrt();
        covered += usize::from((one.length.ln() - mean).abs() < NORMAL_95 * scatter);
        error += (mean.exp() - one.length).abs();
        rival += (straight(&others, one.cutting) - one.length).abs();
    }
    let count = readings.len() as f64;
    Ok(Some(Lands {
        tools: places.iter().map(of_tool).collect(),
        readings: readings.len(),
        by_tool,
        error: error / count,
        rival: rival / count,
        covered,
    }))
}

fn places(found: &WearGrowth, tool: usize) -> Vec<Place> {
    let amounts = &found.left_out[tool].amounts;
    let time = |amount: &Amount| amount.segment.time;
    let (first, last) = (amounts.first().map_or(0.0, time), amounts.last().map_or(1.0, time));
    // Where hardly anything has grown, the interval is that of the noise alone.
    let noise = amounts.iter().map(|a| (a.interval[1] - a.interval[0]) / (2.0 * NORMAL_95));
    let noise = noise.fold(f64::INFINITY, f64::min);
    let place = |amount: &Amount| {
        // Below its noise the force says that the land is small, and not how small.
        let force = amount.never_falling.max(0.0).hypot(noise);
        let age = (time(amount) - first) / (last - first);
        Place { tool, age, force: force.ln(), noise: (noise / force).powi(2) }
    };
    amounts.iter().map(place).collect()
}

fn own_scatter(length: f64) -> f64 {
    READING.0.powi(2) + (READING.1 / length).powi(2)
}

fn kernel(a: &Place, b: &Place, (between, along): (f64, f64)) -> f64 {
    let common = LEVEL * LEVEL + EXPONENT * EXPONENT * a.force * b.force;
    if a.tool != b.tool {
        return common;
    }
    common + between * between + along * along * (-(a.age - b.age).abs() / MEMORY).exp()
}

/// Mean and standard deviation of ln VB at some places.
fn predicted(readings: &[&Reading], at: &[Place]) -> Vec<(f64, f64)> {
    let count = readings.len() as f64;
    // Forces about their mean, so that level and exponent are apart.
    let middle = readings.iter().map(|r| r.place.force).sum::<f64>() / count;
    let centred = |place: &Place| Place { force: place.force - middle, ..*place };
    let places: Vec<Place> = readings.iter().map(|r| centred(&r.place)).collect();
    let rest: Vec<f64> =
        readings.iter().zip(&places).map(|(r, place)| r.length.ln() - place.force).collect();
    let level = rest.iter().sum::<f64>() / count;
    let rest = DVector::from_iterator(rest.len(), rest.iter().map(|x| x - level));
    let mut laws = Vec::new();
    for between in BETWEEN {
        for along in ALONG {
            let sizes = (between, along);
            let covariance = DMatrix::from_fn(places.len(), places.len(), |i, j| {
                let own = own_scatter(readings[i].length) + places[i].noise;
                let own = if i == j { own } else { 0.0 };
                kernel(&places[i], &places[j], sizes) + own
            });
            let Some(known) = covariance.cholesky() else { continue };
            let weights = known.solve(&rest);
            let spread: f64 = known.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
            laws.push((sizes, -0.5 * (rest.dot(&weights) + spread), known, weights));
        }
    }
    let best = laws.iter().map(|law| law.1).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = laws.iter().map(|law| (law.1 - best).exp()).sum();
    let one = |place: &Place| {
        let place = centred(place);
        let (mut mean, mut square) = (0.0, 0.0);
        for (sizes, evidence, known, weights) in &laws {
            let toward = DVector::from_iterator(
                places.len(),
                places.iter().map(|own| kernel(own, &place, *sizes)),
            );
            let log = level + place.force + toward.dot(weights);
            let variance =
                kernel(&place, &place, *sizes) + place.noise - toward.dot(&known.solve(&toward));
            let weight = (evidence - best).exp() / total;
            mean += weight * log;
            square += weight * (variance.max(0.0) + log * log);
        }
        (mean, (square - mean * mean).max(0.0).sqrt())
    };
    at.iter().map(one).collect()
}

/// VB by a straight line over the change of F_c, least squares.
fn straight(readings: &[&Reading], cutting: f64) -> f64 {
    let count = readings.len() as f64;
    let mean = |of: fn(&Reading) -> f64| readings.iter().map(|r| of(r)).sum::<f64>() / count;
    let (x, y) = (mean(|r| r.cutting), mean(|r| r.length));
    let product: f64 = readings.iter().map(|r| (r.cutting - x) * (r.length - y)).sum();
    let square: f64 = readings.iter().map(|r| (r.cutting - x).powi(2)).sum();
    if square > 0.0 { y + product / square * (cutting - x) } else { y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wear::growth::{WearSegment, grows};
    use sphcut_greybox::Random;

    /// Five tools whose land grows at its own pace to 200 to 500 um; pressure and strength differ from tool to tool by 10 %, and the force falls below
    /// proportion as the contact gets hot. Every eighth segment has a reading, but for the tools in `bare`.
    fn series(seed: u64, bare: &[usize]) -> (Vec<WearSegment>, Vec<f64>) {
        let mut random = Random::new(seed, &[4]);
        let (mut segments, mut truth) = (Vec::new(), Vec::new());
        for tool in 0..5 {
            let (reach, power) = (2e-4 + 3e-4 * random.uniform(), 0.6 + 0.8 * random.uniform());
            let pressure = 3e5 * (0.1 * random.normal()).exp();
            for k in 0..40 {
                let land = reach * (f64::from(k) / 39.0).powf(power);
                let force = pressure * land * (1.0 - 0.2 * land / 5e-4);
                let forces = [(500.0, 0.25), (350.0, 0.9), (150.0, 0.43)]
                    .map(|(fresh, share)| fresh + share * force + 1.5 * random.normal());
                let read = k % 8 == 7 && !bare.contains(&tool);
                let reading = land * (0.04 * random.normal()).exp();
                segments.push(WearSegment {
                    tool: tool.to_string(),
                    time: 5.0 * f64::from(k),
                    forces,
                    land: read.then_some(reading),
                });
                truth.push(land);
            }
        }
        (segments, truth)
    }

    #[test]
    fn a_few_readings_give_the_land_of_every_tool_with_its_interval() {
        let (mut inside, mut count, mut worst) = (0, 0_u32, Vec::new());
        for seed in 1..=8 {
            let (segments, truth) = series(seed, &[1, 3]);
            let found = grows(&segments, 1).unwrap();
            let lands = lands(&found).unwrap().unwrap();
            assert_eq!((lands.readings, lands.by_tool), (15, true));
            // Tools without a reading, from where the land is seen on.
            for tool in [1, 3] {
                for k in 10..40 {
                    let (land, truth) = (lands.tools[tool][k], truth[40 * tool + k]);
                    assert!((land.interval[0]..=land.interval[1]).contains(&land.length));
                    inside += usize::from(land.interval[0] < truth && truth < land.interval[1]);
                    worst.push((land.length / truth - 1.0).abs());
                    count += 1;
                }
                let course = &lands.tools[tool];
                assert!(course.windows(2).all(|two| two[0].length <= two[1].length));
            }
        }
        let mean = worst.iter().sum::<f64>() / worst.len() as f64;
        // Sixteen tools without a reading, each with a factor of its own of 10 %.
        assert!(mean < 0.2, "{mean}");
        assert!(inside as f64 > 0.85 * f64::from(count), "{inside} of {count}");
    }

    #[test]
    fn own_readings_hold_the_course_of_a_tool_and_none_are_no_answer() {
        let (segments, truth) = series(3, &[]);
        let found = grows(&segments, 1).unwrap();
        let all = lands(&found).unwrap().unwrap();
        let mean = |tools: &[Vec<Land>]| {
            let logs = tools.iter().flatten().zip(&truth).filter(|(_, t)| **t > 5e-5);
            let errors: Vec<f64> = logs.map(|(l, t)| (l.length / t - 1.0).abs()).collect();
            errors.iter().sum::<f64>() / errors.len() as f64
        };
        assert!(mean(&all.tools) < 0.07, "{}", mean(&all.tools));
        assert!(all.covered >= 22, "{} of 25", all.covered);
        let mut none = segments.clone();
        none.iter_mut().for_each(|segment| segment.land = None);
        assert_eq!(lands(&grows(&none, 1).unwrap()), Ok(None));
        none[10].land = Some(1e-4);
        none[20].land = Some(0.0);
        assert_eq!(lands(&grows(&none, 1).unwrap()), Err(1));
    }
}
