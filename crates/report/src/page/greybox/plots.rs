//! Scatter plots and slices of the grey box.

use crate::kit::colours::{BLUE, GREEN, GREY, RED};
use crate::kit::numbers::{M_PER_MIN, MM};
use crate::kit::plot::{Axis, Plot, extremes};
use sphcut_greybox::{ForceFit, ForceKind, GreyBoxFit, Input, LearningPoint};

/// Predicted against measured: the simulation alone and the held-out corrections.
pub(super) fn against_measured(fit: &GreyBoxFit, force: &ForceFit) -> String {
    let measured = fit.pairs.measured(force.force);
    let simulated = fit.pairs.simulated(force.force);
    let held = &force.chosen().interpolation.predicted;
    let corrected: Vec<f64> = simulated.iter().zip(held).map(|(f, d)| f + d).collect();
    let all = || measured.iter().chain(&simulated).chain(&corrected).copied();
    let symbol = force.force.symbol();
    let mut plot = Plot::new(
        Axis::linear(&format!("Measured {symbol} in N"), all(), 0.04),
        Axis::linear(&format!("Predicted {symbol} in N"), all(), 0.04),
        14.0,
        "Predicted against measured forces.",
    );
    plot.axes("", true);
    let (low, high) = extremes(all());
    plot.line(&[[low, low], [high, high]], r##"stroke="#22262b" stroke-width="1.2""##);
    for factor in [0.9, 1.1] {
        plot.clipped(
            [low, low * factor],
            [high, high * factor],
            r##"stroke="#8b949e" stroke-width="1" stroke-dasharray="4 4""##,
        );
    }
    for (&x, &y) in measured.iter().zip(&simulated) {
        plot.dot(x, y, 3.6, &format!(r#"fill="none" stroke="{GREY}" stroke-width="1.6""#));
    }
    for (&x, &y) in measured.iter().zip(&corrected) {
        plot.dot(x, y, 3.4, &format!(r#"fill="{BLUE}" opacity="0.8""#));
    }
    plot.legend(&[(GREY, "simulation alone"), (BLUE, "corrected, held out")]);
    plot.finish()
}

/// Three slices over h at fixed v_c (axis 1) or over v_c at fixed h (axis 0).
pub(super) fn slices(fit: &GreyBoxFit, force: &ForceFit, axis: usize) -> String {
    let fixed = 1 - axis;
    let scale = [M_PER_MIN, MM];
    let levels = richest_levels(fit, fixed);
    let white = |input: Input| white_at(fit, force.force, input);
    let grey = |input: Input| white(input) + predict(force, input);
    let inputs = fit.pairs.inputs();
    let along: Vec<f64> = inputs.iter().map(|input| input[axis]).collect();
    let (low, high) = extremes(along.iter().copied());
    let measured = fit.pairs.measured(force.force);
    let shown: Vec<usize> =
        (0..inputs.len()).filter(|&row| levels.iter().any(|l| l.rows.contains(&row))).collect();
    let spans: Vec<(f64, f64)> = levels
        .iter()
        .map(|level| extremes(level.rows.iter().map(|&row| inputs[row][axis])))
        .collect();
    let at = |value: f64, along: f64| if axis == 0 { [along, value] } else { [value, along] };
    let steps = |span: (f64, f64)| {
        (0..=60).map(move |k| span.0 * (span.1 / span.0).powf(f64::from(k) / 60.0))
    };
    let values = || {
        let points = shown.iter().map(|&row| measured[row]);
        let lines = levels.iter().zip(&spans).flat_map(|(level, &span)| {
            steps(span).flat_map(move |x| [white(at(level.value, x)), grey(at(level.value, x))])
        });
        points.chain(lines).collect::<Vec<f64>>()
    };
    let titles = ["v_c in m/min", "h in mm"];
    let mut plot = Plot::new(
        Axis::of_conditions(titles[axis], [low, high].into_iter().map(|v| v * scale[axis])),
        Axis::linear(&format!("{} in N", force.force.symbol()), values().into_iter(), 0.05),
        14.0,
        "Slices of the surfaces with the measured points.",
    );
    plot.axes("", true);
    let colours = [BLUE, RED, GREEN];
    let mut names = Vec::new();
    for ((level, &span), colour) in levels.iter().zip(&spans).zip(colours) {
        let line = |surface: &dyn Fn(Input) -> f64| {
            steps(span).map(|x| [x * scale[axis], surface(at(level.value, x))]).collect::<Vec<_>>()
        };
        plot.line(
            &line(&white),
            &format!(r#"stroke="{colour}" stroke-width="1.3" stroke-dasharray="5 4""#),
        );
        plot.line(&line(&grey), &format!(r#"stroke="{colour}" stroke-width="2.2""#));
        for &row in &level.rows {
            let style = format!(r##"fill="{colour}" stroke="#fff" stroke-width="1""##);
            plot.dot(inputs[row][axis] * scale[axis], measured[row], 4.4, &style);
        }
        let value = format!("{:.3}", level.value * scale[fixed]);
        let value = value.trim_end_matches('0').trim_end_matches('.');
        names.push((
            colour,
            if fixed == 0 { format!("{value} m/min") } else { format!("{value} mm") },
        ));
    }
    let entries: Vec<(&str, &str)> = names.iter().map(|(c, n)| (*c, n.as_str())).collect();
    plot.legend(&entries);
    plot.finish()
}

/// Error on the conditions not used over the number of those that were.
pub(super) fn learning(force: &ForceFit) -> Option<String> {
    let points = &force.learning;
    let last = points.last().filter(|_| points.len() > 1)?;
    let white = force.white_box.mae.value;
    let floor = force.floor.map(|floor| floor.mae);
    let values = points.iter().flat_map(|p| [p.mae, p.range[0], p.range[1], p.alone]);
    let values: Vec<f64> = values.chain([white]).chain(floor).collect();
    let counts = points.iter().map(|point| point.conditions as f64).chain([0.0]);
    let counts: Vec<f64> = counts.collect();
    let mut plot = Plot::new(
        Axis::linear("Measured conditions", counts.iter().copied(), 0.03),
        Axis::logarithmic("MAE in N", values.iter().copied()),
        14.0,
        "Error over the number of measured conditions.",
    );
    plot.axes("", true);
    let count = |point: &LearningPoint| point.conditions as f64;
    let level = |plot: &mut Plot, value: f64, style: &str| {
        plot.line(&[[0.0, value], [last.conditions as f64, value]], style);
    };
    level(&mut plot, white, &format!(r#"stroke="{GREY}" stroke-width="1.6""#));
    if let Some(floor) = floor {
        let style = format!(r#"stroke="{RED}" stroke-width="1.6" stroke-dasharray="5 4""#);
        level(&mut plot, floor, &style);
    }
    let alone: Vec<[f64; 2]> = points.iter().map(|p| [count(p), p.alone]).collect();
    plot.line(&alone, &format!(r#"stroke="{GREEN}" stroke-width="1.6""#));
    let grey: Vec<[f64; 2]> = points.iter().map(|p| [count(p), p.mae]).collect();
    plot.line(&grey, &format!(r#"stroke="{BLUE}" stroke-width="2.2""#));
    for point in points {
        let ends = point.range.map(|value| [count(point), value.max(1e-12)]);
        plot.line(&ends, &format!(r#"stroke="{BLUE}" stroke-width="1.2" opacity="0.6""#));
        plot.dot(count(point), point.mae, 3.4, &format!(r#"fill="{BLUE}""#));
    }
    let mut names = vec![(BLUE, "corrected"), (GREEN, "no simulation"), (GREY, "simulation")];
    names.extend(floor.map(|_| (RED, "noise floor")));
    plot.legend(&names);
    Some(plot.finish())
}

/// One level of v_c or h with its rows.
struct Level {
    value: f64,
    rows: Vec<usize>,
}

/// Low, middle and high among the levels with the most conditions.
fn richest_levels(fit: &GreyBoxFit, axis: usize) -> Vec<Level> {
    let inputs = fit.pairs.inputs();
    let of_rows = fit.pairs.levels(axis);
    let count = of_rows.iter().max().map_or(0, |last| last + 1);
    let mut levels: Vec<(usize, Level)> = (0..count)
        .map(|level| {
            let rows: Vec<usize> = (0..inputs.len()).filter(|&r| of_rows[r] == level).collect();
            let mut conditions: Vec<usize> =
                rows.iter().map(|&row| fit.pairs.rows[row].condition).collect();
            conditions.dedup();
            let value = rows.iter().map(|&row| inputs[row][axis]).sum::<f64>() / rows.len() as f64;
            (conditions.len(), Level { value, rows })
        })
        .collect();
    let most = levels.iter().map(|(count, _)| *count).max().unwrap_or(0);
    levels.retain(|(count, _)| 5 * count >= 3 * most);
    let mut levels: Vec<Level> = levels.into_iter().map(|(_, level)| level).collect();
    if levels.len() > 3 {
        let last = levels.len() - 1;
        let mut place = 0;
        levels.retain(|_| {
            place += 1;
            [0, last / 2, last].contains(&(place - 1))
        });
    }
    levels
}

/// The simulated force between its conditions.
pub(super) fn white_at(fit: &GreyBoxFit, force: ForceKind, input: Input) -> f64 {
    use sphcut_greybox::regressor::Regressor;
    fit.white_surfaces[force.index()].predict(input)
}

/// The correction of the regressor to use.
pub(super) fn predict(force: &ForceFit, input: Input) -> f64 {
    use sphcut_greybox::regressor::Regressor;
    force.chosen().model.predict(input)
}
