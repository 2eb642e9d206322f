//! Gradient-boosted trees with XGBoost's regularised objective (Eqs. 12 and 13), by exact search.
//!
//! ```text
//! obj = sum_i 1/2 (y_i - yhat_i)^2 + sum_k [gamma T_k + 1/2 lambda sum_j w_kj^2]
//! ```
//!
//! Each tree is grown on the derivatives g_i = yhat_i - y_i and h_i = 1 and added times the learning rate; the
//! start is the mean of the targets. A split is made where it lowers the objective, so gamma prunes while
//! the tree grows, not afterwards; at gamma = 0, the default of XGBoost, both are the same.

use super::Regressor;
use super::forest::shares;
use super::tree::{Derivative, GrowthLimits, Tree, presort};
use crate::samples::{Input, TrainingRows, mean};
use serde::{Deserialize, Serialize};

/// The hyper-parameters that are searched, and those of the objective.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoostingSettings {
    /// Number of trees K.
    pub trees: usize,
    /// Depth of each.
    pub max_depth: u32,
    /// Share of each tree that is added.
    pub learning_rate: f64,
    /// lambda of Eq. 13.
    pub lambda: f64,
    /// gamma of Eq. 13.
    pub split_penalty: f64,
    /// Least number of rows of a leaf: with this loss its sum of second derivatives.
    pub min_leaf: usize,
}

/// A start and the trees that correct it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Boosting {
    start: f64,
    trees: Vec<Tree>,
}

impl BoostingSettings {
    /// Grows the trees one after another.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows) -> Boosting {
        let growth = GrowthLimits {
            max_depth: self.max_depth,
            min_rows: self.min_leaf,
            lambda: self.lambda,
            split_penalty: self.split_penalty,
            inputs_per_split: 2,
        };
        let start = mean(&samples.targets);
        let mut derivatives: Vec<Derivative> =
            samples.targets.iter().map(|target| [start - target, 1.0]).collect();
        let order = presort(&samples.inputs, &derivatives);
        let trees = (0..self.trees)
            .map(|_| {
                let mut tree =
                    Tree::grow(&samples.inputs, &derivatives, order.clone(), &growth, None);
                tree.shrink(self.learning_rate);
                for (input, derivative) in samples.inputs.iter().zip(&mut derivatives) {
                    derivative[0] += tree.predict(*input);
                }
                tree
            })
            .collect();
        Boosting { start, trees }
    }
}

impl Boosting {
    pub(crate) fn is_sound(&self) -> bool {
        self.trees.iter().all(Tree::is_sound)
    }
}

impl Regressor for Boosting {
    fn predict(&self, input: Input) -> f64 {
        self.start + self.trees.iter().map(|tree| tree.predict(input)).sum::<f64>()
    }

    fn gain(&self) -> Option<[f64; 2]> {
        Some(shares(&self.trees))
    }
}
