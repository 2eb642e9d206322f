//! Springback of the machined surface, and the residual stress below it, of several passes those of the first; in space by
//! `slice.rs`.
//!
//! **Springback** s: normal distance between the lowest point of the tool and the machined surface
//! behind it, positive where the surface has risen (turning tests measure it with a displacement
//! sensor behind the tool). A particle touches the tool with its half thickness r, so
//! `s = y + r - y_tool` along the normal of the machined plane, of a particle of the surface that
//! is more than [`Springback::clear_distance`] behind the tool.
//!
//! **Which particles are the surface** decides everything: the outer rows of a cut are rough by a
//! good part of a spacing, and s is a tenth of one. Taken are the particles that a snapshot has seen
//! *touching* the lowest part of the tool, pressed by it and without a gap: of them it is known that they were at the tool's
//! surface, whatever the rows look like. They are followed by their identifier. The outermost
//! particles of strips two spacings wide, touched or not, give the roughness and a second figure,
//! [`Springback::strips`], that depends on the width of the strips and is no springback.
//!
//! **What the contact adds**: pressed by a penalty the surface lies above the tool's side by the overlap. Where the tool is lowest
//! that shifts the whole surface behind it, so the mean overlap of the same particles there is taken off: a cut has then the same
//! springback with a contact an eighth as stiff (`docs/springback.md`).
//!
//! **What it is worth**: see [`ErrorBar`]. Neglected: thermal expansion (the solver has none).

mod compare;
mod context;
mod error;
mod files;
mod median;
mod residual;
mod result;
mod slice;
mod strips;
mod touched;

pub use compare::{Agreement, Measurement, SpringbackComparison};
pub use error::{ErrorBar, OVERLAP_SHARE, Overlap, RESOLUTION_SHARE, SpringbackError};
pub use files::{SCHEMA_VERSION, SpringbackEntry, springback_csv, springback_json};
pub use median::MedianInterval;
pub use result::Springback;
pub use strips::{Strips, outer_heights};
pub use touched::{RecoveryBin, Touched};

use crate::cloud::{CutParticles, PlanePoint};
use crate::forces::Force;
use crate::result::ProcessResult;
use crate::steady::{self, MeanInterval, window_mean};
use context::{Lowest, SnapshotView, context};
use residual::StressProfile;
use sphcut_record::Run;
use touched::Followed;

/// The shortest window that a mean is taken over, in spacings: ten strips of two.
const PLANE_WINDOW: f64 = 20.0;
/// The same for the slice of a cut in space, which is six spacings wide.
const SLICE_WINDOW: f64 = 10.0;

/// Least share of the heights that counts for their mean: springback wanders along the cut, and one of its swings is no run-in.
const LEAST_WINDOW: f64 = 0.5;

/// Measures springback and residual stress of `run`, evaluated as `result`.
///
/// # Errors
/// A run that is no cut, one too short to leave a machined surface clear of the tool, a snapshot that cannot be read.
pub fn measure(run: &Run, result: &ProcessResult) -> Result<Springback, SpringbackError> {
    let first_pass = run.first_pass();
    let run = first_pass.as_ref().unwrap_or(run);
    let own = result.passes.first().map(|pass| (&pass.window, &pass.forces));
    let (window, forces) = own.unwrap_or((&result.window, &result.forces));
    if run.facts.dimension == 3 {
        let slice = slice::middle_of_groove(run)?;
        return measure_plane(&slice, window.start, SLICE_WINDOW, forces.passive);
    }
    measure_plane(run, window.start, PLANE_WINDOW, forces.feed)
}

fn measure_plane(
    run: &Run,
    window_start: f64,
    least_window: f64,
    normal_force: Force,
) -> Result<Springback, SpringbackError> {
    let context = context(run, window_start, least_window)?;
    let mut followed = Followed::default();
    let mut strips = strips::StripCollector::new(&context);
    let mut stress = StressProfile::new(run, &context);
    let (mut snapshots, mut tool) = (0, Vec::new());
    for number in 0..run.snapshots.len() {
        let snapshot = run.snapshots.get(number)?;
        let cloud = CutParticles::new(&snapshot, context.plane);
        let corners: Vec<PlanePoint> =
            snapshot.tool.iter().map(|c| context.plane.project(c)).collect();
        let Some(lowest) = Lowest::of(&corners, context.spacing) else { continue };
        let view = SnapshotView { snapshot: &snapshot, cloud: &cloud, corners: &corners, lowest };
        followed.visit(&view, &context);
        strips.visit(&view, &context);
        stress.visit(&view, &context);
        snapshots += 1;
        tool = corners.iter().map(|c| [c[0] - lowest.rear, c[1] - lowest.height]).collect();
    }
    let found = followed.finish(&context);
    let mut touched = found.touched;
    let heights: Vec<f64> = touched.iter().map(|touch| touch.springback).collect();
    let entered = touched.iter().filter(|touch| touch.distance < context.entry).count();
    let first = steady::window_start(&heights, LEAST_WINDOW).max(entered).min(heights.len());
    let pressed: Vec<f64> = touched[first..].iter().filter_map(|touch| touch.overlap).collect();
    let overlap = Overlap::of(&pressed);
    touched.iter_mut().for_each(|touch| touch.springback -= overlap.mean);
    let heights: Vec<f64> = touched.iter().map(|touch| touch.springback).collect();
    let (within, record) = (&heights[first..], &heights[entered.min(first)..]);
    let mean = (!within.is_empty())
        .then(|| window_mean(&heights, first))
        .map(|mean| MeanInterval { half_width: mean.half_width.hypot(overlap.half_width), ..mean });
    // Hollows of the surface are in its overlap, too: off the median goes the median overlap.
    let pressed = median::median_interval(&pressed, &pressed).map_or(0.0, |found| found.median);
    let median = median::median_interval(within, record).map(|found| MedianInterval {
        median: found.median + overlap.mean - pressed,
        bounds: found.bounds.map(|bound| bound + overlap.mean - pressed),
    });
    Ok(Springback {
        cutting_speed: run.facts.cutting_speed(),
        particle_spacing: context.spacing,
        clear_distance: context.clear_distance,
        window: context.window,
        averaged_from: touched.get(first).map_or(context.window[1], |touch| touch.distance),
        error: ErrorBar::new(mean, overlap, context.spacing),
        overlap,
        touched,
        torn: found.torn,
        mean,
        median,
        recovery: found.recovery,
        tool,
        normal_force,
        strips: strips.finish(&context),
        stress: stress.finish(),
        snapshots,
    })
}

#[cfg(test)]
mod tests;
