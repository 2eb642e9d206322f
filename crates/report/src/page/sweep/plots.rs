//! Forces of a sweep over its conditions.

use crate::kit::colours::{BLUE, DISTINCT, GREY};
use crate::kit::map::{ColourScale, Map, ValueAt};
use crate::kit::numbers::{M_PER_MIN, MM, three_digits};
use crate::kit::plot::{Axis, Plot};
use sphcut_greybox::{Hull, Input};
use sphcut_sweep::{ForcePoint, SweepTable};

/// Conditions closer than this share are one.
const SAME: f64 = 1e-6;

/// A force at a cutting speed in m/s and an uncut chip thickness in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ForceAt {
    pub(super) at: Input,
    pub(super) value: f64,
    /// Number of the (first) run it is of; `None` of a measured one.
    pub(super) run: Option<usize>,
}

/// The mean of all results at each condition, sorted.
pub(super) fn points(table: &SweepTable, force: usize) -> Vec<ForceAt> {
    let mut all: Vec<(ForceAt, f64)> = Vec::new();
    for row in &table.rows {
        let (Some(condition), Some([mean, _])) = (row.condition, row.forces[force]) else {
            continue;
        };
        let at = [condition.cutting_speed, condition.uncut_chip_thickness];
        let known = |a: &ForceAt| same(a.at[0], at[0]) && same(a.at[1], at[1]);
        match all.iter_mut().find(|(point, _)| known(point)) {
            Some((sum, count)) => (sum.value, *count) = (sum.value + mean, *count + 1.0),
            None => all.push((ForceAt { at, value: mean, run: Some(row.number) }, 1.0)),
        }
    }
    let mut points: Vec<ForceAt> =
        all.into_iter().map(|(sum, count)| ForceAt { value: sum.value / count, ..sum }).collect();
    points.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]).then(a.at[1].total_cmp(&b.at[1])));
    points
}

/// The same as trends are found in.
pub(super) fn force_points(points: &[ForceAt]) -> Vec<ForcePoint> {
    points.iter().map(|point| ForcePoint { at: point.at, force: point.value }).collect()
}

pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// The different values of one input, rising.
pub(super) fn levels(points: &[ForceAt], axis: usize) -> Vec<f64> {
    let mut values: Vec<f64> = points.iter().map(|point| point.at[axis]).collect();
    values.sort_by(f64::total_cmp);
    values.dedup_by(|a, b| same(*a, *b));
    values
}

/// The points on a full grid of speeds and thicknesses, row by row of speeds; `None` if one is missing.
struct Grid {
    speeds: Vec<f64>,
    thicknesses: Vec<f64>,
    values: Vec<f64>,
}

impl Grid {
    fn new(points: &[ForceAt]) -> Option<Self> {
        let (speeds, thicknesses) = (levels(points, 0), levels(points, 1));
        if speeds.len() < 2
            || thicknesses.len() < 2
            || points.len() != speeds.len() * thicknesses.len()
        {
            return None;
        }
        // Sorted by speed, then by thickness.
        Some(Self { speeds, thicknesses, values: points.iter().map(|point| point.value).collect() })
    }

    /// Linear between the conditions, constant beyond.
    fn value(&self, at: Input) -> f64 {
        let place = |levels: &[f64], value: f64| {
            let upper = levels.partition_point(|level| *level <= value).clamp(1, levels.len() - 1);
            let (low, high) = (levels[upper - 1], levels[upper]);
            (upper - 1, ((value - low) / (high - low)).clamp(0.0, 1.0))
        };
        let ((i, a), (j, b)) = (place(&self.speeds, at[0]), place(&self.thicknesses, at[1]));
        let of = |i: usize, j: usize| self.values[i * self.thicknesses.len() + j];
        (1.0 - a) * ((1.0 - b) * of(i, j) + b * of(i, j + 1))
            + a * ((1.0 - b) * of(i + 1, j) + b * of(i + 1, j + 1))
    }
}

/// Where a click on a run leads.
pub(super) type Links<'a> = &'a dyn Fn(usize) -> Option<String>;

/// The surface with the measured points on it; `None` without speeds and thicknesses.
pub(super) fn map(
    points: &[ForceAt],
    measured: &[ForceAt],
    symbol: &str,
    links: Links<'_>,
) -> Option<String> {
    if levels(points, 0).len() < 2 || levels(points, 1).len() < 2 {
        return None;
    }
    let grid = Grid::new(points);
    let surface = |at: Input| grid.as_ref().map_or(f64::NAN, |grid| grid.value(at));
    let dots = if measured.is_empty() { points } else { measured };
    let inputs: Vec<Input> = points.iter().chain(measured).map(|point| point.at).collect();
    let simulated: Vec<Input> = points.iter().map(|point| point.at).collect();
    let hull = Hull::around(&simulated);
    let map = Map {
        title: symbol.to_owned(),
        description: format!("{symbol} over cutting speed and uncut chip thickness."),
        quantity: format!("{symbol} in N"),
        colours: ColourScale::of_range(points.iter().chain(dots).map(|point| point.value)),
        hull: &hull,
        inputs: &inputs,
        surface: grid.is_some().then_some(&surface as &dyn Fn(Input) -> f64),
        points: dots
            .iter()
            .map(|point| ValueAt {
                at: point.at,
                value: point.value,
                link: point.run.and_then(links),
            })
            .collect(),
    };
    Some(map.svg())
}

/// First, middle and last of the levels of the other input; lines over `axis`.
pub(super) fn slices(
    points: &[ForceAt],
    measured: &[ForceAt],
    symbol: &str,
    axis: usize,
    links: Links<'_>,
) -> Option<String> {
    let fixed = 1 - axis;
    let chosen = chosen(&levels(points, fixed));
    let along: Vec<f64> = points.iter().map(|point| point.at[axis]).collect();
    if levels(points, axis).len() < 2 {
        return None;
    }
    let scale = [M_PER_MIN, MM];
    let near = |point: &&ForceAt, level: f64| (point.at[fixed] - level).abs() <= 0.01 * level.abs();
    let of = |from: &[ForceAt], level: f64| -> Vec<ForceAt> {
        from.iter().filter(|point| near(point, level)).copied().collect()
    };
    let lines: Vec<Vec<ForceAt>> = chosen.iter().map(|level| of(points, *level)).collect();
    let dots: Vec<Vec<ForceAt>> = chosen.iter().map(|level| of(measured, *level)).collect();
    let values = lines.iter().chain(&dots).flatten().map(|point| point.value);
    let titles = ["v_c in m/min", "h in mm"];
    let mut plot = Plot::new(
        Axis::of_conditions(titles[axis], along.iter().map(|value| value * scale[axis])),
        Axis::linear(&format!("{symbol} in N"), values.clone(), 0.05),
        14.0,
        "Slices of the simulated forces with the measured points.",
    );
    plot.axes("", true);
    let mut names = Vec::new();
    for (((level, line), dots), colour) in chosen.iter().zip(&lines).zip(&dots).zip(DISTINCT) {
        let place = |point: &ForceAt| [point.at[axis] * scale[axis], point.value];
        let ends: Vec<[f64; 2]> = line.iter().map(place).collect();
        plot.line(&ends, &format!(r#"stroke="{colour}" stroke-width="2""#));
        for point in if dots.is_empty() { line } else { dots } {
            let [x, y] = place(point);
            plot.linked(point.run.and_then(links).as_deref(), |plot| {
                plot.dot(
                    x,
                    y,
                    4.0,
                    &format!(r##"fill="{colour}" stroke="#fff" stroke-width="1""##),
                );
            });
        }
        let value = three_digits(level * scale[fixed]);
        names.push((colour, format!("{value} {}", ["m/min", "mm"][fixed])));
    }
    let entries: Vec<(&str, &str)> = names.iter().map(|(c, n)| (*c, n.as_str())).collect();
    plot.legend(&entries);
    Some(plot.finish())
}

fn chosen(levels: &[f64]) -> Vec<f64> {
    match levels {
        [] => Vec::new(),
        [one] => vec![*one],
        [one, other] => vec![*one, *other],
        many => vec![many[0], many[many.len() / 2], many[many.len() - 1]],
    }
}

/// All runs over a key that is neither speed nor thickness; `None` where it is one or does not vary.
pub(super) fn scatter(
    table: &SweepTable,
    (axis, key, unit): (usize, &str, &str),
    (force, symbol): (usize, &str),
    links: Links<'_>,
) -> Option<String> {
    if ["process.cutting_speed", "process.uncut_chip_thickness"].contains(&key) {
        return None;
    }
    let points: Vec<(usize, [f64; 3])> = table
        .rows
        .iter()
        .filter_map(|row| {
            let [mean, half] = row.forces[force]?;
            Some((row.number, [row.numbers[axis]?, mean, half]))
        })
        .collect();
    let (_, first) = points.first()?;
    if points.iter().all(|(_, point)| same(point[0], first[0])) {
        return None;
    }
    let title = if unit.is_empty() { key.to_owned() } else { format!("{key} in {unit}") };
    // An underscore would make an index of the letter after it.
    let title = title.replace('_', " ");
    let ends = points.iter().flat_map(|(_, [_, mean, half])| {
        let half = if half.is_finite() { *half } else { 0.0 };
        [mean - half, mean + half]
    });
    let mut plot = Plot::new(
        Axis::of_conditions(&title, points.iter().map(|(_, point)| point[0])),
        Axis::linear(&format!("{symbol} in N"), ends, 0.05),
        14.0,
        "Forces of all runs over one key.",
    );
    plot.axes("", true);
    for (run, [x, mean, half]) in points {
        if half.is_finite() {
            plot.line(
                &[[x, mean - half], [x, mean + half]],
                &format!(r#"stroke="{GREY}" stroke-width="1.2""#),
            );
        }
        plot.linked(links(run).as_deref(), |plot| {
            plot.dot(
                x,
                mean,
                3.6,
                &format!(r#"fill="{BLUE}" opacity="0.8" data-note="run {run}""#),
            );
        });
    }
    Some(plot.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_is_linear_between_the_conditions() {
        let plane = |at: Input| 3.0 * at[0] - 2.0 * at[1] + 1.0;
        let points: Vec<ForceAt> = [1.0, 2.0, 4.0]
            .into_iter()
            .flat_map(|v| {
                [10.0, 20.0].map(|h| ForceAt { at: [v, h], value: plane([v, h]), run: None })
            })
            .collect();
        let grid = Grid::new(&points).unwrap();
        for at in [[1.0, 10.0], [1.5, 12.0], [3.9, 20.0], [4.0, 15.0]] {
            assert!((grid.value(at) - plane(at)).abs() < 1e-12, "{at:?}");
        }
        assert_eq!(grid.value([9.0, 10.0]), plane([4.0, 10.0]), "constant beyond");
        assert!(Grid::new(&points[1..]).is_none(), "one condition is missing");
    }

    #[test]
    fn three_of_many_levels_are_shown() {
        assert_eq!(chosen(&[1.0, 2.0, 3.0, 4.0, 5.0]), [1.0, 3.0, 5.0]);
        assert_eq!(chosen(&[1.0]), [1.0]);
    }
}
