//! Simulated against measured springback.

use super::result::Springback;

/// A measured springback. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// Springback in m.
    pub springback: f64,
    /// Its uncertainty (half width) in m.
    pub uncertainty: f64,
    /// F_c in N.
    pub cutting_force: Option<f64>,
    /// F_n, normal to the machined surface (the feed force of an orthogonal cut), in N.
    pub normal_force: Option<f64>,
}

/// What a comparison says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// The difference is at most the uncertainty of the measurement.
    Within,
    /// It is larger, but not by more than the error bar of the simulation.
    Undecided,
    /// It is larger than both together.
    Outside,
}

/// A run beside the measurement at its cutting speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringbackComparison {
    /// What was measured.
    pub measured: Measurement,
    /// Simulated minus measured springback in m.
    pub difference: f64,
    /// The verdict.
    pub agreement: Agreement,
}

/// Cutting speeds that differ by less are the same.
const SAME_SPEED: f64 = 0.01;

impl Springback {
    /// The comparison with the first measurement at this cutting speed; `None` without one, or
    /// without a springback.
    #[must_use]
    pub fn compare(&self, measurements: &[Measurement]) -> Option<SpringbackComparison> {
        let same = |m: &&Measurement| {
            (m.cutting_speed - self.cutting_speed).abs() <= SAME_SPEED * self.cutting_speed
        };
        let measured = *measurements.iter().find(same)?;
        let difference = self.mean?.mean - measured.springback;
        let agreement = if difference.abs() <= measured.uncertainty {
            Agreement::Within
        } else if difference.abs() <= measured.uncertainty + self.error.total() {
            Agreement::Undecided
        } else {
            Agreement::Outside
        };
        Some(SpringbackComparison { measured, difference, agreement })
    }

    /// Whether the springback is larger than its error bar.
    #[must_use]
    pub fn is_resolved(&self) -> bool {
        self.mean.is_some_and(|mean| mean.mean.abs() > self.error.total())
    }
}
