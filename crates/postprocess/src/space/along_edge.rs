//! Chip and contact of a cut in space, in sections along its cutting edge.
//!
//! The edge in engagement is the part of the tool's shadow along the cut that lies below the surface before the cut. Sections
//! are planes along the cut and normal to the chord of that part: the chip leaves about along them (Colwell, Trans. ASME 76
//! (1954) 199). In each the cut is taken as a plane one: the particles nearer to it than w, two spacings, are laid onto it, each
//! for the area `(1 - |z| / w) / w` times its volume, so that it hardly matters how their columns stand to it; the tool where the plane meets it; the uncut chip thickness from the tool's lowest
//! point up to the surface before the cut, both in the section. What is measured in it is what a plane cut is measured by
//! ([`crate::geometry`]).
//!
//! **Limits.** A chip that turns aside from the normal of the chord, or curls out of the plane, is cut obliquely and seems
//! thicker. One pass into a block at rest; a section whose uncut chip is thinner than two spacings has no chip thickness.

use super::section::Axes;
use crate::cloud::CutPlane;
use crate::forces::SteadyWindow;
use crate::geometry::{self, AlongEdge, EdgeSection, Geometry, uncut_surface};
use crate::missing::Missing;
use crate::result::ProcessResult;
use crate::statistics::{mean, median};
use sphcut_record::{Facts, Run, RunError, Snapshots};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::{CuttingFrame, Vector};
use std::collections::BTreeMap;

/// Sections along the edge.
const SECTIONS: usize = 9;
/// Distance of a section in spacings from which on a particle does not count in it.
const SLAB: f64 = 2.0;
/// Most snapshots of the window that are measured.
const MOST_SNAPSHOTS: usize = 12;
/// Least uncut chip thickness of a chip in spacings.
const THINNEST: f64 = 2.0;
/// Heights that differ by less than this share of the slab are one: far above rounding.
const LEVEL: f64 = 1e-6;
/// Places along the feed at which the engagement is looked for.
const PLACES: usize = 200;

/// The section of the largest uncut chip thickness as the geometry of a plane cut, and all along the edge.
pub(crate) fn measure(run: &Run, window: &SteadyWindow) -> Result<Geometry, RunError> {
    if !ProcessResult::is_cut(run) {
        return Ok(Geometry::without(&Missing::NoCut));
    }
    if run.snapshots.is_empty() {
        return Ok(Geometry::without(&Missing::NoSnapshots));
    }
    let first = run.snapshots.get(0)?;
    let axes = Axes::of(&run.facts.frame);
    let Some(engagement) = Engagement::of(&first, &axes) else {
        return Ok(Geometry::without(&Missing::NoRakeFace));
    };
    let numbers = chosen(run, window);
    let across = engagement.axes(&axes);
    let mut along = AlongEdge { uncut_section: engagement.section, ..AlongEdge::default() };
    let mut areas = Vec::new();
    for &number in &numbers[1..] {
        let snapshot = run.snapshots.get(number)?;
        areas.push(snapshot.contact_area.iter().sum::<f64>());
    }
    along.contact_area = Some(mean(&areas)).filter(|area| area.is_finite());
    let mut deepest: Option<(f64, Geometry)> = None;
    for place in engagement.places() {
        let mut plane = Vec::new();
        for &number in &numbers {
            let snapshot = run.snapshots.get(number)?;
            plane.extend(section(&snapshot, &across, place, engagement.ends()));
        }
        if plane.len() < numbers.len() {
            continue;
        }
        let low = lowest(&plane[0]);
        let thickness = uncut_surface(&plane[0], CutPlane::new(CuttingFrame::default())) - low;
        if thickness <= 0.0 {
            continue;
        }
        let plane = as_plane(run, plane, thickness);
        let mut found = geometry::measure(&plane, window)?;
        // A slab of two spacings has crumbs that hang on to what lies beside it.
        found.loose_particles = 0;
        if thickness < THINNEST * run.facts.particle_spacing {
            found.chip = Err(Missing::ThinSection);
            found.shear_angle = Err(Missing::ThinSection);
        }
        along.sections.push(EdgeSection {
            place: engagement.feed(low, place) - engagement.tip,
            uncut_chip_thickness: thickness,
            chip: found.chip.clone(),
            shear_angle: found.shear_angle.clone(),
            contact: found.contact.clone(),
        });
        if deepest.as_ref().is_none_or(|(largest, _)| thickness > *largest) {
            let last = plane.snapshots.last()?;
            along.deepest = last.map(|last| (plane.facts.clone(), (*last).clone()));
            deepest = Some((thickness, found));
        }
    }
    let geometry = deepest.map(|(_, geometry)| geometry);
    Ok(Geometry {
        along_edge: Some(along),
        ..geometry.unwrap_or_else(|| Geometry::without(&Missing::NoRakeFace))
    })
}

/// The first snapshot, then some of the window, the last one among them.
fn chosen(run: &Run, window: &SteadyWindow) -> Vec<usize> {
    let index = run.snapshots.index();
    let last = index.len() - 1;
    let from = index.iter().position(|info| info.time >= window.start_time).unwrap_or(last).max(1);
    let from = from.min(last);
    let step = ((last - from) / MOST_SNAPSHOTS + 1).max(1);
    let mut numbers: Vec<usize> = (from..=last).rev().step_by(step).collect();
    numbers.push(0);
    numbers.reverse();
    numbers
}

/// A plane section of a snapshot whose cut has these `ends` across; `None` where it misses the tool.
fn section(snapshot: &Snapshot, across: &Axes, place: f64, ends: [f64; 2]) -> Option<Snapshot> {
    let reach = SLAB * snapshot.particle_spacing;
    // How much of the weight lies before `end`: beyond the ends there is no material that could count.
    let before = |end: f64| {
        let way = ((end - place) / reach).clamp(-1.0, 1.0);
        0.5 + way - 0.5 * way * way.abs()
    };
    let whole = before(ends[1]) - before(ends[0]);
    let counted = |z: f64| (1.0 - (z - place).abs() / reach) / reach / whole;
    let inside = |[x, y, z]: Vector| Some(([x, y], counted(z))).filter(|(_, share)| *share > 0.0);
    let (mut plane, counted) = across.section(snapshot, inside);
    let area = |(i, share): (usize, f64)| share * plane.spacing_at(i).powi(3);
    plane.plane_area = counted.into_iter().enumerate().map(area).collect();
    plane.tool = across.tool_section(snapshot, place)?;
    Some(plane)
}

fn lowest(plane: &Snapshot) -> f64 {
    plane.tool.iter().map(|corner| corner[1]).fold(f64::INFINITY, f64::min)
}

/// Sections as a plane run with this uncut chip thickness.
fn as_plane(run: &Run, snapshots: Vec<Snapshot>, thickness: f64) -> Run {
    let facts = Facts {
        dimension: 2,
        particle_spacing: snapshots[0].particle_spacing,
        uncut_chip_thickness: Some(thickness),
        tool_velocity: Some([run.facts.cutting_speed(), 0.0, 0.0]),
        frame: CuttingFrame::default(),
        ..run.facts.clone()
    };
    Run {
        provenance: run.provenance.clone(),
        facts,
        samples: run.samples.clone(),
        snapshots: Snapshots::in_memory(snapshots),
        performance: run.performance,
        outcome: run.outcome.clone(),
    }
}

/// Where the tool's shadow lies below the surface before the cut. Points are (up, along the feed) in m.
struct Engagement {
    from: [f64; 2],
    /// Unit vector from one end to the other, and their distance.
    chord: [f64; 2],
    length: f64,
    /// The lowest point along the feed.
    tip: f64,
    /// Area between shadow and surface in m^2.
    section: f64,
}

impl Engagement {
    fn of(first: &Snapshot, axes: &Axes) -> Option<Self> {
        let width = SLAB * first.particle_spacing;
        let corners: Vec<Vector> = first.tool.iter().map(|corner| axes.place(corner)).collect();
        let lowest = corners.iter().map(|corner| corner[1]).fold(f64::INFINITY, f64::min);
        // The middle of an edge that is lowest all along.
        let tips = corners.iter().filter(|c| c[1] <= lowest + LEVEL * width).map(|c| c[2]);
        let (left, right) = tips
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let tip = 0.5 * (left + right);
        let surface = surface(first, axes, width);
        let (low, high) = (*surface.keys().next()?, *surface.keys().last()? + 1);
        let (low, high) = (low as f64 * width, high as f64 * width);
        let step = (high - low) / PLACES as f64;
        let (mut ends, mut section) = (None, 0.0);
        for z in (0..PLACES).map(|k| low + (k as f64 + 0.5) * step) {
            let Some(line) = shadow(&corners, z) else { continue };
            let Some(top) = surface.get(&strip(z, width)) else { continue };
            if *top > line {
                section += (top - line) * step;
                let (from, _) = ends.unwrap_or(([line, z], [line, z]));
                ends = Some((from, [line, z]));
            }
        }
        let (from, to) = ends?;
        let chord = [to[0] - from[0], to[1] - from[1]];
        let length = chord[0].hypot(chord[1]);
        let chord = chord.map(|component| component / length);
        (length > 0.0).then_some(Self { from, chord, length, tip, section })
    }

    /// Along the cut, normal to the chord, along it.
    fn axes(&self, axes: &Axes) -> Axes {
        axes.turned_to(self.chord)
    }

    /// Where the edge in engagement starts and ends, along the chord.
    fn ends(&self) -> [f64; 2] {
        let start = self.chord[0] * self.from[0] + self.chord[1] * self.from[1];
        [start, start + self.length]
    }

    /// Of the sections, along the chord.
    fn places(&self) -> impl Iterator<Item = f64> {
        let (start, length) = (self.ends()[0], self.length);
        (0..SECTIONS).map(move |k| start + (k as f64 + 0.5) / SECTIONS as f64 * length)
    }

    /// Along the feed of what lies this high above the chord's direction at a place along it.
    fn feed(&self, height: f64, place: f64) -> f64 {
        self.chord[1] * place - self.chord[0] * height
    }
}

fn strip(z: f64, width: f64) -> i64 {
    (z / width).floor() as i64
}

/// Height of the surface before the cut by strips of this width along the feed: the median along the cut of the highest
/// particles of squares, each with its half thickness.
fn surface(first: &Snapshot, axes: &Axes, width: f64) -> BTreeMap<i64, f64> {
    let mut tops = BTreeMap::new();
    for (index, position) in first.position.iter().enumerate() {
        let [x, y, z] = axes.place(position);
        let half = first.half_thickness.get(index).copied().filter(|half| !half.is_nan());
        let top = y + half.unwrap_or(0.5 * first.spacing_at(index));
        let known = tops.entry((strip(z, width), strip(x, width))).or_insert(top);
        *known = top.max(*known);
    }
    let mut strips: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for ((across, _), top) in tops {
        strips.entry(across).or_default().push(top);
    }
    strips.into_iter().map(|(across, tops)| (across, median(&tops))).collect()
}

/// The lowest point of the tool's shadow at `z`.
fn shadow(corners: &[Vector], z: f64) -> Option<f64> {
    corners
        .chunks_exact(3)
        .flat_map(|c| [[c[0], c[1]], [c[1], c[2]], [c[2], c[0]]])
        .filter_map(|[a, b]| {
            let share = (z - a[2]) / (b[2] - a[2]);
            (0.0..=1.0).contains(&share).then_some(a[1] + share * (b[1] - a[1]))
        })
        .reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate;
    use crate::synthetic::SyntheticCut;

    /// Half of the width of the drawn cut in spacings.
    const ROWS: i32 = 10;

    /// A drawn plane cut as wide as [`ROWS`] tell, which lie `pitch` spacings apart: cutting along z, up along x, the feed
    /// along y.
    fn extruded(plane: &Run, pitch: f64) -> Run {
        let pitch = pitch * plane.facts.particle_spacing;
        let spacing = (plane.facts.particle_spacing.powi(2) * pitch).cbrt();
        let place = |x: f64, y: f64, across: f64| [y, across, x];
        let lift = |snapshot: &Snapshot| {
            let mut lifted = Snapshot {
                time: snapshot.time,
                step: snapshot.step,
                dimension: 3,
                particle_spacing: spacing,
                ..Snapshot::default()
            };
            for row in -ROWS..ROWS {
                let across = (f64::from(row) + 0.5) * pitch;
                for index in 0..snapshot.position.len() {
                    let ([x, y, _], [u, v, _]) =
                        (snapshot.position[index], snapshot.velocity[index]);
                    let [fx, fy, _] = snapshot.contact_force[index];
                    lifted.id.push(snapshot.id[index] * 100 + (row + ROWS) as u64);
                    lifted.position.push(place(x, y, across));
                    lifted.velocity.push(place(u, v, 0.0));
                    lifted.stress.push([0.0; 6]);
                    lifted.plastic_strain_rate.push(snapshot.plastic_strain_rate[index]);
                    lifted.temperature.push(snapshot.temperature[index]);
                    lifted.contact_force.push(place(fx * pitch, fy * pitch, 0.0));
                    lifted.contact_area.push(snapshot.contact_area[index] * pitch);
                    lifted.friction_use.push(snapshot.friction_use[index]);
                    lifted.shear_friction_factor.push(snapshot.shear_friction_factor[index]);
                    lifted.half_thickness.push(snapshot.half_thickness[index]);
                }
            }
            // The sides of a prism beyond both sides of the workpiece.
            let wide = 2.0 * f64::from(ROWS) * pitch;
            for (k, from) in snapshot.tool.iter().enumerate() {
                let to = snapshot.tool[(k + 1) % snapshot.tool.len()];
                let corner = |end: &Vector, across: f64| place(end[0], end[1], across);
                let [a, b, c, d] = [
                    corner(from, -wide),
                    corner(&to, -wide),
                    corner(&to, wide),
                    corner(from, wide),
                ];
                lifted.tool.extend([a, b, c, a, c, d]);
            }
            lifted
        };
        let snapshots = (0..plane.snapshots.len()).map(|k| lift(&plane.snapshots.get(k).unwrap()));
        let facts = Facts {
            dimension: 3,
            particle_spacing: spacing,
            frame: CuttingFrame {
                cutting: [0.0, 0.0, 1.0],
                feed: [0.0, 1.0, 0.0],
                passive: [-1.0, 0.0, 0.0],
            },
            tool_velocity: Some([0.0, 0.0, plane.facts.cutting_speed()]),
            ..plane.facts.clone()
        };
        Run {
            provenance: plane.provenance.clone(),
            facts,
            samples: plane.samples.clone(),
            snapshots: Snapshots::in_memory(snapshots.collect()),
            performance: plane.performance,
            outcome: plane.outcome.clone(),
        }
    }

    /// Cells need not be cubes, and the flow draws rows apart: where a row ended a line through the chip, a turning had 0.57 of
    /// its thickness.
    fn rows_drawn_apart_leave_the_thickness(pitch: f64) {
        let cut = SyntheticCut { disorder: 0.0, chip_stretch: 1.6, ..SyntheticCut::default() };
        let plane = cut.run(1.5e-3, 5);
        let (expected, found) =
            (evaluate(&plane).unwrap().geometry, evaluate(&extruded(&plane, pitch)).unwrap());
        let along = found.geometry.along_edge.unwrap();
        let thickness = expected.chip.unwrap().thickness;
        for section in &along.sections[1..SECTIONS - 1] {
            let own = section.chip.as_ref().unwrap().thickness;
            assert!((own / thickness - 1.0).abs() < 0.05, "{pitch}: {own} {thickness}");
        }
    }

    #[test]
    fn rows_drawn_apart_and_narrow_columns_leave_the_thickness() {
        rows_drawn_apart_leave_the_thickness(0.6);
    }

    #[test]
    fn rows_drawn_apart_and_somewhat_narrow_columns_leave_the_thickness() {
        rows_drawn_apart_leave_the_thickness(0.8);
    }

    #[test]
    fn rows_drawn_apart_and_wide_columns_leave_the_thickness() {
        rows_drawn_apart_leave_the_thickness(1.25);
    }

    #[test]
    fn sections_of_an_extruded_cut_are_the_plane_cut() {
        let cut = SyntheticCut { disorder: 0.0, ..SyntheticCut::default() };
        let plane = cut.run(1.0e-3, 5);
        let expected = evaluate(&plane).unwrap().geometry;
        let run = extruded(&plane, 1.0);
        let found = evaluate(&run).unwrap().geometry;
        let thickness = plane.facts.uncut_chip_thickness.unwrap();
        let along = found.along_edge.as_ref().unwrap();
        assert_eq!(along.sections.len(), SECTIONS);
        let wide = 2.0 * f64::from(ROWS) * plane.facts.particle_spacing;
        let section = along.uncut_section / (thickness * wide);
        assert!((section - 1.0).abs() < 0.02, "{section} {along:?}");
        let (chip, same) = (expected.chip.unwrap(), found.chip.unwrap());
        assert!((same.thickness / chip.thickness - 1.0).abs() < 0.02, "{chip:?} {same:?}");
        assert!((same.speed_ratio / chip.speed_ratio - 1.0).abs() < 0.01);
        let (angle, own) = (expected.shear_angle.unwrap(), found.shear_angle.unwrap());
        assert!((angle - own).abs() < 0.01, "{angle} {own}");
        let (contact, touched) = (expected.contact.unwrap(), found.contact.unwrap());
        let spacing = plane.facts.particle_spacing;
        assert!((contact.rake - touched.rake).abs() < spacing, "{contact:?} {touched:?}");
        assert!((contact.flank - touched.flank).abs() < spacing);
        let covered = along.contact_area.unwrap() / wide;
        assert!((covered / contact.length() - 1.0).abs() < 0.1, "{covered} {contact:?}");
        for (number, section) in along.sections.iter().enumerate() {
            let place = (number as f64 + 0.5) / SECTIONS as f64 * wide - 0.5 * wide;
            assert!((section.place - place).abs() < 0.01 * wide, "{} {place}", section.place);
            assert!((section.uncut_chip_thickness / thickness - 1.0).abs() < 0.01);
            let own = section.chip.as_ref().unwrap().thickness;
            assert!((own / chip.thickness - 1.0).abs() < 0.02, "{own} {chip:?}");
        }
    }
}
