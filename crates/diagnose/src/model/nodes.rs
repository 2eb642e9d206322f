//! The grid on which effects are tabulated over the coordinates of their parameters, and what lies between its nodes.

use nalgebra::{DMatrix, DVector};

/// Nodes for an effect with one, two, and more parameters: their number and their distance in standard deviations.
const NODES: [(usize, f64); 3] = [(7, 0.8), (5, 1.0), (3, 1.5)];

fn nodes(parameters: usize) -> (usize, f64) {
    NODES[parameters.clamp(1, NODES.len()) - 1]
}

/// Where the model has no answer at a node, a chip too thin for a blunt edge, the strength of the effect cannot be that of the
/// recordings: the nearest node with an answer stands there, if there is one.
pub(crate) fn filled(parameters: usize, columns: Vec<DVector<f64>>) -> DMatrix<f64> {
    let places = coordinates(parameters);
    let is_known = |k: &usize| columns[*k].iter().all(|value| value.is_finite());
    let known: Vec<usize> = (0..columns.len()).filter(is_known).collect();
    let apart = |a: usize, b: usize| {
        places[a].iter().zip(&places[b]).map(|(x, y)| (x - y).powi(2)).sum::<f64>()
    };
    let nearest = |k: usize| {
        known.iter().copied().min_by(|&a, &b| apart(a, k).total_cmp(&apart(b, k))).unwrap_or(k)
    };
    let all: Vec<DVector<f64>> = (0..columns.len()).map(|k| columns[nearest(k)].clone()).collect();
    DMatrix::from_columns(&all)
}

/// The coordinates of all nodes.
pub(crate) fn coordinates(parameters: usize) -> Vec<Vec<f64>> {
    let (count, distance) = nodes(parameters);
    let total = count.pow(u32::try_from(parameters).expect("a handful of parameters"));
    let middle = (count - 1) as f64 / 2.0;
    (0..total)
        .map(|node| {
            let place = |axis: u32| node / count.pow(axis) % count;
            (0..parameters as u32).map(|axis| (place(axis) as f64 - middle) * distance).collect()
        })
        .collect()
}

/// The weight of each node in the value at `t`: along each axis the cubic through four nodes with the slopes of their
/// neighbours (Catmull and Rom 1974), straight at the ends; beyond the last node half a distance more, then constant.
pub(crate) fn weights(t: &[f64]) -> Vec<f64> {
    let (count, distance) = nodes(t.len());
    let along: Vec<Vec<f64>> = t.iter().map(|&t| axis_weights(t, count, distance)).collect();
    let mut all = vec![1.0];
    for axis in along {
        all = axis.iter().flat_map(|a| all.iter().map(move |b| a * b)).collect();
    }
    all
}

fn axis_weights(t: f64, count: usize, distance: f64) -> Vec<f64> {
    let last = (count - 1) as f64;
    let x = (t / distance + last / 2.0).clamp(-0.5, last + 0.5);
    let cell = (x.floor().clamp(0.0, last - 1.0)) as usize;
    let s = x - cell as f64;
    let mut weights = vec![0.0; count];
    if (0.0..=1.0).contains(&s) {
        let (s2, s3) = (s * s, s * s * s);
        weights[cell] += 2.0 * s3 - 3.0 * s2 + 1.0;
        weights[cell + 1] += 3.0 * s2 - 2.0 * s3;
        let mut slope = |node: usize, share: f64| {
            let (a, b) = (node.saturating_sub(1), (node + 1).min(count - 1));
            weights[b] += share / (b - a) as f64;
            weights[a] -= share / (b - a) as f64;
        };
        slope(cell, s3 - 2.0 * s2 + s);
        slope(cell + 1, s3 - s2);
    } else {
        // Straight on with the slope of the outermost cell.
        weights[cell] += 1.0 - s;
        weights[cell + 1] += s;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_without_an_answer_take_that_of_the_nearest_with_one() {
        let column = |x: f64| DVector::from_element(2, x);
        let mut columns: Vec<DVector<f64>> = (0..7).map(|k| column(f64::from(k))).collect();
        columns[0] = column(f64::NAN);
        columns[1][1] = f64::NAN;
        let nodes = filled(1, columns);
        assert_eq!(nodes.row(1).iter().copied().collect::<Vec<_>>(), [2., 2., 2., 3., 4., 5., 6.]);
        let none = filled(1, vec![column(f64::NAN); 7]);
        assert!(none.iter().all(|value| value.is_nan()));
    }

    #[test]
    fn a_line_is_interpolated_exactly_and_nodes_are_kept() {
        for parameters in 1..=3 {
            let plane = |t: &[f64]| {
                1.0 + t.iter().enumerate().map(|(k, t)| (k as f64 + 2.0) * t).sum::<f64>()
            };
            let values: Vec<f64> = coordinates(parameters).iter().map(|t| plane(t)).collect();
            let at = |t: &[f64]| weights(t).iter().zip(&values).map(|(w, v)| w * v).sum::<f64>();
            for share in [-1.4, -0.37, 0.0, 0.9, 1.3] {
                let t: Vec<f64> = (0..parameters).map(|k| share / (k as f64 + 1.0)).collect();
                assert!((at(&t) - plane(&t)).abs() < 1e-12, "{t:?}");
            }
        }
    }

    #[test]
    fn the_interpolation_of_a_share_of_the_prior_is_good_to_a_hundredth() {
        use crate::model::predictor::Prior;
        let prior = Prior::Uniform { low: 0.0, high: 1.0 };
        let values: Vec<f64> = coordinates(1).iter().map(|t| prior.value(t[0])).collect();
        for k in -24..=24 {
            let t = 0.1 * f64::from(k);
            let found: f64 = weights(&[t]).iter().zip(&values).map(|(w, v)| w * v).sum();
            assert!((found - prior.value(t)).abs() < 0.01, "{t}: {found}");
        }
    }
}
