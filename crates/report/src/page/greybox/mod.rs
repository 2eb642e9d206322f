//! `greybox.html`: simulated forces corrected by measured ones.

mod comparison;
mod plots;
mod tables;
mod words;

pub use comparison::render_comparison;
pub use words::greybox_words;

use crate::kit::map::{ColourScale, Map, ValueAt};
use crate::kit::numbers::{percent, three_digits};
use crate::kit::shell::{Shell, note, plotted, tab};
use crate::kit::table::or_dash;
use crate::kit::text::indexed;
use maud::{Markup, html};
use sphcut_greybox::{ForceFit, GreyBoxFit, Input};

/// The text of `greybox.html`; nothing is loaded.
#[must_use]
pub fn render_greybox(fit: &GreyBoxFit) -> String {
    let [simulated, measured] = &fit.origins;
    let lead = html! {
    (fit.pairs.rows.len()) " measured rows under " (fit.pairs.conditions.len()) " conditions (" (measured.name)
    "), simulated in " (simulated.name) ": the simulated force plus a correction learnt from its error, "
    (indexed("f_T + f_D.")) };
    let sentences = greybox_words(fit);
    let body = html! {
        (note("What these figures say", sentences.iter().map(|sentence| indexed(sentence))))
        @for force in &fit.forces { (section(fit, force)) }
        (definitions(fit))
        (reproduce(fit))
    };
    let title = "Grey box: simulated forces corrected";
    Shell { tab: tab(title), title, lead, version: fit.version, body }.render()
}

fn section(fit: &GreyBoxFit, force: &ForceFit) -> Markup {
    let name = force.force.name();
    let method = force.choice.method.name();
    let [surface, corrected, correction, left] = four_maps(fit, force);
    html! {
        section {
            h2 { (capital(name)) " " (indexed(force.force.symbol())) }
            (key_figures(force))
            ul { @for sentence in words::details(force) { li { (indexed(&sentence)) } } }
            div.pair {
                (plotted(&surface, "Simulated force as a surface; the dots are the measured forces in the same colours. The dashed line is the hull of \
                    the measured conditions."))
                (plotted(&corrected, &format!("Corrected force ({method}) with the same dots: they should vanish in the surface. Outside the hull it is pale: \
                    extrapolated.")))
                (plotted(&correction, "The correction f_D; dots: measured minus simulated. Red: the simulation is too low."))
                (plotted(&left, "What is left: measured minus corrected, each condition predicted without its own measurements. Neighbours of one \
                    colour would be structure that the regressor missed."))
                (plotted(&plots::slices(fit, force, 1), "Over the uncut chip thickness at fixed cutting speeds. Solid: corrected; dashed: simulated; dots: measured."))
                (plotted(&plots::slices(fit, force, 0), "Over the cutting speed at fixed thicknesses."))
                (plotted(&plots::against_measured(fit, force), "Predicted against measured; dashed lines at \u{b1} 10 %."))
                (learning(force))
            }
            (tables::errors(force))
            (tables::extrapolation(force))
            (tables::importance(force))
        }
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn key_figures(force: &ForceFit) -> Markup {
    let (before, after) = (force.white_box.mae.value, force.procedure.mae.value);
    let relative =
        |scores: &sphcut_greybox::Scores| or_dash(scores.mape_of_force, |mape| percent(mape.value));
    html! {
        dl.figures {
            div { dt { "MAE of the simulation" } dd { (three_digits(before)) " N " small { (relative(&force.white_box)) } } }
            div { dt { "MAE corrected, held out" } dd { (three_digits(after)) " N " small { (relative(&force.procedure)) } } }
            div { dt { "Reduction of MAE" } dd { (percent(1.0 - after / before.max(f64::MIN_POSITIVE))) } }
            @if let Some(floor) = force.floor {
                div { dt { "Noise floor" } dd { (three_digits(floor.mae)) " N" } }
            }
            div { dt { "Use" } dd { (if force.pays() { force.choice.method.name() } else { "no correction" }) } }
        }
    }
}

/// Simulated, corrected, correction and what is left.
fn four_maps(fit: &GreyBoxFit, force: &ForceFit) -> [String; 4] {
    let inputs = fit.pairs.inputs();
    let measured = fit.pairs.measured(force.force);
    let residuals = fit.pairs.residuals(force.force).targets;
    let held = &force.chosen().interpolation.predicted;
    let symbol = force.force.symbol();
    let white = |input: Input| plots::white_at(fit, force.force, input);
    let correction = |input: Input| plots::predict(force, input);
    let grey = |input: Input| white(input) + correction(input);
    let with = |values: &[f64]| {
        let point = |(at, value): (&Input, &f64)| ValueAt { at: *at, value: *value, link: None };
        inputs.iter().zip(values).map(point).collect::<Vec<_>>()
    };
    let forces = ColourScale::of_range(
        measured.iter().copied().chain(inputs.iter().map(|&input| white(input))),
    );
    let errors = ColourScale::around_zero(residuals.iter().copied());
    let left: Vec<f64> = residuals.iter().zip(held).map(|(r, p)| r - p).collect();
    let map = |title: &str, quantity: &str, colours, surface, points| {
        Map {
            title: title.to_owned(),
            description: format!(
                "{title} of {} over cutting speed and thickness.",
                force.force.name()
            ),
            quantity: quantity.to_owned(),
            colours,
            hull: &fit.hull,
            inputs: &inputs,
            surface,
            points,
        }
        .svg()
    };
    let unit = format!("{symbol} in N");
    [
        map("Simulated", &unit, forces, Some(&white as &dyn Fn(Input) -> f64), with(&measured)),
        map("Corrected", &unit, forces, Some(&grey), with(&measured)),
        map("Correction", "N", errors, Some(&correction), with(&residuals)),
        map("Left over", "N", ColourScale::around_zero(left.iter().copied()), None, with(&left)),
    ]
}

fn learning(force: &ForceFit) -> Markup {
    html! {
        @if let Some(svg) = plots::learning(force) {
            (plotted(&svg, "How many experiments are enough: error on the conditions not used. Dots: median of eight draws, bars: their range; \
                green: the same regressor without the simulation."))
        }
    }
}

fn definitions(fit: &GreyBoxFit) -> Markup {
    let options = &fit.options;
    html! {
        section {
            h2 { "Definitions and limits" }
            p { "Corrected force = simulated force + correction. The correction is taught the difference of measured and simulated force over v"
                sub { "c" } " and h; the simulation comes first and is not changed. A prediction therefore needs a simulation at its condition." }
            p { "Errors are those of conditions left out: " (options.folds) " folds, repeats of a condition in one fold, settings searched by " (options.folds)
                " folds inside each. Intervals: " (options.resamples) " bootstrap resamples of the conditions. \u{201c}Chosen anew in every fold\u{201d} \
                is the error of the whole procedure, the choice of the regressor included; it is what to expect of new conditions inside the hull." }
            p { "R\u{b2} and MAPE of the error refer to measured minus simulated, as in the published method; MAPE is large where that difference is near zero. \
                MAPE of the force refers to the measured force." }
            p { "Surfaces between simulated conditions are interpolated for the pictures alone. The correction knows nothing of wear, other tools or other material: \
                it holds for what was measured." }
        }
    }
}

fn reproduce(fit: &GreyBoxFit) -> Markup {
    html! {
        section {
            h2 { "How to reproduce" }
            pre { code { "sphcut greybox fit --simulated " (fit.origins[0].name) " --measured " (fit.origins[1].name) " --seed " (fit.options.seed) " --out DIR" } }
            p { "The same tables, seed and version give the same numbers, whatever the number of threads." }
            table { thead { tr { th { "Table" } th { "Rows" } th { "SHA-256" } } } tbody {
                @for origin in &fit.origins { tr { td { (origin.name) } td { (origin.rows) } td { code { (origin.sha256) } } } }
            } }
        }
    }
}
