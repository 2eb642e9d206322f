//! Tables of the grey box: errors, importance, and where they come from.

use crate::kit::numbers::{minus, percent, three_digits};
use crate::kit::table::ColumnHead::{Number, Text};
use crate::kit::table::{NONE, or_dash, table};
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_greybox::{BootstrapEstimate, ForceFit, MethodFit, Scores};

/// A value with its interval below.
fn cell(found: Option<&BootstrapEstimate>, show: impl Fn(f64) -> String) -> Markup {
    html! {
        td.n {
            @if let Some(found) = found {
                (show(found.value)) br; small { (show(found.low)) " to " (show(found.high)) }
            } @else { (NONE) }
        }
    }
}

fn thousandths(value: f64) -> String {
    minus(&format!("{value:.3}"))
}

/// Cells of one row of scores.
fn cells(scores: &Scores) -> Markup {
    html! {
        (cell(Some(&scores.mae), three_digits))
        (cell(Some(&scores.mse), three_digits))
        (cell(scores.r_squared.as_ref(), thousandths))
        (cell(scores.mape_of_error.as_ref(), percent))
        (cell(scores.mape_of_force.as_ref(), percent))
    }
}

/// Those of the simulation alone: its error is not predicted, so there is nothing to say of how well.
fn white_cells(scores: &Scores) -> Markup {
    html! {
        (cell(Some(&scores.mae), three_digits))
        (cell(Some(&scores.mse), three_digits))
        (cell(None, thousandths))
        (cell(None, percent))
        (cell(scores.mape_of_force.as_ref(), percent))
    }
}

/// Errors in interpolation, as in Table 6 of the paper.
pub(super) fn errors(force: &ForceFit) -> Markup {
    let symbol = force.force.symbol();
    let columns = [
        Text("Regressor"),
        Number("MAE in N"),
        Number("MSE in N\u{b2}"),
        Number("R\u{b2} of the error"),
        Number("MAPE of the error"),
        Number("MAPE of the force"),
    ];
    let rows = html! {
        tr { th { "Simulation alone" } (white_cells(&force.white_box)) }
        @for fit in &force.methods {
            tr { th { (fit.method.name()) (mark(force, fit)) } (cells(&fit.interpolation.scores)) }
        }
        tr.sum { th { "Chosen anew in every fold" } (cells(&force.procedure)) }
        tr { th { (force.choice.method.name()) ", without the simulation" } (cells(&force.alone.interpolation)) }
        @if let Some(floor) = force.floor {
            tr { th { "Noise floor" } td.n { (three_digits(floor.mae)) } td.n { (three_digits(floor.mse)) }
                @for _ in 0..3 { td.n { (NONE) } } }
        }
    };
    let caption = html! { "Errors of " (indexed(symbol)) " on conditions left out, with 95 % intervals (compare Table 6 of the published method)." };
    table(caption, columns, &rows)
}

fn mark(force: &ForceFit, fit: &MethodFit) -> Markup {
    html! {
        @if fit.method == force.choice.method { " \u{25c0} use this" }
        @else if force.choice.tied.contains(&fit.method) { " (not told apart)" }
    }
}

/// Errors where whole levels were left out.
pub(super) fn extrapolation(force: &ForceFit) -> Markup {
    let both = |axis: usize, fit: &MethodFit| {
        let found = fit.extrapolation[axis].as_ref();
        html! {
            (cell(found.map(|part| &part.all.scores.mae), three_digits))
            (cell(found.map(|part| &part.ends.mae), three_digits))
        }
    };
    let alone = |axis: usize| {
        let found = force.alone.extrapolation[axis].as_ref();
        html! { (cell(found.map(|scores| &scores.mae), three_digits)) (cell(None, three_digits)) }
    };
    let columns = [
        Text("Regressor"),
        Number("speed left out"),
        Number("lowest and highest speed"),
        Number("thickness left out"),
        Number("least and largest thickness"),
        Number("interpolation"),
    ];
    let rows = html! {
        @for fit in &force.methods {
            tr { th { (fit.method.name()) (mark(force, fit)) } (both(0, fit)) (both(1, fit))
                td.n { (three_digits(fit.interpolation.scores.mae.value)) } }
        }
        tr { th { (force.choice.method.name()) ", without the simulation" } (alone(0)) (alone(1))
            td.n { (three_digits(force.alone.interpolation.mae.value)) } }
    };
    let caption = html! { "MAE of " (indexed(force.force.symbol())) " in N where all conditions of one cutting speed or one thickness were left out; at the \
    ends of the range that is extrapolation." };
    table(caption, columns, &rows)
}

/// Importance of v_c and h, as in Tables 7 and 8 of the paper.
pub(super) fn importance(force: &ForceFit) -> Markup {
    let with =
        |value: f64, spread: f64| format!("{} \u{b1} {}", thousandths(value), thousandths(spread));
    let columns = [
        Text("Regressor"),
        Number("Permutation v_c"),
        Number("h"),
        Number("Gain v_c"),
        Number("h"),
        Number("Sobol first v_c"),
        Number("h"),
        Number("total v_c"),
        Number("h"),
    ];
    let rows = html! { @for fit in &force.methods { tr {
        th { (fit.method.name()) }
        @for axis in 0..2 { td.n { (or_dash(fit.permutation, |p| thousandths(p[axis].mean))) } }
        @for axis in 0..2 { td.n { (or_dash(fit.gain, |gain| thousandths(gain[axis]))) } }
        @for axis in 0..2 { td.n { (or_dash(fit.sobol, |s| with(s.first[axis], s.first_spread[axis]))) } }
        @for axis in 0..2 { td.n { (or_dash(fit.sobol, |s| with(s.total[axis], s.total_spread[axis]))) } }
    } } };
    let caption = html! { "What the error of " (indexed(force.force.symbol())) " depends on (compare Tables 7 and 8 of the published method). Permutation: loss of R\u{b2} when the values of one input are shuffled. Gain: \
    share of the gain of all splits. Sobol: share of the variance over the box of the plan, \u{b1} standard deviation between folds." };
    table(caption, columns, &rows)
}
