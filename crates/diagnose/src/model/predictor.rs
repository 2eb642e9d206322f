//! What a diagnosis asks of a model of the cut.

use nalgebra::DMatrix;
use sphcut_physics::{Channel, CuttingCondition};
use statrs::distribution::{ContinuousCDF, Normal};

/// A property of material or friction that differs from batch to batch: the model multiplies its value by exp(x), and
/// x is normal around 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nuisance {
    /// Name in files, e.g. `initial_yield`.
    pub key: &'static str,
    /// Standard deviation of x.
    pub deviation: f64,
}

/// Prior of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prior {
    /// Equally probable between two values.
    Uniform {
        /// Lowest value.
        low: f64,
        /// Highest value.
        high: f64,
    },
    /// Its logarithm is equally probable between those of two values above 0.
    LogUniform {
        /// Lowest value.
        low: f64,
        /// Highest value.
        high: f64,
    },
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
}

/// Beyond this many standard deviations a bounded parameter is at its limit.
const FAR: f64 = 6.0;

fn standard() -> Normal {
    Normal::new(0.0, 1.0).expect("a standard deviation of 1")
}

impl Prior {
    /// The value at which a standard normal coordinate t stands: Phi(t) is the share of the prior below it.
    /// In t every prior is the standard normal law, exactly.
    #[must_use]
    pub fn value(&self, t: f64) -> f64 {
        let share = || standard().cdf(t.clamp(-FAR, FAR));
        match *self {
            Self::Uniform { low, high } => low + (high - low) * share(),
            Self::LogUniform { low, high } => low * (high / low).powf(share()),
            Self::Normal { mean, deviation } => mean + deviation * t,
        }
    }

    /// The coordinate of a value; the inverse of [`Prior::value`].
    #[must_use]
    pub fn coordinate(&self, value: f64) -> f64 {
        let of = |share: f64| standard().inverse_cdf(share.clamp(0.0, 1.0)).clamp(-FAR, FAR);
        match *self {
            Self::Uniform { low, high } => of((value - low) / (high - low)),
            Self::LogUniform { low, high } => of((value / low).ln() / (high / low).ln()),
            Self::Normal { mean, deviation } => (value - mean) / deviation,
        }
    }
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectParameter {
    /// Its key.
    pub key: &'static str,
    /// Its letter in the formula.
    pub symbol: &'static str,
    /// Its SI unit; empty for a pure number.
    pub unit: &'static str,
    /// Prior over SI values.
    pub prior: Prior,
}

/// Physics that the base model does not have and that may be missing.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateEffect {
    /// Its key in the catalogue.
    pub key: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// Friction, heat, rate and size, edge, time, instrument.
    pub family: &'static str,
    /// Its parameters.
    pub parameters: Vec<EffectParameter>,
}

/// An effect that is switched on.
#[derive(Debug, Clone, PartialEq)]
pub struct Active {
    /// Its place in [`Predictor::effects`].
    pub effect: usize,
    /// SI values of its parameters, in their order.
    pub values: Vec<f64>,
}

/// What a relation of a model may be wrong by, where no reference cuts teach it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelationError {
    /// Its name in files.
    pub key: &'static str,
    /// In words.
    pub title: &'static str,
    /// Standard deviation: in the unit, or of the logarithm.
    pub deviation: f64,
    /// SI unit; empty for a logarithm.
    pub unit: &'static str,
    /// Where the deviation comes from.
    pub reason: &'static str,
}

/// A model of the cut with nuisances and with effects that can be switched on.
///
/// The closed-form model and tables of paired solver runs implement it: nothing else is asked of a model.
pub trait Predictor: Sync {
    /// Its nuisances.
    fn nuisances(&self) -> &[Nuisance];

    /// Effects it can switch on.
    fn effects(&self) -> &[CandidateEffect];

    /// Channels it predicts.
    fn channels(&self) -> &[Channel];

    /// Power to which the probability of the data is raised when explanations of a difference are weighed against each other, from 0
    /// to 1: below 1 for a model whose errors are not all stated. See [`Attribution`](crate::Attribution).
    fn likelihood_power(&self) -> f64 {
        1.0
    }

    /// The same power for how well parameters are known: the size of an effect hangs on more of the model than which effect it is.
    fn estimate_power(&self) -> f64 {
        self.likelihood_power()
    }

    /// Whether the answer with these effects depends on the cut length or on the place in the order of the runs. If not, cuts
    /// with the same v_c, h and tool are asked once.
    fn follows_series(&self, active: &[Active]) -> bool {
        let _ = active;
        true
    }

    /// How wrong what it says of an effect may be, as shares of the change; each is as probable as the others.
    fn change_errors(&self) -> &[f64] {
        &[0.0]
    }

    /// How wrong it may be by itself, smoothly over the conditions, where no reference cuts teach it: shares of each channel, by place in
    /// [`Channel::RECORDED`]; each line is as probable as the others.
    fn model_errors(&self) -> &[[f64; Channel::RECORDED.len()]] {
        &[[0.0; Channel::RECORDED.len()]]
    }

    /// What its relations may be wrong by where no reference cuts teach it.
    fn relations(&self) -> Vec<RelationError> {
        Vec::new()
    }

    /// What the logarithms of [`Predictor::channels`]' quantities change by one standard deviation of each of
    /// [`Predictor::relations`]: what is wrong in several channels at once.
    fn relation_errors(&self, condition: &CuttingCondition) -> Vec<Vec<f64>> {
        let _ = condition;
        Vec::new()
    }

    /// Logarithm of each of [`Predictor::channels`]' quantities in SI units, in that order; a value that is not finite
    /// where there is no answer. `nuisances` holds x of each nuisance, the logarithm of a factor.
    fn log_observables(
        &self,
        condition: &CuttingCondition,
        nuisances: &[f64],
        active: &[Active],
    ) -> Vec<f64>;

    /// Covariance, over `conditions`, of what is not known of a channel's logarithm without effects: the means of runs scatter.
    /// `None` of a model that is exact in what it says.
    fn base_uncertainty(
        &self,
        channel: Channel,
        conditions: &[CuttingCondition],
    ) -> Option<DMatrix<f64>> {
        let _ = (channel, conditions);
        None
    }

    /// What effects add to it.
    fn effect_uncertainty(
        &self,
        channel: Channel,
        conditions: &[CuttingCondition],
        active: &[Active],
    ) -> Option<DMatrix<f64>> {
        let _ = (channel, conditions, active);
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_and_values_are_inverse() {
        for prior in [
            Prior::Uniform { low: -1.0, high: 3.0 },
            Prior::LogUniform { low: 1e-6, high: 1e-3 },
            Prior::Normal { mean: 2.0, deviation: 0.5 },
        ] {
            for t in [-3.0, -1.0, 0.0, 0.4, 2.5] {
                let back = prior.coordinate(prior.value(t));
                assert!((back - t).abs() < 1e-6, "{prior:?} {t} {back}");
            }
        }
    }

    #[test]
    fn half_of_a_prior_lies_below_the_middle() {
        // The middle of a uniform law, and of the logarithms of 1 and 100.
        assert!((Prior::Uniform { low: 2.0, high: 4.0 }.value(0.0) - 3.0).abs() < 1e-12);
        assert!((Prior::LogUniform { low: 1.0, high: 100.0 }.value(0.0) - 10.0).abs() < 1e-9);
        // Phi(1) = 0.841345.
        let one = Prior::Uniform { low: 0.0, high: 1.0 }.value(1.0);
        assert!((one - 0.841_344_746).abs() < 1e-8, "{one}");
    }
}
