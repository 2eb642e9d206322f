//! The primary shear zone: its angle, width and strain rate.
//!
//! The plastic strain rates of all snapshots of the window are averaged in the frame of the tool.
//! Looked at is the middle part of the zone, between 0.35 h and 0.9 h above the tool's lowest point and more
//! than a quarter of h away from the rake face, where the secondary shear zone is not. In each of
//! six rows of this part, the **place of fastest shear** is the centre of what lies above half of
//! the row's highest rate; a line through the six is the shear plane, the **shear angle** phi is its
//! angle with the cutting direction.
//!
//! Across this line, the **width** is that over which the rate exceeds half of its highest value,
//! the **strain rate** the mean over this width, the **peak** its highest value. They are equivalent
//! (von Mises) rates; in simple shear the engineering shear strain rate is sqrt(3) times that
//! (Oxley 1989 gives gamma_dot = C v_s / l, with C of about 6, in these terms).
//!
//! A zone that is narrower than about two spacings comes out as wide as that, with a rate that is
//! as much too small. The rates of the record are smoothed over about a hundred steps, in which
//! material travels some tenths of a spacing.

use crate::cloud::{CutParticles, PlanePoint};
use crate::missing::Missing;
use crate::outline::Outline;
use sphcut_sph::Snapshot;

/// The part of the zone that is looked at: heights over the lowest point in h.
const HEIGHTS: [f64; 2] = [0.35, 0.9];
/// Distance from the rake face in h.
const CLEAR: f64 = 0.25;
/// Rows of places of fastest shear.
const ROWS: usize = 6;
/// How far ahead of the tool it is looked for, in h.
const REACH: f64 = 5.0;
/// Width of a bin in spacings.
const BIN: f64 = 0.5;
/// Least rate in v_c / h.
const LEAST_RATE: f64 = 0.05;
/// Largest distance of the places of fastest shear from their line (root of the mean square) in h.
const LARGEST_SCATTER: f64 = 0.25;

/// The primary shear zone, mean over the snapshots of the window.
#[derive(Debug, Clone, PartialEq)]
pub struct ShearZone {
    /// phi in rad.
    pub angle: f64,
    /// Width over which the rate exceeds half of its highest value in m.
    pub width: f64,
    /// Where this width begins and ends across the shear plane in m.
    pub limits: [f64; 2],
    /// Mean equivalent plastic strain rate over this width in 1/s.
    pub strain_rate: f64,
    /// Highest mean rate across the zone in 1/s.
    pub peak_rate: f64,
    /// Distance across the shear plane in m, positive towards the workpiece, and mean rate in 1/s.
    pub profile: Vec<[f64; 2]>,
}

impl ShearZone {
    /// Engineering shear strain rate in 1/s.
    #[must_use]
    pub fn shear_strain_rate(&self) -> f64 {
        3.0_f64.sqrt() * self.strain_rate
    }
}

/// Places relative to the tool's edge, in h, and rates, of the snapshots of the window.
#[derive(Debug, Default)]
pub(crate) struct ShearZoneCollector {
    found: Vec<(PlanePoint, f64)>,
}

impl ShearZoneCollector {
    pub fn visit(
        &mut self,
        snapshot: &Snapshot,
        cloud: &CutParticles,
        outline: &Outline,
        depth: f64,
    ) {
        for (&[x, y], &index) in cloud.points.iter().zip(&cloud.source) {
            let place = [(x - outline.front) / depth, (y - outline.lowest) / depth];
            let rate = snapshot.plastic_strain_rate[index];
            let inside = place[1] >= HEIGHTS[0] && place[1] < HEIGHTS[1] && place[0] < REACH;
            if inside && rate.is_finite() {
                // Ahead of the rake face: its distance at the same height.
                let face = outline.face_at(y);
                if face.is_some_and(|face| x - face > CLEAR * depth) {
                    self.found.push((place, rate));
                }
            }
        }
    }

    /// `spacing` and `depth` (h) in m, `speed` (v_c) in m/s.
    pub fn finish(&self, spacing: f64, depth: f64, speed: f64) -> Result<ShearZone, Missing> {
        let bin = BIN * spacing / depth;
        let [low, high] = HEIGHTS;
        let height = (high - low) / ROWS as f64;
        let mut places = Vec::with_capacity(ROWS);
        for row in 0..ROWS {
            let from = low + height * row as f64;
            let inside = self.found.iter().filter(|(p, _)| p[1] >= from && p[1] < from + height);
            let rates = binned(inside.map(|(p, rate)| (p[0], *rate)), bin);
            if let Some(centre) = centre(&rates, LEAST_RATE * speed / depth) {
                places.push([centre, from + 0.5 * height]);
            }
        }
        if places.len() < ROWS {
            return Err(Missing::NoShearZone);
        }
        let (origin, cotangent) = line(&places).ok_or(Missing::NoShearLine)?;
        let angle = 1.0_f64.atan2(cotangent);
        let (sine, cosine) = angle.sin_cos();
        let away = |p: &PlanePoint| (p[0] - origin) * sine - p[1] * cosine;
        let rates = binned(self.found.iter().map(|(p, rate)| (away(p), *rate)), bin);
        let (peak_rate, limits, strain_rate) = half_width(&rates).ok_or(Missing::OpenShearZone)?;
        let limits = limits.map(|away| away * depth);
        let width = limits[1] - limits[0];
        let profile = rates.iter().map(|&[away, rate]| [away * depth, rate]).collect();
        Ok(ShearZone { angle, width, limits, strain_rate, peak_rate, profile })
    }
}

/// Means in bins of width `bin`, each with its neighbours (weights 1, 2, 1 of sums and counts): the
/// middle of the bin and the mean. Bins that nothing fell into are left out.
fn binned(values: impl Iterator<Item = (f64, f64)>, bin: f64) -> Vec<[f64; 2]> {
    let mut sums: std::collections::BTreeMap<i64, (f64, f64)> = std::collections::BTreeMap::new();
    for (place, value) in values {
        let number = (place / bin).floor() as i64;
        for (number, weight) in [(number - 1, 1.0), (number, 2.0), (number + 1, 1.0)] {
            let entry = sums.entry(number).or_default();
            *entry = (entry.0 + weight * value, entry.1 + weight);
        }
    }
    let mean =
        |(number, (sum, weight)): (&i64, &(f64, f64))| [(*number as f64 + 0.5) * bin, sum / weight];
    sums.iter().map(mean).collect()
}

/// Centre of what lies above half of the highest rate; `None` where that is below `least`.
fn centre(rates: &[[f64; 2]], least: f64) -> Option<f64> {
    let peak = rates.iter().map(|r| r[1]).fold(0.0, f64::max);
    if peak <= least {
        return None;
    }
    let above = |r: &[f64; 2]| (r[1] - 0.5 * peak).max(0.0);
    let weight: f64 = rates.iter().map(above).sum();
    Some(rates.iter().map(|r| r[0] * above(r)).sum::<f64>() / weight)
}

/// x = x_0 + c y through points by least squares; `None` where they scatter too much or c is so
/// steep or flat that no shear plane lies there (phi below 5 or above 85 degrees).
fn line(points: &[PlanePoint]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let square: f64 = points.iter().map(|p| (p[1] - y).powi(2)).sum();
    let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / square;
    let error = |p: &PlanePoint| (p[0] - x - slope * (p[1] - y)).powi(2);
    let scatter = (points.iter().map(error).sum::<f64>() / count).sqrt();
    let steepest = 85.0_f64.to_radians().tan();
    let is_plane = slope > 1.0 / steepest && slope < steepest && scatter < LARGEST_SCATTER;
    is_plane.then_some((x - slope * y, slope))
}

/// Highest rate, the places about the peak where the rate is half of it, mean rate between them.
fn half_width(rates: &[[f64; 2]]) -> Option<(f64, [f64; 2], f64)> {
    let top = (0..rates.len()).max_by(|&a, &b| rates[a][1].total_cmp(&rates[b][1]))?;
    let half = 0.5 * rates[top][1];
    // Where the rate falls through half, by linear interpolation from the peak outwards.
    let edge = |outwards: &[usize]| {
        let step = outwards.windows(2).find(|pair| rates[pair[1]][1] < half)?;
        let ([x0, y0], [x1, y1]) = (rates[step[0]], rates[step[1]]);
        Some(x0 + (x1 - x0) * (y0 - half) / (y0 - y1))
    };
    let left = edge(&(0..=top).rev().collect::<Vec<_>>())?;
    let right = edge(&(top..rates.len()).collect::<Vec<_>>())?;
    let inside = rates.iter().filter(|r| r[0] >= left && r[0] <= right);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), r| (sum + r[1], count + 1.0));
    Some((rates[top][1], [left, right], sum / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::CutPlane;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::CuttingFrame;

    fn zone(cut: &SyntheticCut) -> Result<ShearZone, Missing> {
        let plane = CutPlane::new(CuttingFrame::default());
        let mut collector = ShearZoneCollector::default();
        for k in 0..10 {
            let snapshot = cut.snapshot(0.8e-3 + 13e-6 * f64::from(k));
            let outline = Outline::of(&snapshot, plane).unwrap();
            let cloud = CutParticles::new(&snapshot, plane);
            collector.visit(&snapshot, &cloud, &outline, cut.uncut_chip_thickness);
        }
        collector.finish(cut.particle_spacing, cut.uncut_chip_thickness, cut.cutting_speed)
    }

    #[test]
    fn the_drawn_band_is_found_with_its_angle_width_and_rate() {
        for (rake, thickness, spacing) in [
            (5.0_f64, 0.22e-3, 5e-6),
            (-10.0, 0.22e-3, 5e-6),
            (20.0, 0.16e-3, 5e-6),
            (5.0, 0.22e-3, 10e-6),
        ] {
            let cut = SyntheticCut {
                rake_angle: rake.to_radians(),
                chip_thickness: thickness,
                particle_spacing: spacing,
                loose_particles: 30,
                ..SyntheticCut::default()
            };
            let found = zone(&cut).unwrap();
            // Six centres, each to a tenth of a spacing over 0.45 h: 1 degree.
            let error = (found.angle - cut.shear_angle()).to_degrees();
            assert!(error.abs() < 1.5, "{rake}: {error} {found:?}");
            // A Gaussian of 40 um, smoothed by bins of half a spacing (standard deviation of the
            // weights 0.7 bins) gains (0.35 * 2.355 dx)^2 / 2 / 40 um: 0.2 and 0.9 um, and the bin.
            assert!((found.width / 40e-6 - 1.0).abs() < 0.08, "{rake}: {found:?}");
            assert!((found.peak_rate / 5e4 - 1.0).abs() < 0.06, "{rake}: {found:?}");
            // The mean of exp(-ln2 x^2) over -1 to 1 is sqrt(pi / 4 ln2) erf(sqrt(ln2)) = 0.8100.
            assert!((found.strain_rate / 5e4 - 0.810).abs() < 0.05, "{rake}: {found:?}");
        }
    }

    #[test]
    fn a_wide_band_is_wide_and_a_slow_one_is_none() {
        let wide = SyntheticCut { shear_width: 60e-6, ..SyntheticCut::default() };
        assert!((zone(&wide).unwrap().width / 60e-6 - 1.0).abs() < 0.08);
        // 5 % of v_c / h are 1250 1/s.
        let slow = SyntheticCut { shear_rate: 1e3, ..SyntheticCut::default() };
        assert_eq!(zone(&slow), Err(Missing::NoShearZone));
    }

    #[test]
    fn a_band_that_does_not_rise_from_the_edge_is_none() {
        assert_eq!(line(&[[1.0, 0.4], [0.8, 0.6], [0.6, 0.8]]), None);
        assert_eq!(line(&[[0.0, 0.4], [3.0, 0.6], [0.0, 0.8]]), None);
        let (origin, slope) = line(&[[0.9, 0.4], [1.3, 0.6], [1.7, 0.8]]).unwrap();
        assert!((origin - 0.1).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12);
    }
}
