//! Regression trees grown by exact search over all splits.
//!
//! With first derivatives g_i and second derivatives h_i of the loss, a leaf with the sums G and H weighs
//! -G / (H + lambda), and the best split maximises
//!
//! ```text
//! 1/2 [G_L^2/(H_L + lambda) + G_R^2/(H_R + lambda) - G^2/(H + lambda)] - gamma
//! ```
//!
//! which is what Eqs. 12 and 13 say for one leaf more (Chen and Guestrin 2016). With g = -y, h = 1 and lambda = 0
//! leaves are means and splits those of least squares: the trees of a forest.

use crate::random::Random;
use crate::samples::Input;
use serde::{Deserialize, Serialize};

/// A node: a leaf, or a split with its children.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Node {
    /// Value of a leaf.
    Leaf(f64),
    /// Input below the threshold goes to the first child.
    Split(u8, f64, u32, u32),
}

/// A tree; its root is the first node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Gain of all splits in v_c and in h.
    gain: [f64; 2],
}

/// How far a tree grows.
#[derive(Debug, Clone)]
pub(super) struct GrowthLimits {
    pub max_depth: u32,
    /// Least number of different rows of a leaf.
    pub min_rows: usize,
    pub lambda: f64,
    pub split_penalty: f64,
    /// Inputs tried at a split: 1 (drawn) or 2.
    pub inputs_per_split: usize,
}

/// Derivatives of the loss at one row: first and second.
pub(super) type Derivative = [f64; 2];

struct Grower<'a> {
    inputs: &'a [Input],
    derivatives: &'a [Derivative],
    growth: &'a GrowthLimits,
    random: Option<&'a mut Random>,
    tree: Tree,
}

struct Split {
    axis: usize,
    threshold: f64,
    gain: f64,
}

/// Rows in the order of both inputs, for those with a weight.
pub(super) fn presort(inputs: &[Input], derivatives: &[Derivative]) -> [Vec<usize>; 2] {
    [0, 1].map(|axis| {
        let mut rows: Vec<usize> =
            (0..inputs.len()).filter(|&row| derivatives[row][1] > 0.0).collect();
        rows.sort_by(|&a, &b| inputs[a][axis].total_cmp(&inputs[b][axis]));
        rows
    })
}

impl Tree {
    /// Grows a tree over the rows in `order`.
    pub(super) fn grow(
        inputs: &[Input],
        derivatives: &[Derivative],
        order: [Vec<usize>; 2],
        growth: &GrowthLimits,
        random: Option<&mut Random>,
    ) -> Self {
        let tree = Self { nodes: Vec::new(), gain: [0.0; 2] };
        let mut grower = Grower { inputs, derivatives, growth, random, tree };
        grower.node(order, 0);
        grower.tree
    }

    pub(super) fn predict(&self, input: Input) -> f64 {
        let mut at = 0;
        loop {
            match self.nodes[at] {
                Node::Leaf(value) => return value,
                Node::Split(axis, threshold, below, above) => {
                    at = if input[usize::from(axis)] < threshold { below } else { above } as usize;
                }
            }
        }
    }

    /// Makes every leaf smaller by a factor.
    pub(super) fn shrink(&mut self, factor: f64) {
        for node in &mut self.nodes {
            if let Node::Leaf(value) = node {
                *value *= factor;
            }
        }
    }

    pub(super) fn gain(&self) -> [f64; 2] {
        self.gain
    }

    /// Whether every child exists and comes after its parent: what a stored tree has to be.
    pub(super) fn is_sound(&self) -> bool {
        let count = self.nodes.len();
        let after = |parent: usize, child: u32| (child as usize) < count && child as usize > parent;
        count > 0
            && self.nodes.iter().enumerate().all(|(at, node)| match *node {
                Node::Leaf(value) => value.is_finite(),
                Node::Split(axis, _, below, above) => {
                    axis < 2 && after(at, below) && after(at, above)
                }
            })
    }
}

impl Grower<'_> {
    /// Grows the node of the rows in `order` and returns its index.
    fn node(&mut self, order: [Vec<usize>; 2], depth: u32) -> u32 {
        let at = self.tree.nodes.len();
        let sums = self.sums(&order[0]);
        self.tree.nodes.push(Node::Leaf(-sums[0] / (sums[1] + self.growth.lambda)));
        let split = if depth < self.growth.max_depth { self.best(&order, sums) } else { None };
        if let Some(split) = split {
            self.tree.gain[split.axis] += split.gain;
            let below = |row: &usize| self.inputs[*row][split.axis] < split.threshold;
            let (mut left, mut right) = ([vec![], vec![]], [vec![], vec![]]);
            for (axis, rows) in order.into_iter().enumerate() {
                (left[axis], right[axis]) = rows.into_iter().partition(below);
            }
            let children = [self.node(left, depth + 1), self.node(right, depth + 1)];
            let axis = u8::from(split.axis == 1);
            self.tree.nodes[at] = Node::Split(axis, split.threshold, children[0], children[1]);
        }
        at as u32
    }

    fn sums(&self, rows: &[usize]) -> Derivative {
        rows.iter().fold([0.0; 2], |sum, &row| {
            [sum[0] + self.derivatives[row][0], sum[1] + self.derivatives[row][1]]
        })
    }

    /// The split with the largest gain above 0; the first input wins a tie.
    fn best(&mut self, order: &[Vec<usize>; 2], sums: Derivative) -> Option<Split> {
        let tried = match &mut self.random {
            Some(random) if self.growth.inputs_per_split == 1 => {
                let axis = random.below(2);
                axis..axis + 1
            }
            _ => 0..2,
        };
        let mut best: Option<Split> = None;
        for axis in tried {
            for split in self.along(&order[axis], axis, sums) {
                if best.as_ref().is_none_or(|found| split.gain > found.gain) {
                    best = Some(split);
                }
            }
        }
        // Rounding alone must not split rows of equal targets.
        let noise = 1e-14 * sums[1].max(1.0);
        best.filter(|split| split.gain > noise)
    }

    /// All splits along one input.
    fn along<'a>(
        &'a self,
        rows: &'a [usize],
        axis: usize,
        sums: Derivative,
    ) -> impl Iterator<Item = Split> + 'a {
        let growth = self.growth;
        let score = move |[g, h]: Derivative| g * g / (h + growth.lambda);
        let mut left = [0.0; 2];
        rows.windows(2).enumerate().filter_map(move |(k, pair)| {
            let derivative = self.derivatives[pair[0]];
            left = [left[0] + derivative[0], left[1] + derivative[1]];
            let right = [sums[0] - left[0], sums[1] - left[1]];
            let (a, b) = (self.inputs[pair[0]][axis], self.inputs[pair[1]][axis]);
            let enough = (k + 1).min(rows.len() - k - 1) >= growth.min_rows;
            (a < b && enough).then(|| Split {
                axis,
                threshold: middle(a, b),
                gain: 0.5 * (score(left) + score(right) - score(sums)) - growth.split_penalty,
            })
        })
    }
}

/// A threshold above `a` and at most `b`.
fn middle(a: f64, b: f64) -> f64 {
    let middle = 0.5 * (a + b);
    if middle > a { middle } else { b }
}
