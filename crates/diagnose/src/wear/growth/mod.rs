//! What grows while a tool cuts: forces of tools from fresh to worn, one cut after the other under the same conditions.
//!
//! No model of the cut is asked: the state of each tool when it was fresh is what it is compared with, so what a simulation
//! gets wrong by itself cancels. What is left has a direction in the space of the forces, and causes differ in it:
//!
//! | cause | direction of the change of (F_c, F_f, F_p) | why |
//! |---|---|---|
//! | wear land | (mu, cos psi, sin psi), mu from 0.05 to 0.6 | a land rubs: normal force and friction of it |
//! | rounding of the edge | (q, cos psi, sin psi), q from 0.47 to 0.66 | normal stress on the arc below the separation at 45 degrees, friction up to the shear strength (`sphcut_analytic::edge`) |
//! | strength | the forces of the fresh tool | the cut becomes harder as a whole, or the sensitivity changes |
//! | none of these | any other | |
//! | zero drift | any, in proportion to the time since the first cut of the first tool | it does not go back when the tool is changed |
//!
//! psi, the direction of the normal force between feed and passive force, is unknown and the same for all tools: their geometry is. With the
//! changes y_b between successive parts of a tool's life,
//!
//! ```text
//! y_b = sum_j a_jb (d_j + e_jb) + noise,   a_jb normal around 0 with the deviation A_jb,   e normal with tau
//! ```
//!
//! noise with s^2 (1/n + 1/n'), s from second differences of the segments, in which a steady growth cancels; tau by how far a change may
//! point beside its direction. Each change has an A of its own, of four sizes with equal probability: some parts of a life change little
//! and some much. The
//! evidence of a cause is the mean over grids of mu, psi, A and tau. Then each tool is left out in turn: directions are learnt from the
//! others, and the amount on each segment of the tool left out follows by weighted least squares.

use crate::error::DiagnoseError;
use crate::inference::monotone::never_falling;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::FRAC_PI_2;

/// Parts of a life, after the fresh ones.
const PARTS: usize = 6;
/// Segments that a tool needs beside its fresh ones.
const FEWEST_SEGMENTS: usize = 2 * PARTS;
/// Tools that are needed.
const FEWEST_TOOLS: usize = 3;
/// Less scatter than this share of the mean force is none: a column of one value, or one that somebody drew.
const LEAST_NOISE: f64 = 1e-6;
/// How far a change may point beside its direction.
const BESIDE: [f64; 4] = [0.05, 0.1, 0.2, 0.3];
/// Deviations of amounts, as shares of the root mean square of the changes.
const AMOUNTS: [f64; 4] = [0.1, 0.3, 1.0, 3.0];
/// Steps of psi from 0 to 90 degrees.
const ANGLES: usize = 18;
/// Scatter of the forces of fresh tools among themselves, as a share.
const FRESH: f64 = 0.1;
/// Probabilities before the data: nothing, the single causes together, pairs together, none of these.
const PRIORS: [f64; 4] = [0.3, 0.5, 0.1, 0.1];
/// Half width of a 95 % interval in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Mean forces of a piece of a cut.
#[derive(Debug, Clone, PartialEq)]
pub struct WearSegment {
    /// Name of the tool.
    pub tool: String,
    /// Time in cut at its middle, in s.
    pub time: f64,
    /// F_c, F_f and F_p in N.
    pub forces: [f64; 3],
    /// VB in m, where it was read.
    pub land: Option<f64>,
}

/// What may grow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Nothing.
    Nothing,
    /// A wear land on the flank.
    WearLand,
    /// The rounding of the edge.
    Rounding,
    /// All forces in proportion.
    Strength,
    /// The zeros of the channels.
    ZeroDrift,
    /// Wear land and strength.
    WearLandAndStrength,
    /// Rounding and strength.
    RoundingAndStrength,
    /// Something in no direction of these.
    NoneOfThese,
}

impl Cause {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Nothing,
        Self::WearLand,
        Self::Rounding,
        Self::Strength,
        Self::ZeroDrift,
        Self::WearLandAndStrength,
        Self::RoundingAndStrength,
        Self::NoneOfThese,
    ];

    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::WearLand => "flank_wear",
            Self::Rounding => "edge_rounding",
            Self::Strength => "strength",
            Self::ZeroDrift => "zero_drift",
            Self::WearLandAndStrength => "flank_wear+strength",
            Self::RoundingAndStrength => "edge_rounding+strength",
            Self::NoneOfThese => "none_of_these",
        }
    }

    /// Its name for people.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Nothing => "nothing grows",
            Self::WearLand => "a wear land grows on the flank",
            Self::Rounding => "the rounding of the edge grows",
            Self::Strength => "all forces grow in proportion",
            Self::ZeroDrift => "the zeros of the channels drift",
            Self::WearLandAndStrength => "a wear land grows, and all forces in proportion",
            Self::RoundingAndStrength => {
                "the rounding of the edge grows, and all forces in proportion"
            }
            Self::NoneOfThese => "something in no direction of these",
        }
    }

    /// Whether the edge wears: a land or a rounding.
    #[must_use]
    pub const fn is_wear(self) -> bool {
        self.ratios().is_some()
    }

    /// Ratios of F_c to the force normal to it that the edge may have.
    const fn ratios(self) -> Option<[f64; 2]> {
        match self {
            Self::WearLand | Self::WearLandAndStrength => Some([0.05, 0.6]),
            // (1 - cos s + mu sin s) / (sin s - mu (1 - cos s)) at s = 45 degrees, mu from 0.05 to 1 / (2 + pi).
            Self::Rounding | Self::RoundingAndStrength => Some([0.47, 0.66]),
            _ => None,
        }
    }

    const fn has_strength(self) -> bool {
        matches!(self, Self::Strength | Self::WearLandAndStrength | Self::RoundingAndStrength)
    }

    fn prior(self) -> f64 {
        let [nothing, single, pair, none] = PRIORS;
        match self {
            Self::Nothing => nothing,
            Self::WearLand | Self::Rounding | Self::Strength | Self::ZeroDrift => single / 4.0,
            Self::WearLandAndStrength | Self::RoundingAndStrength => pair / 2.0,
            Self::NoneOfThese => none,
        }
    }
}

/// Where the edge's force points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// F_c over the force normal to it.
    pub ratio: f64,
    /// Angle of the normal force from the feed force to the passive force, in rad.
    pub angle: f64,
    /// How far changes point beside it.
    pub beside: f64,
}

impl Direction {
    fn vector(self) -> Vector3<f64> {
        Vector3::new(self.ratio, self.angle.cos(), self.angle.sin())
    }
}

/// The normal force of wear on a segment, in N, as its tool left out says.
#[derive(Debug, Clone, PartialEq)]
pub struct Amount {
    /// The segment.
    pub segment: WearSegment,
    /// Normal force between the worn edge and the work, with its 95 % interval.
    pub force: f64,
    /// The interval.
    pub interval: [f64; 2],
    /// The same by the nearest course that never falls: a land does not shrink while a tool cuts. But its force may, where the contact
    /// becomes hotter and the material softer; and an insert that was ground or swapped takes the land back.
    pub never_falling: f64,
    /// Change of F_c since the tool was fresh, in N: measured, and by the changes of F_f and F_p.
    pub cutting_change: [f64; 2],
}

/// A tool left out.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutTool {
    /// The tool.
    pub tool: String,
    /// Probability of wear by the others alone.
    pub wear: f64,
    /// Mean error of the change of F_c that follows from that of F_f and F_p, in N.
    pub error: f64,
    /// Mean change of F_c, in N: the error if nothing grew.
    pub change: f64,
    /// How far the force departs from the course that never falls: root mean square over the standard deviation by which a segment
    /// scatters beside its neighbours.
    pub fall: f64,
    /// The amounts.
    pub amounts: Vec<Amount>,
}

impl LeftOutTool {
    /// Whether it falls by more than its noise: a sum of squares beyond the 99 % quantile of chi^2 with as many degrees of freedom as
    /// segments. Of a course that never falls fewer are left, so that this is rarer than in one of a hundred tools.
    #[must_use]
    pub fn is_unsteady(&self) -> bool {
        let count = self.amounts.len() as f64;
        let law = ChiSquared::new(count).expect("a tool has segments");
        count * self.fall * self.fall > law.inverse_cdf(0.99)
    }
}

/// What grows.
#[derive(Debug, Clone, PartialEq)]
pub struct WearGrowth {
    /// The causes with their probabilities, the most probable first.
    pub causes: Vec<(Cause, f64)>,
    /// Direction of wear by all tools.
    pub direction: Direction,
    /// Standard deviation of a segment's forces, in N.
    pub noise: [f64; 3],
    /// Each tool left out.
    pub left_out: Vec<LeftOutTool>,
}

impl WearGrowth {
    /// Probability that the edge wears.
    #[must_use]
    pub fn wear(&self) -> f64 {
        self.causes.iter().filter(|(cause, _)| cause.is_wear()).map(|(_, p)| p).sum()
    }

    /// Mean error of F_c over its change, all tools left out.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        let sum = |of: fn(&LeftOutTool) -> f64| self.left_out.iter().map(of).sum::<f64>();
        sum(|tool| tool.error) / sum(|tool| tool.change)
    }
}

struct Tool {
    name: String,
    segments: Vec<WearSegment>,
    fresh: Vector3<f64>,
    /// Successive changes with their variances and times.
    changes: Vec<Change>,
}

struct Change {
    of: Vector3<f64>,
    variance: Vector3<f64>,
    time: f64,
    /// Direction of the fresh forces.
    fresh: Vector3<f64>,
}

/// What grows over the lives of some tools, whose first `fresh` segments are taken as the state in which nothing has grown.
///
/// # Errors
/// Fewer than three tools, a tool with too few segments, a force without scatter, times that do not go on.
pub fn grows(segments: &[WearSegment], fresh: usize) -> Result<WearGrowth, DiagnoseError> {
    let (tools, noise) = tools(segments, fresh.max(1))?;
    let all: Vec<&Tool> = tools.iter().collect();
    let (causes, direction) = weigh(&all);
    let left_out = (0..tools.len())
        .map(|k| {
            let others: Vec<&Tool> =
                (0..tools.len()).filter(|&j| j != k).map(|j| &tools[j]).collect();
            let (causes, direction) = weigh(&others);
            let wear = causes.iter().filter(|(cause, _)| cause.is_wear()).map(|(_, p)| p).sum();
            left_out(&tools[k], wear, direction, (noise, fresh.max(1)))
        })
        .collect();
    Ok(WearGrowth { causes, direction, noise: noise.map(f64::sqrt).into(), left_out })
}

fn tools(
    segments: &[WearSegment],
    fresh: usize,
) -> Result<(Vec<Tool>, Vector3<f64>), DiagnoseError> {
    let mut names: Vec<&str> = Vec::new();
    for segment in segments {
        if !names.contains(&segment.tool.as_str()) {
            names.push(&segment.tool);
        }
    }
    if names.len() < FEWEST_TOOLS {
        return Err(DiagnoseError::TooFewTools { found: names.len(), needed: FEWEST_TOOLS });
    }
    let of = |name: &&str| {
        let mut own: Vec<WearSegment> =
            segments.iter().filter(|segment| segment.tool == *name).cloned().collect();
        own.sort_by(|a, b| a.time.total_cmp(&b.time));
        own
    };
    let lives: Vec<Vec<WearSegment>> = names.iter().map(of).collect();
    let (mut squares, mut count) = (Vector3::zeros(), 0.0);
    for (life, &tool) in lives.iter().zip(&names) {
        if life.len() < fresh + FEWEST_SEGMENTS {
            let needed = fresh + FEWEST_SEGMENTS;
            let tool = tool.to_owned();
            return Err(DiagnoseError::TooFewSegments { tool, found: life.len(), needed });
        }
        for three in life.windows(3) {
            let bend = forces(&three[2]) - forces(&three[1]) * 2.0 + forces(&three[0]);
            squares += bend.component_mul(&bend) / 6.0;
            count += 1.0;
        }
    }
    let noise: Vector3<f64> = squares / count;
    let total: Vector3<f64> = segments.iter().map(forces).sum();
    for (k, column) in ["F_c", "F_f", "F_p"].into_iter().enumerate() {
        if noise[k].sqrt() <= LEAST_NOISE * total[k] / segments.len() as f64 {
            let what = "does not scatter from segment to segment";
            return Err(DiagnoseError::NoSeries { column, what });
        }
    }
    // Times that are rounded may stand twice; a life without a length has no drift.
    if lives.iter().any(|life| life[0].time >= life[life.len() - 1].time) {
        let what = "is the same in all segments of a tool";
        return Err(DiagnoseError::NoSeries { column: "time", what });
    }
    let made = lives.into_iter().zip(names).map(|(segments, name)| {
        let (first, rest) = segments.split_at(fresh);
        let start = mean(first);
        let mut parts = vec![first];
        let bounds: Vec<usize> = (0..=PARTS).map(|k| k * rest.len() / PARTS).collect();
        parts.extend(bounds.windows(2).map(|ends| &rest[ends[0]..ends[1]]));
        let changes = parts.windows(2).map(|pair| Change {
            of: mean(pair[1]) - mean(pair[0]),
            variance: noise * (1.0 / pair[0].len() as f64 + 1.0 / pair[1].len() as f64),
            time: middle(pair[1]) - middle(pair[0]),
            fresh: start.normalize(),
        });
        let changes = changes.collect();
        Tool { name: name.to_owned(), fresh: start, changes, segments }
    });
    Ok((made.collect(), noise))
}

fn forces(segment: &WearSegment) -> Vector3<f64> {
    Vector3::from(segment.forces)
}

fn mean(segments: &[WearSegment]) -> Vector3<f64> {
    segments.iter().map(forces).sum::<Vector3<f64>>() / segments.len() as f64
}

fn middle(segments: &[WearSegment]) -> f64 {
    segments.iter().map(|segment| segment.time).sum::<f64>() / segments.len() as f64
}

/// The probabilities of all causes, and the most likely direction of wear.
fn weigh(tools: &[&Tool]) -> (Vec<(Cause, f64)>, Direction) {
    let mut best = (f64::NEG_INFINITY, Direction { ratio: 0.0, angle: 0.0, beside: 0.0 });
    let logs: Vec<f64> =
        Cause::ALL.iter().map(|&cause| evidence(cause, tools, &mut best)).collect();
    let weights: Vec<f64> =
        Cause::ALL.iter().zip(&logs).map(|(cause, log)| cause.prior().ln() + log).collect();
    let most = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = weights.iter().map(|weight| (weight - most).exp()).sum();
    let mut causes: Vec<(Cause, f64)> =
        Cause::ALL.into_iter().zip(weights.iter().map(|w| (w - most).exp() / total)).collect();
    causes.sort_by(|a, b| b.1.total_cmp(&a.1));
    (causes, best.1)
}

/// log of the mean likelihood over the grids; keeps the most likely direction of wear in `best`.
fn evidence(cause: Cause, tools: &[&Tool], best: &mut (f64, Direction)) -> f64 {
    let changes: Vec<&Change> = tools.iter().flat_map(|tool| &tool.changes).collect();
    let square = changes.iter().map(|c| c.of.norm_squared()).sum::<f64>() / changes.len() as f64;
    let amounts = AMOUNTS.map(|share| share * share * square);
    let mut logs = Vec::new();
    if cause == Cause::ZeroDrift {
        for beside in BESIDE {
            logs.extend(amounts.map(|amount| drifting(tools, beside, amount)));
        }
        return log_mean(&logs);
    }
    let directions: Vec<Option<(f64, f64)>> = match cause.ratios() {
        _ if cause == Cause::NoneOfThese => anywhere().map(Some).collect(),
        None => vec![None],
        Some([low, high]) => {
            let steps = ((high - low) / 0.05).round() as usize;
            let ratio = |i: usize| low + (high - low) * i as f64 / steps as f64;
            let angle = |j: usize| FRAC_PI_2 * (j as f64 + 0.5) / ANGLES as f64;
            let all = (0..=steps).flat_map(|i| (0..ANGLES).map(move |j| (i, j)));
            all.map(|(i, j)| Some((ratio(i), angle(j)))).collect()
        }
    };
    let reset = fresh_changes(tools);
    for direction in directions {
        for beside in BESIDE {
            let along = direction.map(|(ratio, angle)| Direction { ratio, angle, beside });
            let each = changes.iter().map(|change| {
                let mut parts: Vec<Matrix3<f64>> = Vec::new();
                parts.extend(along.map(|along| around(along.vector(), beside)));
                parts.extend(cause.has_strength().then(|| around(change.fresh, beside)));
                any_amount(change, &parts, &amounts)
            });
            let log = each.sum::<f64>() + reset;
            if let Some(along) = along.filter(|_| cause.is_wear())
                && log > best.0
            {
                *best = (log, along);
            }
            logs.push(log);
        }
    }
    log_mean(&logs)
}

/// d d' + tau^2 I.
fn around(direction: Vector3<f64>, beside: f64) -> Matrix3<f64> {
    direction * direction.transpose() + Matrix3::identity() * (beside * beside)
}

/// log of the density of a change whose parts have amounts of any of the sizes.
fn any_amount(change: &Change, parts: &[Matrix3<f64>], amounts: &[f64]) -> f64 {
    let noise = Matrix3::from_diagonal(&change.variance);
    let mut covariances = vec![noise];
    for part in parts {
        covariances = covariances
            .iter()
            .flat_map(|own| amounts.iter().map(move |amount| own + part * *amount))
            .collect();
    }
    let logs: Vec<f64> = covariances.iter().map(|covariance| normal(change, covariance)).collect();
    log_mean(&logs)
}

/// Ratios and angles of all directions but those of wear, the opposite ones left out.
fn anywhere() -> impl Iterator<Item = (f64, f64)> {
    let steps = |i: usize| std::f64::consts::PI * ((i as f64 + 0.5) / ANGLES as f64 - 0.5);
    let all = (0..ANGLES).flat_map(move |i| (0..ANGLES).map(move |j| (steps(i).tan(), steps(j))));
    all.filter(|(ratio, angle)| *angle < 0.0 || !(0.0..=0.7).contains(ratio))
}

fn normal(change: &Change, covariance: &Matrix3<f64>) -> f64 {
    let Some(factor) = covariance.cholesky() else { return f64::NEG_INFINITY };
    let determinant: f64 = factor.l_dirty().diagonal().iter().map(|d| 2.0 * d.ln()).sum();
    -0.5 * (change.of.dot(&factor.solve(&change.of)) + determinant)
}

/// log of the density of the differences between successive fresh tools.
fn fresh_changes(tools: &[&Tool]) -> f64 {
    let each = tools.windows(2).map(|pair| {
        let (off, scale) = (pair[1].fresh - pair[0].fresh, pair[0].fresh * FRESH);
        let part = |k: usize| (off[k] / scale[k]).powi(2) + 2.0 * scale[k].ln();
        -0.5 * (0..3).map(part).sum::<f64>()
    });
    each.sum()
}

/// Zeros that drift: each channel with a rate of its own over the time of all tools; the tool's change does not reset it.
fn drifting(tools: &[&Tool], beside: f64, amount: f64) -> f64 {
    let time = tools.iter().flat_map(|t| &t.changes).map(|c| c.time).sum::<f64>()
        / tools.iter().map(|t| t.changes.len()).sum::<usize>() as f64;
    let variance_of_rate = amount / (time * time);
    let mut sum = 0.0;
    for channel in 0..3 {
        let mut rows: Vec<[f64; 3]> = Vec::new();
        for tool in tools {
            let own = tool.changes.iter();
            rows.extend(own.map(|c| {
                let unsteady = variance_of_rate * (beside * c.time).powi(2);
                [c.of[channel], c.time, c.variance[channel] + unsteady]
            }));
        }
        rows.extend(tools.windows(2).map(|pair| {
            let life: f64 = pair[0].changes.iter().map(|c| c.time).sum();
            let scale = pair[0].fresh[channel] * FRESH;
            [pair[1].fresh[channel] - pair[0].fresh[channel], life, scale * scale]
        }));
        let (mut square, mut product, mut times) = (0.0, 0.0, 1.0 / variance_of_rate);
        for [value, time, variance] in rows {
            square += value * value / variance + variance.ln();
            product += value * time / variance;
            times += time * time / variance;
        }
        sum += -0.5 * (square - product * product / times + (times * variance_of_rate).ln());
    }
    sum
}

fn log_mean(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + (logs.iter().map(|log| (log - most).exp()).sum::<f64>() / logs.len() as f64).ln()
}

/// The amounts on a tool by a direction that it did not teach.
fn left_out(
    tool: &Tool,
    wear: f64,
    direction: Direction,
    (noise, fresh): (Vector3<f64>, usize),
) -> LeftOutTool {
    let along = direction.vector();
    let (mut error, mut change) = (0.0, 0.0);
    let mut weights = Vec::new();
    let amounts = tool.segments.iter().map(|segment| {
        let of = forces(segment) - tool.fresh;
        let variance = noise * (1.0 + 1.0 / fresh as f64);
        let spread = variance.add_scalar((direction.beside * of.norm()).powi(2));
        let least = |channels: &[usize]| {
            let d = DVector::from_iterator(channels.len(), channels.iter().map(|&k| along[k]));
            let inverse: Vec<f64> = channels.iter().map(|&k| 1.0 / spread[k]).collect();
            let inverse = DMatrix::from_diagonal(&DVector::from_vec(inverse));
            let y = DVector::from_iterator(channels.len(), channels.iter().map(|&k| of[k]));
            let weighted = &inverse * &d;
            let precision = d.dot(&weighted);
            // What a single segment scatters by: the direction and the fresh state are the same for all segments.
            let own = channels.iter().zip(weighted.iter()).map(|(&k, w)| w * w * noise[k]);
            (weighted.dot(&y) / precision, precision, own.sum::<f64>() / (precision * precision))
        };
        let (without, ..) = least(&[1, 2]);
        let cutting_change = [of[0], without * along[0]];
        error += (of[0] - cutting_change[1]).abs();
        change += of[0].abs();
        let (force, precision, own) = least(&[0, 1, 2]);
        let half = NORMAL_95 / precision.sqrt();
        weights.push(1.0 / own);
        let interval = [force - half, force + half];
        Amount { segment: segment.clone(), force, interval, never_falling: force, cutting_change }
    });
    let mut amounts: Vec<Amount> = amounts.collect();
    let count = amounts.len() as f64;
    let raw: Vec<f64> = amounts.iter().map(|amount| amount.force).collect();
    let rising = never_falling(&raw, &weights);
    let squares = raw.iter().zip(&rising).zip(&weights).map(|((a, b), w)| w * (a - b).powi(2));
    let fall = (squares.sum::<f64>() / count).sqrt();
    amounts.iter_mut().zip(rising).for_each(|(amount, force)| amount.never_falling = force);
    LeftOutTool {
        tool: tool.name.clone(),
        wear,
        error: error / count,
        change: change / count,
        fall,
        amounts,
    }
}

#[cfg(test)]
mod tests;
