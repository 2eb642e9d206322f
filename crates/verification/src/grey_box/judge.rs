//! From the figures of the fits to findings.

use super::{FitFigures, ForceCompared, ForceFigures, GreyBoxCase, GreyBoxExpectation};
use crate::case::Metric;
use crate::error::CaseError;
use crate::judge::number;
use crate::verdict::Finding;
use serde::Deserialize;

/// What is judged of a fit or of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
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

impl Measure {
    /// Whether it is one of comparisons.
    #[must_use]
    pub fn is_of_comparison(self) -> bool {
        matches!(self, Self::MaeOverFit | Self::BiasUpperEnd)
    }

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

/// Judges every expectation of `case`.
pub(super) fn judge(case: &GreyBoxCase, figures: &[FitFigures]) -> Result<Vec<Finding>, CaseError> {
    case.expectations
        .iter()
        .map(|expectation| {
            let value = value(expectation, figures).ok_or_else(|| CaseError::Unobservable {
                observable: expectation.measure.words().to_owned(),
                reason: format!("`{}` has no figure for it", expectation.of),
            })?;
            Ok(finding(expectation, value))
        })
        .collect()
}

fn value(expectation: &GreyBoxExpectation, figures: &[FitFigures]) -> Option<f64> {
    let force = |forces: &[ForceFigures]| {
        forces.iter().find(|found| found.force == expectation.force).cloned()
    };
    if let Some(fit) = figures.iter().find(|found| found.fit == expectation.of) {
        return expectation.measure.of_fit(&force(&fit.forces)?);
    }
    figures.iter().find_map(|fit| {
        let found = fit.comparisons.iter().find(|found| found.comparison == expectation.of)?;
        let compared = found.forces.iter().find(|found| found.force == expectation.force)?;
        expectation.measure.of_comparison(compared, &force(&fit.forces)?)
    })
}

fn finding(expectation: &GreyBoxExpectation, value: f64) -> Finding {
    // Reading a case refuses expectations with no limit or with two.
    let (metric, limit, holds) = match (expectation.at_least, expectation.at_most) {
        (Some(limit), _) => (Metric::AtLeast, limit, value >= limit),
        (None, limit) => {
            let limit = limit.unwrap_or(f64::NAN);
            (Metric::AtMost, limit, value <= limit)
        }
    };
    Finding {
        run: expectation.of.clone(),
        observable: format!("{}: {}", expectation.force.symbol(), expectation.measure.words()),
        unit: expectation.measure.unit().to_owned(),
        metric,
        values: vec![value],
        reference: number(limit),
        result: value,
        tolerance: 0.0,
        holds,
        known_gap: expectation.known_gap.clone(),
        because: expectation.because.clone(),
    }
}
