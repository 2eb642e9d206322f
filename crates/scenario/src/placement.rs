//! From the local frame of the set-up to the frame of the solver: mirror, then rotate.

use sphcut_geometry::mesh::Surface;
use sphcut_sph::setup::{CuttingFrame, Shape, Vector};

/// Mirror y to -y, then rotate about the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    /// Counter-clockwise, in rad.
    pub(crate) rotation: f64,
    pub(crate) handedness: Handedness,
}

/// Whether y is mirrored before the rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Handedness {
    Kept,
    Mirrored,
}

impl Placement {
    /// A vector or a point of the local frame.
    pub(crate) fn vector(&self, [x, y, z]: Vector) -> Vector {
        let y = if self.handedness == Handedness::Mirrored { -y } else { y };
        let (sine, cosine) = self.rotation.sin_cos();
        [x * cosine - y * sine, x * sine + y * cosine, z]
    }

    /// A counter-clockwise polygon stays counter-clockwise: mirrored, its order is turned.
    pub(crate) fn polygon(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let place = |point: &[f64; 2]| {
            let [x, y, _] = self.vector([point[0], point[1], 0.0]);
            [x, y]
        };
        match self.handedness {
            Handedness::Kept => points.iter().map(place).collect(),
            Handedness::Mirrored => points.iter().rev().map(place).collect(),
        }
    }

    /// A closed surface keeps its outside: mirrored, its triangles are turned.
    pub(crate) fn surface(&self, (vertices, triangles): &Surface) -> Surface {
        let turn = |triangle: &[usize; 3]| match self.handedness {
            Handedness::Kept => *triangle,
            Handedness::Mirrored => [triangle[0], triangle[2], triangle[1]],
        };
        let vertices =
            vertices.iter().map(|vertex| self.vector(vertex.to_array()).into()).collect();
        (vertices, triangles.iter().map(turn).collect())
    }

    /// Where side `side` of a polygon of `count` corners is after [`Placement::polygon`].
    pub(crate) fn side(&self, side: usize, count: usize) -> usize {
        match self.handedness {
            Handedness::Kept => side,
            // Corner k becomes corner count - 1 - k, and a side begins at what was its end.
            Handedness::Mirrored => (2 * count - 2 - side) % count,
        }
    }

    /// The rectangle or block from `min` to `max` of the local frame; the plane leaves z at zero.
    pub(crate) fn block(&self, min: Vector, max: Vector) -> Shape {
        Shape::Box {
            min,
            max,
            rotation: self.rotation,
            mirrored: self.handedness == Handedness::Mirrored,
        }
    }

    /// The directions of forces in turning: along the cut, along the feed, into the machined surface.
    pub(crate) fn turning_frame(&self) -> CuttingFrame {
        CuttingFrame {
            cutting: self.vector([1.0, 0.0, 0.0]),
            feed: self.vector([0.0, 0.0, 1.0]),
            passive: self.vector([0.0, -1.0, 0.0]),
        }
    }

    /// The directions of forces: along the cut and into the machined surface.
    pub(crate) fn frame(&self) -> CuttingFrame {
        let local = CuttingFrame::default();
        CuttingFrame {
            cutting: self.vector(local.cutting),
            feed: self.vector(local.feed),
            passive: local.passive,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use sphcut_geometry::tool_section::signed_double_area;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn mirrored_first_then_rotated() {
        let placement = Placement { rotation: FRAC_PI_2, handedness: Handedness::Mirrored };
        // (1, 2) -> (1, -2) -> rotated by 90 deg: (2, 1).
        let [x, y, _] = placement.vector([1.0, 2.0, 0.0]);
        assert_relative_eq!(x, 2.0, epsilon = 1e-15);
        assert_relative_eq!(y, 1.0, epsilon = 1e-15);
    }

    #[test]
    fn polygons_keep_their_sense() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for handedness in [Handedness::Kept, Handedness::Mirrored] {
            let placement = Placement { rotation: 0.7, handedness };
            assert_relative_eq!(
                signed_double_area(&placement.polygon(&square)),
                2.0,
                epsilon = 1e-12
            );
        }
    }

    #[test]
    fn sides_are_found_again() {
        let corners = [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [1.0, 5.0]];
        for handedness in [Handedness::Kept, Handedness::Mirrored] {
            let placement = Placement { rotation: 0.3, handedness };
            let placed = placement.polygon(&corners);
            let length = |polygon: &[[f64; 2]], k: usize| {
                let (a, b) = (polygon[k], polygon[(k + 1) % 4]);
                (b[0] - a[0]).hypot(b[1] - a[1])
            };
            for side in 0..4 {
                let after = length(&placed, placement.side(side, 4));
                assert_relative_eq!(after, length(&corners, side), max_relative = 1e-12);
            }
        }
    }

    #[test]
    fn no_rotation_changes_no_bit() {
        let placement = Placement { rotation: 0.0, handedness: Handedness::Kept };
        assert_eq!(placement.vector([0.1, 0.2, 0.3]), [0.1, 0.2, 0.3]);
        assert_eq!(placement.frame(), CuttingFrame::default());
    }
}
