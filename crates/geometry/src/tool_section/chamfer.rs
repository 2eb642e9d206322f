//! A chamfer between edge and rake face.

use super::{EdgeGeometry, Front, moved};
use std::f64::consts::FRAC_PI_2;

/// A plane face of length `width` whose rake angle is smaller than that of the rake face by
/// `angle`: `gamma_c = gamma - delta`.
///
/// ```text
/// V = (t, -h),   t = r_n tan((gamma_c + pi/2) / 2),   C = V + b_c (-sin gamma_c, cos gamma_c)
/// ```
/// The width is counted from V, where the chamfer would meet the plane y = -h of the machined
/// surface if the edge were sharp, to the corner C with the rake face; the edge radius takes the
/// length t from it. Width and angle against the rake face are those by which chamfered inserts are
/// ordered; that manufacturers count the width along the rake face where this one is along the
/// chamfer makes a difference of 1 - cos delta.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chamfer {
    /// b_c in m, above 0.
    pub width: f64,
    /// delta in rad, above 0.
    pub angle: f64,
}

impl Chamfer {
    /// gamma_c.
    #[must_use]
    pub fn rake_angle(&self, tool: &EdgeGeometry) -> f64 {
        tool.rake_angle - self.angle
    }

    /// t: length of the chamfer that the edge radius takes.
    #[must_use]
    pub fn length_in_edge(&self, tool: &EdgeGeometry) -> f64 {
        tool.edge_radius * (0.5 * (self.rake_angle(tool) + FRAC_PI_2)).tan()
    }

    pub(super) fn front(&self, tool: &EdgeGeometry) -> Front {
        let rake_angle = self.rake_angle(tool);
        let virtual_edge = [self.length_in_edge(tool), -tool.uncut_chip_thickness];
        let along = [-rake_angle.sin(), rake_angle.cos()];
        Front { rake_angle, corner: Some(moved(virtual_edge, along, self.width)) }
    }
}
