//! `comparison.html`: a stored correction against new measurements.

use super::words::estimate;
use crate::kit::colours::{BLUE, GREY};
use crate::kit::numbers::percent;
use crate::kit::plot::{Axis, Plot, extremes};
use crate::kit::shell::{Shell, note, plotted, tab};
use crate::kit::table::or_dash;
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_greybox::{BootstrapEstimate, ForceComparison, GreyBox, Scores, TableComparison};

/// The text of `comparison.html`; nothing is loaded.
#[must_use]
pub fn render_comparison(model: &GreyBox, comparison: &TableComparison) -> String {
    let lead = html! {
        (comparison.pairs.rows.len()) " measured values under " (comparison.pairs.conditions.len()) " conditions, "
        (comparison.inside) " of them inside the hull of the conditions the correction was fitted to (" (model.tables[1].name) ")."
    };
    let sentences = words(comparison);
    let body = html! {
        (note("What these figures say", sentences.iter().map(|sentence| indexed(sentence))))
        @for force in &comparison.forces { (section(comparison, force)) }
    };
    let title = "Grey box against new measurements";
    Shell { tab: tab(title), title, lead, version: &model.version, body }.render()
}

fn words(comparison: &TableComparison) -> Vec<String> {
    let mut words = Vec::new();
    if comparison.seen > 0 {
        words.push(format!(
            "{} measured rows are left out: the correction was fitted to them, so they test nothing.",
            comparison.seen
        ));
    }
    words.extend(comparison.notes.iter().cloned());
    let measured = comparison.pairs.rows.len();
    for force in &comparison.forces {
        let (before, after) = (&force.white_box.mae, &force.grey_box.mae);
        let verdict = if after.high < before.low {
            format!("the correction removes {}", percent(1.0 - after.value / before.value))
        } else if after.value < before.value {
            "the correction helps, but not by more than the scatter of so few measurements"
                .to_owned()
        } else {
            "the correction makes it worse: it does not hold for these cuts".to_owned()
        };
        words.push(format!(
            "{}: the simulation misses by {} N, corrected by {} N: {verdict}.",
            force.force.symbol(),
            estimate(before),
            estimate(after)
        ));
        words.push(coverage(force, measured));
        words.extend(force.bias_inside.and_then(|found| bias(force, &found)));
    }
    let outside = comparison.pairs.rows.len() - comparison.inside;
    if outside > 0 {
        words.push(format!(
            "{outside} of {} measurements lie outside the hull of the conditions the correction was fitted to: there it extrapolates.",
            comparison.pairs.rows.len()
        ));
    }
    words
}

/// How many measurements the predicted intervals hold; whether so few are chance.
fn coverage(force: &ForceComparison, measured: usize) -> String {
    let found = format!(
        "{}: {} of the measurements lie inside the 95 % intervals that were predicted",
        force.force.symbol(),
        percent(force.coverage)
    );
    // Two standard deviations of a share of 95 % of so many.
    let least = 0.95 - 2.0 * (0.95 * 0.05 / measured as f64).sqrt();
    if force.coverage < least {
        return format!(
            "{found}: fewer than chance explains. The intervals do not hold for these cuts."
        );
    }
    format!("{found}.")
}

/// A difference in one direction: something that v_c and h do not say has changed.
fn bias(force: &ForceComparison, found: &BootstrapEstimate) -> Option<String> {
    let direction = if found.low > 0.0 {
        "above"
    } else if found.high < 0.0 {
        "below"
    } else {
        return None;
    };
    Some(format!(
        "{}: inside the hull the measured forces lie {direction} the corrected ones, by {} N on average: a step that cutting speed \
         and thickness do not explain, such as another tool, another batch, another zero of the dynamometer.",
        force.force.symbol(),
        estimate(&BootstrapEstimate {
            value: found.value.abs(),
            low: found.low.abs().min(found.high.abs()),
            high: found.low.abs().max(found.high.abs()),
        })
    ))
}

fn section(comparison: &TableComparison, force: &ForceComparison) -> Markup {
    let row = |name: &str, scores: &Scores| {
        html! { tr { th { (name) } td.n { (estimate(&scores.mae)) } td.n { (estimate(&scores.mse)) }
        td.n { (or_dash(scores.mape_of_force, |mape| percent(mape.value))) } } }
    };
    html! {
        section {
            h2 { (indexed(force.force.symbol())) ", " (force.method.name()) }
            div.pair {
                (plotted(&plot(comparison, force), "Predicted against measured; line: equal; bars: predicted 95 % \
                    intervals; hollow blue: outside the hull."))
                div {
                    div.scroll { table {
                        caption { "Errors of the force with 95 % intervals." }
                        thead { tr { th { "" } th.n { "MAE in N" } th.n { "MSE in N\u{b2}" } th.n { "MAPE" } } }
                        tbody {
                            (row("Simulation alone", &force.white_box))
                            (row("Corrected", &force.grey_box))
                            @if let Some(scores) = &force.grey_box_inside { (row("Corrected, inside", scores)) }
                        }
                    } }
                    div.scroll { table {
                        tbody {
                            tr { th scope="row" { "Measured minus corrected in N" } td.n { (estimate(&force.bias)) } }
                            @if let Some(found) = &force.bias_inside {
                                tr { th scope="row" { "The same inside the hull" } td.n { (estimate(found)) } }
                            }
                            tr { th scope="row" { "Inside the predicted 95 % intervals" } td.n { (percent(force.coverage)) } }
                        }
                    } }
                }
            }
        }
    }
}

fn plot(comparison: &TableComparison, force: &ForceComparison) -> String {
    let measured = comparison.pairs.measured(force.force);
    let found = &force.predictions;
    let all = || {
        let predicted = found.iter().flat_map(|p| [p.simulated, p.corrected]);
        predicted.chain(measured.iter().copied())
    };
    let symbol = force.force.symbol();
    let mut plot = Plot::new(
        Axis::linear(&format!("Measured {symbol} in N"), all(), 0.04),
        Axis::linear(
            &format!("Predicted {symbol} in N"),
            all().chain(found.iter().flat_map(|p| p.interval)),
            0.04,
        ),
        14.0,
        "Predicted against measured forces.",
    );
    plot.axes("", true);
    plot.legend(&[(GREY, "simulation alone"), (BLUE, "corrected")]);
    let (low, high) = extremes(all());
    plot.line(&[[low, low], [high, high]], r##"stroke="#22262b" stroke-width="1.2""##);
    for (&x, prediction) in measured.iter().zip(found) {
        let [from, to] = prediction.interval;
        plot.line(&[[x, from], [x, to]], r##"stroke="#0072b2" opacity="0.35""##);
        plot.dot(
            x,
            prediction.simulated,
            3.2,
            r##"fill="none" stroke="#8b949e" stroke-width="1.4""##,
        );
        let style = if prediction.inside {
            r##"fill="#0072b2""##
        } else {
            r##"fill="#fff" stroke="#0072b2" stroke-width="1.6""##
        };
        plot.dot(x, prediction.corrected, 3.6, style);
    }
    plot.finish()
}
