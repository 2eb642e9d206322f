//! From the figures of the fits to judgements.

use super::{FitFigures, ForceCompared, ForceFigures, GreyBoxFits};
use crate::error::CaseError;
use crate::expectation::{Expected, Measure};
use crate::verdict::Judgement;
use serde::Deserialize;

/// What is judged of a fit or of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GreyBoxMeasure {
    /// Fit: 1 - MAE corrected / MAE simulated, conditions left out.
    MaeReduction,
    /// Fit: the same of the MSE.
    MseReduction,
    /// Fit: mean of |error / force|, corrected.
    RelativeError,
    /// Fit: MAE corrected / noise floor.
    MaeOverFloor,
    /// Fit: upper end of the interval of the corrected MAE / lower end of that of the simulated.
    IntervalRatio,
    /// Comparison: MAE inside the hull / MAE of the fit on its own conditions left out.
    MaeOverFit,
    /// Comparison: upper end of the interval of measured minus corrected, inside the hull, in N.
    BiasUpperEnd,
}

impl GreyBoxMeasure {
    /// Whether it is one of comparisons.
    #[must_use]
    pub fn is_of_comparison(self) -> bool {
        matches!(self, Self::MaeOverFit | Self::BiasUpperEnd)
    }

    fn of_fit(self, force: &ForceFigures) -> Option<f64> {
        let (before, after) = (&force.simulated, &force.corrected);
        match self {
            Self::MaeReduction => Some(1.0 - after.mae.value / before.mae.value),
            Self::MseReduction => Some(1.0 - after.mse.value / before.mse.value),
            Self::RelativeError => after.mape_of_force.map(|mape| mape.value),
            Self::MaeOverFloor => force.floor.map(|floor| after.mae.value / floor.mae),
            Self::IntervalRatio => Some(after.mae.high / before.mae.low),
            Self::MaeOverFit | Self::BiasUpperEnd => None,
        }
    }

    fn of_comparison(self, found: &ForceCompared, fit: &ForceFigures) -> Option<f64> {
        match self {
            Self::MaeOverFit => {
                let inside = found.corrected_inside.as_ref()?;
                Some(inside.mae.value / fit.corrected.mae.value)
            }
            Self::BiasUpperEnd => found.bias_inside.map(|bias| bias.high),
            _ => None,
        }
    }
}

impl Measure for GreyBoxMeasure {
    const KEYS: &'static [&'static str] = &["of", "force"];

    fn words(self) -> &'static str {
        match self {
            Self::MaeReduction => "MAE less by (share)",
            Self::MseReduction => "MSE less by (share)",
            Self::RelativeError => "mean relative error, corrected",
            Self::MaeOverFloor => "MAE corrected over noise floor",
            Self::IntervalRatio => "upper end of MAE corrected over lower end of MAE simulated",
            Self::MaeOverFit => "MAE inside the hull over MAE of the fit",
            Self::BiasUpperEnd => "upper end of measured minus corrected, inside the hull",
        }
    }

    fn unit(self) -> &'static str {
        if self == Self::BiasUpperEnd { "N" } else { "" }
    }
}

impl GreyBoxFits {
    /// Judges every expectation.
    pub(super) fn judge(&self, figures: &[FitFigures]) -> Result<Vec<Judgement>, CaseError> {
        let judged = self.expectations.iter().map(|expectation| {
            let of = expectation.of();
            let force = expectation.force.map_or("", |force| force.symbol());
            let about = format!("{force}: {}", expectation.measure.words());
            let missing = format!("`{of}` has no figure for it");
            expectation.judge(of, &about, value(expectation, figures), &missing)
        });
        judged.collect()
    }
}

fn value(expectation: &Expected<GreyBoxMeasure>, figures: &[FitFigures]) -> Option<f64> {
    let (of, force) = (expectation.of(), expectation.force?);
    let own = |forces: &'_ [ForceFigures]| forces.iter().position(|found| found.force == force);
    if let Some(fit) = figures.iter().find(|found| found.fit == of) {
        return expectation.measure.of_fit(&fit.forces[own(&fit.forces)?]);
    }
    figures.iter().find_map(|fit| {
        let found = fit.comparisons.iter().find(|found| found.comparison == of)?;
        let compared = found.forces.iter().find(|found| found.force == force)?;
        expectation.measure.of_comparison(compared, &fit.forces[own(&fit.forces)?])
    })
}
