//! What is the same for all snapshots, and what every measure needs of one.

use super::error::SpringbackError;
use crate::cloud::{CutParticles, CutPlane, PlanePoint};
use crate::result::ProcessResult;
use sphcut_record::Run;
use sphcut_sph::{ChannelId, Snapshot};

/// Left out at the entry, in spacings.
const ENTRY: f64 = 4.0;

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
    pub fn of(corners: &[PlanePoint], spacing: f64) -> Option<Self> {
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
    /// Cutting distance that is left out at the entry.
    pub entry: f64,
    /// Cutting distances of the window.
    pub window: [f64; 2],
}

/// A snapshot with what every measure needs of it.
pub(crate) struct SnapshotView<'a> {
    pub snapshot: &'a Snapshot,
    pub cloud: &'a CutParticles,
    /// Of the tool.
    pub corners: &'a [PlanePoint],
    pub lowest: Lowest,
}

impl SnapshotView<'_> {
    /// Height of the tool's lower side at `x` along the cut; infinite beside it.
    pub fn under_side(&self, x: f64) -> f64 {
        let next = |k: usize| self.corners[(k + 1) % self.corners.len()];
        let heights = self.corners.iter().enumerate().filter_map(|(k, &from)| {
            let to = next(k);
            let share = (x - from[0]) / (to[0] - from[0]);
            (0.0..=1.0).contains(&share).then_some(from[1] + share * (to[1] - from[1]))
        });
        heights.fold(f64::INFINITY, f64::min)
    }
}

/// The context of a run.
///
/// # Errors
/// No cut, no snapshots, a cut or a moving window that leaves too little machined surface.
pub(super) fn context(
    run: &Run,
    window_start: f64,
    least_window: f64,
) -> Result<Context, SpringbackError> {
    let facts = &run.facts;
    let Some(thickness) = facts.uncut_chip_thickness.filter(|_| ProcessResult::is_cut(run)) else {
        return Err(SpringbackError::NoCut);
    };
    let last = run.snapshots.last()?.ok_or(SpringbackError::NoSnapshots)?;
    let begin = run.snapshots.get(0)?;
    let (plane, spacing) = (CutPlane::new(facts.frame), facts.particle_spacing);
    let corners: Vec<PlanePoint> = last.tool.iter().map(|c| plane.project(c)).collect();
    let lowest = Lowest::of(&corners, spacing).ok_or(SpringbackError::NoCut)?;
    let cloud = CutParticles::new(&last, plane);
    let rearmost =
        |cloud: &CutParticles| cloud.points.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let mut first = rearmost(&cloud);
    let at_begin = rearmost(&CutParticles::new(&begin, plane));
    // What a moving window has given up behind the tool, a cut does not push so far.
    let windowed = first > at_begin + ENTRY * spacing;
    let kept = lowest.rear - first;
    if windowed {
        first = at_begin;
    }
    let travel = run.samples.channel(ChannelId::Travel).last().copied().unwrap_or(0.0);
    let origin = first.max(lowest.rear - travel);
    let radius = facts.edge_radius.unwrap_or(0.0);
    let clear_distance = radius.max(3.0 * spacing) + thickness;
    let least_kept = clear_distance + ENTRY * spacing;
    if windowed && kept < least_kept {
        return Err(SpringbackError::WindowTooShort { kept, needed: least_kept });
    }
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
        entry: ENTRY * spacing,
        window: [start.min(end - least_window * spacing), end],
    })
}
