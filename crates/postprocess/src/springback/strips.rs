//! The outermost particles of the machined surface, strip by strip.

use super::context::{Context, SnapshotView};
use crate::cloud::{CutParticles, CutPlane};
use crate::statistics::{mean, median};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::CuttingFrame;

/// Width of a strip in spacings: flow may stretch the particles of a row to twice their distance.
const WIDTH: f64 = 2.0;
/// Particles further than this many spacings from the plane looked at are no surface.
const REACH: f64 = 3.0;

/// Height of the outermost particles above the tool's lowest point, plus half a spacing, in strips
/// two spacings wide. In m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strips {
    /// Middle of each strip, from the start of the cut.
    pub distance: Vec<f64>,
    /// Its height: mean over the snapshots in which it is clear of the tool.
    pub height: Vec<f64>,
    /// Mean over the window.
    pub mean: f64,
    /// Median over the window.
    pub median: f64,
    /// Standard deviation between the strips of the window: the roughness.
    pub roughness: f64,
}

/// Heights of the outermost particles of `snapshot` above `level`, each plus its half thickness, in
/// strips two spacings wide between `from` and `to` along the cutting direction; strips without a
/// particle within three spacings of the level are left out. Loose particles do not count.
#[must_use]
pub fn outer_heights(
    snapshot: &Snapshot,
    frame: CuttingFrame,
    level: f64,
    [from, to]: [f64; 2],
) -> Vec<f64> {
    let cloud = CutParticles::new(snapshot, CutPlane::new(frame));
    let mut heights = outermost(&cloud, level, from, to);
    heights.retain(|height| height.is_finite());
    heights
}

/// As [`outer_heights`], with minus infinity for strips without a particle.
fn outermost(cloud: &CutParticles, level: f64, from: f64, to: f64) -> Vec<f64> {
    let width = WIDTH * cloud.spacing;
    let count = ((to - from) / width + 1e-9).floor().max(0.0) as usize;
    let mut heights = vec![f64::NEG_INFINITY; count];
    for (point, half) in
        cloud.points.iter().zip(&cloud.half_thickness).filter(|(p, _)| p[0] >= from)
    {
        let strip = ((point[0] - from) / width) as usize;
        let height = point[1] - level;
        if height.abs() <= REACH * cloud.spacing
            && let Some(highest) = heights.get_mut(strip)
        {
            *highest = highest.max(height + half);
        }
    }
    heights
}

/// Means over the snapshots.
pub(super) struct StripCollector {
    sums: Vec<f64>,
    counts: Vec<usize>,
}

impl StripCollector {
    pub fn new(context: &Context) -> Self {
        let count = (context.window[1] / (WIDTH * context.spacing)).max(0.0) as usize;
        Self { sums: vec![0.0; count], counts: vec![0; count] }
    }

    pub fn visit(&mut self, view: &SnapshotView<'_>, context: &Context) {
        let end = view.lowest.rear - context.clear_distance;
        let heights = outermost(view.cloud, view.lowest.height, context.origin, end);
        for ((sum, count), height) in self.sums.iter_mut().zip(&mut self.counts).zip(heights) {
            if height.is_finite() {
                *sum += height;
                *count += 1;
            }
        }
    }

    pub fn finish(self, context: &Context) -> Strips {
        let width = WIDTH * context.spacing;
        let mut strips = Strips::default();
        for (strip, (sum, count)) in self.sums.iter().zip(&self.counts).enumerate() {
            if *count > 0 {
                strips.distance.push((strip as f64 + 0.5) * width);
                strips.height.push(sum / *count as f64);
            }
        }
        let inside: Vec<f64> = strips
            .distance
            .iter()
            .zip(&strips.height)
            .filter(|(distance, _)| **distance >= context.window[0])
            .map(|(_, height)| *height)
            .collect();
        strips.mean = mean(&inside);
        strips.median = median(&inside);
        let squares: f64 = inside.iter().map(|height| (height - strips.mean).powi(2)).sum();
        strips.roughness = (squares / inside.len().saturating_sub(1).max(1) as f64).sqrt();
        strips
    }
}
