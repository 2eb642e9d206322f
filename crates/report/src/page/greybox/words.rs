//! What the figures of a grey box say, in sentences.

use crate::kit::numbers::{percent, three_digits, with_ends};
use sphcut_greybox::regressor::Method;
use sphcut_greybox::{BootstrapEstimate, FloorSource, ForceFit, GreyBoxFit};

/// Improvement of a mean absolute error as a share.
fn reduction(before: f64, after: f64) -> f64 {
    if before > 0.0 { 1.0 - after / before } else { 0.0 }
}

/// `5.65 (3.62 to 7.96)`.
pub(super) fn estimate(estimate: &BootstrapEstimate) -> String {
    with_ends([estimate.value, estimate.low, estimate.high])
}

/// What can be said, one entry per force and point.
#[must_use]
pub fn greybox_words(fit: &GreyBoxFit) -> Vec<String> {
    let mut words: Vec<String> = fit.forces.iter().flat_map(force_words).collect();
    let conditions = fit.pairs.conditions.len();
    if fit.pairs.condensed {
        words.push(
            "The measured table is long: repeats were condensed to the means of their conditions."
                .to_owned(),
        );
    }
    if conditions < 30 {
        words.push(format!(
            "{conditions} conditions are few: the intervals below are wide, and the order of the regressors may \
             change with the next measurement."
        ));
    }
    words
}

/// The headline of a force.
fn force_words(force: &ForceFit) -> Vec<String> {
    let chosen = force.chosen();
    let (before, after) = (&force.white_box.mae, &force.procedure.mae);
    let name = force.force.name();
    let advice = if force.pays() { article(chosen.method) } else { "no correction" };
    let mut headline = format!(
        "{}: use {advice}. The simulation alone misses the measured {name} by {} N on average; corrected, held-out conditions \
         are missed by {} N",
        force.force.symbol(),
        three_digits(before.value),
        estimate(after),
    );
    if force.pays() {
        headline += &format!(", {} less", percent(reduction(before.value, after.value)));
    }
    if let Some(mape) = force.procedure.mape_of_force {
        headline += &format!("; that is {} of the force", percent(mape.value));
    }
    headline += ".";
    if let Some(floor) = force.floor {
        headline += &format!(" Repeats alone scatter by {} N.", three_digits(floor.mae));
    }
    if !force.pays() {
        headline += " There is no pattern in the error that these measurements would show.";
    }
    let mut words = vec![headline];
    words.extend(outliers(force));
    words.extend(beyond(force));
    words
}

/// Most outliers that are named.
const NAMED: usize = 3;

/// Rows to look at again, and what they change.
fn outliers(force: &ForceFit) -> Option<String> {
    let without = force.without_outliers.as_ref()?;
    let named = force.outliers.iter().take(NAMED).map(|row| {
        format!(
            "{} N at {} m/min and {} mm ({} N from what the other rows predict, {} times the usual error)",
            three_digits(row.measured),
            three_digits(60.0 * row.input[0]),
            three_digits(1e3 * row.input[1]),
            three_digits(row.error),
            three_digits(row.ratio)
        )
    });
    let named = named.collect::<Vec<_>>().join("; ");
    let more = force.outliers.len().saturating_sub(NAMED);
    let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
    Some(format!(
        "{}: check the record of {named}{rest}. Without {}, {} misses held-out conditions by {} N instead of {} N.",
        force.force.symbol(),
        if force.outliers.len() == 1 { "it" } else { "them" },
        article(force.choice.method),
        three_digits(without.mae.value),
        three_digits(force.chosen().interpolation.scores.mae.value)
    ))
}

/// Why this regressor, what is left, where it ends and what it took: one sentence each.
pub(super) fn details(force: &ForceFit) -> Vec<String> {
    let mut words = vec![why(force)];
    words.extend(floor(force));
    words.extend(extrapolation(force));
    words.push(simulation(force));
    words.extend(enough(force));
    words
}

/// A warning where the ends of the plan are missed by much more than its inside.
fn beyond(force: &ForceFit) -> Option<String> {
    let worst = at_the_ends(force)?;
    let symbol = force.force.symbol();
    if worst > force.white_box.mae.value {
        Some(format!(
            "{symbol}: not beyond the measured range. Where the outermost speeds or thicknesses were left out, the corrected force \
             was worse than the simulation ({} N).",
            three_digits(worst)
        ))
    } else if worst > 2.0 * force.procedure.mae.value {
        Some(format!(
            "{symbol}: trust it less beyond the measured range. Where the outermost speeds or thicknesses were left out, it missed by \
             up to {} N on average.",
            three_digits(worst)
        ))
    } else {
        None
    }
}

/// The larger of the errors at the ends of both ranges.
fn at_the_ends(force: &ForceFit) -> Option<f64> {
    let ends = force.chosen().extrapolation.iter().flatten().map(|found| found.ends.mae.value);
    ends.reduce(f64::max)
}

fn article(method: Method) -> &'static str {
    match method {
        Method::Linear => "the linear fit",
        Method::Quadratic => "the polynomial of degree 2",
        Method::Quartic => "the polynomial of degree 4",
        Method::SupportVector => "support vectors",
        Method::Forest => "the random forest",
        Method::Boosting => "boosted trees",
        Method::Network => "the network",
        Method::GaussianProcess => "the Gaussian process",
    }
}

/// Why this regressor.
fn why(force: &ForceFit) -> String {
    let choice = &force.choice;
    let tied: Vec<&str> =
        choice.tied.iter().filter(|m| **m != choice.best).map(|m| article(*m)).collect();
    let (best, method) = (article(choice.best), article(choice.method));
    if tied.is_empty() {
        return "Why: its error is the least, and the difference to every other regressor is larger than the scatter of the \
                resamples."
            .to_owned();
    }
    let rest = tied.join(", ");
    format!(
        "Why: the least error is that of {best}, but with these measurements it is not distinguishable from {rest}. Of all these, {method} \
         came closest where whole levels of v_c or h were left out."
    )
}

fn floor(force: &ForceFit) -> Option<String> {
    let Some(floor) = force.floor else {
        return Some(
            "Noise: the table has neither repeats nor standard deviations, so it cannot be said how much of \
             the error is left to remove. Measure some conditions three times."
                .to_owned(),
        );
    };
    let source = match floor.source {
        FloorSource::Repeats => "the scatter of repeats",
        FloorSource::Deviations => "the standard deviations of the table",
    };
    let ratio = force.procedure.mae.value / floor.mae;
    let verdict = if ratio < 1.15 {
        "nothing is left to learn from these measurements; an error much below the floor would be over-fitting"
    } else if ratio < 2.0 {
        "most of what is left is noise of the measurement"
    } else {
        "the larger part of the error is the model's, or a difference between conditions that repeats do not show and v_c and h do \
         not explain (another insert, another day)"
    };
    Some(format!(
        "Noise: by {source} a perfect model would miss single values by {} N; this one is at {} times \
         that: {verdict}.",
        three_digits(floor.mae),
        three_digits(ratio)
    ))
}

fn extrapolation(force: &ForceFit) -> Option<String> {
    let chosen = force.chosen();
    let [speed, thickness] = &chosen.extrapolation;
    let part = |found: &Option<sphcut_greybox::Extrapolated>, what: &str| {
        found.as_ref().map(|found| {
            format!(
                "{} N with a whole {what} left out ({} N at the ends of the range)",
                three_digits(found.all.scores.mae.value),
                three_digits(found.ends.mae.value)
            )
        })
    };
    let parts: Vec<String> = [part(speed, "cutting speed"), part(thickness, "thickness")]
        .into_iter()
        .flatten()
        .collect();
    if parts.is_empty() {
        return None;
    }
    Some(format!("Beyond the plan: the error is {}.", parts.join(" and ")))
}

/// Whether the simulation is worth its time.
fn simulation(force: &ForceFit) -> String {
    let (grey, black) = (force.chosen().interpolation.scores.mae, force.alone.interpolation.mae);
    let verdict = if black.value > 1.1 * grey.value {
        "the simulation helps"
    } else if black.value < 0.9 * grey.value {
        "inside the measured range the simulation does not help: its error is less smooth than the force"
    } else {
        "inside the measured range the simulation adds little with so many conditions measured"
    };
    format!(
        "Is the simulation worth it: the same regressor without it misses by {} N, with it by {} N: {verdict}.",
        three_digits(black.value),
        three_digits(grey.value)
    )
}

/// How many experiments are enough: the first size within a tenth of the last.
fn enough(force: &ForceFit) -> Option<String> {
    let last = force.learning.last()?;
    let first = force.learning.iter().find(|point| point.mae <= 1.1 * last.mae)?;
    Some(if first.conditions == last.conditions {
        format!(
            "How many experiments: the error still falls at {} conditions; more would help.",
            last.conditions
        )
    } else {
        format!(
            "How many experiments: {} conditions are enough for an error within a tenth of that with {}.",
            first.conditions, last.conditions
        )
    })
}
