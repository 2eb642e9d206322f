//! How much of the tool's surface each touching particle covers.
//!
//! Pressure and shear stress of a contact are forces over an area, and the law's shear limit is a
//! stress. Particles that lie on the tool share its surface out among themselves (Voronoi): the border
//! between two of them lies half-way between the points where they touch,
//! ```text
//! A_i = area of { y on the tangent plane : y . t_ij <= |p_j - p_i| / 2 for all j nearer than 1.5 dx }
//! ```
//! with the points `p` of the tool nearest to the particles and the unit tangents `t_ij` from `i` to
//! `j`. Where nobody follows, the contact ends half a spacing beyond the last particle: there a
//! neighbour at a distance of `dx` is assumed in each tangent direction (two in 2D, four in 3D) without
//! a real one within 45 degrees. On a regular lattice that is the area of its cell, `dx^(D-1)` where it is
//! square; in a chip that has become thicker it is less, on a stretched surface more.
//!
//! **Limits.** A gap above 1.5 dx between touching particles is open. In 3D the surface counts as flat over
//! the distance of two particles.

use crate::setup::Vector as Vector3;

/// Neighbours touch the same patch up to this many spacings.
const REACH: f64 = 1.5;
/// Cosine of the angle within which a neighbour continues the contact.
const CONE: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Least share over that of a cell on its own; particles that stand behind others would have none.
const LEAST: f64 = 0.05;
/// Corners that a particle's patch can have; further neighbours than that cut nothing.
const MOST_CORNERS: usize = 48;

/// Room for `most` values in all.
pub(crate) fn make_room<T>(values: &mut Vec<T>, most: usize) {
    values.reserve(most.saturating_sub(values.len()));
}

/// A particle that touches the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Footing {
    pub(crate) centre: Vector3,
    /// Point of the tool that is nearest.
    pub(crate) foot: Vector3,
    /// Unit normal out of the tool.
    pub(crate) normal: Vector3,
}

/// Shares out the surface; keeps its memory between the steps.
#[derive(Debug, Default)]
pub(crate) struct SurfaceShares {
    order: Vec<u32>,
    shares: Vec<f64>,
}

/// Part of the tangent plane around a particle, as a convex polygon.
struct Patch {
    corners: [[f64; 2]; MOST_CORNERS],
    count: usize,
}

fn minus(a: &Vector3, b: &Vector3) -> Vector3 {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: &Vector3, b: &Vector3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector3, b: &Vector3) -> Vector3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Two unit vectors along the surface; in the plane, the first lies in it.
fn tangents(normal: &Vector3, dimension: usize) -> [Vector3; 2] {
    let least = if dimension == 2 {
        2
    } else {
        (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).expect("three")
    };
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let along = cross(normal, &axis);
    let length = dot(&along, &along).sqrt();
    let first = along.map(|component| component / length);
    [first, cross(normal, &first)]
}

impl Patch {
    fn square(half: f64) -> Self {
        let mut corners = [[0.0; 2]; MOST_CORNERS];
        corners[..4].copy_from_slice(&[[-half, -half], [half, -half], [half, half], [-half, half]]);
        Self { corners, count: 4 }
    }

    /// Keeps what lies within `distance` of the origin along `direction`.
    fn cut(&mut self, direction: [f64; 2], distance: f64) {
        if self.count + 1 > MOST_CORNERS {
            return;
        }
        let beyond = |c: &[f64; 2]| c[0] * direction[0] + c[1] * direction[1] - distance;
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
                self.push(std::array::from_fn(|i| here[i] + part * (next[i] - here[i])));
            }
        }
    }

    fn push(&mut self, corner: [f64; 2]) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    fn area(&self) -> f64 {
        let corner = |k: usize| self.corners[k % self.count.max(1)];
        let doubled = |k: usize| corner(k)[0] * corner(k + 1)[1] - corner(k)[1] * corner(k + 1)[0];
        0.5 * (0..self.count).map(doubled).sum::<f64>()
    }
}

impl SurfaceShares {
    /// Room for `most` particles.
    pub(crate) fn make_room(&mut self, most: usize) {
        make_room(&mut self.order, most);
        make_room(&mut self.shares, most);
    }

    /// Area in m^2 (length in m in 2D) of each particle of the last sharing, in their order.
    pub(crate) fn areas(&self) -> &[f64] {
        &self.shares
    }

    /// Shares the surface out among `footings`.
    pub(crate) fn share_out(&mut self, footings: &[Footing], spacing: f64, dimension: usize) {
        let axis = longest_axis(footings);
        let place = |i: u32| footings[i as usize].foot[axis];
        self.order.clear();
        self.order.extend(0..footings.len() as u32);
        self.order.sort_unstable_by(|&i, &j| place(i).total_cmp(&place(j)).then(i.cmp(&j)));
        self.shares.clear();
        self.shares.resize(footings.len(), 0.0);
        let reach = REACH * spacing;
        let mut first = 0;
        for &i in &self.order {
            while place(self.order[first]) < place(i) - reach {
                first += 1;
            }
            let near = self.order[first..].iter().take_while(|&&j| place(j) <= place(i) + reach);
            let others = near.filter(|&&j| j != i).map(|&j| &footings[j as usize]);
            self.shares[i as usize] = share(&footings[i as usize], others, spacing, dimension);
        }
    }
}

/// Axis along which the contact is longest.
fn longest_axis(footings: &[Footing]) -> usize {
    let extent = |k: usize| {
        let places = footings.iter().map(|footing| footing.foot[k]);
        let (low, high) = places
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..3).max_by(|&i, &j| extent(i).total_cmp(&extent(j))).expect("three axes")
}

fn share<'a>(
    this: &Footing,
    others: impl Iterator<Item = &'a Footing>,
    spacing: f64,
    dimension: usize,
) -> f64 {
    let basis = tangents(&this.normal, dimension);
    let directions = 2 * (dimension - 1);
    let mut continued = [false; 4];
    let mut patch = Patch::square(0.5 * REACH * spacing);
    for other in others {
        let apart = minus(&other.foot, &this.foot);
        let distance = dot(&apart, &apart).sqrt();
        if distance > REACH * spacing {
            continue;
        }
        let towards = minus(&other.centre, &this.centre);
        let mut way = [dot(&towards, &basis[0]), dot(&towards, &basis[1])];
        if dimension == 2 {
            way[1] = 0.0;
        }
        let length = way[0].hypot(way[1]);
        if length == 0.0 {
            continue;
        }
        let unit = way.map(|component| component / length);
        patch.cut(unit, 0.5 * distance);
        for (k, continued) in continued.iter_mut().enumerate().take(directions) {
            *continued |= along_direction(k, unit) >= CONE;
        }
    }
    for (k, continued) in continued.iter().enumerate().take(directions) {
        if !continued {
            let mut direction = [0.0; 2];
            direction[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
            patch.cut(direction, 0.5 * spacing);
        }
    }
    let area = patch.area();
    if dimension == 2 {
        // The patch is as wide as the square was.
        (area / (REACH * spacing)).max(LEAST * spacing)
    } else {
        area.max(LEAST * spacing * spacing)
    }
}

/// Component of `unit` along tangent direction `k`: +first, -first, +second, -second.
fn along_direction(k: usize, unit: [f64; 2]) -> f64 {
    if k.is_multiple_of(2) { unit[k / 2] } else { -unit[k / 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shares(footings: &[Footing], spacing: f64, dimension: usize) -> Vec<f64> {
        let mut shares = SurfaceShares::default();
        shares.share_out(footings, spacing, dimension);
        shares.areas().to_vec()
    }

    fn on_plane(places: &[[f64; 2]]) -> Vec<Footing> {
        let stand = |&[x, y]: &[f64; 2]| Footing {
            centre: [x, y, 0.5],
            foot: [x, y, 0.0],
            normal: [0.0, 0.0, 1.0],
        };
        places.iter().map(stand).collect()
    }

    /// Footings along a line in the plane with normal `normal`.
    fn on_line(places: &[f64], angle: f64) -> Vec<Footing> {
        let (sin, cos) = angle.sin_cos();
        let stand = |&s: &f64| {
            let foot = [s * cos, s * sin, 0.0];
            let normal = [-sin, cos, 0.0];
            Footing { centre: std::array::from_fn(|k| foot[k] + 0.5 * normal[k]), foot, normal }
        };
        places.iter().map(stand).collect()
    }

    fn assert_close(got: &[f64], expected: &[f64]) {
        assert_eq!(got.len(), expected.len());
        for (a, b) in got.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{got:?} instead of {expected:?}");
        }
    }

    #[test]
    fn particles_on_a_line_share_it() {
        for angle in [0.0, 0.7, 1.6, 4.0] {
            // Ends half a spacing beyond; 0.7 and 1.4 apart; a gap of 2 stays open.
            let footings = on_line(&[1.4, 0.0, 0.7, 2.8, 4.8], angle);
            assert_close(&shares(&footings, 1.0, 2), &[1.05, 0.85, 0.7, 1.2, 1.0]);
        }
    }

    #[test]
    fn around_a_corner_the_feet_count_not_the_centres() {
        let diagonal = std::f64::consts::FRAC_1_SQRT_2;
        let faces = [
            ([-0.3, 0.5, 0.0], [-0.3, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([0.5 * diagonal, 0.5 * diagonal, 0.0], [0.0; 3], [diagonal, diagonal, 0.0]),
            ([0.5, -0.4, 0.0], [0.0, -0.4, 0.0], [1.0, 0.0, 0.0]),
        ];
        let footings = faces.map(|(centre, foot, normal)| Footing { centre, foot, normal });
        assert_close(&shares(&footings, 1.0, 2), &[0.65, 0.35, 0.7]);
    }

    #[test]
    fn one_alone_covers_the_area_of_its_cell() {
        assert_close(&shares(&on_line(&[3.0], 0.4), 0.1, 2), &[0.1]);
        assert_close(&shares(&on_plane(&[[3.0, -1.0]]), 0.1, 3), &[0.01]);
        assert_close(&shares(&[], 0.1, 3), &[]);
    }

    #[test]
    fn a_lattice_on_a_plane_is_shared_exactly() {
        let (a, b) = (0.8, 1.3);
        let places: Vec<[f64; 2]> =
            (0..35).map(|k| [a * f64::from(k % 7), b * f64::from(k / 7)]).collect();
        let got = shares(&on_plane(&places), 1.0, 3);
        for (place, share) in places.iter().zip(&got) {
            let inner = |x: f64, step: f64, last: f64| {
                if x > 0.1 && x < last - 0.1 { step } else { 0.5 * step + 0.5 }
            };
            let expected = inner(place[0], a, 6.0 * a) * inner(place[1], b, 4.0 * b);
            assert!((share - expected).abs() < 1e-12, "{place:?}: {share} instead of {expected}");
        }
    }

    #[test]
    fn a_disordered_layer_covers_its_plane_once() {
        // A lattice, inside its rim moved at random by up to 0.25 (linear congruential numbers).
        let mut state = 12345_u64;
        let mut random = |inner: bool| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let moved = (state >> 11) as f64 / (1_u64 << 53) as f64 * 0.5 - 0.25;
            if inner { moved } else { 0.0 }
        };
        let mut places = Vec::new();
        for k in 0..900 {
            let (row, column) = (k / 30, k % 30);
            let inner = (1..29).contains(&row) && (1..29).contains(&column);
            places.push([f64::from(column) + random(inner), f64::from(row) + random(inner)]);
        }
        let total: f64 = shares(&on_plane(&places), 1.0, 3).iter().sum();
        // Neighbours beyond the reach, which would cut some corners, are not seen.
        assert!((total / 900.0 - 1.0).abs() < 2e-3, "{total}");
    }
}
