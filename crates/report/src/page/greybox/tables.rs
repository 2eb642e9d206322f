//! Tables of the grey box: errors, importance, and where they come from.

use super::words::{estimate, percent};
use crate::text::three_digits;
use maud::{Markup, html};
use sphcut_greybox::{Estimate, ForceFit, MethodFit, Scores};

fn optional(found: Option<&Estimate>, show: impl Fn(&Estimate) -> String) -> String {
    found.map_or_else(|| "\u{2013}".to_owned(), show)
}

fn r_squared(found: &Estimate) -> String {
    crate::text::minus(&format!("{:.3} ({:.3} to {:.3})", found.value, found.low, found.high))
}

fn share(found: &Estimate) -> String {
    format!("{} ({} to {})", percent(found.value), percent(found.low), percent(found.high))
}

/// Cells of one row of scores.
fn cells(scores: &Scores) -> Markup {
    html! {
        td.n { (estimate(&scores.mae)) }
        td.n { (estimate(&scores.mse)) }
        td.n { (optional(scores.r_squared.as_ref(), r_squared)) }
        td.n { (optional(scores.mape_of_error.as_ref(), share)) }
        td.n { (optional(scores.mape_of_force.as_ref(), share)) }
    }
}

/// Errors in interpolation, as in Table 6 of the paper.
pub(super) fn errors(force: &ForceFit) -> Markup {
    let symbol = force.force.symbol();
    html! {
        div.scroll { table {
            caption { "Errors of " (symbol) " on conditions left out, 95 % intervals in brackets." }
            thead { tr {
                th { "Regressor" }
                th.n { "MAE in N" } th.n { "MSE in N\u{b2}" } th.n { "R\u{b2} of the error" }
                th.n { "MAPE of the error" } th.n { "MAPE of the force" }
            } }
            tbody {
                tr { th { "Simulation alone" } (cells(&force.white_box)) }
                @for fit in &force.methods {
                    tr { th { (fit.method.name()) (mark(force, fit)) } (cells(&fit.interpolation.scores)) }
                }
                tr.sum { th { "Chosen anew in every fold" } (cells(&force.procedure)) }
                tr { th { (force.choice.method.name()) ", without the simulation" } (cells(&force.alone.interpolation)) }
                @if let Some(floor) = force.floor {
                    tr { th { "Noise floor" } td.n { (three_digits(floor.mae)) } td.n { (three_digits(floor.mse)) }
                        td.n { "\u{2013}" } td.n { "\u{2013}" } td.n { "\u{2013}" } }
                }
            }
        } }
    }
}

fn mark(force: &ForceFit, fit: &MethodFit) -> Markup {
    html! {
        @if fit.method == force.choice.method { " \u{25c0} use this" }
        @else if force.choice.tied.contains(&fit.method) { " (not told apart)" }
    }
}

/// Errors where whole levels were left out.
pub(super) fn extrapolation(force: &ForceFit) -> Markup {
    let cell = |axis: usize, fit: &MethodFit| {
        let found = fit.extrapolation[axis].as_ref();
        let all = optional(found.map(|part| &part.all.scores.mae), estimate);
        let ends = optional(found.map(|part| &part.ends.mae), estimate);
        html! { td.n { (all) } td.n { (ends) } }
    };
    let alone = |axis: usize| {
        optional(force.alone.extrapolation[axis].as_ref().map(|scores| &scores.mae), estimate)
    };
    html! {
        div.scroll { table {
            caption { "MAE of " (force.force.symbol()) " in N where all conditions of one cutting speed or one thickness were left out; at the \
                ends of the range that is extrapolation." }
            thead { tr {
                th { "Regressor" }
                th.n { "speed left out" } th.n { "lowest and highest speed" }
                th.n { "thickness left out" } th.n { "least and largest thickness" }
                th.n { "interpolation" }
            } }
            tbody {
                @for fit in &force.methods {
                    tr { th { (fit.method.name()) (mark(force, fit)) } (cell(0, fit)) (cell(1, fit))
                        td.n { (three_digits(fit.interpolation.scores.mae.value)) } }
                }
                tr { th { (force.choice.method.name()) ", without the simulation" }
                    td.n { (alone(0)) } td.n { "\u{2013}" } td.n { (alone(1)) } td.n { "\u{2013}" }
                    td.n { (three_digits(force.alone.interpolation.mae.value)) } }
            }
        } }
    }
}

/// Importance of v_c and h, as in Tables 7 and 8 of the paper.
pub(super) fn importance(force: &ForceFit) -> Markup {
    let number = |value: f64| crate::text::minus(&format!("{value:.3}"));
    let with = |value: f64, spread: f64| format!("{} \u{b1} {}", number(value), number(spread));
    let dash = || "\u{2013}".to_owned();
    html! {
        div.scroll { table {
            caption { "What the error of " (force.force.symbol()) " depends on. Permutation: loss of R\u{b2} when the values of one input are shuffled. Gain: \
                share of the gain of all splits. Sobol: share of the variance over the box of the plan, \u{b1} standard deviation between folds." }
            thead { tr {
                th { "Regressor" }
                th.n { "Permutation v" sub { "c" } } th.n { "h" } th.n { "Gain v" sub { "c" } } th.n { "h" }
                th.n { "Sobol first v" sub { "c" } } th.n { "h" } th.n { "total v" sub { "c" } } th.n { "h" }
            } }
            tbody {
                @for fit in &force.methods { tr {
                    th { (fit.method.name()) }
                    @for axis in 0..2 { td.n { (fit.permutation.map_or_else(dash, |p| number(p[axis].mean))) } }
                    @for axis in 0..2 { td.n { (fit.gain.map_or_else(dash, |gain| number(gain[axis]))) } }
                    @for axis in 0..2 { td.n { (fit.sobol.map_or_else(dash, |s| with(s.first[axis], s.first_spread[axis]))) } }
                    @for axis in 0..2 { td.n { (fit.sobol.map_or_else(dash, |s| with(s.total[axis], s.total_spread[axis]))) } }
                } }
            }
        } }
    }
}
