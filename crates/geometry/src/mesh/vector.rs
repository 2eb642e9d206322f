//! Vectors with three components.

pub(super) type Vector = [f64; 3];

pub(super) fn sub(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn length(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The point `a + share (b - a)`.
pub(super) fn between(a: &Vector, b: &Vector, share: f64) -> Vector {
    std::array::from_fn(|axis| a[axis] + share * (b[axis] - a[axis]))
}

/// Twice the area of a triangle times its normal by the right-hand rule.
pub(super) fn area_vector([a, b, c]: &[Vector; 3]) -> Vector {
    cross(&sub(b, a), &sub(c, a))
}

/// Distance of `x` from a triangle.
pub fn triangle_distance(x: &Vector, corners: &[Vector; 3]) -> f64 {
    let normal = area_vector(corners);
    let sides = [0, 1, 2].map(|k| (&corners[k], &corners[(k + 1) % 3]));
    let is_left = |(from, to): &(&Vector, &Vector)| {
        dot(&cross(&sub(to, from), &sub(x, from)), &normal) >= 0.0
    };
    if sides.iter().all(is_left) {
        return dot(&sub(x, &corners[0]), &normal).abs() / length(&normal);
    }
    let side = |(from, to): (&Vector, &Vector)| {
        let way = sub(to, from);
        let share = (dot(&sub(x, from), &way) / dot(&way, &way)).clamp(0.0, 1.0);
        length(&sub(x, &between(from, to, share)))
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
            assert!((triangle_distance(&x, &corners) - distance).abs() < 1e-14, "{x:?}");
        }
    }
}
