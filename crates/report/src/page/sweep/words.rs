//! What a sweep over speed and thickness says, in words.

use super::plots::{ForceAt, force_points, levels, points, same};
use crate::kit::numbers::{M_PER_MIN, MM, minus, three_digits};
use sphcut_sweep::{SweepTable, TrendEstimate, line_over_thickness, power_law};

/// One sentence each.
#[must_use]
pub fn sweep_words(table: &SweepTable, measured: &[[f64; 4]]) -> Vec<String> {
    let mut words = Vec::new();
    for (index, symbol) in ["F_c", "F_f"].into_iter().enumerate() {
        let simulated = points(table, index);
        let point =
            |row: &[f64; 4]| ForceAt { at: [row[0], row[1]], value: row[2 + index], run: None };
        let real: Vec<ForceAt> = measured.iter().map(point).collect();
        words.extend(over_thickness(&simulated, &real, symbol));
        words.extend(over_all(&simulated, symbol, "simulated"));
        words.extend(over_all(&common(&real, &simulated), symbol, "measured"));
        words.extend(against(&simulated, &real, symbol));
    }
    let steady = |row: &&sphcut_sweep::SweepRow| row.summary.get("steady.reached") == Some(&0.0);
    let unsteady = table.rows.iter().filter(steady).count();
    if unsteady > 0 {
        let runs = if unsteady == 1 { "run" } else { "runs" };
        words.push(format!(
            "In {unsteady} {runs} the cutting force was not steady: the means are those of the travel there was."
        ));
    }
    if words.is_empty() {
        words.push("No cut with a result yet.".to_owned());
    }
    words
}

/// The value nearest to the middle of the range.
fn middle(levels: &[f64]) -> Option<f64> {
    levels.get(levels.len() / 2).copied()
}

/// Half widths below this share of their number are rounding.
const ROUNDING: f64 = 1e-8;

/// `8260 ± 120`.
fn with_half(estimate: TrendEstimate, factor: f64) -> String {
    let value = minus(&three_digits(factor * estimate.value));
    let exact = estimate.half_width <= ROUNDING * estimate.value.abs();
    let half = if exact { 0.0 } else { (factor * estimate.half_width).abs() };
    format!("{value} ± {}", three_digits(half))
}

/// `6.70 %`.
fn percent(share: f64) -> String {
    let rounded = if share.abs() < ROUNDING { 0.0 } else { 100.0 * share };
    format!("{} %", three_digits(rounded))
}

/// `At 150 m/min the simulated F_c changes by 8260 ± 90 N per mm of h ...`, and how it compares with the measured one.
fn over_thickness(simulated: &[ForceAt], measured: &[ForceAt], symbol: &str) -> Option<String> {
    let speed = middle(&levels(simulated, 0))?;
    let line = line_over_thickness(&force_points(simulated), speed)?;
    let mut text = format!(
        "At {} m/min the simulated {symbol} changes by {} N per mm of h; the line misses its values by {} of their mean at most.",
        three_digits(speed * M_PER_MIN),
        with_half(line.slope, 1.0 / MM),
        percent(line.worst)
    );
    if let Some(real) = line_over_thickness(&force_points(measured), speed) {
        let difference = line.slope.value / real.slope.value - 1.0;
        text += &format!(" Measured it changes by {} N per mm", with_half(real.slope, 1.0 / MM));
        text +=
            &compared(difference, line.slope.half_width + real.slope.half_width, real.slope.value);
    }
    Some(text)
}

/// Difference as a share of the measured number from which on it is not told in per cent.
const TENFOLD: f64 = 10.0;

/// What a simulated number is against a measured one: the end of a sentence.
fn compared(difference: f64, half_widths: f64, real: f64) -> String {
    if (difference * real).abs() <= half_widths {
        ": the intervals do not tell them apart.".to_owned()
    } else {
        let word = if difference > 0.0 { "more" } else { "less" };
        // A share of next to nothing says nothing.
        let share = if difference.abs() < TENFOLD {
            percent(difference.abs()) + " "
        } else {
            String::new()
        };
        format!(": the simulation has {share}{word}.")
    }
}

/// The exponents over all conditions, and what the speed changes from end to end.
fn over_all(points: &[ForceAt], symbol: &str, what: &str) -> Option<String> {
    let law = power_law(&force_points(points))?;
    let mut powers = Vec::new();
    if let Some(thickness) = law.thickness {
        powers.push(format!("with h to the power {}", with_half(thickness, 1.0)));
    }
    let Some(speed) = law.speed else {
        return Some(format!("The {what} {symbol} goes {}.", powers.join(" and ")));
    };
    powers.push(format!("with v_c to the power {}", with_half(speed, 1.0)));
    let speeds = levels(points, 0);
    let (first, last) = (speeds.first()?, speeds.last()?);
    let change = |power: f64| (last / first).powf(power) - 1.0;
    let range = format!(
        "from {} to {} m/min",
        three_digits(first * M_PER_MIN),
        three_digits(last * M_PER_MIN)
    );
    let half =
        0.5 * (change(speed.value + speed.half_width) - change(speed.value - speed.half_width));
    let says = if speed.value.abs() <= speed.half_width {
        format!(
            "{range} no change is distinguishable from none (within {})",
            percent(change(speed.value).abs() + half)
        )
    } else {
        let word = if speed.value < 0.0 { "falls" } else { "rises" };
        format!("{range} it {word} by {} ± {}", percent(change(speed.value).abs()), percent(half))
    };
    Some(format!("Over all conditions the {what} {symbol} goes {}: {says}.", powers.join(" and ")))
}

/// Those of `points` whose conditions are among the `others`: exponents are not the same everywhere.
fn common(points: &[ForceAt], others: &[ForceAt]) -> Vec<ForceAt> {
    let is_among =
        |a: &ForceAt| others.iter().any(|b| same(a.at[0], b.at[0]) && same(a.at[1], b.at[1]));
    points.iter().filter(|point| is_among(point)).copied().collect()
}

/// How far the simulated forces are from the measured ones where there are both.
fn against(simulated: &[ForceAt], measured: &[ForceAt], symbol: &str) -> Option<String> {
    let is_at = |a: &ForceAt, b: &ForceAt| same(a.at[0], b.at[0]) && same(a.at[1], b.at[1]);
    let mut pairs = Vec::new();
    for point in simulated {
        let there: Vec<f64> =
            measured.iter().filter(|other| is_at(point, other)).map(|other| other.value).collect();
        if !there.is_empty() {
            pairs.push((point.value, there.iter().sum::<f64>() / there.len() as f64));
        }
    }
    let n = pairs.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n;
    let ratio = mean(&|(s, m)| s / m) - 1.0;
    let error = mean(&|(s, m)| (s - m).abs());
    (!pairs.is_empty()).then(|| {
        format!(
            "At the {} conditions with both, the simulated {symbol} is {} {} than the measured in the mean of the ratios; the mean \
             absolute error is {} N.",
            pairs.len(),
            percent(ratio.abs()),
            if ratio > 0.0 { "larger" } else { "smaller" },
            three_digits(error)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(slope: f64, power: f64) -> Vec<ForceAt> {
        let at = [100.0, 150.0, 200.0]
            .into_iter()
            .flat_map(|v| [0.06, 0.1, 0.15].map(|h| [v / 60.0, h / 1e3]));
        let force = |at: [f64; 2]| slope * at[1] * 1e3 * (at[0] / 2.5).powf(power);
        at.map(|at| ForceAt { at, value: force(at), run: None }).collect()
    }

    #[test]
    fn slopes_are_found_told_and_compared() {
        let said = over_thickness(&grid(8260.0, 0.0), &grid(6318.0, 0.0), "F_c").unwrap();
        assert!(
            said.contains("At 150 m/min the simulated F_c changes by 8260 ± 0.00 N per mm"),
            "{said}"
        );
        assert!(
            said.contains(
                "Measured it changes by 6318 ± 0.00 N per mm: the simulation has 30.7 % more"
            ),
            "{said}"
        );
    }

    #[test]
    fn a_change_over_the_speed_is_told_only_where_there_is_one() {
        let said = over_all(&grid(8260.0, -0.1), "F_c", "simulated").unwrap();
        assert!(said.contains("from 100 to 200 m/min it falls by 6.70 % ± 0.00 %"), "{said}");
        let mut scattered = grid(8260.0, 0.0);
        for (k, point) in scattered.iter_mut().enumerate() {
            point.value *= 1.0 + 0.01 * (k as f64 * 2.3).sin();
        }
        let said = over_all(&scattered, "F_c", "simulated").unwrap();
        assert!(said.contains("no change is distinguishable from none"), "{said}");
    }

    #[test]
    fn errors_are_those_of_the_common_conditions() {
        let said = against(&grid(2.0, 0.0), &grid(1.0, 0.0)[..3], "F_f").unwrap();
        assert!(said.contains("3 conditions with both") && said.contains("100 % larger"), "{said}");
    }
}
