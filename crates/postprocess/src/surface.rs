//! Depth of the machined surface behind the tool.
//!
//! The surface behind the tool is divided into strips two spacings wide. In each the highest
//! particle of the material below the tool's edge, plus its half thickness, is the surface; its
//! distance from the nominal plane, the uncut surface minus h, is the depth error (negative: too
//! deep). A jump of about one spacing between the strips is the parting line moving to another
//! row of particles: from there on the chip is thicker and every force with it.

use crate::cloud::CutParticles;
use crate::statistics::median;

/// Strips averaged to find a jump.
const RUN: usize = 5;

/// The machined surface in one snapshot, in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MachinedSurface {
    /// Median of height minus nominal height.
    pub depth_error: f64,
    /// Highest minus lowest level, each the median of five neighbouring strips.
    pub jump: f64,
    /// Length over which it was measured.
    pub length: f64,
}

/// Where to look.
pub(crate) struct SurfaceContext {
    /// Height of the nominal machined plane.
    pub nominal: f64,
    /// Position of the lowest point of the tool along the cutting direction.
    pub tip: f64,
    /// Edge radius or zero.
    pub edge_radius: f64,
    /// Position along the cutting direction from which on the surface counts.
    pub from: f64,
}

/// Measures the machined surface; `None` while it is too short.
pub(crate) fn measure(cloud: &CutParticles, context: &SurfaceContext) -> Option<MachinedSurface> {
    let width = 2.0 * cloud.spacing;
    let end = context.tip - context.edge_radius.max(3.0 * cloud.spacing);
    // The side of the workpiece where the tool entered is pushed out of shape.
    let start = context.from + 4.0 * cloud.spacing;
    let count = ((end - start) / width).floor();
    if count.is_nan() || count < RUN as f64 {
        return None;
    }
    // Chip material that has fallen behind the tool lies higher than three spacings.
    let ceiling = context.nominal + 3.0 * cloud.spacing;
    let mut heights = vec![f64::NEG_INFINITY; count as usize];
    let below = cloud.points.iter().zip(&cloud.half_thickness);
    for (point, half) in below.filter(|(p, _)| p[1] < ceiling && p[0] >= start) {
        let strip = ((point[0] - start) / width) as usize;
        if let Some(height) = heights.get_mut(strip) {
            *height = height.max(point[1] + half - context.nominal);
        }
    }
    heights.retain(|height| height.is_finite());
    let levels: Vec<f64> = heights.windows(RUN).map(median).collect();
    let highest = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = levels.iter().copied().fold(f64::INFINITY, f64::min);
    (!levels.is_empty()).then(|| MachinedSurface {
        depth_error: median(&heights),
        jump: highest - lowest,
        length: end - start,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::CutPlane;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    fn surface_of(change: impl Fn(&mut [f64; 3])) -> MachinedSurface {
        let cut = SyntheticCut { disorder: 0.1, ..SyntheticCut::default() };
        let mut snapshot = cut.snapshot(1.2e-3);
        snapshot.position.iter_mut().for_each(change);
        let cloud = CutParticles::new(&snapshot, CutPlane::new(CuttingFrame::default()));
        let context =
            SurfaceContext { nominal: -0.1e-3, tip: 1.2e-3, edge_radius: 20e-6, from: 0.0 };
        measure(&cloud, &context).unwrap()
    }

    #[test]
    fn a_flat_surface_has_no_error_and_no_jump() {
        let surface = surface_of(|_| ());
        // Particles are displaced by up to 0.05 spacings = 0.5 um.
        assert!(surface.depth_error.abs() < 0.6e-6, "{surface:?}");
        assert!(surface.jump < 0.6e-6, "{surface:?}");
        assert!(surface.length > 1.0e-3);
    }

    #[test]
    fn a_jump_of_the_parting_line_is_seen() {
        // Beyond x = 0.8 mm the material behind the tool sinks by a row: 10 um.
        let surface = surface_of(|position| {
            if position[0] > 0.8e-3 && position[0] < 1.2e-3 && position[1] < -0.1e-3 {
                position[1] -= 10e-6;
            }
        });
        assert!((surface.jump - 10e-6).abs() < 1e-6, "{surface:?}");
        assert!(surface.depth_error.abs() < 1e-6, "{surface:?}");
    }
}
