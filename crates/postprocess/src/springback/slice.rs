//! The first pass of a cut in space as a plane cut: a slice along the cut through the tool's lowest point,
//! its groove laid flat.
//!
//! ```text
//! x' = x . cutting,   y' = x . up - (p(z) - p(z_tip)),   |z - z_tip| <= 3 dx,   z = x . feed
//! ```
//! p(z) is the lowest line of the tool's shadow along the cut, so that the swept surface of the tool becomes the
//! plane y' = p(z_tip) and heights above it are springback as in the plane. They are taken along the depth, not
//! along the normal: with a nose of 0.8 mm and a slice of +-60 um the difference is 0.3 % of the height at its rim.
//! Contact forces are divided by the spacing: in space a particle covers a spacing of width.

use super::error::SpringbackError;
use crate::cloud::CutPlane;
use crate::geometry::uncut_surface;
use crate::result::ProcessResult;
use sphcut_record::{Facts, Run, Samples, Snapshots};
use sphcut_sph::setup::{CuttingFrame, Vector};
use sphcut_sph::{ChannelId, Snapshot};

/// Half of the width of the slice in spacings.
const HALF_WIDTH: f64 = 3.0;
/// Places across the slice at which the tool's lowest line is known.
const PLACES: usize = 61;

/// A plane run, and the travel from which on the forces of the pass are steady.
pub(super) struct Slice {
    pub run: Run,
    pub window_start: f64,
}

/// Directions of the cut in space, right-handed: along it, up, along the feed.
struct Axes([Vector; 3]);

impl Axes {
    fn of(frame: &CuttingFrame) -> Self {
        Self([frame.cutting, frame.passive.map(|component| -component), frame.feed])
    }

    fn place(&self, vector: &Vector) -> Vector {
        std::array::from_fn(|k| dot(vector, &self.0[k]))
    }

    /// A symmetric tensor xx, yy, zz, xy, yz, xz in these directions.
    fn turned(&self, stress: &[f64; 6]) -> [f64; 6] {
        let [xx, yy, zz, xy, yz, xz] = *stress;
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let on =
            |direction: &Vector| -> Vector { std::array::from_fn(|k| dot(&rows[k], direction)) };
        let part = |a: usize, b: usize| dot(&self.0[a], &on(&self.0[b]));
        [part(0, 0), part(1, 1), part(2, 2), part(0, 1), part(1, 2), part(0, 2)]
    }
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The first pass of `run` as a plane run.
///
/// # Errors
/// No cut, no snapshots, a snapshot that cannot be read.
pub(super) fn first_pass(run: &Run, result: &ProcessResult) -> Result<Slice, SpringbackError> {
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
    let profile = Profile::of(&first, &axes, spacing).ok_or(SpringbackError::NoCut)?;
    let end = run.facts.passes.first().map_or(f64::INFINITY, |pass| pass.end * (1.0 + 1e-9));
    let mut slices = Vec::new();
    for number in 0..run.snapshots.len() {
        if run.snapshots.index()[number].time > end {
            break;
        }
        slices.push(profile.slice(&*run.snapshots.get(number)?, &axes, spacing));
    }
    let uncut = uncut_surface(&slices[0], CutPlane::new(CuttingFrame::default()));
    let depth = uncut - profile.tip[1];
    let speed = run.facts.cutting_speed();
    let facts = Facts {
        dimension: 2,
        uncut_chip_thickness: Some(depth),
        tool_velocity: Some([speed, 0.0, 0.0]),
        frame: CuttingFrame::default(),
        passes: Vec::new(),
        ..run.facts.clone()
    };
    let time = run.samples.channel(ChannelId::Time);
    let count = time.partition_point(|time| *time <= end);
    let columns = run.samples.columns().iter().map(|column| column[..count].to_vec()).collect();
    let samples = Samples::from_columns(columns).expect("columns cut to one length");
    let window_start = result.passes.first().map_or(result.window.start, |pass| pass.window.start);
    let snapshots = Snapshots::in_memory(slices);
    let run = Run {
        provenance: run.provenance.clone(),
        facts,
        samples,
        snapshots,
        performance: run.performance,
        outcome: run.outcome.clone(),
    };
    Ok(Slice { run, window_start })
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
    /// Of the tool's triangles in `snapshot`; `None` without any.
    fn of(snapshot: &Snapshot, axes: &Axes, spacing: f64) -> Option<Self> {
        let corners: Vec<Vector> = snapshot.tool.iter().map(|corner| axes.place(corner)).collect();
        let tip = *corners.iter().min_by(|a, b| a[1].total_cmp(&b[1]))?;
        let half_width = HALF_WIDTH * spacing;
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

    /// Height above the tip at a distance from it along the feed.
    fn height(&self, distance: f64) -> f64 {
        let place = (distance / self.half_width + 1.0) * 0.5 * (PLACES - 1) as f64;
        let below = (place.max(0.0) as usize).min(PLACES - 2);
        let share = place - below as f64;
        self.heights[below] + share * (self.heights[below + 1] - self.heights[below])
    }

    fn slice(&self, snapshot: &Snapshot, axes: &Axes, spacing: f64) -> Snapshot {
        let mut slice = Snapshot {
            time: snapshot.time,
            step: snapshot.step,
            dimension: 2,
            particle_spacing: spacing,
            ..Snapshot::default()
        };
        let lowest = snapshot
            .tool
            .iter()
            .map(|corner| axes.place(corner))
            .min_by(|a, b| a[1].total_cmp(&b[1]));
        slice.tool.extend(lowest.map(|tip| [tip[0], tip[1], 0.0]));
        for index in 0..snapshot.position.len() {
            let [x, y, z] = axes.place(&snapshot.position[index]);
            let distance = z - self.tip[2];
            if distance.abs() > self.half_width {
                continue;
            }
            slice.id.push(snapshot.id[index]);
            slice.position.push([x, y - self.height(distance), 0.0]);
            slice.stress.push(axes.turned(&snapshot.stress[index]));
            let [fx, fy, _] = axes.place(&snapshot.contact_force[index]);
            slice.contact_force.push([fx / spacing, fy / spacing, 0.0]);
        }
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
        let place = |x: f64, y: f64, across: f64| [y + nose(across), across, x];
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
                    lifted.position.push(place(x, y, across));
                    lifted.stress.push([yy, zz, xx, 0.0, 0.0, xy]);
                    let [fx, fy, _] = snapshot.contact_force[index];
                    lifted.contact_force.push([fy * spacing, 0.0, fx * spacing]);
                }
            }
            // Strips of the tool's lowest line, and far points above.
            let tip = snapshot.tool[0];
            for k in -100..100 {
                let [from, to] = [f64::from(k), f64::from(k + 1)].map(|k| k * 1e-6);
                lifted.tool.extend([
                    place(tip[0], tip[1], from),
                    place(tip[0], tip[1], to),
                    place(tip[0] - 1e-3, tip[1] + 1e-3, to),
                ]);
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
        let plane = cut.run(1.2e-3, 41);
        let expected = measure(&plane, &evaluate(&plane).unwrap()).unwrap();
        let run = groove(&plane);
        let found = measure(&run, &evaluate(&run).unwrap()).unwrap();
        // The chords of the drawn tool, 1 um long, stay within 0.2 nm of its arc.
        let mean = found.mean.unwrap().mean;
        assert!((mean - 1e-6).abs() < 1e-9, "{mean}");
        // Rows -3 to 3 of the nine: seven times as many particles.
        assert_eq!(found.touched.len(), 7 * expected.touched.len());
        assert!((found.clear_distance - expected.clear_distance).abs() < 2e-6);
        assert!((found.error.overlap - expected.error.overlap).abs() < 1e-12);
        for (bin, same) in found.stress.iter().zip(&expected.stress) {
            assert!((bin.cutting - same.cutting).abs() < 5e6, "{bin:?} {same:?}");
            assert!((bin.normal - same.normal).abs() < 5e6, "{bin:?} {same:?}");
        }
        assert!(!found.stress.is_empty());
    }
}
