//! The part of the surface around a particle in space, and the directions of its neighbours.

use glam::DVec2;

/// Corners that a particle's cell can have; further neighbours than that cut nothing.
const MOST_CORNERS: usize = 48;

/// Part of the tangent plane around a particle, as a convex polygon.
pub(super) struct Cell {
    corners: [DVec2; MOST_CORNERS],
    count: usize,
}

impl Cell {
    pub(super) fn square(half: f64) -> Self {
        let mut corners = [DVec2::ZERO; MOST_CORNERS];
        for (corner, [x, y]) in
            corners.iter_mut().zip([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        {
            *corner = half * DVec2::new(x, y);
        }
        Self { corners, count: 4 }
    }

    /// Whether a corner lies beyond `distance` of the origin along `direction`.
    pub(super) fn is_cut(&self, direction: DVec2, distance: f64) -> bool {
        self.corners[..self.count].iter().any(|corner| corner.dot(direction) > distance)
    }

    /// Keeps what lies within `distance` of the origin along `direction`.
    pub(super) fn cut(&mut self, direction: DVec2, distance: f64) {
        if self.count + 1 > MOST_CORNERS {
            return;
        }
        let beyond = |corner: &DVec2| corner.dot(direction) - distance;
        let old = self.corners;
        let count = self.count;
        self.count = 0;
        for k in 0..count {
            let (here, next) = (old[k], old[(k + 1) % count]);
            let (a, b) = (beyond(&here), beyond(&next));
            if a <= 0.0 {
                self.push(here);
            }
            if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
                let part = a / (a - b);
                self.push(here + part * (next - here));
            }
        }
    }

    fn push(&mut self, corner: DVec2) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    pub(super) fn area(&self) -> f64 {
        let corner = |k: usize| self.corners[k % self.count.max(1)];
        let doubled = |k: usize| corner(k).perp_dot(corner(k + 1));
        0.5 * (0..self.count).map(doubled).sum::<f64>()
    }
}

pub(super) fn angle(unit: DVec2) -> f64 {
    unit.y.atan2(unit.x)
}

/// Start and width of what lies behind number `k` of `angles`, which rise.
pub(super) fn gap(angles: &[f64], k: usize) -> (f64, f64) {
    let next = angles.get(k + 1).copied().unwrap_or(angles[0] + std::f64::consts::TAU);
    (angles[k], next - angles[k])
}

/// Width of the widest, of angles in any order.
pub(super) fn widest_sector(angles: &mut [f64]) -> f64 {
    angles.sort_unstable_by(f64::total_cmp);
    (0..angles.len()).map(|k| gap(angles, k).1).reduce(f64::max).unwrap_or(std::f64::consts::TAU)
}

pub(super) fn is_within(angle: f64, (start, width): (f64, f64)) -> bool {
    let way = (angle - start).rem_euclid(std::f64::consts::TAU);
    way > 0.0 && way < width
}
