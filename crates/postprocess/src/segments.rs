//! Segmentation of the chip: pitch, frequency, height of the teeth.
//!
//! The free side of the chip was the uncut surface, and its particles keep their identifiers: in the order of
//! their places before the cut they trace it, curled as the chip may be. At each of them the
//! **thickness** is the shortest distance to a particle of the chip's surface that was in the lower
//! half of the uncut chip, plus one spacing for the two halves.
//!
//! A **tooth** is a maximum of the thickness along the surface that stands out (prominence) by at
//! least 15 % of the median thickness and 1.5 spacings. From three distances between teeth on:
//!
//! - undeformed pitch: mean distance of the teeth before the cut, along the cutting direction;
//! - **pitch** p_c: mean distance between neighbouring tips in the chip;
//! - **frequency** f = v_c / undeformed pitch: teeth per second;
//! - **degree of segmentation** G_s = (h_max - h_min) / h_max with the mean thickness at the tips and
//!   in the valleys (Schulz, Abele and Sahm 2001).
//!
//! Teeth whose distances scatter by more than half of their mean are roughness, not a pitch. A tooth
//! shorter than four spacings before the cut cannot be told from it.

use crate::chip::ChipContext;
use crate::cloud::{CutParticles, PlanePoint, distance};
use crate::missing::Missing;
use crate::statistics::{mean, median};
use sphcut_sph::Snapshot;
use std::collections::HashMap;

/// Fewest particles of the uncut surface on the chip.
const FEWEST_PARTICLES: usize = 12;
/// Fewest teeth.
const FEWEST_TEETH: usize = 4;
/// Least prominence of a tooth: share of the median thickness, and spacings.
const PROMINENCE: (f64, f64) = (0.15, 1.5);
/// Largest scatter of the distances between teeth over their mean.
const LARGEST_SCATTER: f64 = 0.5;

/// The teeth of a segmented chip. Lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segments {
    /// Number of teeth.
    pub teeth: usize,
    /// p_c.
    pub pitch: f64,
    /// Standard deviation of the distances between neighbouring tips.
    pub pitch_deviation: f64,
    /// Mean distance before the cut.
    pub undeformed_pitch: f64,
    /// f in 1/s.
    pub frequency: f64,
    /// Mean thickness at the tips.
    pub tip_thickness: f64,
    /// Mean thickness in the valleys.
    pub valley_thickness: f64,
}

impl Segments {
    /// G_s.
    #[must_use]
    pub fn degree(&self) -> f64 {
        1.0 - self.valley_thickness / self.tip_thickness
    }
}

/// Thickness at one particle of the free side.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Along the cutting direction before the cut.
    before: f64,
    now: PlanePoint,
    thickness: f64,
}

/// What is known beforehand.
pub(crate) struct SegmentContext<'a> {
    pub first: &'a Snapshot,
    pub chip: &'a ChipContext,
    /// Places along the cutting direction, before the cut, that count.
    pub range: [f64; 2],
    /// v_c in m/s.
    pub cutting_speed: f64,
}

/// The thickness along the free side (place before the cut, thickness; in m), and the teeth.
pub(crate) type Along = (Vec<[f64; 2]>, Result<Segments, Missing>);

/// Measures the teeth of the chip in `snapshot`.
pub(crate) fn measure(
    snapshot: &Snapshot,
    cloud: &CutParticles,
    context: &SegmentContext<'_>,
) -> Along {
    let places = places(snapshot, cloud, context);
    let profile = places.iter().map(|place| [place.before, place.thickness]).collect();
    (profile, teeth(&places, cloud.spacing, context.cutting_speed))
}

fn places(snapshot: &Snapshot, cloud: &CutParticles, context: &SegmentContext<'_>) -> Vec<Place> {
    let plane = context.chip.plane;
    let floor = context.chip.floor(cloud.spacing);
    let before: HashMap<u64, PlanePoint> = context
        .first
        .id
        .iter()
        .zip(&context.first.position)
        .map(|(id, position)| (*id, plane.project(position)))
        .collect();
    let origin = |i: usize| before.get(&snapshot.id[cloud.source[i]]).copied();
    let chip: Vec<(usize, PlanePoint)> = (0..cloud.points.len())
        .filter(|&i| cloud.points[i][1] > floor)
        .filter_map(|i| origin(i).map(|origin| (i, origin)))
        .collect();
    let middle = context.chip.surface - 0.5 * context.chip.uncut_chip_thickness;
    let rake_side: Vec<PlanePoint> = chip
        .iter()
        .filter(|(i, origin)| origin[1] < middle && cloud.outward_normal(*i).is_some())
        .map(|(i, _)| cloud.points[*i])
        .collect();
    let across = |from: PlanePoint| {
        rake_side.iter().map(|point| distance(*point, from)).min_by(f64::total_cmp)
    };
    let counts = |origin: &PlanePoint| {
        let was_surface = origin[1] > context.chip.surface - cloud.spacing;
        was_surface && origin[0] >= context.range[0] && origin[0] <= context.range[1]
    };
    let mut places: Vec<Place> = chip
        .iter()
        .filter(|(_, origin)| counts(origin))
        .filter_map(|(i, origin)| {
            let now = cloud.points[*i];
            let thickness = across(now)? + cloud.spacing;
            Some(Place { before: origin[0], now, thickness })
        })
        .collect();
    places.sort_by(|a, b| a.before.total_cmp(&b.before));
    places
}

fn teeth(places: &[Place], spacing: f64, cutting_speed: f64) -> Result<Segments, Missing> {
    if places.len() < FEWEST_PARTICLES {
        let (found, needed) = (places.len(), FEWEST_PARTICLES);
        return Err(Missing::TooFewSurfaceParticles { found, needed });
    }
    let heights: Vec<f64> = places.iter().map(|place| place.thickness).collect();
    let least_height = (PROMINENCE.0 * median(&heights)).max(PROMINENCE.1 * spacing);
    let tips = tips(&heights, least_height);
    if tips.len() < 2 {
        return Err(Missing::Continuous { least_height });
    }
    if tips.len() < FEWEST_TEETH {
        return Err(Missing::TooFewTeeth { found: tips.len(), needed: FEWEST_TEETH });
    }
    let between = |length: &dyn Fn(&Place, &Place) -> f64| -> Vec<f64> {
        tips.windows(2).map(|pair| length(&places[pair[0]], &places[pair[1]])).collect()
    };
    let before = between(&|a, b| b.before - a.before);
    let now = between(&|a, b| distance(a.now, b.now));
    let scatter = deviation(&before) / mean(&before);
    if scatter > LARGEST_SCATTER {
        return Err(Missing::Irregular { scatter });
    }
    let lowest =
        |pair: &[usize]| heights[pair[0]..=pair[1]].iter().copied().fold(f64::INFINITY, f64::min);
    let valleys: Vec<f64> = tips.windows(2).map(lowest).collect();
    let highest: Vec<f64> = tips.iter().map(|&tip| heights[tip]).collect();
    Ok(Segments {
        teeth: tips.len(),
        pitch: mean(&now),
        pitch_deviation: deviation(&now),
        undeformed_pitch: mean(&before),
        frequency: cutting_speed / mean(&before),
        tip_thickness: mean(&highest),
        valley_thickness: mean(&valleys),
    })
}

/// Indices of the maxima that stand out by at least `least` on both sides.
fn tips(heights: &[f64], least: f64) -> Vec<usize> {
    let mut tips = Vec::new();
    let (mut top, mut bottom) = (0, 0);
    let mut rising = false;
    for (k, &height) in heights.iter().enumerate() {
        if rising {
            if height > heights[top] {
                top = k;
            }
            if heights[top] - height >= least {
                tips.push(top);
                (rising, bottom) = (false, k);
            }
        } else {
            if height < heights[bottom] {
                bottom = k;
            }
            if height - heights[bottom] >= least {
                (rising, top) = (true, k);
            }
        }
    }
    tips
}

/// Standard deviation; 0 for fewer than two values.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let centre = mean(values);
    let sum: f64 = values.iter().map(|v| (v - centre).powi(2)).sum();
    (sum / (values.len() - 1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::CutPlane;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    fn measured(cut: &SyntheticCut, travel: f64) -> Along {
        let (first, snapshot) = (cut.snapshot(0.0), cut.snapshot(travel));
        let plane = CutPlane::new(CuttingFrame::default());
        let chip = ChipContext {
            plane,
            surface: 0.0,
            uncut_chip_thickness: cut.uncut_chip_thickness,
            tool_velocity: [cut.cutting_speed, 0.0, 0.0],
        };
        let context = SegmentContext {
            first: &first,
            chip: &chip,
            range: [0.1e-3, travel],
            cutting_speed: cut.cutting_speed,
        };
        measure(&snapshot, &CutParticles::new(&snapshot, plane), &context)
    }

    fn serrated() -> SyntheticCut {
        SyntheticCut {
            tooth_pitch: 90e-6,
            tooth_height: 60e-6,
            particle_spacing: 5e-6,
            length: 2.2e-3,
            ..SyntheticCut::default()
        }
    }

    #[test]
    fn the_drawn_teeth_are_found_with_pitch_frequency_and_height() {
        for (rake, disorder, loose) in [(5.0_f64, 0.0, 0), (5.0, 0.3, 30), (-10.0, 0.15, 0)] {
            let cut = SyntheticCut {
                rake_angle: rake.to_radians(),
                disorder,
                loose_particles: loose,
                ..serrated()
            };
            let (_, found) = measured(&cut, 1.6e-3);
            let found = found.unwrap();
            // 1.5 mm of travel make 0.68 mm of chip: seven teeth, of which an end may be missing.
            assert!((5..=8).contains(&found.teeth), "{found:?}");
            // A tip lies within a particle of the free side, 5 um in the chip: over five pitches of
            // 90 um 2 %.
            assert!((found.pitch / 90e-6 - 1.0).abs() < 0.04, "{found:?}");
            // p_c h_ch / h = 198 um before the cut; f = v_c / 198 um = 12.6 kHz.
            assert!((found.undeformed_pitch / 198e-6 - 1.0).abs() < 0.04, "{found:?}");
            assert!((found.frequency / 12_626.0 - 1.0).abs() < 0.04, "{found:?}");
            // Tips of 220 um, valleys of 160 um: within a layer of 5 um each; G_s = 0.273,
            // within 2 * 5 / 220 = 0.045.
            assert!((found.tip_thickness / 220e-6 - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.valley_thickness / 160e-6 - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.degree() - 0.273).abs() < 0.046, "{found:?}");
        }
    }

    #[test]
    fn a_smooth_chip_has_no_pitch_and_two_teeth_are_too_few() {
        let (profile, found) = measured(&SyntheticCut::default(), 1.6e-3);
        assert!(matches!(found, Err(Missing::Continuous { .. })), "{found:?}");
        let thickness: Vec<f64> = profile.iter().map(|place| place[1]).collect();
        assert!((median(&thickness) / 0.22e-3 - 1.0).abs() < 0.05);
        let (_, found) = measured(&serrated(), 0.8e-3);
        assert!(matches!(found, Err(Missing::TooFewTeeth { .. })), "{found:?}");
        let (_, found) = measured(&serrated(), 0.1e-3);
        assert!(matches!(found, Err(Missing::TooFewSurfaceParticles { .. })), "{found:?}");
    }

    #[test]
    fn small_teeth_are_no_teeth_and_uneven_ones_have_no_pitch() {
        assert_eq!(tips(&[0.0, 3.0, 1.0, 1.4, 0.0, 4.0, 3.5, 4.5, 0.0, 2.0], 1.0), [1, 7]);
        let place = |before: f64, thickness: f64| Place { before, now: [before, 0.0], thickness };
        let at = [3.0, 5.0, 8.0, 25.0, 27.0, 50.0];
        let places: Vec<Place> = (0..60)
            .map(|k| {
                let before = f64::from(k);
                let tip = at.iter().any(|tip: &f64| (tip - before).abs() < 0.5);
                place(before, if tip { 15.0 } else { 10.0 })
            })
            .collect();
        let found = teeth(&places, 1.0, 1.0);
        assert!(matches!(found, Err(Missing::Irregular { scatter }) if scatter > 0.9), "{found:?}");
    }
}
