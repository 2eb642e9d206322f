//! Triangles in space.

use glam::DVec3;

/// Twice the area of a triangle times its normal by the right-hand rule.
pub(super) fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Distance of `x` from a triangle.
#[must_use]
pub fn triangle_distance(x: DVec3, corners: &[DVec3; 3]) -> f64 {
    let normal = area_vector(*corners);
    let sides = [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3]));
    let is_left = |(from, to): &(DVec3, DVec3)| (to - from).cross(x - from).dot(normal) >= 0.0;
    if sides.iter().all(is_left) {
        return (x - corners[0]).dot(normal).abs() / normal.length();
    }
    let side = |(from, to): (DVec3, DVec3)| {
        let way = to - from;
        let share = ((x - from).dot(way) / way.dot(way)).clamp(0.0, 1.0);
        x.distance(from + share * way)
    };
    sides.into_iter().map(side).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_as_far_as_its_face_its_side_or_its_corner() {
        let corners = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let cases = [([1.0, 1.0, -2.0], 2.0), ([2.0, -3.0, 4.0], 5.0), ([-2.0, -1.0, 2.0], 3.0)];
        for (x, distance) in cases {
            assert!(
                (triangle_distance(x.into(), &corners.map(DVec3::from)) - distance).abs() < 1e-14,
                "{x:?}"
            );
        }
    }
}
