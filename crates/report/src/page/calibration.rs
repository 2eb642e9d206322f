//! `calibration.html`: a friction coefficient from measured forces.

use crate::kit::chart::{Band, Chart, ChartLine};
use crate::kit::colours::{BLUE, GREEN, RED};
use crate::kit::numbers::{M_PER_MIN, signed_percent, three_digits, with_interval};
use crate::kit::shell::{Shell, figure, note, plain, tab};
use crate::kit::table::{ColumnHead, table};
use maud::{Markup, html};
use sphcut_postprocess::Force;
use sphcut_postprocess::calibration::{Calibration, Standing, Trial};

/// An error of the best run above which, and above its own interval, it is said that friction alone does not explain the forces.
const LARGE_ERROR: f64 = 0.1;

/// The text of `calibration.html`; nothing is loaded.
#[must_use]
pub fn render_calibration(calibration: &Calibration) -> String {
    let lead = html! { (calibration.scenario) ", friction law " code { (calibration.law) } ": scanned at "
    (speed(calibration.scan.best())) " m/min, then fixed." };
    let sentences = calibration_words(calibration);
    let body = html! {
        (note("What these figures say", sentences.iter().map(|sentence| plain(sentence))))
        (scan(calibration))
        (predictions(calibration))
        (definitions())
    };
    let title = "Friction coefficient from measured forces";
    let tab = tab("Friction coefficient");
    Shell { tab, title, lead, version: &calibration.version, body }.render()
}

/// What can be said, one sentence or two per entry.
#[must_use]
pub fn calibration_words(calibration: &Calibration) -> Vec<String> {
    let scan = &calibration.scan;
    let best = scan.best();
    let [low, high] = scan.range().map(coefficient);
    let found = coefficient(best.coefficient);
    let least = format!(
        "The least error of the forces, {}, is found with a coefficient of {found} at {} m/min",
        percent_with_interval(best),
        speed(best)
    );
    let mut words = vec![match scan.standing() {
        Standing::Enclosed if low == high => {
            format!("{least}; its neighbours in the scan are worse by more than the intervals.")
        }
        Standing::Enclosed => format!(
            "{least}. Coefficients from {low} to {high} are not distinguishable from it: the differences of \
             their errors lie within the intervals of the runs."
        ),
        Standing::AtBorder => format!(
            "{least}, which is an end of the range scanned: the coefficient is not found. Either \
             the range is too narrow, or something else than friction is missing."
        ),
        Standing::ReachesBorder => format!(
            "{least}. Coefficients from {low} to {high}, an end of the range scanned, are not distinguishable \
             from it: the coefficient is bounded on one side only."
        ),
        Standing::Saturated => format!(
            "{least}. From {} on more friction changes neither force beyond its interval, as where the chip \
             sticks and its shear strength decides: any coefficient from there on is as good, and a wider range \
             does not help.",
            scan.saturated_from().map(coefficient).unwrap_or_default()
        ),
        Standing::Undetermined => format!(
            "{least}, but no coefficient of the range is distinguishable from it: the runs do not \
             determine the coefficient. Longer cuts have smaller intervals."
        ),
    }];
    let misfit = best.misfit();
    if misfit.error > LARGE_ERROR.max(misfit.half_width) {
        let [cutting, feed] = best.deviations().map(|share| signed_percent(share, 1));
        words.push(format!(
            "Even the best run misses the measurement: cutting force {cutting}, feed force {feed}. No \
             coefficient of friction corrects that."
        ));
    }
    words.extend(calibration.predictions.iter().map(|trial| {
        let [cutting, feed] = trial.deviations().map(|share| signed_percent(share, 1));
        format!(
            "With this coefficient, not fitted, at {} m/min: cutting force {cutting}, feed force {feed}.",
            speed(trial)
        )
    }));
    let all = scan.trials().iter().chain(&calibration.predictions);
    let unsteady: Vec<String> = all
        .filter(|trial| !trial.steady)
        .map(|trial| format!("{} at {} m/min", coefficient(trial.coefficient), speed(trial)))
        .collect();
    match unsteady.len() {
        0 => {}
        1..=3 => words.push(format!(
            "The cutting force was not steady with {}: a longer cut is needed.",
            unsteady.join(", ")
        )),
        count => words.push(format!(
            "The cutting force of {count} runs was not steady: a longer cut is needed."
        )),
    }
    words
}

fn speed(trial: &Trial) -> String {
    three_digits(trial.measured.cutting_speed * M_PER_MIN)
}

/// A coefficient as it stands in the scenario.
fn coefficient(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn percent_with_interval(trial: &Trial) -> String {
    let misfit = trial.misfit();
    format!("{} %", with_interval(100.0 * misfit.error, 100.0 * misfit.half_width))
}

fn scan(calibration: &Calibration) -> Markup {
    let scan = &calibration.scan;
    html! {
        section {
            h2 { "The scan at " (speed(scan.best())) " m/min" }
            (figure(errors(calibration).svg(), "Error of the two forces against the coefficient: each bar is a run (line) \
                with the 95 % interval of its error (box). Shaded: what is not distinguishable from the best run."))
            (figure(forces(calibration).svg(), "Simulated forces against the coefficient with their 95 % intervals; the \
                level lines are the measured ones."))
            (trial_table("Scan", scan.trials(), Some(calibration)))
        }
    }
}

/// Bars over the coefficients of the scan.
fn bands<'a>(
    trials: &[Trial],
    colour: &'a str,
    value: impl Fn(&Trial) -> (f64, f64),
) -> Vec<Band<'a>> {
    let (first, last) = ends(trials);
    let half = 0.006 * (last - first);
    trials
        .iter()
        .map(|trial| {
            let (mean, half_width) = value(trial);
            Band {
                from: trial.coefficient - half,
                to: trial.coefficient + half,
                mean,
                half_width: if half_width.is_finite() { half_width } else { 0.0 },
                colour,
                label: String::new(),
            }
        })
        .collect()
}

fn ends(trials: &[Trial]) -> (f64, f64) {
    let of = |trial: Option<&Trial>| trial.map_or(0.0, |trial| trial.coefficient);
    (of(trials.first()), of(trials.last()))
}

/// Values of `y` that show all bars whole.
fn reach(bands: &[Band<'_>]) -> Vec<f64> {
    let ends =
        bands.iter().flat_map(|band| [band.mean - band.half_width, band.mean + band.half_width]);
    ends.chain([0.0]).collect()
}

fn errors(calibration: &Calibration) -> Chart<'static> {
    let trials = calibration.scan.trials();
    let value = |trial: &Trial| {
        let misfit = trial.misfit();
        (100.0 * misfit.error, 100.0 * misfit.half_width)
    };
    let bars = bands(trials, BLUE, value);
    let [low, high] = calibration.scan.range();
    let x: Vec<f64> = trials.iter().map(|trial| trial.coefficient).collect();
    let margin = 0.01 * (ends(trials).1 - ends(trials).0);
    Chart {
        description: "Error of the forces against the friction coefficient.".to_owned(),
        x_title: "Friction coefficient",
        y_title: "Error in %",
        height: 320.0,
        lines: vec![ChartLine::new(
            "Error",
            BLUE,
            1.0,
            trials.iter().map(|trial| value(trial).0).collect(),
        )],
        window: Some((low - margin, high + margin, "not told apart")),
        y_includes: reach(&bars),
        bands: bars,
        x,
        ..Chart::default()
    }
}

/// Picks a force of a run.
type Pick = fn(&Trial) -> &Force;

fn forces(calibration: &Calibration) -> Chart<'static> {
    let trials = calibration.scan.trials();
    let measured = calibration.scan.best().measured;
    let (cutting, feed): (Pick, Pick) = (|trial| &trial.cutting, |trial| &trial.feed);
    let line = |name, colour, pick: Pick| {
        ChartLine::new(name, colour, 1.5, trials.iter().map(|trial| pick(trial).mean).collect())
    };
    let level = |name, force: f64| ChartLine::new(name, RED, 1.5, vec![force; trials.len()]);
    let value = |pick: Pick| move |trial: &Trial| (pick(trial).mean, pick(trial).ci95);
    let mut bars = bands(trials, BLUE, value(cutting));
    bars.extend(bands(trials, GREEN, value(feed)));
    Chart {
        description: "Forces against the friction coefficient.".to_owned(),
        x_title: "Friction coefficient",
        y_title: "Force in N",
        height: 360.0,
        x: trials.iter().map(|trial| trial.coefficient).collect(),
        lines: vec![
            line("Cutting force", BLUE, cutting),
            line("Feed force", GREEN, feed),
            level("Measured", measured.cutting_force),
            level("", measured.normal_force),
        ],
        y_includes: reach(&bars),
        bands: bars,
        ..Chart::default()
    }
}

fn trial_table(caption: &str, trials: &[Trial], scanned: Option<&Calibration>) -> Markup {
    use ColumnHead::{Number, Text};
    let columns = [
        Text("Coefficient"),
        Number("v_c in m/min"),
        Number("F_c in N"),
        Number("F_f in N"),
        Number("Error in %"),
        Text(""),
    ];
    let force = |force: &Force, measured: f64, deviation: f64| {
        html! {
            (with_interval(force.mean, force.ci95)) br;
            "measured " (three_digits(measured)) ", " (signed_percent(deviation, 1))
        }
    };
    let rows = html! { @for trial in trials {
        @let [cutting, feed] = trial.deviations();
        @let misfit = trial.misfit();
        tr {
            th scope="row" { (coefficient(trial.coefficient)) }
            td.n { (speed(trial)) }
            td.n { (force(&trial.cutting, trial.measured.cutting_force, cutting)) }
            td.n { (force(&trial.feed, trial.measured.normal_force, feed)) }
            td.n { (with_interval(100.0 * misfit.error, 100.0 * misfit.half_width)) }
            td { (remark(trial, scanned)) }
        }
    } };
    let what = ": forces with their 95 % intervals, measured forces, and the error of both.";
    table(html! { (caption) (what) }, columns, &rows)
}

/// What there is to say of a run in a table.
fn remark(trial: &Trial, scanned: Option<&Calibration>) -> String {
    let mut parts = Vec::new();
    if let Some(calibration) = scanned {
        let scan = &calibration.scan;
        if scan.best() == trial {
            parts.push("least error");
        } else if scan.is_indistinct(trial) {
            parts.push("not distinguishable from the best");
        }
    }
    if !trial.steady {
        parts.push("not steady");
    }
    parts.join("; ")
}

fn predictions(calibration: &Calibration) -> Markup {
    html! {
        section {
            h2 { "The other cutting speeds" }
            @if calibration.predictions.is_empty() {
                p { "The measured table has no other cutting speed: the coefficient is fitted and nothing tests it." }
            } @else {
                p { "The same coefficient at the other measured cutting speeds: nothing is fitted here." }
                (trial_table("Predictions", &calibration.predictions, None))
            }
        }
    }
}

fn definitions() -> Markup {
    html! {
        section {
            h2 { "Definitions and limits" }
            p { "The error is the root mean square of the relative deviations of the mean cutting and feed force from \
                the measured F" sub { "c" } " and F" sub { "n" } ". Its interval is the same norm of the half widths \
                of the 95 % intervals of both forces: by so much it can change at most within them. Two runs are told \
                apart if their errors differ by more than the root of the sum of squares of both half widths." }
            p { "The coefficient is scanned at the highest measured cutting speed and then fixed. It takes up whatever \
                else makes the simulated forces differ at that speed: flow stress, edge radius, spacing. That the \
                measured forces have errors of their own is not part of the intervals. A coefficient between two \
                runs of the scan is not interpolated." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_postprocess::calibration::{MeasuredForces, Scan};

    fn trial(coefficient: f64, feed: f64) -> Trial {
        let force = |mean| Force { mean, ci95: 2.0, mean_per_width: mean, ci95_per_width: 2.0 };
        Trial {
            name: format!("mu_{coefficient}"),
            coefficient,
            measured: MeasuredForces {
                cutting_speed: 1.0,
                cutting_force: 200.0,
                normal_force: 100.0,
            },
            cutting: force(200.0),
            feed: force(feed),
            steady: true,
        }
    }

    /// A user whose chip sticks is not sent to a wider range.
    #[test]
    fn forces_that_level_off_are_said_to() {
        let trials = [(0.2, 60.0), (0.4, 80.0), (0.6, 91.0), (0.8, 92.0)];
        let calibration = Calibration {
            scenario: "cut".to_owned(),
            version: "0.1.0".to_owned(),
            law: "shear_capped_coulomb".to_owned(),
            scan: Scan::new(trials.map(|(mu, feed)| trial(mu, feed)).to_vec()).unwrap(),
            predictions: Vec::new(),
        };
        let words = calibration_words(&calibration).join(" ");
        assert!(words.contains("From 0.6 on more friction changes neither force"), "{words}");
        assert!(words.contains("a wider range does not help"), "{words}");
        assert!(!words.contains("not found"), "{words}");
    }

    /// 20 % off in the feed force is an error of 14 %: said to be beyond friction only where it is known.
    #[test]
    fn an_error_within_its_interval_is_not_beyond_friction() {
        let words = |ci95| {
            let mut off = trial(0.4, 80.0);
            off.feed.ci95 = ci95;
            let calibration = Calibration {
                scenario: "cut".to_owned(),
                version: "0.1.0".to_owned(),
                law: "coulomb".to_owned(),
                scan: Scan::new(vec![off]).unwrap(),
                predictions: Vec::new(),
            };
            calibration_words(&calibration).join(" ")
        };
        assert!(words(2.0).contains("No coefficient of friction corrects that"));
        assert!(!words(25.0).contains("No coefficient of friction corrects that"));
    }
}
