//! A background of tetrahedra over the tool, fine where particles can touch it.
//!
//! An octree whose cells are at most twice as wide as those that they touch, by a face, an edge or a
//! corner. Two equal neighbours share the tetrahedra between their centres and the edges of their common face,
//! halves of an edge where smaller cells divide it: the body-centred cubic lattice. On a face between cells
//! of two sizes stand pyramids from the centres of both sides, each cut in two along the diagonal from the
//! middle of the larger face. The tetrahedra fill the cube without gaps (as in Labelle and Shewchuk, ACM
//! Transactions on Graphics 26, 2007, 57).

use glam::DVec3;
use std::collections::BTreeSet;

/// Deepest subdivision: coordinates have 21 bits.
const DEEPEST: u32 = 19;
/// Most nodes of a background.
pub(crate) const MOST_POINTS: usize = 1_500_000;

/// Place in units of half the smallest cell.
type Place = [u32; 3];

/// How the tree is to be divided.
pub(crate) struct Cube {
    pub(crate) low: DVec3,
    pub(crate) smallest: f64,
    /// Halvings from the whole cube to the smallest cell.
    pub(crate) levels: u32,
}

impl Cube {
    /// About the box, with room at each side; `None` where it would need too many halvings.
    pub(crate) fn about([low, high]: [DVec3; 2], smallest: f64) -> Option<Self> {
        let extent = (high - low).max_element();
        let levels = (0..=DEEPEST).find(|n| smallest * f64::from(1 << n) >= 1.3 * extent)?;
        let width = smallest * f64::from(1_u32 << levels);
        let low = 0.5 * (low + high) - 0.5 * width;
        Some(Self { low, smallest, levels })
    }

    fn position(&self, place: Place) -> DVec3 {
        self.low + 0.5 * self.smallest * DVec3::from(place.map(f64::from))
    }
}

/// A cell: its lowest corner in units of half the smallest cell, and its level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cell {
    corner: Place,
    level: u32,
}

fn key(place: Place) -> u64 {
    place.iter().fold(0, |key, component| key << 21 | u64::from(*component))
}

/// The tree.
pub(crate) struct Octree {
    cube: Cube,
    /// Cells that are divided, by level.
    divided: Vec<BTreeSet<u64>>,
    leaves: Vec<Cell>,
    /// Keys of corners and centres, rising.
    points: Vec<u64>,
}

/// What lies behind a face.
enum Neighbour {
    Same(Cell),
    Finer,
    /// Or nothing: the face is dealt with from the other side, or bounds the cube.
    Other,
}

impl Octree {
    /// Divides cells as long as `is_coarse(centre, width)`; `None` beyond the most points.
    pub(crate) fn new(cube: Cube, is_coarse: impl Fn(DVec3, f64) -> bool) -> Option<Self> {
        let levels = cube.levels as usize;
        let root = Cell { corner: [0; 3], level: 0 };
        let mut tree = Self {
            cube,
            divided: vec![BTreeSet::new(); levels + 1],
            leaves: Vec::new(),
            points: Vec::new(),
        };
        let mut waiting = vec![root];
        let mut count = 0;
        while let Some(cell) = waiting.pop() {
            let centre = tree.cube.position(tree.centre(cell));
            if cell.level < tree.cube.levels && is_coarse(centre, tree.width(cell)) {
                tree.divided[cell.level as usize].insert(key(cell.corner));
                waiting.extend(tree.children(cell));
                count += 8;
                if count > MOST_POINTS {
                    return None;
                }
            }
        }
        tree.balance();
        tree.collect_leaves(root);
        for leaf in &tree.leaves {
            let size = tree.size(leaf.level);
            tree.points.push(key(tree.centre(*leaf)));
            for corner in 0..8 {
                let place = std::array::from_fn(|k| leaf.corner[k] + size * (corner >> k & 1));
                tree.points.push(key(place));
            }
        }
        tree.points.sort_unstable();
        tree.points.dedup();
        (tree.points.len() <= MOST_POINTS).then_some(tree)
    }

    /// Positions of the points.
    pub(crate) fn positions(&self) -> Vec<DVec3> {
        let mask = (1 << 21) - 1;
        let part = |key: u64, shift: u32| (key >> shift & mask) as u32;
        let place = |key: &u64| [part(*key, 42), part(*key, 21), part(*key, 0)];
        self.points.iter().map(|key| self.cube.position(place(key))).collect()
    }

    /// Whether each point is the centre of a cell.
    pub(crate) fn are_centres(&self) -> Vec<bool> {
        let mut are_centres = vec![false; self.points.len()];
        for leaf in &self.leaves {
            are_centres[self.number(self.centre(*leaf)) as usize] = true;
        }
        are_centres
    }

    /// Width of a cell in units of half the smallest.
    fn size(&self, level: u32) -> u32 {
        2 << (self.cube.levels - level)
    }

    fn width(&self, cell: Cell) -> f64 {
        0.5 * self.cube.smallest * f64::from(self.size(cell.level))
    }

    fn centre(&self, cell: Cell) -> Place {
        cell.corner.map(|component| component + self.size(cell.level) / 2)
    }

    fn children(&self, cell: Cell) -> [Cell; 8] {
        let half = self.size(cell.level + 1);
        std::array::from_fn(|child| Cell {
            corner: std::array::from_fn(|k| cell.corner[k] + half * (child as u32 >> k & 1)),
            level: cell.level + 1,
        })
    }

    fn is_divided(&self, cell: Cell) -> bool {
        self.divided[cell.level as usize].contains(&key(cell.corner))
    }

    /// The place of a cell's neighbour of the same size, if it lies in the cube.
    fn beside(&self, cell: Cell, way: [i64; 3]) -> Option<Cell> {
        let (size, whole) = (i64::from(self.size(cell.level)), i64::from(self.size(0)));
        let mut corner = [0; 3];
        for k in 0..3 {
            let place = i64::from(cell.corner[k]) + way[k] * size;
            if place < 0 || place >= whole {
                return None;
            }
            corner[k] = u32::try_from(place).expect("inside the cube");
        }
        Some(Cell { corner, ..cell })
    }

    fn parent(&self, cell: Cell) -> Cell {
        let size = self.size(cell.level - 1);
        Cell { corner: cell.corner.map(|place| place / size * size), level: cell.level - 1 }
    }

    /// Divides until all neighbours of a divided cell exist.
    fn balance(&mut self) {
        let mask = (1 << 21) - 1;
        for level in (1..self.cube.levels).rev() {
            let mut parents = Vec::new();
            for code in &self.divided[level as usize] {
                let corner = [42, 21, 0].map(|shift| (code >> shift & mask) as u32);
                let cell = Cell { corner, level };
                for way in 0..27 {
                    let way = [way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1];
                    if let Some(neighbour) = self.beside(cell, way) {
                        parents.push(key(self.parent(neighbour).corner));
                    }
                }
            }
            self.divided[level as usize - 1].extend(parents);
        }
    }

    fn collect_leaves(&mut self, cell: Cell) {
        if self.is_divided(cell) {
            for child in self.children(cell) {
                self.collect_leaves(child);
            }
        } else {
            self.leaves.push(cell);
        }
    }

    fn neighbour(&self, leaf: Cell, axis: usize, side: usize) -> Neighbour {
        let mut way = [0; 3];
        way[axis] = if side == 0 { -1 } else { 1 };
        match self.beside(leaf, way) {
            Some(cell) if self.is_divided(cell) => Neighbour::Finer,
            Some(cell) if self.is_divided(self.parent(cell)) => Neighbour::Same(cell),
            _ => Neighbour::Other,
        }
    }

    fn known(&self, place: Place) -> Option<u32> {
        self.points.binary_search(&key(place)).ok().map(|index| index as u32)
    }

    fn number(&self, place: Place) -> u32 {
        self.known(place).expect("corners and centres of leaves are points")
    }

    /// Gives every tetrahedron, in either orientation.
    pub(crate) fn each_tetrahedron(&self, mut take: impl FnMut([u32; 4])) {
        for leaf in &self.leaves {
            let centre = self.number(self.centre(*leaf));
            for axis in 0..3 {
                for side in 0..2 {
                    match self.neighbour(*leaf, axis, side) {
                        // Once for both.
                        Neighbour::Same(other) if side == 1 => {
                            let other = self.number(self.centre(other));
                            self.edges_of_face(*leaf, axis, |from, to| {
                                take([centre, other, from, to]);
                            });
                        }
                        Neighbour::Finer => self.pyramids(*leaf, axis, side, centre, &mut take),
                        _ => {}
                    }
                }
            }
        }
    }

    /// Point of a face: `along` its two axes in halves of its width.
    fn on_face(&self, leaf: Cell, axis: usize, side: usize, along: [u32; 2]) -> Place {
        let size = self.size(leaf.level);
        let mut place = leaf.corner;
        place[axis] += size * side as u32;
        place[(axis + 1) % 3] += size / 2 * along[0];
        place[(axis + 2) % 3] += size / 2 * along[1];
        place
    }

    /// The edges of the upper face, in halves where they are divided.
    fn edges_of_face(&self, leaf: Cell, axis: usize, mut take: impl FnMut(u32, u32)) {
        let round = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]];
        for edge in 0..4 {
            let at = |k: usize| self.on_face(leaf, axis, 1, round[(2 * edge + k) % 8]);
            let (from, to) = (self.number(at(0)), self.number(at(2)));
            match self.known(at(1)) {
                Some(middle) => {
                    take(from, middle);
                    take(middle, to);
                }
                None => take(from, to),
            }
        }
    }

    /// Over the four smaller cells behind a face: from both sides.
    fn pyramids(
        &self,
        leaf: Cell,
        axis: usize,
        side: usize,
        centre: u32,
        take: &mut impl FnMut([u32; 4]),
    ) {
        let quarter = self.size(leaf.level) / 4;
        let at = |along: [u32; 2]| self.number(self.on_face(leaf, axis, side, along));
        let middle = at([1, 1]);
        for [a, b] in [[0, 0], [2, 0], [0, 2], [2, 2]] {
            let corner = at([a, b]);
            let mut place = self.on_face(leaf, axis, side, [0, 0]);
            place[axis] = if side == 0 { place[axis] - quarter } else { place[axis] + quarter };
            place[(axis + 1) % 3] += quarter * (a + 1);
            place[(axis + 2) % 3] += quarter * (b + 1);
            let small = self.number(place);
            for half in [at([a, 1]), at([1, b])] {
                take([centre, corner, half, middle]);
                take([small, corner, half, middle]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(points: &[DVec3], corners: [u32; 4]) -> f64 {
        let [a, b, c, d] = corners.map(|corner| points[corner as usize]);
        ((b - a).cross(c - a).dot(d - a) / 6.0).abs()
    }

    #[test]
    fn the_tetrahedra_of_a_graded_tree_fill_the_cube_and_meet_face_to_face() {
        let cube = Cube::about([DVec3::ZERO, DVec3::ONE], 0.03).unwrap();
        let width = 0.03 * f64::from(1_u32 << cube.levels);
        let corner = cube.low;
        // Fine about one point, as coarse as balance allows elsewhere.
        let far = |c: DVec3| (c.x - 0.3).hypot(c.y - 0.4).hypot(c.z - 0.2);
        let tree = Octree::new(cube, |c, w| w > 0.4 || far(c) < 0.8 * w).unwrap();
        let points = tree.positions();
        let mut faces: Vec<[u32; 3]> = Vec::new();
        let mut whole = 0.0;
        tree.each_tetrahedron(|mut corners| {
            whole += volume(&points, corners);
            corners.sort_unstable();
            let [a, b, c, d] = corners;
            faces.extend([[a, b, c], [a, b, d], [a, c, d], [b, c, d]]);
        });
        faces.sort_unstable();
        // Pyramids to the faces of the cube are left out: what is there fills all cells but those.
        let mut outside = 0.0;
        for leaf in &tree.leaves {
            let size = tree.size(leaf.level);
            for k in 0..3 {
                let ends = [leaf.corner[k] == 0, leaf.corner[k] + size == tree.size(0)];
                outside += ends.iter().filter(|end| **end).count() as f64 / 6.0
                    * tree.width(*leaf).powi(3);
            }
        }
        assert!((whole + outside - width.powi(3)).abs() < 1e-12 * width.powi(3));
        // A face is shared by two; single ones lie on pyramids left out, next to the cube's boundary.
        for group in faces.chunk_by(|a, b| a == b) {
            assert!(group.len() <= 2);
            let near = |point: &u32| {
                let place = points[*point as usize];
                (0..3).any(|k| {
                    let way = place[k] - corner[k];
                    way.min(width - way) < 0.3
                })
            };
            assert!(group.len() == 2 || group[0].iter().all(near), "{group:?}");
        }
    }
}
