//! `comparison.html`: a stored correction against new measurements.

use super::axes::{Axis, Frame, extremes};
use super::words::{estimate, percent};
use crate::text::three_digits;
use maud::{Markup, PreEscaped, html};
use sphcut_greybox::{Comparison, ForceComparison, GreyBox, Scores};

/// The text of `comparison.html`; nothing is loaded.
#[must_use]
pub fn render_comparison(model: &GreyBox, comparison: &Comparison) -> String {
    let lead = format!(
        "{} measured values under {} conditions, {} of them inside the hull of the conditions the correction was \
         fitted to ({}).",
        comparison.pairs.rows.len(),
        comparison.pairs.conditions.len(),
        comparison.inside,
        model.tables[1].name
    );
    let body = html! {
        section.warnings role="note" {
            h2 { "What these figures say" }
            ul { @for sentence in words(comparison) { li { (super::indexed(&sentence)) } } }
        }
        @for force in &comparison.forces { (section(comparison, force)) }
    };
    super::page("Grey box against new measurements", &lead, &model.version, &body)
}

fn words(comparison: &Comparison) -> Vec<String> {
    let mut words = Vec::new();
    if comparison.same_measurements {
        words.push(
            "These are the very measurements the correction was fitted to: the errors below are too small to be \
             believed. Compare with others."
                .to_owned(),
        );
    }
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
        words.push(format!(
            "{}: {} of the measurements lie inside the 95 % intervals that were predicted.",
            force.force.symbol(),
            percent(force.coverage)
        ));
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

fn section(comparison: &Comparison, force: &ForceComparison) -> Markup {
    let row = |name: &str, scores: &Scores| {
        html! { tr { th { (name) } td.n { (estimate(&scores.mae)) } td.n { (estimate(&scores.mse)) }
        td.n { (scores.mape_of_force.map_or_else(|| "\u{2013}".to_owned(), |mape| percent(mape.value))) } } }
    };
    html! {
        section {
            h2 { (super::indexed(force.force.symbol())) ", " (force.method.name()) }
            figure { (PreEscaped(plot(comparison, force))) figcaption { "Predicted against measured; bars: predicted 95 % intervals; \
                hollow: outside the hull; grey: the simulation alone." } }
            div.scroll { table {
                caption { "95 % intervals in brackets." }
                thead { tr { th { "" } th.n { "MAE in N" } th.n { "MSE in N\u{b2}" } th.n { "MAPE" } } }
                tbody {
                    (row("Simulation alone", &force.white_box))
                    (row("Corrected", &force.grey_box))
                    @if let Some(scores) = &force.grey_box_inside { (row("Corrected, inside the hull", scores)) }
                }
            } }
            p { "Inside the predicted intervals: " (three_digits(100.0 * force.coverage)) " % of the measurements." }
        }
    }
}

fn plot(comparison: &Comparison, force: &ForceComparison) -> String {
    let measured = comparison.pairs.measured(force.force);
    let found = &force.predictions;
    let all = || {
        let predicted = found.iter().flat_map(|p| [p.simulated, p.corrected]);
        predicted.chain(measured.iter().copied())
    };
    let symbol = force.force.symbol();
    let mut frame = Frame::new(
        Axis::linear(&format!("Measured {symbol} in N"), all(), 0.04),
        Axis::linear(&format!("Predicted {symbol} in N"), all(), 0.04),
        14.0,
        "Predicted against measured forces.",
    );
    frame.axes("", true);
    let (low, high) = extremes(all());
    frame.line(&[[low, low], [high, high]], r##"stroke="#22262b" stroke-width="1.2""##);
    for (&x, prediction) in measured.iter().zip(found) {
        let [from, to] = prediction.interval;
        frame.line(&[[x, from], [x, to]], r##"stroke="#0072b2" opacity="0.35""##);
        frame.dot(
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
        frame.dot(x, prediction.corrected, 3.6, style);
    }
    frame.finish()
}
