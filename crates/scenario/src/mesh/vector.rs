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
