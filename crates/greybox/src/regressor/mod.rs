//! The regressors f_D, each behind [`Regressor`].
//!
//! [`Method`] names them and holds their grids, [`RegressorSettings`] is one point of a grid, [`Model`] is what a fit gives:
//! plain numbers that are stored and read again to the same predictions.

mod boosting;
mod forest;
mod gaussian_process;
mod grids;
mod network;
mod polynomial;
mod scaling;
mod support_vector;
mod tree;

pub use boosting::{Boosting, BoostingSettings};
pub use forest::{Forest, ForestSettings};
pub use gaussian_process::{GaussianProcess, GaussianProcessSettings};
pub use network::{Network, NetworkSettings};
pub use polynomial::{Polynomial, PolynomialSettings};
pub use scaling::InputScale;
pub use support_vector::{SupportVector, SupportVectorSettings};

use crate::samples::{Input, TrainingRows};
use serde::{Deserialize, Serialize};

/// A function of the cutting conditions that was learnt.
pub trait Regressor {
    /// Its value.
    fn predict(&self, input: Input) -> f64;

    /// Standard deviation of a new measurement around that value, if the regressor knows one.
    fn deviation(&self, _input: Input) -> Option<f64> {
        None
    }

    /// Share of both inputs in the gain of all splits, if the regressor has splits.
    fn gain(&self) -> Option<[f64; 2]> {
        None
    }
}

/// A kind of regressor with its grid of settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Least squares, linear.
    Linear,
    /// Least squares, polynomial of degree 2.
    Quadratic,
    /// Least squares, polynomial of degree 4.
    Quartic,
    /// Support vector regression with radial basis functions.
    SupportVector,
    /// Random forest.
    Forest,
    /// Gradient-boosted trees with XGBoost's objective.
    Boosting,
    /// Feed-forward network with two hidden layers.
    Network,
    /// Gaussian process with noise.
    GaussianProcess,
}

impl Method {
    /// All, from the simplest.
    pub const ALL: [Self; 8] = [
        Self::Linear,
        Self::Quadratic,
        Self::Quartic,
        Self::SupportVector,
        Self::Forest,
        Self::Boosting,
        Self::Network,
        Self::GaussianProcess,
    ];

    /// Its name in files and on the command line.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Quadratic => "quadratic",
            Self::Quartic => "quartic",
            Self::SupportVector => "support_vector",
            Self::Forest => "forest",
            Self::Boosting => "boosting",
            Self::Network => "network",
            Self::GaussianProcess => "gaussian_process",
        }
    }

    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "Linear",
            Self::Quadratic => "Polynomial, degree 2",
            Self::Quartic => "Polynomial, degree 4",
            Self::SupportVector => "Support vectors",
            Self::Forest => "Random forest",
            Self::Boosting => "Boosted trees",
            Self::Network => "Network",
            Self::GaussianProcess => "Gaussian process",
        }
    }

    /// The method of a key.
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.key() == key)
    }

    /// The settings that are tried, simplest first.
    #[must_use]
    pub fn grid(self) -> Vec<RegressorSettings> {
        grids::grid(self)
    }
}

/// One point of a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RegressorSettings {
    /// Least squares.
    Polynomial(PolynomialSettings),
    /// Support vectors.
    SupportVector(SupportVectorSettings),
    /// Random forest.
    Forest(ForestSettings),
    /// Boosted trees.
    Boosting(BoostingSettings),
    /// Network.
    Network(NetworkSettings),
    /// Gaussian process.
    GaussianProcess(GaussianProcessSettings),
}

impl RegressorSettings {
    /// Teaches a regressor with `samples`, which are not empty.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows, seed: u64) -> Model {
        match self {
            Self::Polynomial(settings) => Model::Polynomial(settings.fit(samples)),
            Self::SupportVector(settings) => Model::SupportVector(settings.fit(samples)),
            Self::Forest(settings) => Model::Forest(settings.fit(samples, seed)),
            Self::Boosting(settings) => Model::Boosting(settings.fit(samples)),
            Self::Network(settings) => Model::Network(settings.fit(samples, seed)),
            Self::GaussianProcess(settings) => Model::GaussianProcess(settings.fit(samples, seed)),
        }
    }
}

/// A regressor that was taught.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Least squares.
    Polynomial(Polynomial),
    /// Support vectors.
    SupportVector(SupportVector),
    /// Random forest.
    Forest(Forest),
    /// Boosted trees.
    Boosting(Boosting),
    /// Network.
    Network(Network),
    /// Gaussian process.
    GaussianProcess(GaussianProcess),
}

impl Model {
    fn inner(&self) -> &dyn Regressor {
        match self {
            Self::Polynomial(model) => model,
            Self::SupportVector(model) => model,
            Self::Forest(model) => model,
            Self::Boosting(model) => model,
            Self::Network(model) => model,
            Self::GaussianProcess(model) => model,
        }
    }
}

impl Model {
    /// Whether a stored model can be evaluated: lengths agree, and trees end.
    pub(crate) fn is_sound(&self) -> bool {
        match self {
            Self::Polynomial(model) => model.is_sound(),
            Self::SupportVector(_) | Self::GaussianProcess(_) => true,
            Self::Forest(model) => model.is_sound(),
            Self::Boosting(model) => model.is_sound(),
            Self::Network(model) => model.is_sound(),
        }
    }
}

impl Regressor for Model {
    fn predict(&self, input: Input) -> f64 {
        self.inner().predict(input)
    }

    fn deviation(&self, input: Input) -> Option<f64> {
        self.inner().deviation(input)
    }

    fn gain(&self) -> Option<[f64; 2]> {
        self.inner().gain()
    }
}

#[cfg(test)]
mod tests;
