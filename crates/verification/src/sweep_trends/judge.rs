//! From the forces of a sweep to findings.

use crate::case::Metric;
use crate::error::CaseError;
use crate::judge::number;
use crate::verdict::Finding;
use serde::Deserialize;
use sphcut_greybox::ForceKind;
use sphcut_sweep::{Estimate, ForcePoint, line_over_thickness, power_law};

/// What is judged of the forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SweepMeasure {
    /// Change per uncut chip thickness at `cutting_speed`, in N/mm.
    SlopeOverThickness,
    /// Half width of its 95 % interval over the slope.
    SlopeHalfWidth,
    /// Largest distance from the line over h at `cutting_speed`, over the mean.
    DepartureFromLine,
    /// Exponent of v_c over all conditions.
    ExponentOfSpeed,
    /// Its lower end.
    ExponentOfSpeedLower,
    /// Its upper end.
    ExponentOfSpeedUpper,
    /// Exponent of h over all conditions.
    ExponentOfThickness,
    /// Exponent of v_c minus that of the measured forces, both of the common conditions.
    ExponentOfSpeedAgainstMeasured,
    /// Exponent of h minus that of the measured forces, both of the common conditions.
    ExponentOfThicknessAgainstMeasured,
    /// Mean over the common conditions of simulated over measured, minus 1.
    MeanRatio,
    /// Mean of |simulated - measured| over the common conditions over the mean of the measured.
    MeanAbsoluteError,
}

/// What is expected of a sweep.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepExpectation {
    /// F_c or F_f.
    pub force: ForceKind,
    /// What is judged.
    pub measure: SweepMeasure,
    /// In m/min, for a line over h.
    pub cutting_speed: Option<f64>,
    /// A value of others.
    pub reference: Option<f64>,
    /// How far from the reference, as a share of it.
    pub tolerance: Option<f64>,
    /// The least value that holds.
    pub at_least: Option<f64>,
    /// The largest value that holds.
    pub at_most: Option<f64>,
    /// Why this limit.
    pub because: String,
    /// Why it is known not to hold yet.
    pub known_gap: Option<String>,
}

impl SweepMeasure {
    fn needs_measured(self) -> bool {
        matches!(
            self,
            Self::ExponentOfSpeedAgainstMeasured
                | Self::ExponentOfThicknessAgainstMeasured
                | Self::MeanRatio
                | Self::MeanAbsoluteError
        )
    }

    fn needs_speed(self) -> bool {
        matches!(self, Self::SlopeOverThickness | Self::SlopeHalfWidth | Self::DepartureFromLine)
    }

    fn words(self) -> &'static str {
        match self {
            Self::SlopeOverThickness => "change per mm of h",
            Self::SlopeHalfWidth => "half width of the change per mm of h, relative",
            Self::DepartureFromLine => "largest departure from a line over h, of the mean",
            Self::ExponentOfSpeed => "exponent of v_c",
            Self::ExponentOfSpeedLower => "lower end of the exponent of v_c",
            Self::ExponentOfSpeedUpper => "upper end of the exponent of v_c",
            Self::ExponentOfThickness => "exponent of h",
            Self::ExponentOfSpeedAgainstMeasured => "exponent of v_c, simulated minus measured",
            Self::ExponentOfThicknessAgainstMeasured => "exponent of h, simulated minus measured",
            Self::MeanRatio => "simulated over measured, minus 1, mean",
            Self::MeanAbsoluteError => "mean absolute error over mean measured",
        }
    }

    fn unit(self) -> &'static str {
        if self == Self::SlopeOverThickness { "N/mm" } else { "" }
    }

    fn of(
        self,
        speed: Option<f64>,
        simulated: &[ForcePoint],
        measured: &[ForcePoint],
    ) -> Option<f64> {
        let line = || line_over_thickness(simulated, speed? / 60.0);
        let power = |points: &[ForcePoint],
                     pick: fn(&sphcut_sweep::PowerLaw) -> Option<Estimate>| {
            power_law(points).as_ref().and_then(pick)
        };
        let own = |pick| power(simulated, pick);
        // Of the conditions that both have: exponents are not the same everywhere.
        let against = |pick| {
            let both = common(simulated, measured);
            let of =
                |k: fn(&(ForcePoint, f64)) -> ForcePoint| both.iter().map(k).collect::<Vec<_>>();
            let own = power(&of(|pair| pair.0), pick)?;
            let real = power(&of(|pair| ForcePoint { force: pair.1, ..pair.0 }), pick)?;
            Some(own.value - real.value)
        };
        match self {
            Self::SlopeOverThickness => Some(line()?.slope.value / 1e3),
            Self::SlopeHalfWidth => line().map(|l| l.slope.half_width / l.slope.value.abs()),
            Self::DepartureFromLine => Some(line()?.worst),
            Self::ExponentOfSpeed => Some(own(|law| law.speed)?.value),
            Self::ExponentOfSpeedLower => own(|law| law.speed).map(|e| e.value - e.half_width),
            Self::ExponentOfSpeedUpper => own(|law| law.speed).map(|e| e.value + e.half_width),
            Self::ExponentOfThickness => Some(own(|law| law.thickness)?.value),
            Self::ExponentOfSpeedAgainstMeasured => against(|law| law.speed),
            Self::ExponentOfThicknessAgainstMeasured => against(|law| law.thickness),
            Self::MeanRatio => mean(&pairs(simulated, measured), |(s, m)| s / m - 1.0),
            Self::MeanAbsoluteError => {
                let pairs = pairs(simulated, measured);
                Some(mean(&pairs, |(s, m)| (s - m).abs())? / mean(&pairs, |(_, m)| m)?)
            }
        }
    }
}

/// Simulated and mean measured forces where there are both.
fn pairs(simulated: &[ForcePoint], measured: &[ForcePoint]) -> Vec<(f64, f64)> {
    common(simulated, measured).into_iter().map(|(point, real)| (point.force, real)).collect()
}

/// The simulated points at which something was measured, with the mean of it.
fn common(simulated: &[ForcePoint], measured: &[ForcePoint]) -> Vec<(ForcePoint, f64)> {
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
    let mut pairs = Vec::new();
    for point in simulated {
        let here = |other: &&ForcePoint| (0..2).all(|k| same(point.at[k], other.at[k]));
        let there: Vec<f64> = measured.iter().filter(here).map(|other| other.force).collect();
        if !there.is_empty() {
            pairs.push((*point, there.iter().sum::<f64>() / there.len() as f64));
        }
    }
    pairs
}

fn mean(pairs: &[(f64, f64)], of: impl Fn((f64, f64)) -> f64) -> Option<f64> {
    let sum: f64 = pairs.iter().map(|pair| of(*pair)).sum();
    (!pairs.is_empty()).then(|| sum / pairs.len() as f64)
}

impl SweepExpectation {
    pub(super) fn check(&self, has_measured: bool) -> Result<(), String> {
        let wrong = |reason: &str| Err(format!("`{}`: {reason}", self.measure.words()));
        let limits = [self.reference, self.at_least, self.at_most];
        if limits.iter().flatten().count() != 1
            || self.reference.is_some() != self.tolerance.is_some()
        {
            return wrong(
                "one of `at_least`, `at_most` and `reference` with `tolerance` is needed",
            );
        }
        if self.measure.needs_speed() != self.cutting_speed.is_some() {
            return wrong("`cutting_speed` belongs to lines over h, and they need it");
        }
        if self.measure.needs_measured() && !has_measured {
            return wrong("there are no measured forces");
        }
        if self.because.trim().is_empty() { wrong("`because` is empty") } else { Ok(()) }
    }

    pub(super) fn judge(
        &self,
        simulated: &[Vec<ForcePoint>; 2],
        measured: &[Vec<ForcePoint>; 2],
    ) -> Result<Finding, CaseError> {
        let index = usize::from(self.force == ForceKind::Feed);
        let value = self.measure.of(self.cutting_speed, &simulated[index], &measured[index]);
        let value =
            value.filter(|value| value.is_finite()).ok_or_else(|| CaseError::Unobservable {
                observable: self.measure.words().to_owned(),
                reason: "the table has too few conditions for it".to_owned(),
            })?;
        // Checked when the case was read: one of the three.
        let (metric, limit, result, holds) = match (self.at_least, self.at_most, self.reference) {
            (Some(limit), ..) => (Metric::AtLeast, limit, value, value >= limit),
            (_, Some(limit), _) => (Metric::AtMost, limit, value, value <= limit),
            (.., reference) => {
                let reference = reference.unwrap_or(f64::NAN);
                let error = value / reference - 1.0;
                let holds = error.abs() <= self.tolerance.unwrap_or(0.0);
                (Metric::RelativeError, reference, error, holds)
            }
        };
        let at = self.cutting_speed.map(|speed| format!(" at {} m/min", number(speed)));
        Ok(Finding {
            run: "all".to_owned(),
            observable: format!(
                "{}: {}{}",
                self.force.symbol(),
                self.measure.words(),
                at.unwrap_or_default()
            ),
            unit: self.measure.unit().to_owned(),
            metric,
            values: vec![value],
            reference: number(limit),
            result,
            tolerance: self.tolerance.unwrap_or(0.0),
            holds,
            known_gap: self.known_gap.clone(),
            because: self.because.clone(),
        })
    }
}
