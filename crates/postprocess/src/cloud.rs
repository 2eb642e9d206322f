//! The particles of a plane snapshot in the frame of the cut, with a grid that answers which
//! lie near a point, and without the loose ones.

use sphcut_sph::Snapshot;
use sphcut_sph::setup::{CuttingFrame, Vector};

/// Particles closer than this many spacings hang together: flow may stretch the rows of a lattice
/// apart to twice their spacing.
const LINK: f64 = 2.2;
/// Clusters of fewer particles are loose: crumbs, not chip.
const SMALLEST_CLUSTER: usize = 20;

/// A point in the frame of the cut: along the cutting direction, and away from the machined
/// surface (against the feed direction).
pub(crate) type PlanePoint = [f64; 2];

/// The projection of space onto the plane of the cut.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CutPlane {
    frame: CuttingFrame,
}

impl CutPlane {
    pub fn new(frame: CuttingFrame) -> Self {
        Self { frame }
    }

    pub fn project(&self, vector: &Vector) -> PlanePoint {
        [dot(vector, &self.frame.cutting), -dot(vector, &self.frame.feed)]
    }
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(crate) fn difference(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

/// The particles that hang together with others, in the frame of the cut.
pub(crate) struct CutParticles {
    pub spacing: f64,
    /// Positions of the particles kept.
    pub points: Vec<PlanePoint>,
    /// How far the material of each reaches towards the tool in m; half a spacing where a record does not tell.
    pub half_thickness: Vec<f64>,
    /// Their indices in the snapshot.
    pub source: Vec<usize>,
    /// Number of particles left out as loose or without a finite position.
    pub loose: usize,
    grid: Grid,
}

impl CutParticles {
    /// Projects the particles and leaves out those in clusters of fewer than twenty.
    pub fn new(snapshot: &Snapshot, plane: CutPlane) -> Self {
        let spacing = snapshot.particle_spacing;
        let all: Vec<PlanePoint> = snapshot.position.iter().map(|p| plane.project(p)).collect();
        let finite: Vec<usize> =
            (0..all.len()).filter(|&i| all[i].iter().all(|x| x.is_finite())).collect();
        let points: Vec<PlanePoint> = finite.iter().map(|&i| all[i]).collect();
        let sizes = cluster_sizes(&points, spacing);
        let kept: Vec<usize> =
            (0..points.len()).filter(|&i| sizes[i] >= SMALLEST_CLUSTER).collect();
        let source: Vec<usize> = kept.iter().map(|&i| finite[i]).collect();
        let points: Vec<PlanePoint> = kept.iter().map(|&i| points[i]).collect();
        let grid = Grid::new(&points, LINK * spacing);
        let half_thickness = source
            .iter()
            .map(|&i| snapshot.half_thickness.get(i).copied().unwrap_or(f64::NAN))
            .map(|half| if half.is_nan() { 0.5 * spacing } else { half })
            .collect();
        Self { spacing, loose: all.len() - points.len(), points, half_thickness, source, grid }
    }

    /// Calls `visit` for each particle within `radius` of `centre`; `radius` is at most 2.2
    /// spacings.
    pub fn near(&self, centre: PlanePoint, radius: f64, mut visit: impl FnMut(usize)) {
        debug_assert!(radius <= LINK * self.spacing * (1.0 + 1e-12));
        self.grid.around(centre, |i| {
            if distance(self.points[i], centre) <= radius {
                visit(i);
            }
        });
    }

    /// Whether a particle lies within `radius` of `centre`.
    pub fn any_near(&self, centre: PlanePoint, radius: f64) -> bool {
        let mut found = false;
        self.near(centre, radius, |_| found = true);
        found
    }

    /// Direction from the material outwards at a particle of the surface; `None` inside.
    /// The sum of the unit vectors from the neighbours vanishes inside and points outwards at a
    /// surface; a particle is at the surface where it is at least 0.25 of their number (a
    /// straight edge gives 2 / pi of a half disc of neighbours).
    pub fn outward_normal(&self, particle: usize) -> Option<PlanePoint> {
        let here = self.points[particle];
        let (mut sum, mut count) = ([0.0, 0.0], 0.0);
        self.near(here, LINK * self.spacing, |i| {
            let length = distance(self.points[i], here);
            if i != particle && length > 0.0 {
                let offset = difference(here, self.points[i]);
                sum = [sum[0] + offset[0] / length, sum[1] + offset[1] / length];
                count += 1.0;
            }
        });
        let length = sum[0].hypot(sum[1]);
        (length > 0.25 * count && length > 0.0).then(|| [sum[0] / length, sum[1] / length])
    }
}

pub(crate) fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// For each point the number of points in its cluster.
fn cluster_sizes(points: &[PlanePoint], spacing: f64) -> Vec<usize> {
    let grid = Grid::new(points, LINK * spacing);
    let mut cluster = vec![usize::MAX; points.len()];
    let mut sizes = Vec::new();
    let mut queue = Vec::new();
    for start in 0..points.len() {
        if cluster[start] != usize::MAX {
            continue;
        }
        let mut size = 0;
        cluster[start] = sizes.len();
        queue.push(start);
        while let Some(member) = queue.pop() {
            size += 1;
            grid.around(points[member], |i| {
                let linked = distance(points[i], points[member]) <= LINK * spacing;
                if cluster[i] == usize::MAX && linked {
                    cluster[i] = sizes.len();
                    queue.push(i);
                }
            });
        }
        sizes.push(size);
    }
    cluster.into_iter().map(|number| sizes[number]).collect()
}

/// Points sorted into square cells by a counting sort; cells outside the extent are empty.
struct Grid {
    low: PlanePoint,
    cell: f64,
    size: [usize; 2],
    starts: Vec<usize>,
    members: Vec<usize>,
}

/// Most cells per direction: stray particles far away must not exhaust the memory.
const MOST_CELLS: f64 = 4096.0;

impl Grid {
    fn new(points: &[PlanePoint], wanted_cell: f64) -> Self {
        let bound = |component: usize, start: f64, pick: fn(f64, f64) -> f64| {
            points.iter().map(|p| p[component]).fold(start, pick)
        };
        let low = [0, 1].map(|c| bound(c, f64::INFINITY, f64::min));
        let high = [0, 1].map(|c| bound(c, f64::NEG_INFINITY, f64::max));
        let extent = (high[0] - low[0]).max(high[1] - low[1]).max(0.0);
        let cell = wanted_cell.max(extent / MOST_CELLS).max(f64::MIN_POSITIVE);
        let size = [0, 1].map(|c| ((high[c] - low[c]).max(0.0) / cell) as usize + 1);
        let mut grid =
            Self { low, cell, size, starts: vec![0; size[0] * size[1] + 1], members: Vec::new() };
        let cells: Vec<usize> = points.iter().map(|&p| grid.cell_of(p)).collect();
        cells.iter().for_each(|&cell| grid.starts[cell + 1] += 1);
        for cell in 0..size[0] * size[1] {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        let mut next = grid.starts.clone();
        grid.members = vec![0; points.len()];
        for (point, cell) in cells.into_iter().enumerate() {
            grid.members[next[cell]] = point;
            next[cell] += 1;
        }
        grid
    }

    fn cell_of(&self, point: PlanePoint) -> usize {
        let index =
            |c: usize| (((point[c] - self.low[c]) / self.cell) as usize).min(self.size[c] - 1);
        index(1) * self.size[0] + index(0)
    }

    /// Visits the points in the cell of `centre` and its eight neighbours.
    fn around(&self, centre: PlanePoint, mut visit: impl FnMut(usize)) {
        let range = |c: usize| {
            let position = (centre[c] - self.low[c]) / self.cell;
            let first = (position - 1.0).floor().clamp(0.0, self.size[c] as f64);
            let end = (position + 2.0).floor().clamp(0.0, self.size[c] as f64);
            first as usize..end as usize
        };
        let columns = range(0);
        if columns.is_empty() {
            return;
        }
        for row in range(1) {
            let row_start = row * self.size[0];
            let cells =
                self.starts[row_start + columns.start]..self.starts[row_start + columns.end];
            self.members[cells].iter().for_each(|&member| visit(member));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{SyntheticCut, uniform};

    #[test]
    fn the_grid_finds_what_a_search_over_all_finds() {
        let points: Vec<PlanePoint> =
            (0..400).map(|k| [uniform(2 * k), uniform(2 * k + 1)]).collect();
        let grid = Grid::new(&points, 0.08);
        for k in 0..50 {
            let centre = [1.4 * uniform(9000 + k) - 0.2, 1.4 * uniform(9500 + k) - 0.2];
            let mut found = Vec::new();
            grid.around(centre, |i| {
                if distance(points[i], centre) <= 0.08 {
                    found.push(i);
                }
            });
            found.sort_unstable();
            let expected: Vec<usize> =
                (0..400).filter(|&i| distance(points[i], centre) <= 0.08).collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn loose_particles_are_left_out_and_counted() {
        let cut = SyntheticCut { loose_particles: 7, ..SyntheticCut::default() };
        let mut snapshot = cut.snapshot(0.5e-3);
        snapshot.position[0] = [f64::NAN, 0.0, 0.0];
        snapshot.position[1] = [1e3, 1e3, 0.0];
        let cloud = CutParticles::new(&snapshot, CutPlane::new(CuttingFrame::default()));
        assert_eq!(cloud.loose, 9);
        assert_eq!(cloud.points.len() + 9, snapshot.position.len());
    }

    #[test]
    fn surfaces_have_normals_and_the_inside_has_none() {
        let cut = SyntheticCut { disorder: 0.2, ..SyntheticCut::default() };
        let snapshot = cut.snapshot(0.0);
        let cloud = CutParticles::new(&snapshot, CutPlane::new(CuttingFrame::default()));
        let (mut surface, mut count) = (0, 0);
        for (i, point) in cloud.points.iter().enumerate() {
            let inside_x = point[0] > 0.4e-3 && point[0] < 2.4e-3;
            let depth = -point[1] / cut.particle_spacing;
            if inside_x && depth < 0.9 {
                count += 1;
                surface += usize::from(cloud.outward_normal(i).is_some_and(|n| n[1] > 0.8));
            } else if inside_x && depth > 2.0 && depth < 48.0 {
                assert_eq!(cloud.outward_normal(i), None);
            }
        }
        assert!(surface * 100 >= 95 * count && count > 150, "{surface} of {count}");
    }
}
