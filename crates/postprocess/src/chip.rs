//! Chip thickness and chip speed from the particles.
//!
//! **Chip**: the particles that hang together (clusters of at least twenty) and lie above the
//! uncut surface by more than a quarter of the uncut chip thickness, and by two spacings.
//!
//! **Thickness** h_ch: at each particle of the chip's surface a straight line is drawn inwards,
//! against the surface normal, to where the material ends. The local thickness is the area of
//! the particles about the line per length along the chip: sum of (1 - d / w) dx_i^2 / w over the
//! particles at a distance d < w = 2 dx of it (their areas dx_i^2, or what they count for in a section; dx: the largest spacing in the chip). Counting area and not the distance between the
//! outermost particles needs no assumption on how the flow has rearranged their rows, and leaves
//! holes out. The chip thickness is the median over the lines: the few that run along the chip
//! from its free end do not matter, nor does the curl. Lines that leave the chip downwards are
//! dropped, and those that follow the flow: the sides of a chip are streamlines, relative to the tool, and its
//! end is not. So a chip may be short: a moving window of the default length leaves some 5 h^2 of it, 0.6 times as long as
//! thick at lambda_h = 3.
//!
//! **Compression ratio** lambda_h = h_ch / h. The **chip speed** v_ch is the median speed of the
//! chip's particles relative to the tool; by conservation of volume v_c / v_ch is the same ratio
//! once the cut is steady and no material flows sideways or under the edge.

use crate::cloud::{CutParticles, CutPlane, PlanePoint, difference};
use crate::statistics::{median, quantile};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::Vector;

/// Fewest lines a thickness is taken from.
const FEWEST_LINES: usize = 12;
/// A chip must be this many times as long as thick: else its sides are near the shear zone throughout.
const LEAST_SLENDERNESS: f64 = 0.55;
/// Largest share of the normal of a side along the flow: that of an angle of 53 degrees across it.
const ALONG_FLOW: f64 = 0.8;
/// Distance of a point of a line from every particle beyond which it lies outside the material,
/// in spacings.
const REACH: f64 = 1.3;
/// Half width w of the strip about a line, in the coarsest spacings of the chip.
const STRIP: f64 = 2.0;

/// The chip in one snapshot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ChipShape {
    /// h_ch in m.
    pub thickness: f64,
    /// First quartile of the local thickness in m.
    pub thin: f64,
    /// Third quartile of the local thickness in m.
    pub thick: f64,
    /// v_ch in m/s.
    pub speed: f64,
}

/// What is known beforehand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChipContext {
    pub plane: CutPlane,
    /// Height of the uncut surface in the frame of the cut.
    pub surface: f64,
    pub uncut_chip_thickness: f64,
    pub tool_velocity: Vector,
}

impl ChipContext {
    /// Height above which material is chip.
    pub fn floor(&self, spacing: f64) -> f64 {
        self.surface + (0.25 * self.uncut_chip_thickness).max(2.0 * spacing)
    }
}

/// Measures the chip; `None` while there is too little of it.
pub(crate) fn measure(
    snapshot: &Snapshot,
    cloud: &CutParticles,
    context: &ChipContext,
) -> Option<ChipShape> {
    let floor = context.floor(cloud.spacing);
    let chip: Vec<usize> =
        (0..cloud.points.len()).filter(|&i| cloud.points[i][1] > floor).collect();
    let flow = |i: usize| relative_velocity(snapshot, cloud.source[i], context);
    let width = STRIP * chip.iter().map(|&i| cloud.spacings[i]).fold(0.0, f64::max);
    // A coarse particle stands for as many fine ones as there is room for: along a side, and in the chip.
    let size = |i: usize| (cloud.spacings[i] / cloud.spacing).round() as usize;
    let line =
        |&i: &usize| Some((i, local_thickness(cloud, (i, width), context.surface, flow(i))?));
    let lines: Vec<f64> = chip
        .iter()
        .filter_map(line)
        .flat_map(|(i, thickness)| std::iter::repeat_n(thickness, size(i)))
        .collect();
    if lines.len() < FEWEST_LINES {
        return None;
    }
    let thickness = median(&lines);
    let area: f64 = chip.iter().map(|&i| cloud.areas[i]).sum();
    if area < LEAST_SLENDERNESS * thickness * thickness {
        return None;
    }
    let speed = |i: usize| flow(i)[0].hypot(flow(i)[1]);
    let speeds: Vec<f64> =
        chip.iter().flat_map(|&i| std::iter::repeat_n(speed(i), size(i).pow(2))).collect();
    Some(ChipShape {
        thickness,
        thin: quantile(&lines, 0.25),
        thick: quantile(&lines, 0.75),
        speed: median(&speeds),
    })
}

/// In the frame of the tool.
fn relative_velocity(snapshot: &Snapshot, particle: usize, context: &ChipContext) -> PlanePoint {
    let velocity = snapshot.velocity[particle];
    context.plane.project(&[0, 1, 2].map(|k| velocity[k] - context.tool_velocity[k]))
}

/// Area per length about the line from a surface particle inwards; `None` inside the material, at an end that the flow
/// crosses, and where the line goes below the uncut surface.
fn local_thickness(
    cloud: &CutParticles,
    (particle, width): (usize, f64),
    surface: f64,
    flow: PlanePoint,
) -> Option<f64> {
    let normal = cloud.outward_normal(particle)?;
    let across = normal[0] * flow[0] + normal[1] * flow[1];
    if across.abs() > ALONG_FLOW * flow[0].hypot(flow[1]) {
        return None;
    }
    let start = cloud.points[particle];
    let step = 0.5 * cloud.spacing;
    let at = |length: f64| -> PlanePoint {
        [start[0] - normal[0] * length, start[1] - normal[1] * length]
    };
    let mut length = 0.0;
    let mut strip: Vec<usize> = Vec::new();
    loop {
        strip.extend(cloud.near(at(length), 1.1 * width));
        if !cloud.is_material(at(length + step), REACH) {
            break;
        }
        length += step;
        if at(length)[1] < surface {
            return None;
        }
    }
    strip.sort_unstable();
    strip.dedup();
    let weight = |&i: &usize| {
        let offset = difference(cloud.points[i], start);
        let aside = (offset[0] * normal[1] - offset[1] * normal[0]).abs();
        (1.0 - aside / width).max(0.0) * cloud.areas[i]
    };
    Some(strip.iter().map(weight).sum::<f64>() / width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    fn frame(angle: f64) -> CuttingFrame {
        let (sine, cosine) = angle.sin_cos();
        CuttingFrame {
            cutting: [cosine, sine, 0.0],
            feed: [sine, -cosine, 0.0],
            passive: [0.0, 0.0, 1.0],
        }
    }

    fn shape(cut: &SyntheticCut, travel: f64) -> Option<ChipShape> {
        let snapshot = cut.snapshot(travel);
        let frame = frame(cut.orientation);
        let plane = CutPlane::new(frame);
        let cloud = CutParticles::new(&snapshot, plane);
        let context = ChipContext {
            plane,
            surface: 0.0,
            uncut_chip_thickness: cut.uncut_chip_thickness,
            tool_velocity: frame.cutting.map(|c| c * cut.cutting_speed),
        };
        measure(&snapshot, &cloud, &context)
    }

    #[test]
    fn the_drawn_thickness_is_found_whatever_the_rake_the_disorder_and_the_direction() {
        for rake in [-10.0_f64, 0.0, 5.0, 25.0] {
            for (orientation, disorder) in [(0.0, 0.0), (0.0, 0.3), (0.6458, 0.15)] {
                let cut = SyntheticCut {
                    rake_angle: rake.to_radians(),
                    orientation,
                    disorder,
                    ..SyntheticCut::default()
                };
                let chip = shape(&cut, 1.5e-3).unwrap();
                // Lines are oblique by up to ten degrees where neighbours are few: 1.5 %, and the
                // strip sees a row more or less at its ends: half a spacing of 22.
                let error = chip.thickness / cut.chip_thickness - 1.0;
                assert!(error.abs() < 0.035, "rake {rake}: {chip:?}");
            }
        }
    }

    #[test]
    fn rows_that_the_flow_has_stretched_apart_are_one_chip() {
        for (stretch, spacing) in [(1.7, 10e-6), (1.9, 20e-6), (0.6, 10e-6)] {
            let cut = SyntheticCut {
                chip_stretch: stretch,
                particle_spacing: spacing,
                ..SyntheticCut::default()
            };
            let chip = shape(&cut, 1.5e-3).unwrap();
            // A coarse chip has six rows; the drawing rounds their number.
            let error = chip.thickness / cut.chip_thickness - 1.0;
            assert!(error.abs() < 0.06, "stretch {stretch}: {chip:?}");
        }
    }

    #[test]
    fn the_speed_of_the_drawn_chip_gives_the_compression_ratio() {
        let cut = SyntheticCut::default();
        let chip = shape(&cut, 1.5e-3).unwrap();
        // v_ch = v_c / 2.2 relative to the tool.
        assert!((chip.speed * 2.2 / cut.cutting_speed - 1.0).abs() < 1e-9, "{chip:?}");
    }

    #[test]
    fn what_a_moving_window_leaves_of_a_chip_has_its_thickness() {
        for compression in [2.2, 2.6] {
            let cut = SyntheticCut {
                chip_thickness: compression * SyntheticCut::default().uncut_chip_thickness,
                ..SyntheticCut::default()
            };
            // What was cut over 6 h, as in a window of the default length: 1.2 and 0.8 times as long as thick, less what
            // lies below a quarter of h.
            let chip = shape(&cut, 6.0 * cut.uncut_chip_thickness).unwrap();
            // Ends of lines as above; the corners, where normals are oblique, are a larger part of a short chip.
            let error = chip.thickness / cut.chip_thickness - 1.0;
            assert!(error.abs() < 0.06, "{compression}: {chip:?}");
        }
    }

    #[test]
    fn no_chip_has_no_thickness() {
        assert_eq!(shape(&SyntheticCut::default(), 0.0), None);
        assert_eq!(shape(&SyntheticCut::default(), 0.3e-3), None);
    }
}
