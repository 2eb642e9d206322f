//! What a solid tool leaves of the workpiece: the lowest line of its shadow along the cut.

use crate::mesh::Surface;

/// Places at which the line is known.
const PLACES: usize = 801;

/// The part of the line below the uncut surface y = 0. Lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// (z, y) by increasing z, all with y <= 0.
    points: Vec<[f64; 2]>,
}

impl Silhouette {
    /// The shadow along x; `None` if the surface lies above y = 0.
    pub fn of((vertices, triangles): &Surface) -> Option<Self> {
        let edges: Vec<[[f64; 2]; 2]> = triangles
            .iter()
            .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|ends| ends.map(|&vertex| [vertices[vertex][2], vertices[vertex][1]]))
            .filter_map(below)
            .collect();
        let places = || edges.iter().flatten().map(|point| point[0]);
        let low = places().reduce(f64::min)?;
        let high = places().reduce(f64::max)?;
        let points = (0..PLACES).map(|k| {
            let z = low + (high - low) * k as f64 / (PLACES - 1) as f64;
            let heights = edges.iter().filter_map(|edge| height(edge, z));
            [z, heights.fold(0.0, f64::min)]
        });
        Some(Self { points: points.collect() })
    }

    /// Smallest and largest z of the groove.
    pub fn extent(&self) -> [f64; 2] {
        [self.points[0][0], self.points[self.points.len() - 1][0]]
    }

    /// Area in m^2 between the line and the uncut surface: the trapezoidal rule.
    pub fn section(&self) -> f64 {
        self.points
            .windows(2)
            .map(|pair| 0.5 * (pair[1][0] - pair[0][0]) * -(pair[0][1] + pair[1][1]))
            .sum()
    }

    /// The line that passes at each of `shifts` along z leave, as (z, y) by increasing z.
    pub fn left_by(&self, shifts: &[f64]) -> Vec<[f64; 2]> {
        let moved = |point: &[f64; 2], shift: f64| [point[0] + shift, point[1]];
        let lines: Vec<Vec<[f64; 2]>> = shifts
            .iter()
            .map(|shift| self.points.iter().map(|point| moved(point, *shift)).collect())
            .collect();
        let mut places: Vec<f64> = lines.iter().flatten().map(|point| point[0]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let height = |line: &[[f64; 2]], z: f64| {
            let pairs = line.windows(2).map(|pair| [pair[0], pair[1]]);
            pairs.filter_map(|pair| height(&pair, z)).fold(0.0, f64::min)
        };
        let lowest = |z: f64| lines.iter().map(|line| height(line, z)).fold(0.0, f64::min);
        places.into_iter().map(|z| [z, lowest(z)]).collect()
    }

    /// Largest distance of the line, moved by `shift` along z, from the surface that the unmoved one
    /// leaves of the uncut one.
    pub fn distance_when_moved(&self, shift: f64) -> f64 {
        let [low, high] = self.extent();
        let far = 10.0 * (high - low + shift);
        let mut left = vec![[low - far, 0.0], [low, 0.0]];
        left.extend(&self.points);
        left.extend([[high, 0.0], [high + far, 0.0]]);
        let distance = |point: [f64; 2]| {
            let of_piece = |pair: &[[f64; 2]]| {
                let along = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
                let to = [point[0] - pair[0][0], point[1] - pair[0][1]];
                let square = along[0] * along[0] + along[1] * along[1];
                let share = if square > 0.0 {
                    ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                (to[0] - share * along[0]).hypot(to[1] - share * along[1])
            };
            left.windows(2).map(of_piece).fold(f64::INFINITY, f64::min)
        };
        let height = |z: f64| {
            let pair = left.windows(2).find(|pair| z <= pair[1][0])?;
            let share = (z - pair[0][0]) / (pair[1][0] - pair[0][0]).max(f64::MIN_POSITIVE);
            Some(pair[0][1] + share * (pair[1][1] - pair[0][1]))
        };
        self.points
            .iter()
            .map(|point| [point[0] + shift, point[1]])
            .filter(|point| height(point[0]).is_some_and(|above| point[1] < above))
            .map(distance)
            .fold(0.0, f64::max)
    }
}

/// The part of an edge with y <= 0, as (z, y).
fn below([a, b]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let at_surface = || {
        let share = a[1] / (a[1] - b[1]);
        [a[0] + share * (b[0] - a[0]), 0.0]
    };
    match (a[1] <= 0.0, b[1] <= 0.0) {
        (true, true) => Some([a, b]),
        (true, false) => Some([a, at_surface()]),
        (false, true) => Some([at_surface(), b]),
        (false, false) => None,
    }
}

/// The lowest height of an edge at `z`.
fn height([a, b]: &[[f64; 2]; 2], z: f64) -> Option<f64> {
    let (low, high) = if a[0] <= b[0] { (a, b) } else { (b, a) };
    if z < low[0] || z > high[0] {
        return None;
    }
    let width = high[0] - low[0];
    if width == 0.0 {
        return Some(low[1].min(high[1]));
    }
    Some(low[1] + (z - low[0]) / width * (high[1] - low[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A wedge along x with its edge at (z, y) = (0, -1) and flanks of 45 deg.
    fn wedge() -> Surface {
        let vertices =
            [0.0, -1.0].into_iter().flat_map(|x| [[x, -1.0, 0.0], [x, 1.0, 2.0], [x, 1.0, -2.0]]);
        let triangles = vec![
            [0, 1, 2],
            [3, 5, 4],
            [0, 3, 4],
            [0, 4, 1],
            [1, 4, 5],
            [1, 5, 2],
            [2, 5, 3],
            [2, 3, 0],
        ];
        (vertices.map(Into::into).collect(), triangles)
    }

    #[test]
    fn a_wedge_by_hand() {
        let shadow = Silhouette::of(&wedge()).unwrap();
        assert_eq!(shadow.extent(), [-1.0, 1.0]);
        // A triangle 2 wide and 1 deep.
        assert_relative_eq!(shadow.section(), 1.0, max_relative = 1e-12);
        // Moved by 0.2 its right flank lies 0.2 / 2^(1/2) from the old one.
        assert_relative_eq!(
            shadow.distance_when_moved(0.2),
            0.2 / 2.0_f64.sqrt(),
            max_relative = 1e-9
        );
        // Moved beyond the groove it meets the uncut surface: its tip is 1 deep.
        assert_relative_eq!(shadow.distance_when_moved(5.0), 1.0, max_relative = 1e-9);
    }

    #[test]
    fn a_groove_may_have_upright_walls() {
        let points = vec![[-1.0, -0.5], [1.0, -0.5]];
        let shadow = Silhouette { points };
        // Moved by 2 its far corner is 2 from the wall and 0.5 below the surface.
        assert_relative_eq!(shadow.distance_when_moved(2.0), 0.5, max_relative = 1e-9);
        // Moved by 0.2 it is 0.2 from the wall.
        assert_relative_eq!(shadow.distance_when_moved(0.2), 0.2, max_relative = 1e-9);
    }

    #[test]
    fn two_wedges_leave_two_grooves_with_a_ridge_between() {
        let shadow = Silhouette::of(&wedge()).unwrap();
        let line = shadow.left_by(&[0.0, 0.5]);
        let at = |z: f64| {
            let pairs = line.windows(2).map(|pair| [pair[0], pair[1]]);
            pairs.filter_map(|pair| height(&pair, z)).fold(0.0, f64::min)
        };
        for (z, depth) in
            [(-1.0, 0.0), (-0.5, 0.5), (0.0, 1.0), (0.25, 0.75), (0.5, 1.0), (1.5, 0.0)]
        {
            assert_relative_eq!(at(z), -depth, epsilon = 1e-9);
        }
    }

    #[test]
    fn a_tool_in_the_air_leaves_nothing() {
        let (mut vertices, triangles) = wedge();
        vertices.iter_mut().for_each(|vertex| vertex[1] += 1.5);
        assert_eq!(Silhouette::of(&(vertices, triangles)), None);
    }
}
