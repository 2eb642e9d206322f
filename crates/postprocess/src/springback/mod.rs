//! Springback of the machined surface, and the residual stress below it; in space of the first pass, by
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
//! *touching* the lowest part of the tool: of them it is known that they were at the tool's
//! surface, whatever the rows look like. They are followed by their identifier. The outermost
//! particles of strips two spacings wide, touched or not, give the roughness and a second figure,
//! [`Springback::strips`], that depends on the width of the strips and is no springback.
//!
//! **What it is worth**: see [`ErrorBar`]. Neglected: thermal expansion (the solver has none).

mod compare;
mod error;
mod files;
mod median;
mod residual;
mod slice;
mod strips;
mod touched;

pub use compare::{Agreement, Comparison, Measurement};
pub use error::{ErrorBar, RESOLUTION_SHARE, SpringbackError};
pub use files::{Entry, SCHEMA_VERSION, springback_csv, springback_json};
pub use median::MedianInterval;
pub use residual::StressBin;
pub use strips::{Strips, outer_heights};
pub use touched::{RecoveryBin, Touched};

use crate::cloud::{Cloud, CutPlane, Point};
use crate::process::ProcessResult;
use crate::steady::{MeanInterval, autocorrelation_time, mean_interval};
use residual::StressProfile;
use sphcut_record::Run;
use sphcut_sph::{ChannelId, Snapshot};
use touched::Followed;

/// Left out at the entry, in spacings.
const ENTRY: f64 = 4.0;
/// The shortest window that a mean is taken over, in spacings: ten strips of two.
const PLANE_WINDOW: f64 = 20.0;
/// The same for the slice of a cut in space, which is six spacings wide.
const SLICE_WINDOW: f64 = 10.0;

/// Springback and residual stress of one run. Lengths in m, stress in Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct Springback {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// dx.
    pub particle_spacing: f64,
    /// Length of the machined surface behind the tool that is left out: the larger of edge radius
    /// and three spacings, plus the uncut chip thickness, over which the stress under the tool
    /// fades.
    pub clear_distance: f64,
    /// The cutting distances over which means are taken: from the window of the forces on, at least
    /// four spacings, to the clear distance behind the tool at the end.
    pub window: [f64; 2],
    /// Particles that have touched the lowest part of the tool and lie clear of it, in the order of
    /// the cutting distance.
    pub touched: Vec<Touched>,
    /// Touched particles that lie further than 1.5 spacings from the tool's lowest plane: torn out.
    pub torn: usize,
    /// Mean springback over the window with its 95 % interval; `None` without a touched particle.
    pub mean: Option<MeanInterval>,
    /// Median over the same window: unlike the mean it does not follow a crumb that stands up from the surface.
    pub median: Option<MedianInterval>,
    /// The same particles against the distance behind the tool.
    pub recovery: Vec<RecoveryBin>,
    /// The outermost particles.
    pub strips: Strips,
    /// Residual stress against depth.
    pub stress: Vec<StressBin>,
    /// What the mean is worth.
    pub error: ErrorBar,
    /// Snapshots that were used.
    pub snapshots: usize,
}

impl Springback {
    /// Number of touched particles that the mean is taken over.
    #[must_use]
    pub fn in_window(&self) -> usize {
        self.touched.iter().filter(|touch| touch.distance >= self.window[0]).count()
    }
}

/// Where the tool is lowest in one snapshot, in the frame of the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lowest {
    /// Height of the lowest point.
    pub height: f64,
    /// Rear end of the lowest side (a wear land) or the lowest corner.
    pub rear: f64,
    /// Its front end.
    pub front: f64,
}

impl Lowest {
    /// Heights within a ten-thousandth of a spacing of the lowest are lowest: far above rounding,
    /// and below the first chord of any edge that is resolved at all.
    fn of(corners: &[Point], spacing: f64) -> Option<Self> {
        let height = corners.iter().map(|corner| corner[1]).min_by(f64::total_cmp)?;
        let level = height + 1e-4 * spacing;
        let side = corners.iter().filter(|corner| corner[1] <= level).map(|corner| corner[0]);
        let (rear, front) = side
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        Some(Self { height, rear, front })
    }
}

/// What is the same for all snapshots.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context {
    pub plane: CutPlane,
    pub spacing: f64,
    /// Position along the cutting direction at which the cut begins.
    pub origin: f64,
    pub clear_distance: f64,
    /// Distance from the lowest side within which a touch counts.
    pub reach: f64,
    pub uncut_chip_thickness: f64,
    /// Cutting distances of the window.
    pub window: [f64; 2],
}

/// A snapshot with what every measure needs of it.
pub(crate) struct View<'a> {
    pub snapshot: &'a Snapshot,
    pub cloud: &'a Cloud,
    pub lowest: Lowest,
}

/// Measures springback and residual stress of `run`, evaluated as `result`.
///
/// # Errors
/// A plane run of several passes, one that is no cut, one too short to leave a machined surface clear of
/// the tool, a snapshot that cannot be read.
pub fn measure(run: &Run, result: &ProcessResult) -> Result<Springback, SpringbackError> {
    if run.facts.dimension == 3 {
        let slice = slice::first_pass(run, result)?;
        return measure_plane(&slice.run, slice.window_start, SLICE_WINDOW);
    }
    measure_plane(run, result.window.start, PLANE_WINDOW)
}

fn measure_plane(
    run: &Run,
    window_start: f64,
    least_window: f64,
) -> Result<Springback, SpringbackError> {
    let context = context(run, window_start, least_window)?;
    let mut followed = Followed::default();
    let mut strips = strips::Collector::new(&context);
    let mut stress = StressProfile::new(run, &context);
    let mut snapshots = 0;
    for number in 0..run.snapshots.len() {
        let snapshot = run.snapshots.get(number)?;
        let cloud = Cloud::new(&snapshot, context.plane);
        let corners: Vec<Point> = snapshot.tool.iter().map(|c| context.plane.project(c)).collect();
        let Some(lowest) = Lowest::of(&corners, context.spacing) else { continue };
        let view = View { snapshot: &snapshot, cloud: &cloud, lowest };
        followed.visit(&view, &context);
        strips.visit(&view, &context);
        stress.visit(&view, &context);
        snapshots += 1;
    }
    let found = followed.finish(&context);
    let in_window: Vec<f64> = found
        .touched
        .iter()
        .filter(|touch| touch.distance >= context.window[0])
        .map(|touch| touch.springback)
        .collect();
    let all: Vec<f64> = found.touched.iter().map(|touch| touch.springback).collect();
    let mean = (!in_window.is_empty())
        .then(|| mean_interval(&in_window, Some(autocorrelation_time(&all))));
    let median = median::median_interval(&in_window, &all);
    Ok(Springback {
        cutting_speed: run.facts.cutting_speed(),
        particle_spacing: context.spacing,
        clear_distance: context.clear_distance,
        window: context.window,
        error: ErrorBar::new(run, found.contact_force, mean, context.spacing),
        touched: found.touched,
        torn: found.torn,
        mean,
        median,
        recovery: found.recovery,
        strips: strips.finish(&context),
        stress: stress.finish(),
        snapshots,
    })
}

fn context(run: &Run, window_start: f64, least_window: f64) -> Result<Context, SpringbackError> {
    let facts = &run.facts;
    if !facts.passes.is_empty() {
        return Err(SpringbackError::SeveralPasses);
    }
    let Some(thickness) = facts.uncut_chip_thickness.filter(|_| ProcessResult::is_cut(run)) else {
        return Err(SpringbackError::NoCut);
    };
    let last = run.snapshots.last()?.ok_or(SpringbackError::NoSnapshots)?;
    let (plane, spacing) = (CutPlane::new(facts.frame), facts.particle_spacing);
    let corners: Vec<Point> = last.tool.iter().map(|c| plane.project(c)).collect();
    let lowest = Lowest::of(&corners, spacing).ok_or(SpringbackError::NoCut)?;
    let cloud = Cloud::new(&last, plane);
    let first = cloud.points.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let travel = run.samples.channel(ChannelId::Travel).last().copied().unwrap_or(0.0);
    let origin = first.max(lowest.rear - travel);
    let radius = facts.edge_radius.unwrap_or(0.0);
    let clear_distance = radius.max(3.0 * spacing) + thickness;
    let start = window_start.max(ENTRY * spacing);
    let end = lowest.rear - clear_distance - origin;
    let least = (ENTRY + least_window) * spacing;
    if end.partial_cmp(&least) != Some(std::cmp::Ordering::Greater) {
        // What the tool had to go before it cut (its gap, its edge) is in the travel.
        let needed = travel + (least - end);
        return Err(SpringbackError::TooShort { travel, needed });
    }
    Ok(Context {
        plane,
        spacing,
        origin,
        clear_distance,
        reach: radius.max(spacing),
        uncut_chip_thickness: thickness,
        window: [start.min(end - least_window * spacing), end],
    })
}

#[cfg(test)]
mod tests;
