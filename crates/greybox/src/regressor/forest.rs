//! Random forest (Breiman 2001): trees of least squares on bootstrap samples, averaged.

use super::Regressor;
use super::tree::{Derivative, GrowthLimits, Tree, presort};
use crate::random::Random;
use crate::samples::{Input, TrainingRows};
use serde::{Deserialize, Serialize};

/// Size and depth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForestSettings {
    /// Number of trees.
    pub trees: usize,
    /// Depth of each.
    pub max_depth: u32,
    /// Least number of different rows of a leaf.
    pub min_leaf: usize,
    /// Inputs tried at a split: 1 (drawn at random) or 2.
    pub inputs_per_split: usize,
}

/// The mean of its trees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Forest {
    trees: Vec<Tree>,
}

impl ForestSettings {
    /// Grows the forest; every tree has a stream of random numbers of its own.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows, seed: u64) -> Forest {
        let growth = GrowthLimits {
            max_depth: self.max_depth,
            min_rows: self.min_leaf,
            lambda: 0.0,
            split_penalty: 0.0,
            inputs_per_split: self.inputs_per_split,
        };
        let trees = (0..self.trees as u64)
            .map(|number| {
                let mut random = Random::new(seed, &[0xf0_4e57, number]);
                let mut derivatives: Vec<Derivative> = vec![[0.0; 2]; samples.len()];
                for _ in 0..samples.len() {
                    let row = random.below(samples.len());
                    derivatives[row][0] -= samples.targets[row];
                    derivatives[row][1] += 1.0;
                }
                let order = presort(&samples.inputs, &derivatives);
                Tree::grow(&samples.inputs, &derivatives, order, &growth, Some(&mut random))
            })
            .collect();
        Forest { trees }
    }
}

impl Forest {
    pub(crate) fn is_sound(&self) -> bool {
        !self.trees.is_empty() && self.trees.iter().all(Tree::is_sound)
    }
}

impl Regressor for Forest {
    fn predict(&self, input: Input) -> f64 {
        self.trees.iter().map(|tree| tree.predict(input)).sum::<f64>() / self.trees.len() as f64
    }

    fn gain(&self) -> Option<[f64; 2]> {
        Some(shares(&self.trees))
    }
}

/// Shares of both inputs in the gain of all splits.
pub(super) fn shares(trees: &[Tree]) -> [f64; 2] {
    let sum = trees.iter().map(Tree::gain).fold([0.0; 2], |s, g| [s[0] + g[0], s[1] + g[1]]);
    let total = sum[0] + sum[1];
    if total > 0.0 { sum.map(|gain| gain / total) } else { [0.0; 2] }
}
