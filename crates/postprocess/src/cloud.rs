//! The particles of a plane snapshot in the frame of the cut, with a tree that answers which
//! lie near a point, and without the loose ones.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
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
    /// Where it is smallest.
    pub spacing: f64,
    /// That of each.
    pub spacings: Vec<f64>,
    /// Area that each stands for in m^2.
    pub areas: Vec<f64>,
    coarsest: f64,
    /// Positions of the particles kept.
    pub points: Vec<PlanePoint>,
    /// How far the material of each reaches towards the tool in m; half a spacing where a record does not tell.
    pub half_thickness: Vec<f64>,
    /// Their indices in the snapshot.
    pub source: Vec<usize>,
    /// Number of particles left out as loose or without a finite position.
    pub loose: usize,
    tree: PointTree,
}

impl CutParticles {
    /// Projects the particles and leaves out those in clusters of fewer than twenty.
    pub fn new(snapshot: &Snapshot, plane: CutPlane) -> Self {
        let spacing = snapshot.particle_spacing;
        let all: Vec<PlanePoint> = snapshot.position.iter().map(|p| plane.project(p)).collect();
        let finite: Vec<usize> =
            (0..all.len()).filter(|&i| all[i].iter().all(|x| x.is_finite())).collect();
        let points: Vec<PlanePoint> = finite.iter().map(|&i| all[i]).collect();
        let spacings: Vec<f64> = finite.iter().map(|&i| snapshot.spacing_at(i)).collect();
        let sizes = cluster_sizes(&points, &spacings);
        let kept: Vec<usize> =
            (0..points.len()).filter(|&i| sizes[i] >= SMALLEST_CLUSTER).collect();
        let source: Vec<usize> = kept.iter().map(|&i| finite[i]).collect();
        let points: Vec<PlanePoint> = kept.iter().map(|&i| points[i]).collect();
        let spacings: Vec<f64> = kept.iter().map(|&i| spacings[i]).collect();
        let areas = source.iter().map(|&i| snapshot.plane_area_at(i)).collect();
        let tree = PointTree::new(&points, LINK * spacing);
        let half_thickness = source
            .iter()
            .map(|&i| {
                let half = snapshot.half_thickness.get(i).copied().filter(|half| !half.is_nan());
                half.unwrap_or(0.5 * snapshot.spacing_at(i))
            })
            .collect();
        let loose = all.len() - points.len();
        let coarsest = spacings.iter().copied().fold(0.0, f64::max);
        Self { spacing, spacings, areas, coarsest, loose, points, half_thickness, source, tree }
    }

    /// The particles within `radius` of `centre`.
    pub fn near(&self, centre: PlanePoint, radius: f64) -> Vec<usize> {
        self.tree.within(&self.points, centre, radius)
    }

    /// Whether material is at `place`: within `spacings` of a particle, by its own spacing.
    pub fn is_material(&self, place: PlanePoint, spacings: f64) -> bool {
        self.near(place, spacings * self.coarsest)
            .iter()
            .any(|&i| distance(self.points[i], place) <= spacings * self.spacings[i])
    }

    /// Direction from the material outwards at a particle of the surface; `None` inside.
    /// The sum of the unit vectors from the neighbours, each with its area, vanishes inside and points outwards at a
    /// surface; a particle is at the surface where it is at least 0.25 of their number (a
    /// straight edge gives 2 / pi of a half disc of neighbours).
    pub fn outward_normal(&self, particle: usize) -> Option<PlanePoint> {
        let here = self.points[particle];
        let (mut sum, mut count) = ([0.0, 0.0], 0.0);
        let own = self.spacings[particle];
        for i in self.near(here, LINK * own) {
            let length = distance(self.points[i], here);
            if i != particle && length > 0.0 {
                let offset = difference(here, self.points[i]);
                let area = self.areas[i] / own.powi(2);
                let share = area / length;
                sum = [sum[0] + offset[0] * share, sum[1] + offset[1] * share];
                count += area;
            }
        }
        let length = sum[0].hypot(sum[1]);
        (length > 0.25 * count && length > 0.0).then(|| [sum[0] / length, sum[1] / length])
    }
}

pub(crate) fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// For each point the number of points in its cluster.
fn cluster_sizes(points: &[PlanePoint], spacings: &[f64]) -> Vec<usize> {
    let coarsest = LINK * spacings.iter().copied().fold(0.0, f64::max);
    let tree = PointTree::new(points, coarsest);
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
            for i in tree.within(points, points[member], coarsest) {
                let reach = 0.5 * LINK * (spacings[i] + spacings[member]);
                if cluster[i] == usize::MAX && distance(points[i], points[member]) <= reach {
                    cluster[i] = sizes.len();
                    queue.push(i);
                }
            }
        }
        sizes.push(size);
    }
    cluster.into_iter().map(|number| sizes[number]).collect()
}

/// A tree of points that gives what lies near a place in a fixed order.
struct PointTree {
    tree: ImmutableKdTree<f64, 2>,
    /// Row by row of square cells, then by index: sums over neighbours run in this order, so that their bits do not
    /// depend on how the tree is built.
    order: Vec<usize>,
}

impl PointTree {
    /// All points have to be finite.
    fn new(points: &[PlanePoint], cell: f64) -> Self {
        let low = [0, 1].map(|c| points.iter().map(|p| p[c]).fold(f64::INFINITY, f64::min));
        let place = |i: usize, c: usize| ((points[i][c] - low[c]) / cell) as usize;
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_cached_key(|&i| (place(i, 1), place(i, 0)));
        let sorted: Vec<PlanePoint> = order.iter().map(|&i| points[i]).collect();
        let tree = ImmutableKdTree::new_from_slice(&sorted)
            .expect("finite points, fewer than the tree can number");
        Self { tree, order }
    }

    /// Those of `points` within `radius` of `centre`.
    fn within(&self, points: &[PlanePoint], centre: PlanePoint, radius: f64) -> Vec<usize> {
        // The tree compares squares: a little more is asked for, and the distance itself decides.
        let reach = radius * (1.0 + 1e-9);
        let query = self.tree.query(&centre).within::<SquaredEuclidean<f64>>(reach * reach);
        let mut ranks: Vec<u32> = query.unsorted().execute().iter().map(|near| near.item).collect();
        ranks.sort_unstable();
        let near = ranks.into_iter().map(|rank| self.order[rank as usize]);
        near.filter(|&i| distance(points[i], centre) <= radius).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{SyntheticCut, uniform};

    #[test]
    fn the_tree_finds_what_a_search_over_all_finds() {
        let points: Vec<PlanePoint> =
            (0..400).map(|k| [uniform(2 * k), uniform(2 * k + 1)]).collect();
        let tree = PointTree::new(&points, 0.08);
        for k in 0..50 {
            let centre = [1.4 * uniform(9000 + k) - 0.2, 1.4 * uniform(9500 + k) - 0.2];
            let mut found = tree.within(&points, centre, 0.08);
            found.sort_unstable();
            let expected: Vec<usize> =
                (0..400).filter(|&i| distance(points[i], centre) <= 0.08).collect();
            assert_eq!(found, expected);
        }
        assert!(PointTree::new(&[], 0.08).within(&[], [0.0; 2], 1.0).is_empty());
        // A lattice: many points share a coordinate.
        let lattice: Vec<PlanePoint> =
            (0..2500).map(|k| [f64::from(k % 50), f64::from(k / 50)]).collect();
        assert_eq!(PointTree::new(&lattice, 1.0).within(&lattice, [7.0, 9.0], 1.0).len(), 5);
        let one_place = [[1.0, 2.0]; 100];
        let found = PointTree::new(&one_place, 1.0).within(&one_place, [1.0, 2.0], 0.5);
        assert_eq!(found, (0..100).collect::<Vec<usize>>());
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

    #[test]
    fn a_change_of_spacing_is_no_surface() {
        // Spacing 1 above y = 0, 2 below, and the frame's y points away from the machined surface.
        let mut snapshot = Snapshot { dimension: 2, particle_spacing: 1.0, ..Snapshot::default() };
        let mut fill = |spacing: f64, low: f64, rows: u32| {
            for (row, column) in
                (0..rows).flat_map(|r| (0..(40.0 / spacing) as u32).map(move |c| (r, c)))
            {
                let at = |k: u32, from: f64| from + (f64::from(k) + 0.5) * spacing;
                snapshot.position.push([at(column, 0.0), at(row, low), 0.0]);
                snapshot.relative_spacing.push(spacing);
            }
        };
        fill(1.0, 0.0, 12);
        fill(2.0, -12.0, 6);
        let cloud = CutParticles::new(&snapshot, CutPlane::new(CuttingFrame::default()));
        assert_eq!(cloud.loose, 0);
        let (mut surface, mut inside) = (0, 0);
        for (i, [x, y]) in cloud.points.iter().enumerate() {
            if (10.0..30.0).contains(x) {
                let is_surface = cloud.outward_normal(i).is_some();
                surface += usize::from(is_surface);
                inside += usize::from(is_surface && y.abs() < 6.0);
            }
        }
        // The outer rows of either side: 20 and 10.
        assert_eq!((surface, inside), (30, 0));
        assert!(cloud.is_material([20.0, -6.0], 1.3) && !cloud.is_material([20.0, -15.0], 1.3));
    }
}
