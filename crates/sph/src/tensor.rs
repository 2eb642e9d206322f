//! Small dense vectors and matrices of dimension 2 or 3.

/// A vector of dimension `D`, of space where nothing is said; plane problems leave its third component at zero.
pub type Vector<const D: usize = 3> = [f64; D];
/// A matrix, row by row.
pub(crate) type Matrix<const D: usize> = [[f64; D]; D];

/// A vector of space; in the plane its third component is zero.
pub(crate) fn extended<const D: usize>(x: &Vector<D>) -> Vector<3> {
    std::array::from_fn(|k| if k < D { x[k] } else { 0.0 })
}

/// The first components of a vector of space.
pub(crate) fn reduced<const D: usize>(x: &Vector<3>) -> Vector<D> {
    std::array::from_fn(|k| x[k])
}

/// The zero matrix.
pub(crate) const fn zero<const D: usize>() -> Matrix<D> {
    [[0.0; D]; D]
}

/// The unit matrix.
pub(crate) fn identity<const D: usize>() -> Matrix<D> {
    std::array::from_fn(|row| std::array::from_fn(|column| f64::from(row == column)))
}

/// a . b
#[inline]
pub(crate) fn dot<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += a[k] * b[k];
    }
    sum
}

/// a - b
#[inline]
pub(crate) fn minus<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|k| a[k] - b[k])
}

/// a + factor b
#[inline]
pub(crate) fn plus_scaled<const D: usize>(a: &Vector<D>, factor: f64, b: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|k| a[k] + factor * b[k])
}

/// A x
#[inline]
pub(crate) fn apply<const D: usize>(a: &Matrix<D>, x: &Vector<D>) -> Vector<D> {
    std::array::from_fn(|row| dot(&a[row], x))
}

/// A B
#[inline]
pub(crate) fn product<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
    let mut c = zero();
    for row in 0..D {
        for column in 0..D {
            for k in 0..D {
                c[row][column] += a[row][k] * b[k][column];
            }
        }
    }
    c
}

/// Transpose.
#[inline]
pub(crate) fn transpose<const D: usize>(a: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|row| std::array::from_fn(|column| a[column][row]))
}

/// A + factor B
#[inline]
pub(crate) fn sum_scaled<const D: usize>(a: &Matrix<D>, factor: f64, b: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| a[row][column] + factor * b[row][column])
    })
}

/// A : B, the sum of the products of all components.
#[inline]
pub(crate) fn contract<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> f64 {
    let mut sum = 0.0;
    for row in 0..D {
        for column in 0..D {
            sum += a[row][column] * b[row][column];
        }
    }
    sum
}

/// Trace.
#[inline]
pub(crate) fn trace<const D: usize>(a: &Matrix<D>) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += a[k][k];
    }
    sum
}

/// Determinant for `D` = 2 or 3.
#[inline]
pub(crate) fn determinant<const D: usize>(a: &Matrix<D>) -> f64 {
    if D == 2 {
        a[0][0] * a[1][1] - a[0][1] * a[1][0]
    } else {
        a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
            - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
            + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
    }
}

/// Inverse for `D` = 2 or 3; the caller makes sure that the determinant is not zero.
#[inline]
pub(crate) fn inverse_nonsingular<const D: usize>(a: &Matrix<D>) -> Matrix<D> {
    let scale = 1.0 / determinant(a);
    let mut b = zero();
    if D == 2 {
        b[0][0] = a[1][1] * scale;
        b[0][1] = -a[0][1] * scale;
        b[1][0] = -a[1][0] * scale;
        b[1][1] = a[0][0] * scale;
    } else {
        for row in 0..3 {
            for column in 0..3 {
                let (r1, r2) = ((column + 1) % 3, (column + 2) % 3);
                let (c1, c2) = ((row + 1) % 3, (row + 2) % 3);
                b[row][column] = (a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1]) * scale;
            }
        }
    }
    b
}

/// Rotation over one step of the spin `W` (skew part of the velocity gradient), exact to second
/// order and orthogonal to rounding: `(I - W dt/2)^-1 (I + W dt/2)` (Hughes and Winget 1980).
#[inline]
pub(crate) fn step_rotation<const D: usize>(spin: &Matrix<D>, time_step: f64) -> Matrix<D> {
    let half = 0.5 * time_step;
    if D == 2 {
        let t = half * spin[1][0];
        let scale = 1.0 / (1.0 + t * t);
        let (cosine, sine) = ((1.0 - t * t) * scale, 2.0 * t * scale);
        let mut r = zero();
        r[0][0] = cosine;
        r[0][1] = -sine;
        r[1][0] = sine;
        r[1][1] = cosine;
        return r;
    }
    let back = sum_scaled(&identity(), -half, spin);
    let forth = sum_scaled(&identity(), half, spin);
    product(&inverse_nonsingular(&back), &forth)
}

/// R S R^T
#[inline]
pub(crate) fn rotated<const D: usize>(s: &Matrix<D>, r: &Matrix<D>) -> Matrix<D> {
    product(&product(r, s), &transpose(r))
}

/// Sweeps of [`clamped_spectrum`]: Jacobi's method squares the error with each.
const SWEEPS: usize = 8;

/// The symmetric matrix `a` with its eigenvalues limited to `[low, high]`, and the largest of these;
/// eigenvectors by cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, section 8.5).
pub(crate) fn clamped_spectrum<const D: usize>(
    a: &Matrix<D>,
    low: f64,
    high: f64,
) -> (Matrix<D>, f64) {
    let mut values = *a;
    let mut vectors: Matrix<D> = identity();
    for _ in 0..SWEEPS {
        for row in 0..D {
            for column in row + 1..D {
                let off = values[row][column];
                if off.abs() <= f64::EPSILON * (values[row][row] + values[column][column]).abs() {
                    continue;
                }
                let theta = (values[column][column] - values[row][row]) / (2.0 * off);
                let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                let mut turn: Matrix<D> = identity();
                turn[row][row] = cosine;
                turn[column][column] = cosine;
                turn[row][column] = tangent * cosine;
                turn[column][row] = -tangent * cosine;
                values = product(&product(&transpose(&turn), &values), &turn);
                vectors = product(&vectors, &turn);
            }
        }
    }
    let mut limited = zero();
    let mut largest = low;
    for k in 0..D {
        limited[k][k] = values[k][k].clamp(low, high);
        largest = largest.max(limited[k][k]);
    }
    (rotated(&limited, &vectors), largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn inverse_times_matrix_is_identity() {
        let a = [[2.0, 0.3, -1.0], [0.1, 1.5, 0.2], [0.7, -0.4, 3.0]];
        let unit = product(&inverse_nonsingular(&a), &a);
        for (row, found) in unit.iter().enumerate() {
            for (column, value) in found.iter().enumerate() {
                assert_relative_eq!(*value, f64::from(row == column), epsilon = 1e-14);
            }
        }
        let b = [[2.0, 0.5], [-0.3, 1.0]];
        assert_relative_eq!(product(&inverse_nonsingular(&b), &b)[0][0], 1.0, epsilon = 1e-15);
    }

    #[test]
    fn a_spectrum_is_clamped_along_its_own_axes() {
        // Eigenvalues 5, 2 and 0.5 along turned axes.
        let turn: Matrix<3> =
            step_rotation(&[[0.0, -0.7, 0.3], [0.7, 0.0, -0.9], [-0.3, 0.9, 0.0]], 1.0);
        let stretched = rotated(&[[5.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.5]], &turn);
        let (limited, largest) = clamped_spectrum(&stretched, 1.0, 4.0);
        let expected = rotated(&[[4.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]], &turn);
        assert_relative_eq!(largest, 4.0, epsilon = 1e-14);
        for row in 0..3 {
            for column in 0..3 {
                assert_relative_eq!(limited[row][column], expected[row][column], epsilon = 1e-13);
            }
        }
        // Degenerate: nothing to turn.
        assert_eq!(clamped_spectrum(&identity::<2>(), 1.0, 4.0).0, identity());
    }

    #[test]
    fn step_rotations_are_orthogonal() {
        let plane: Matrix<2> = step_rotation(&[[0.0, -3.0], [3.0, 0.0]], 0.2);
        assert_relative_eq!(determinant(&plane), 1.0, epsilon = 1e-15);
        let space: Matrix<3> =
            step_rotation(&[[0.0, -3.0, 1.0], [3.0, 0.0, -0.5], [-1.0, 0.5, 0.0]], 0.2);
        let unit = product(&space, &transpose(&space));
        for (row, found) in unit.iter().enumerate() {
            for (column, value) in found.iter().enumerate() {
                assert_relative_eq!(*value, f64::from(row == column), epsilon = 1e-14);
            }
        }
    }
}
