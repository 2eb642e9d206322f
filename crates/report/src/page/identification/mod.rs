//! `identification.html`: flow-stress laws from material tests.

mod figures;

use crate::kit::numbers::{minus, percent, plain, three_digits, with_interval};
use crate::kit::shell::{Shell, note, plain as as_it_is};
use crate::kit::table::{ColumnHead, NONE, or_dash, table};
use figures::{curves, residuals};
use maud::{Markup, html};
use sphcut_identify::{Curve, CurvePoint, Fitted, LawComparison, LawFit, Sequence, SequenceError};

/// A correlation above which two parameters are not told apart.
const STRONG: f64 = 0.95;
/// An advantage in standard errors that is more than chance.
const CLEAR: f64 = 2.0;

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct IdentificationPage<'a> {
    /// What was tested.
    pub title: &'a str,
    /// Where the tests come from.
    pub source: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// The flow curves.
    pub curves: &'a [Curve],
    /// Their points.
    pub points: &'a [CurvePoint],
    /// Johnson-Cook one parameter after the other.
    pub sequence: Result<&'a Sequence, SequenceError>,
    /// Johnson-Cook, all parameters at once.
    pub johnson_cook: &'a LawFit,
    /// With tanh softening.
    pub tanh: &'a LawFit,
    /// The laws side by side.
    pub comparison: &'a LawComparison,
}

/// The text of `identification.html`; nothing is loaded.
#[must_use]
pub fn render_identification(page: &IdentificationPage<'_>) -> String {
    let lead =
        html! { (page.curves.len()) " curves, " (page.points.len()) " points; " (page.source) "." };
    let sentences = identification_words(page);
    let body = html! {
        (note("What these figures say", sentences.iter().map(|sentence| as_it_is(sentence))))
        (parameters(page))
        (laws(page.comparison))
        (residuals(page))
        (curves(page))
        (correlations(page.johnson_cook))
        (definitions(page))
    };
    let tab = format!("Flow stress \u{2013} {}", page.title);
    let title = format!("Flow stress of {}", page.title);
    Shell { tab, title: &title, lead, version: page.version, body }.render()
}

/// What can be said, one sentence or two per entry.
#[must_use]
pub fn identification_words(page: &IdentificationPage<'_>) -> Vec<String> {
    let fit = page.johnson_cook;
    let laws = &page.comparison.laws;
    let mut words = vec![format!(
        "Johnson-Cook follows the curves to {} (root mean square), and held-out curves to {}.",
        percent(fit.deviation),
        percent(laws[0].unseen)
    )];
    let limits: Vec<&str> =
        fit.parameters.iter().filter(|p| p.at_limit).map(|p| symbol(p.key)).collect();
    if !limits.is_empty() {
        words.push(format!(
            "{} ran into the limit of its range: these curves do not determine it, and its interval means \
             nothing. Slow tests with small strains at the reference temperature would.",
            limits.join(", ")
        ));
    }
    let mut pairs = Vec::new();
    for (i, row) in fit.correlation.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(i) {
            if value.abs() > STRONG {
                let [a, b] = [j, i].map(|k| symbol(fit.parameters[k].key));
                pairs.push(format!("{a} and {b}"));
            }
        }
    }
    if !pairs.is_empty() {
        words.push(format!(
            "{} are hardly told apart (correlation above {STRONG}): only together do they mean anything.",
            pairs.join(", ")
        ));
    }
    if let Err(reason) = page.sequence {
        words.push(format!("The sequence by hand cannot be gone: {reason}."));
    }
    for rival in &laws[1..] {
        let name = title(rival.law);
        words.push(if rival.advantage > CLEAR {
            format!(
                "{name} is better on held-out conditions: {} against {} ({:.1} standard errors).",
                percent(rival.unseen),
                percent(laws[0].unseen),
                rival.advantage
            )
        } else if rival.unseen > laws[0].unseen {
            format!(
                "{name} gains nothing on held-out conditions ({}): it is not worth its parameters here.",
                percent(rival.unseen)
            )
        } else {
            format!(
                "{name} is not significantly better on held-out conditions ({}, {:.1} standard errors).",
                percent(rival.unseen),
                rival.advantage
            )
        });
    }
    words
}

/// Letter of a parameter.
fn symbol(key: &str) -> &str {
    match key {
        "initial_yield" => "A",
        "hardening_modulus" => "B",
        "hardening_exponent" => "n",
        "rate_coefficient" => "C",
        "softening_exponent" => "m",
        "hardening_damping" => "a",
        "offset_exponent" => "b",
        "strain_exponent" => "r",
        "floor_exponent" => "d",
        "tanh_exponent" => "s",
        other => other,
    }
}

fn title(law: &str) -> &str {
    match law {
        "johnson_cook" => "Johnson-Cook",
        "tanh_johnson_cook" => "Johnson-Cook with tanh softening",
        _ => "A table",
    }
}

/// Scale and unit for people.
fn unit(key: &str) -> (f64, &'static str) {
    if key == "initial_yield" || key == "hardening_modulus" { (1e-6, " in MPa") } else { (1.0, "") }
}

fn parameters(page: &IdentificationPage<'_>) -> Markup {
    let shown = |p: &Fitted| {
        let (scale, _) = unit(p.key);
        if p.at_limit {
            format!("{} (at its limit)", three_digits(p.value * scale))
        } else {
            with_interval(p.value * scale, p.half_width * scale)
        }
    };
    let by_hand = |k: usize, key: &str| match page.sequence {
        Ok(found) if k < 5 => three_digits(found.parameters[k] * unit(key).0),
        _ => NONE.to_owned(),
    };
    let columns = [
        ColumnHead::Text("Parameter"),
        ColumnHead::Number("Johnson-Cook, by sequence"),
        ColumnHead::Number("Johnson-Cook, jointly"),
        ColumnHead::Number("with tanh softening"),
    ];
    let rows = html! { @for (k, p) in page.tanh.parameters.iter().enumerate() { tr {
        th scope="row" { (symbol(p.key)) (unit(p.key).1) " " code { (p.key) } }
        td.n { (by_hand(k, p.key)) }
        td.n { (or_dash(page.johnson_cook.parameters.get(k), shown)) }
        td.n { (shown(p)) }
    } } };
    html! {
        section {
            h2 { "Parameters" }
            (table("By sequence: one after the other, as by hand. Jointly: all curves at once, robust, with the \
                95 % interval from the scatter between curves.", columns, &rows))
            @if let Ok(found) = page.sequence { p { (why_they_differ(found, page.johnson_cook)) } }
        }
    }
}

/// Why the constants of the sequence are not those of the joint fit, in the figures of these curves.
fn why_they_differ(found: &Sequence, fit: &LawFit) -> String {
    let strain = found.yield_strain;
    let references = fit.references;
    let there = fit.stress(strain, references.rate, references.temperature) * 1e-6;
    let own = fit.value("initial_yield").map_or(f64::NAN, |value| value * 1e-6);
    let mut text = format!(
        "Why they differ: by sequence, A is the stress read at a plastic strain of {}, and that holds hardening already: \
         the joint law has {} MPa there, {} of them its own A. With A too large, n comes out too large for the hardening that is left, and B, \
         C and m make up for it.",
        three_digits(strain),
        three_digits(there),
        three_digits(own)
    );
    if let Some(deviation) = found.deviation {
        text += &format!(
            " Over the strains that were tested the constants of the sequence miss by {} (root mean square), those of the joint fit by {}.",
            percent(deviation),
            percent(fit.deviation)
        );
    }
    text + " Below the smallest strain the two laws go apart: use the constants of one column together, never mixed. Both columns use the same \
            curves and references; neither the reference rate nor the heating of fast tests is what sets them apart."
}

fn laws(comparison: &LawComparison) -> Markup {
    let columns = [
        ColumnHead::Text("Law"),
        ColumnHead::Number("fitted"),
        ColumnHead::Number("held out"),
        ColumnHead::Number("better than Johnson-Cook by standard errors"),
    ];
    let rows = html! { @for law in &comparison.laws { tr {
        th scope="row" { (title(law.law)) }
        td.n { (percent(law.fitted)) } td.n { (percent(law.unseen)) }
        td.n { (minus(&format!("{:.1}", law.advantage))) }
    } } };
    let caption = html! { "Root mean square of ln(model / measured). Held out: each of " (comparison.conditions) " rates and \
    temperatures left out once, in ten groups." };
    html! { section { h2 { "Laws side by side" } (table(caption, columns, &rows)) } }
}

fn correlations(fit: &LawFit) -> Markup {
    let parameters = fit.parameters.iter().map(|p| ColumnHead::Number(symbol(p.key)));
    let number = |value: &f64| {
        or_dash(value.is_finite().then_some(value), |value| minus(&format!("{value:.2}")))
    };
    let rows = html! { @for (p, row) in fit.parameters.iter().zip(&fit.correlation) { tr {
        th scope="row" { (symbol(p.key)) }
        @for value in row { td.n { (number(value)) } }
    } } };
    let caption = "Between the errors of two parameters of Johnson-Cook.";
    html! {
        section {
            h2 { "Correlations of the joint fit" }
            (table(caption, [ColumnHead::Text("")].into_iter().chain(parameters), &rows))
        }
    }
}

fn definitions(page: &IdentificationPage<'_>) -> Markup {
    let references = page.johnson_cook.references;
    html! {
        section {
            h2 { "Definitions and limits" }
            p { "Stated, not fitted: reference rate " (plain(references.rate)) " 1/s, reference temperature "
                (three_digits(references.temperature)) " K, melting temperature " (three_digits(references.melting)) " K. \
                A, C and m mean nothing without them." }
            p { "Every curve has the same weight, however densely it was sampled. Temperatures are those at the start of a \
                test: the heating of the specimen by its own work, about 100 K for a strain of 0.2 in steel, is in the curves \
                of fast tests and not taken out. The table follows the curves by a smooth correction of Johnson-Cook and \
                goes over into it where nothing was measured." }
        }
    }
}
