//! The convex hull of the conditions that were measured: outside it a correction extrapolates.

use crate::samples::Input;
use serde::{Deserialize, Serialize};

/// A convex polygon in the plane of v_c and h, anticlockwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hull {
    corners: Vec<Input>,
    /// Extent of both inputs, by which the tolerance is scaled.
    extent: Input,
}

/// Share of the extent by which a point may lie outside: rounding of tables.
const TOLERANCE: f64 = 1e-3;

impl Hull {
    /// The hull of `points` (monotone chain, Andrew 1979).
    #[must_use]
    pub fn around(points: &[Input]) -> Self {
        let mut sorted = points.to_vec();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        sorted.dedup();
        let mut corners = half(sorted.iter().copied());
        let upper = half(sorted.iter().rev().copied());
        if sorted.len() > 1 {
            corners.pop();
            corners.extend(&upper[..upper.len() - 1]);
        }
        let extent = [0, 1].map(|axis| {
            let of = |point: &Input| point[axis];
            let (low, high) = points
                .iter()
                .map(of)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            if high > low { high - low } else { high.abs().max(f64::MIN_POSITIVE) }
        });
        Self { corners, extent }
    }

    /// Its corners, anticlockwise.
    #[must_use]
    pub fn corners(&self) -> &[Input] {
        &self.corners
    }

    /// Whether `point` lies inside or, to a thousandth of the extent, on the border.
    #[must_use]
    pub fn contains(&self, point: Input) -> bool {
        let scaled = |p: Input| [p[0] / self.extent[0], p[1] / self.extent[1]];
        let count = self.corners.len();
        if count < 3 {
            return self.distance_to_chain(scaled(point)) <= TOLERANCE;
        }
        (0..count).all(|k| {
            let [a, b] = [self.corners[k], self.corners[(k + 1) % count]].map(scaled);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            cross(a, b, scaled(point)) >= -TOLERANCE * length
        })
    }

    /// Distance of a scaled point from a hull without area: a point or a line.
    fn distance_to_chain(&self, point: Input) -> f64 {
        let scaled = |p: &Input| [p[0] / self.extent[0], p[1] / self.extent[1]];
        let Some(a) = self.corners.first().map(scaled) else { return f64::INFINITY };
        let b = self.corners.last().map_or(a, scaled);
        let (along, to) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
        let square = along[0] * along[0] + along[1] * along[1];
        let share = if square > 0.0 { (to[0] * along[0] + to[1] * along[1]) / square } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        (to[0] - share * along[0]).hypot(to[1] - share * along[1])
    }
}

/// One half of the chain.
fn half(points: impl Iterator<Item = Input>) -> Vec<Input> {
    let mut chain: Vec<Input> = Vec::new();
    for point in points {
        while let [.., a, b] = chain[..]
            && cross(a, b, point) <= 0.0
        {
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

/// Twice the area of the triangle a, b, c; positive if it turns left.
fn cross(a: Input, b: Input, c: Input) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_with_a_missing_corner_does_not_contain_it() {
        let plan: Vec<Input> = (0..11)
            .flat_map(|i| {
                (0..10).map(move |k| [100.0 + 10.0 * f64::from(i), 0.06 + 0.01 * f64::from(k)])
            })
            .filter(|p| !(p[0] > 195.0 && p[1] > 0.145))
            .collect();
        let hull = Hull::around(&plan);
        assert_eq!(hull.corners().len(), 5);
        assert!(hull.contains([150.0, 0.1]) && hull.contains([100.0, 0.06]));
        assert!(hull.contains([190.0, 0.15]) && !hull.contains([200.0, 0.15]));
        assert!(!hull.contains([99.0, 0.1]) && !hull.contains([150.0, 0.151]));
    }

    #[test]
    fn lines_and_points_are_hulls_too() {
        let line = Hull::around(&[[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]);
        assert!(
            line.contains([1.5, 1.5]) && !line.contains([1.5, 1.6]) && !line.contains([4.0, 4.0])
        );
        let point = Hull::around(&[[1.0, 2.0]]);
        assert!(point.contains([1.0, 2.0]) && !point.contains([1.1, 2.0]));
    }
}
