//! From the forces of a sweep to judgements.

use crate::error::CaseError;
use crate::expectation::{Expected, Measure};
use crate::metric::number;
use crate::verdict::Judgement;
use serde::Deserialize;
use sphcut_sweep::{ForcePoint, TrendEstimate, line_over_thickness, power_law};

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

    fn of(
        self,
        speed: Option<f64>,
        simulated: &[ForcePoint],
        measured: &[ForcePoint],
    ) -> Option<f64> {
        let line = || line_over_thickness(simulated, speed? / 60.0);
        let power =
            |points: &[ForcePoint], pick: fn(&sphcut_sweep::PowerLaw) -> Option<TrendEstimate>| {
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

impl Measure for SweepMeasure {
    const KEYS: &'static [&'static str] = &["force", "cutting_speed"];

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
}

impl Expected<SweepMeasure> {
    pub(super) fn check_trend(&self, has_measured: bool) -> Result<(), String> {
        self.check()?;
        if self.measure.needs_speed() != self.cutting_speed.is_some() {
            return Err(self.wrong("`cutting_speed` belongs to lines over h, and they need it"));
        }
        if self.measure.needs_measured() && !has_measured {
            return Err(self.wrong("there are no measured forces"));
        }
        Ok(())
    }

    pub(super) fn judge_trend(
        &self,
        simulated: &[Vec<ForcePoint>; 2],
        measured: &[Vec<ForcePoint>; 2],
    ) -> Result<Judgement, CaseError> {
        let index = self.force_index();
        let value = self.measure.of(self.cutting_speed, &simulated[index], &measured[index]);
        let at = self.cutting_speed.map(|speed| format!(" at {} m/min", number(speed)));
        let force = self.force.map_or("", |force| force.symbol());
        let about = format!("{force}: {}{}", self.measure.words(), at.unwrap_or_default());
        let value = value.filter(|value| value.is_finite());
        self.judge("all", &about, value, "the table has too few conditions for it")
    }
}
