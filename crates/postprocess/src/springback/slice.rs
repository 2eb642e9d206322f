//! A cut in space as a plane cut: a slice along the cut through the tool's lowest point,
//! its groove laid flat.
//!
//! ```text
//! x' = x . cutting,   y' = y_tip + (x . up - p(z)) cos(theta(z)),   |z - z_tip| <= w,   z = x . feed,   tan(theta) = dp/dz
//! ```
//! p(z) is the lowest line of the tool's shadow along the cut, so that the swept surface of the tool becomes the
//! plane y' = y_tip and heights above it are springback along the normal of the groove. w is where the line has risen by a
//! tenth of the depth, three spacings at least: there the groove was cut about as deep as at its lowest line.
//! Contact forces are divided by the spacing: in space a particle covers a spacing of width.

use super::error::SpringbackError;
use crate::cloud::CutPlane;
use crate::geometry::uncut_surface;
use crate::result::ProcessResult;
use crate::space::Axes;
use sphcut_record::{Facts, Run, Snapshots};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::{CuttingFrame, Vector};

/// Least half of the width of the slice in spacings.
const LEAST_HALF_WIDTH: f64 = 3.0;
/// Share of the depth by which the tool's lowest line rises across half of the slice.
const RISE: f64 = 0.1;
/// Places across the slice at which the tool's lowest line is known.
const PLACES: usize = 121;

/// The middle of the groove that `run` cuts, as a plane run.
///
/// # Errors
/// No cut, no snapshots, a snapshot that cannot be read.
pub(super) fn middle_of_groove(run: &Run) -> Result<Run, SpringbackError> {
    if !ProcessResult::is_cut(run) {
        return Err(SpringbackError::NoCut);
    }
    let first = if run.snapshots.is_empty() {
        return Err(SpringbackError::NoSnapshots);
    } else {
        run.snapshots.get(0)?
    };
    let axes = Axes::of(&run.facts.frame);
    let spacing = run.facts.particle_spacing;
    let middle = Profile::of(&first, &axes, LEAST_HALF_WIDTH * spacing);
    let middle = middle.ok_or(SpringbackError::NoCut)?;
    let slice = middle.slice(&first, &axes, spacing);
    let depth = uncut_surface(&slice, CutPlane::new(CuttingFrame::default())) - middle.tip[1];
    let profile = middle.widened(&first, &axes, RISE * depth);
    let mut slices = Vec::new();
    for number in 0..run.snapshots.len() {
        slices.push(profile.slice(&*run.snapshots.get(number)?, &axes, spacing));
    }
    let speed = run.facts.cutting_speed();
    let facts = Facts {
        dimension: 2,
        uncut_chip_thickness: Some(depth),
        tool_velocity: Some([speed, 0.0, 0.0]),
        frame: CuttingFrame::default(),
        ..run.facts.clone()
    };
    Ok(Run {
        provenance: run.provenance.clone(),
        facts,
        samples: run.samples.clone(),
        snapshots: Snapshots::in_memory(slices),
        performance: run.performance,
        outcome: run.outcome.clone(),
    })
}

/// The lowest line of the tool's shadow near its lowest point.
struct Profile {
    /// The lowest point in the directions of the cut.
    tip: Vector,
    half_width: f64,
    /// Height above the tip at [`PLACES`] places from -`half_width` to `half_width`.
    heights: Vec<f64>,
}

impl Profile {
    /// Of the tool's triangles in `snapshot`, to `half_width` on both sides of its lowest point; `None` where it ends before.
    fn of(snapshot: &Snapshot, axes: &Axes, half_width: f64) -> Option<Self> {
        let corners: Vec<Vector> = snapshot.tool.iter().map(|corner| axes.place(corner)).collect();
        let tip = *corners.iter().min_by(|a, b| a[1].total_cmp(&b[1]))?;
        let sides: Vec<[Vector; 2]> = corners
            .chunks_exact(3)
            .flat_map(|c| [[c[0], c[1]], [c[1], c[2]], [c[2], c[0]]])
            .filter(|[a, b]| {
                a[2].min(b[2]) <= tip[2] + half_width && a[2].max(b[2]) >= tip[2] - half_width
            })
            .collect();
        let heights = (0..PLACES)
            .map(|k| {
                let place = 2.0 * k as f64 / (PLACES - 1) as f64 - 1.0;
                let z = tip[2] + half_width * place;
                let found = sides.iter().filter_map(|side| height(side, z));
                found.reduce(f64::min).map(|lowest| lowest - tip[1])
            })
            .collect::<Option<Vec<f64>>>()?;
        Some(Self { tip, half_width, heights })
    }

    /// As wide as its line rises by `rise` at most.
    fn widened(self, snapshot: &Snapshot, axes: &Axes, rise: f64) -> Self {
        let wider = |half_width: f64| {
            let profile = Self::of(snapshot, axes, half_width)?;
            profile.heights.iter().all(|height| *height <= rise).then_some(profile)
        };
        // A nose rises by the square of the way along it.
        let mut found = self;
        while let Some(next) = wider(1.1 * found.half_width) {
            found = next;
        }
        found
    }

    /// Height above the tip at a distance from it along the feed, and the cosine of the line's slope there.
    fn line(&self, distance: f64) -> (f64, f64) {
        let step = 2.0 * self.half_width / (PLACES - 1) as f64;
        let place = (distance + self.half_width) / step;
        let below = (place.max(0.0) as usize).min(PLACES - 2);
        let change = self.heights[below + 1] - self.heights[below];
        (self.heights[below] + (place - below as f64) * change, step / step.hypot(change))
    }

    fn slice(&self, snapshot: &Snapshot, axes: &Axes, spacing: f64) -> Snapshot {
        let flat = |[x, y, z]: Vector| {
            let distance = z - self.tip[2];
            (distance.abs() <= self.half_width).then(|| {
                let (line, cosine) = self.line(distance);
                ([x, self.tip[1] + (y - self.tip[1] - line) * cosine], 1.0 / spacing)
            })
        };
        let (mut slice, _) = axes.section(snapshot, flat);
        slice.tool = axes.tool_section(snapshot, self.tip[2]).unwrap_or_default();
        slice
    }
}

/// Height of a side at `z`, if it reaches there.
fn height([a, b]: &[Vector; 2], z: f64) -> Option<f64> {
    let (low, high) = if a[2] <= b[2] { (a, b) } else { (b, a) };
    if z < low[2] || z > high[2] {
        return None;
    }
    let width = high[2] - low[2];
    if width <= 0.0 {
        return Some(low[1].min(high[1]));
    }
    Some(low[1] + (z - low[2]) / width * (high[1] - low[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate;
    use crate::springback::measure;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::setup::Pass;

    const RADIUS: f64 = 0.8e-3;

    /// Height of the nose above its lowest line.
    fn nose(z: f64) -> f64 {
        RADIUS - (RADIUS * RADIUS - z * z).sqrt()
    }

    /// The drawn plane cut as a groove in space, with the directions turned round: cutting along z, up along x,
    /// the feed along y. Each particle stands for nine across the groove.
    fn groove(plane: &Run) -> Run {
        let spacing = plane.facts.particle_spacing;
        // Heights above the tool's lowest line along the normal of the groove.
        let bottom = -plane.facts.uncut_chip_thickness.unwrap();
        let place = |x: f64, y: f64, across: f64| {
            let (sine, cosine) = ((across / RADIUS), (1.0 - (across / RADIUS).powi(2)).sqrt());
            let above = y - bottom;
            [bottom + nose(across) + above * cosine, across - above * sine, x]
        };
        let rows: Vec<f64> = (-4..=4).map(|row| f64::from(row) * spacing).collect();
        let lift = |snapshot: &Snapshot| {
            let mut lifted = Snapshot {
                time: snapshot.time,
                step: snapshot.step,
                dimension: 3,
                particle_spacing: spacing,
                ..Snapshot::default()
            };
            for (row, &across) in rows.iter().enumerate() {
                for index in 0..snapshot.position.len() {
                    let [x, y, _] = snapshot.position[index];
                    let [xx, yy, zz, xy, ..] = snapshot.stress[index];
                    lifted.id.push(snapshot.id[index] * 10 + row as u64);
                    // Flat cells: their centres lie higher, the surface does not.
                    lifted.position.push(place(x, y + 0.2 * spacing, across));
                    lifted.stress.push([yy, zz, xx, 0.0, 0.0, xy]);
                    let [u, v, _] = snapshot.velocity[index];
                    lifted.velocity.push([v, 0.0, u]);
                    lifted.plastic_strain_rate.push(snapshot.plastic_strain_rate[index]);
                    lifted.temperature.push(snapshot.temperature[index]);
                    lifted.contact_area.push(snapshot.contact_area[index] * spacing);
                    lifted.friction_use.push(snapshot.friction_use[index]);
                    lifted.shear_friction_factor.push(snapshot.shear_friction_factor[index]);
                    let [fx, fy, _] = snapshot.contact_force[index];
                    lifted.contact_force.push([fy * spacing, 0.0, fx * spacing]);
                    lifted.half_thickness.push(snapshot.half_thickness[index] - 0.2 * spacing);
                }
            }
            // The tool's outline along the arc of the groove.
            for (k, from) in snapshot.tool.iter().enumerate() {
                let to = snapshot.tool[(k + 1) % snapshot.tool.len()];
                for chord in -100..100 {
                    let [low, high] = [f64::from(chord), f64::from(chord + 1)].map(|k| k * 1e-6);
                    let corner =
                        |end: &Vector, across: f64| [end[1] + nose(across), across, end[0]];
                    let [a, b, c, d] = [
                        corner(from, low),
                        corner(&to, low),
                        corner(&to, high),
                        corner(from, high),
                    ];
                    lifted.tool.extend([a, b, c, a, c, d]);
                }
            }
            lifted
        };
        let slices: Vec<Snapshot> =
            (0..plane.snapshots.len()).map(|k| lift(&plane.snapshots.get(k).unwrap())).collect();
        let mut facts = plane.facts.clone();
        facts.dimension = 3;
        facts.frame = CuttingFrame {
            cutting: [0.0, 0.0, 1.0],
            feed: [0.0, 1.0, 0.0],
            passive: [-1.0, 0.0, 0.0],
        };
        facts.tool_velocity = Some([0.0, 0.0, plane.facts.cutting_speed()]);
        facts.passes = vec![
            Pass { start: 0.0, end: facts.end_time },
            Pass { start: 2.0 * facts.end_time, end: 3.0 * facts.end_time },
        ];
        Run {
            provenance: plane.provenance.clone(),
            facts,
            samples: plane.samples.clone(),
            snapshots: Snapshots::in_memory(slices),
            performance: plane.performance,
            outcome: plane.outcome.clone(),
        }
    }

    #[test]
    fn a_groove_has_the_springback_of_the_plane_cut_it_is_drawn_from() {
        let cut = SyntheticCut {
            length: 1.5e-3,
            height: 0.3e-3,
            flank_force: 14e3,
            springback: 1e-6,
            disorder: 0.0,
            residual_stress: -300e6,
            ..SyntheticCut::default()
        };
        let plane = cut.run(1.2e-3, 43);
        let expected = measure(&plane, &evaluate(&plane).unwrap()).unwrap();
        let run = groove(&plane);
        let found = measure(&run, &evaluate(&run).unwrap()).unwrap();
        // The chords of the drawn tool, 1 um long, stay within 0.2 nm of its arc.
        let mean = found.mean.unwrap().mean;
        assert!((mean - 1e-6).abs() < 1e-9, "{mean}");
        // All nine rows.
        assert_eq!(found.touched.len(), 9 * expected.touched.len());
        assert!((found.clear_distance - expected.clear_distance).abs() < 2e-6);
        assert!((found.overlap.mean - expected.overlap.mean).abs() < 1e-9);
        for (bin, same) in found.stress.iter().zip(&expected.stress) {
            assert!((bin.cutting - same.cutting).abs() < 5e6, "{bin:?} {same:?}");
            assert!((bin.normal - same.normal).abs() < 5e6, "{bin:?} {same:?}");
        }
        assert!(!found.stress.is_empty());
    }
}
