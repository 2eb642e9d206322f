//! A built-up edge: a cap of work material that stays in front of the edge.

use super::{EdgeGeometry, Front, moved, on_circle};

/// A rigid cap with a plane underside along the cut, a nose with the tool's edge radius, and a
/// plane upper side up to the rake face.
///
/// ```text
/// O = (-L, -h + r_n)               centre of the tool's own edge
/// C = (0, -h + r_n)                centre of the nose
/// R = O + r_n n + s u              on the rake face at the height H above the machined surface
/// theta = arg(R - C) - arccos(r_n / |R - C|)
/// ```
/// `n = (cos gamma, sin gamma)`, `u = (-sin gamma, cos gamma)`. The upper side is tangent to the nose
/// at the angle theta, which is its rake angle: larger than gamma, as the cap makes the tool keener.
///
/// That a small stable cap sticks to the edge is observed and used by Waldorf, DeVor and Kapoor,
/// J. Manuf. Sci. Eng. 120 (1998) 693-699. The shape here is our simplification, not theirs: two
/// lengths that a micrograph shows. Its material does not deform, grow or break off, and does not
/// reach below the edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BuiltUpEdge {
    /// L: how far the nose is ahead of the edge, in m, above 0.
    pub length: f64,
    /// H: height above the machined surface of its end on the rake face, in m.
    pub height: f64,
}

impl BuiltUpEdge {
    /// Height above the machined surface at which the rake face leaves both the edge and the nose:
    /// the cap must be higher. With R on the nose circle, `s^2 + 2 L s sin gamma + L^2 =
    /// 2 L r_n cos gamma`.
    #[must_use]
    pub fn least_height(&self, tool: &EdgeGeometry) -> f64 {
        let (sine, cosine) = tool.rake_angle.sin_cos();
        let across = self.length * cosine;
        let square = across * (2.0 * tool.edge_radius - across);
        let along = if square > 0.0 { square.sqrt() - self.length * sine } else { 0.0 };
        tool.edge_radius * (1.0 + sine) + along.max(0.0) * cosine
    }

    pub(super) fn front(&self, tool: &EdgeGeometry) -> Front {
        let height_of_centre = -tool.uncut_chip_thickness + tool.edge_radius;
        let begin = on_circle([-self.length, height_of_centre], tool.edge_radius, tool.rake_angle);
        let along_rake = [-tool.rake_angle.sin(), tool.rake_angle.cos()];
        let rise = self.height - tool.uncut_chip_thickness - begin[1];
        let end = moved(begin, along_rake, rise / tool.rake_angle.cos());
        let (x, y) = (end[0], end[1] - height_of_centre);
        let theta = y.atan2(x) - (tool.edge_radius / x.hypot(y)).acos();
        Front { rake_angle: theta, corner: Some(end) }
    }
}
