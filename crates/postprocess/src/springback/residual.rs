//! Residual stress below the machined surface against depth.
//!
//! Depth counts from the plane of the tool's lowest point, in bins of one spacing; the first bin takes
//! what has risen above that plane by up to a spacing. A bin is averaged over the window of the
//! machined surface that is clear of the tool and over the snapshots.
//!
//! Pressure alternates between the rows below the surface (`docs/numerics.md`, *What is not solved*),
//! by as much as the yield stress, and a mean along a row does not remove that: only means over a
//! few spacings of depth are meaningful. The stress of a layer is therefore that of three,
//! weighted 1, 2, 1: it leaves nothing of an alternation whose size grows or falls evenly, and
//! costs a stress that varies over a depth d only (dx / 2 d)^2 of itself. The layers themselves are
//! [`StressBin::layer`].

use super::context::{Context, SnapshotView};
use crate::result::StressBin;
use crate::statistics::mean;
use crate::steady::mean_interval;
use sphcut_record::Run;
use sphcut_sph::setup::{CuttingFrame, Vector};

/// Deepest bin in uncut chip thicknesses.
const DEEPEST: f64 = 4.0;
/// Width of the strips whose means are the samples of a bin, in spacings.
const STRIP: f64 = 2.0;

/// Sums of the three stresses, and their number.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    stress: [f64; 3],
    count: usize,
}

pub(super) struct StressProfile {
    frame: CuttingFrame,
    spacing: f64,
    bins: usize,
    strips: usize,
    sums: Vec<Sums>,
}

impl StressProfile {
    pub fn new(run: &Run, context: &Context) -> Self {
        let bins = (DEEPEST * context.uncut_chip_thickness / context.spacing).round() as usize;
        let length = context.window[1] - context.window[0];
        let strips = (length / (STRIP * context.spacing)).max(0.0) as usize;
        Self {
            frame: run.facts.frame,
            spacing: context.spacing,
            bins,
            strips,
            sums: vec![Sums::default(); bins * strips],
        }
    }

    pub fn visit(&mut self, view: &SnapshotView<'_>, context: &Context) {
        let end = view.lowest.rear - context.clear_distance;
        let start = context.origin + context.window[0];
        for (point, &index) in view.cloud.points.iter().zip(&view.cloud.source) {
            if point[0] < start || point[0] >= end {
                continue;
            }
            let strip = ((point[0] - start) / (STRIP * self.spacing)) as usize;
            let depth = (view.lowest.height - point[1]) / self.spacing;
            let bin = depth.max(0.0) as usize;
            if depth < -1.0 || bin >= self.bins || strip >= self.strips {
                continue;
            }
            let stress = &view.snapshot.stress[index];
            let along = |direction: &Vector| normal_stress(stress, direction);
            let found =
                [along(&self.frame.cutting), along(&self.frame.passive), along(&self.frame.feed)];
            let sums = &mut self.sums[bin * self.strips + strip];
            (0..3).for_each(|k| sums.stress[k] += found[k]);
            sums.count += 1;
        }
    }

    /// All layers but the first and the last, which have no neighbour on one side.
    pub fn finish(&self) -> Vec<StressBin> {
        (1..self.bins.saturating_sub(1)).filter_map(|bin| self.bin(bin)).collect()
    }

    /// Mean stress of a layer in one strip; `None` without a particle.
    fn layer(&self, bin: usize, strip: usize, component: usize) -> Option<f64> {
        let sums = &self.sums[bin * self.strips + strip];
        (sums.count > 0).then(|| sums.stress[component] / sums.count as f64)
    }

    fn bin(&self, bin: usize) -> Option<StressBin> {
        let about = |strip: usize, component: usize| {
            let [above, here, below] =
                [bin - 1, bin, bin + 1].map(|layer| self.layer(layer, strip, component));
            Some(0.25 * (above? + 2.0 * here? + below?))
        };
        let smoothed = |component: usize| -> Vec<f64> {
            (0..self.strips).filter_map(|strip| about(strip, component)).collect()
        };
        let alone = |component: usize| -> Vec<f64> {
            (0..self.strips).filter_map(|strip| self.layer(bin, strip, component)).collect()
        };
        let components = [0, 1, 2].map(smoothed);
        if components[0].is_empty() {
            return None;
        }
        let [cutting, across, normal] = components.map(|means| mean_interval(&means, None));
        Some(StressBin {
            depth: (bin as f64 + 0.5) * self.spacing,
            cutting: cutting.mean,
            cutting_ci95: cutting.half_width,
            across: across.mean,
            across_ci95: across.half_width,
            normal: normal.mean,
            normal_ci95: normal.half_width,
            layer: [0, 1, 2].map(|component| mean(&alone(component))),
            count: self.sums[bin * self.strips..(bin + 1) * self.strips]
                .iter()
                .map(|sums| sums.count)
                .sum(),
        })
    }
}

/// n . sigma n of a stress stored as xx, yy, zz, xy, yz, xz.
fn normal_stress(stress: &[f64; 6], normal: &Vector) -> f64 {
    let [x, y, z] = *normal;
    let [xx, yy, zz, xy, yz, xz] = *stress;
    xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + yz * y * z + xz * x * z)
}
