//! The tables of a grey-box case in the ledger: errors before and after, beyond the plan, and against other
//! measurements.

use super::{FitFigures, ForceFigures, GreyBoxFits};
use crate::head::CaseHead;
use crate::metric::number;
use sphcut_greybox::{BootstrapEstimate, ForceKind, Scores};
use std::fmt::Write;

/// Figures of the paper whose method is followed, for one force.
struct Published {
    force: ForceKind,
    /// MAE in N and MSE in N^2 of its simulation.
    simulated: [f64; 2],
    /// The same corrected, by the best regressor.
    corrected: [f64; 2],
}

/// Wolf et al., "A grey-box approach based on Johnson-Cook constitutive model to improve predictions of mechanical loads
/// of cutting simulations for normalized AISI 1045": Table 6 and the text before it. Its reductions are 97.9 and 99.9 %
/// (F_c), 94.9 and 99.7 % (F_f), its mean relative error 1.3 %.
const PUBLISHED: [Published; 2] = [
    Published {
        force: ForceKind::Cutting,
        simulated: [272.31, 77_406.0],
        corrected: [5.65, 60.24],
    },
    Published { force: ForceKind::Feed, simulated: [149.65, 30_748.0], corrected: [7.60, 104.65] },
];

impl GreyBoxFits {
    /// Tables of errors before and after, beyond the plan and of the comparisons, as Markdown.
    #[must_use]
    pub fn tables(&self, head: &CaseHead, figures: &[FitFigures]) -> String {
        let mut text = String::new();
        interpolation(&mut text, self, figures);
        extrapolation(&mut text, self, figures);
        comparisons(&mut text, self, figures);
        text.push_str("\nTables and commands:\n\n");
        let folder = format!("validation/{}", head.name);
        for fit in &self.fits {
            let (simulated, measured) = (fit.simulated.display(), fit.measured.display());
            let command = match &fit.made_by {
                Some(how) => format!("`{how}`, then `sphcut greybox fit` with its tables"),
                None => format!(
                    "`sphcut greybox fit --simulated {folder}/{simulated} --measured {folder}/{measured} --out DIR`"
                ),
            };
            let _ = writeln!(text, "- {}: {}; {command}", fit.name, fit.title);
        }
        for other in &self.comparisons {
            let (simulated, measured) = (other.simulated.display(), other.measured.display());
            let _ = writeln!(
                text,
                "- {}: {}; `sphcut greybox compare --model DIR --simulated {folder}/{simulated} --measured \
                 {folder}/{measured} --out OTHER`, DIR that of the fit \"{}\"",
                other.name, other.title, other.fit
            );
        }
        text
    }
}

/// The forces of all fits, each with the name of its fit.
fn forces<'a>(
    case: &'a GreyBoxFits,
    figures: &'a [FitFigures],
) -> impl Iterator<Item = (&'a FitFigures, &'a ForceFigures)> {
    let in_order = case.fits.iter().filter_map(|fit| figures.iter().find(|f| f.fit == fit.name));
    in_order.flat_map(|fit| fit.forces.iter().map(move |force| (fit, force)))
}

fn interpolation(text: &mut String, case: &GreyBoxFits, figures: &[FitFigures]) {
    text.push_str(
        "\n**Interpolation:** errors of conditions left out (nested ten-fold, the choice of the regressor included), 95 % \
         intervals in brackets; floor: the error that the scatter of repeats leaves to a perfect model, below it is \
         over-fitting.\n\n\
         | fit | force | MAE in N: simulated | corrected | less by | floor | MSE in N^2: simulated | corrected | less \
         by | floor | mean relative error: simulated | corrected |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (fit, force) in forces(case, figures) {
        let (before, after) = (&force.simulated, &force.corrected);
        let floor = |pick: fn(&sphcut_greybox::NoiseFloor) -> f64| {
            force.floor.as_ref().map_or_else(|| "not known".to_owned(), |f| three(pick(f)))
        };
        let _ = writeln!(
            text,
            "| {}, {} rows, {} conditions | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            fit.fit,
            fit.rows,
            fit.conditions,
            force.force.symbol(),
            three(before.mae.value),
            estimate(&after.mae),
            less(before.mae.value, after.mae.value),
            floor(|floor| floor.mae),
            three(before.mse.value),
            estimate(&after.mse),
            less(before.mse.value, after.mse.value),
            floor(|floor| floor.mse),
            relative(before),
            relative(after),
        );
    }
    for published in PUBLISHED {
        let ([mae, mse], [mae_after, mse_after]) = (published.simulated, published.corrected);
        let _ = writeln!(
            text,
            "| paper (AISI 1045, 110 conditions) | {} | {} | {} | {} | not stated | {} | {} | {} | not stated | not \
             stated | 1.3 % |",
            published.force.symbol(),
            three(mae),
            three(mae_after),
            less(mae, mae_after),
            three(mse),
            three(mse_after),
            less(mse, mse_after),
        );
    }
}

fn extrapolation(text: &mut String, case: &GreyBoxFits, figures: &[FitFigures]) {
    text.push_str(
        "\n**Beyond the plan:** errors of the regressor to use where all conditions of one speed or one thickness were left out. \
         At the lowest and the highest level that is extrapolation.\n\n\
         | fit | force | regressor | left out | MAE in N: simulated | corrected | less by | MSE in N^2: simulated | \
         corrected | less by | mean relative error: simulated | corrected |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (fit, force) in forces(case, figures) {
        let mut row = |what: &str, before: &Scores, after: &Scores| {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {what} | {} | {} | {} | {} | {} | {} | {} | {} |",
                fit.fit,
                force.force.symbol(),
                force.chosen.name(),
                three(before.mae.value),
                estimate(&after.mae),
                less(before.mae.value, after.mae.value),
                three(before.mse.value),
                estimate(&after.mse),
                less(before.mse.value, after.mse.value),
                relative(before),
                relative(after),
            );
        };
        if let Some(found) = &force.speeds {
            row("each speed", &force.simulated, &found.all);
            row("lowest, highest speed", &found.simulated_at_ends, &found.ends);
        }
        if let Some(found) = &force.thicknesses {
            row("each thickness", &force.simulated, &found.all);
            row("least, largest thickness", &found.simulated_at_ends, &found.ends);
        }
    }
}

fn comparisons(text: &mut String, case: &GreyBoxFits, figures: &[FitFigures]) {
    if case.comparisons.is_empty() {
        return;
    }
    text.push_str(
        "\n**Against held-out measurements:** within the hull of its conditions. Own error: that of the fit, \
         conditions left out.\n\n\
         | fit | compared with | force | rows, of them inside | own MAE in N | MAE there | measured minus corrected in N | inside \
         the 95 % intervals (all rows) |\n|---|---|---|---|---|---|---|---|\n",
    );
    for (fit, force) in forces(case, figures) {
        for other in &fit.comparisons {
            let Some(found) = other.forces.iter().find(|f| f.force == force.force) else {
                continue;
            };
            let inside = |text: Option<String>| text.unwrap_or_else(|| "none".to_owned());
            let _ = writeln!(
                text,
                "| {} | {} | {} | {}, {} | {} | {} | {} | {} |",
                fit.fit,
                other.comparison,
                force.force.symbol(),
                other.rows,
                other.inside,
                estimate(&force.corrected.mae),
                inside(found.corrected_inside.as_ref().map(|scores| estimate(&scores.mae))),
                inside(found.bias_inside.as_ref().map(estimate)),
                percent(found.coverage, 0),
            );
        }
    }
}

/// `3.30 (2.76 to 3.89)`.
fn estimate(estimate: &BootstrapEstimate) -> String {
    let [value, low, high] = [estimate.value, estimate.low, estimate.high].map(three);
    format!("{value} ({low} to {high})")
}

/// Three significant digits, all of those before the point.
fn three(value: f64) -> String {
    if value == 0.0 {
        return number(value);
    }
    let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}")
}

fn less(before: f64, after: f64) -> String {
    let share = 1.0 - after / before;
    percent(share, if share > 0.9985 { 2 } else { 1 })
}

fn percent(share: f64, digits: usize) -> String {
    format!("{:.digits$} %", 100.0 * share)
}

fn relative(scores: &Scores) -> String {
    scores.mape_of_force.map_or_else(|| "no figure".to_owned(), |mape| percent(mape.value, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_figures_give_the_published_reductions() {
        let reductions = PUBLISHED.map(|p| {
            [0, 1].map(|k| (1000.0 * (1.0 - p.corrected[k] / p.simulated[k])).round() / 10.0)
        });
        assert_eq!(reductions, [[97.9, 99.9], [94.9, 99.7]]);
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!([0.9614, 37.01, 4158.2, 0.0].map(three), ["0.961", "37.0", "4158", "0"]);
        assert_eq!(less(4158.0, 290.0), "93.0 %");
        assert_eq!(less(78_992.0, 11.2), "99.99 %");
    }
}
