//! Neighbour lists over a fixed reference configuration, by cells of the kernel's support.
//!
//! Every particle lists all its neighbours (no half lists): each gathers over
//! its own ordered list, so that results do not depend on the thread count.

use crate::kernel::KernelChoice;
use crate::operators::cells::Cells;
use crate::parallel::{CHUNK, TURN};
use crate::tensor::{Matrix, Vector, apply, dot, minus, sum_scaled};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Neighbours of all particles in compressed rows.
#[derive(Debug, Default)]
pub(crate) struct NeighbourList {
    /// `start[i]..start[i + 1]` is the row of particle `i`.
    start: Vec<u32>,
    /// Index of the neighbour.
    index: Vec<u32>,
    /// `-W'(r)/r V_j` in 1/m^2.
    weight: Vec<f64>,
    /// Rows on their way into the list, kept from one reference update to the next.
    rows: Vec<Rows>,
}

impl NeighbourList {
    /// Neighbours of particle `i` with their weights.
    #[inline]
    pub(crate) fn row(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.start[i] as usize..self.start[i + 1] as usize;
        (&self.index[range.clone()], &self.weight[range])
    }

    /// Number of neighbours of particle `i`.
    pub(crate) fn count(&self, i: usize) -> u32 {
        self.start[i + 1] - self.start[i]
    }

    /// Number of listed pairs, each counted from both sides.
    pub(crate) fn pairs(&self) -> usize {
        self.index.len()
    }

    /// Memory in bytes.
    pub(crate) fn memory(&self) -> usize {
        4 * (self.start.capacity() + self.index.capacity())
            + 8 * self.weight.capacity()
            + self.rows.iter().map(Rows::memory).sum::<usize>()
    }
}

/// A kernel with its smoothing length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothing {
    pub(crate) kernel: KernelChoice,
    pub(crate) length: f64,
}

impl Smoothing {
    /// Radius of a round support in m.
    pub(crate) fn support(&self) -> f64 {
        2.0 * self.length
    }
}

/// Who belongs together: those that were near each other in the undeformed state, and those between which flow has left no
/// gap since.
///
/// Particles far apart in the undeformed state belong together once they are neighbours with at least D + 1 neighbours in
/// common that belong to both, as many as tell a linear motion: where layers slide past each other (a layer that sticks to the
/// tool, material that stagnates in front of its edge) the next neighbour along always has them. Two surfaces that meet, as a chip
/// that curls onto the workpiece, have none, and stay two. Such a pair is kept while it is in the support.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kinship<'a, const D: usize> {
    pub(crate) id: &'a [u64],
    /// Pairs that belong together though they were far apart, by id, the lower first; sorted.
    pub(crate) bonds: &'a [(u64, u64)],
    /// Whether there may be new ones.
    pub(crate) grows: bool,
    pub(crate) body: &'a [u32],
    pub(crate) origin: &'a [Vector<D>],
    /// Whether different bodies are one continuum.
    pub(crate) bonded: bool,
    /// Undeformed distance in m up to which particles of size 1 belong together without more ado.
    pub(crate) reach: f64,
    /// Spacing of each particle over the particle spacing; empty where all are the same.
    pub(crate) sizes: &'a [f64],
}

impl<const D: usize> Kinship<'_, D> {
    /// Whether `i` and `j` were near each other in the undeformed state, in one piece of material.
    #[inline]
    fn joins(&self, i: usize, j: usize) -> bool {
        let apart = minus(&self.origin[j], &self.origin[i]);
        let reach = self.reach * self.size(i, j);
        dot(&apart, &apart) < reach * reach && self.may_join(i, j)
    }

    /// Whether `i` and `j` can belong together at all.
    #[inline]
    fn may_join(&self, i: usize, j: usize) -> bool {
        self.bonded || self.body[i] == self.body[j]
    }

    /// Whether `i` and `j` have come to belong together before.
    fn is_bond(&self, i: usize, j: usize) -> bool {
        self.bonds.binary_search(&self.bond(i, j)).is_ok()
    }

    /// `i` and `j` as a bond.
    fn bond(&self, i: usize, j: usize) -> (u64, u64) {
        let (a, b) = (self.id[i], self.id[j]);
        (a.min(b), a.max(b))
    }

    /// The size of a pair.
    #[inline]
    fn size(&self, i: usize, j: usize) -> f64 {
        pair_mean(self.sizes, i, j)
    }
}

/// The mean of two particles' values, which are 1 where there are none.
#[inline]
pub(crate) fn pair_mean(values: &[f64], i: usize, j: usize) -> f64 {
    if values.is_empty() { 1.0 } else { 0.5 * (values[i] + values[j]) }
}

/// Where the particles are, what they weigh and who belongs together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cloud<'a, const D: usize> {
    /// Stored in cell order.
    pub(crate) positions: &'a [Vector<D>],
    pub(crate) volumes: &'a [f64],
    pub(crate) kinship: Kinship<'a, D>,
    /// The inverse shapes of the supports, or none for round ones.
    pub(crate) metrics: &'a [Matrix<D>],
    /// Class of each particle's row, and the factors of their pairs; no classes where all are the same.
    pub(crate) rows: (&'a [u8], &'a DMatrix<f64>),
}

impl<const D: usize> Cloud<'_, D> {
    /// The squared distance of `i` and `j`, and that in terms of the shapes of their supports.
    #[inline]
    fn squares(&self, i: usize, j: usize) -> (f64, f64) {
        let separation = minus(&self.positions[j], &self.positions[i]);
        let distance_square = dot(&separation, &separation);
        if self.metrics.is_empty() {
            return (distance_square, distance_square);
        }
        let both = sum_scaled(&self.metrics[i], 1.0, &self.metrics[j]);
        (distance_square, 0.5 * dot(&separation, &apply(&both, &separation)))
    }

    /// The weight of `j` for `i` at a squared distance in terms of the shapes of their supports.
    #[inline]
    fn weight(&self, i: usize, j: usize, square: f64, smoothing: Smoothing) -> f64 {
        let length = smoothing.length * self.kinship.size(i, j);
        let weight = smoothing.kernel.weight(square.sqrt(), length, D);
        let (classes, factors) = self.rows;
        let factor = if classes.is_empty() {
            1.0
        } else {
            factors[(classes[i] as usize, classes[j] as usize)]
        };
        self.volumes[j] * weight * factor
    }
}

/// Tasks per thread whose rows wait to be joined to the list.
const BATCH: usize = 8;

/// The rows of one chunk of particles.
#[derive(Debug, Default)]
struct Rows {
    counts: Vec<u32>,
    index: Vec<u32>,
    weight: Vec<f64>,
    /// Pairs that are near without belonging together.
    self_contact: Vec<(u32, u32)>,
    /// Pairs that belong together though they were far apart, from the side of the lower id.
    bonds: Vec<(u64, u64)>,
    /// Particles near the present one that were far from it.
    far: Vec<Far>,
}

/// A particle near another that was far from it in the undeformed state.
#[derive(Debug, Clone, Copy)]
struct Far {
    particle: u32,
    /// Distance in terms of the support's shape, where it lies within the support.
    in_support: Option<f64>,
    /// Whether it is close enough for contact.
    near: bool,
}

impl Rows {
    fn clear(&mut self) {
        self.counts.clear();
        self.index.clear();
        self.weight.clear();
        self.self_contact.clear();
        self.bonds.clear();
    }

    fn memory(&self) -> usize {
        4 * (self.counts.capacity() + self.index.capacity() + 2 * self.self_contact.capacity())
            + 8 * (self.weight.capacity() + 2 * self.bonds.capacity())
            + size_of::<Far>() * self.far.capacity()
    }
}

/// Builds the list, and finds the pairs of self-contact: closer than `reach` without belonging together, each from both sides, in the order of the first. `reach` and every support must not exceed the cells.
/// Returns the pairs that belong together though they were far apart, as in [`Kinship::bonds`].
pub(crate) fn build_list<const D: usize>(
    list: &mut NeighbourList,
    cells: &Cells<D>,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    (self_contact, reach): (&mut Vec<(u32, u32)>, f64),
) -> Vec<(u64, u64)> {
    let mut bonds = Vec::new();
    let count = cloud.positions.len();
    let batch = BATCH * rayon::current_num_threads();
    self_contact.clear();
    list.rows.resize_with(batch.min(count.div_ceil(CHUNK)), Rows::default);
    list.start.clear();
    make_room(&mut list.start, count + 1, count + 1);
    list.start.push(0);
    list.index.clear();
    list.weight.clear();
    for first in (0..count).step_by(batch * CHUNK) {
        let last = (first + batch * CHUNK).min(count);
        let rows = &mut list.rows[..(last - first).div_ceil(CHUNK)];
        rows.par_iter_mut().enumerate().with_max_len(TURN).for_each(|(chunk, rows)| {
            let own = first + chunk * CHUNK;
            find_rows(rows, own..(own + CHUNK).min(last), cells, cloud, smoothing, reach);
        });
        let pairs = list.index.len() + rows.iter().map(|rows| rows.index.len()).sum::<usize>();
        let all = (pairs as f64 * count as f64 / last as f64) as usize;
        make_room(&mut list.index, pairs, all);
        make_room(&mut list.weight, pairs, all);
        for rows in rows {
            let mut end = list.index.len() as u32;
            list.start.extend(rows.counts.iter().map(|count| {
                end += count;
                end
            }));
            list.index.extend_from_slice(&rows.index);
            list.weight.extend_from_slice(&rows.weight);
            self_contact.extend_from_slice(&rows.self_contact);
            bonds.extend_from_slice(&rows.bonds);
        }
    }
    bonds.sort_unstable();
    bonds
}

fn find_rows<const D: usize>(
    rows: &mut Rows,
    own: std::ops::Range<usize>,
    cells: &Cells<D>,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    reach: f64,
) {
    rows.clear();
    let Cloud { positions, kinship, .. } = *cloud;
    let support = smoothing.support();
    for i in own {
        let before = rows.index.len();
        rows.far.clear();
        cells.around(&positions[i], kinship.size(i, i), |range| {
            for j in range {
                if j == i {
                    continue;
                }
                let (distance_square, square) = cloud.squares(i, j);
                let size = kinship.size(i, j);
                let (support, reach) = (support * size, reach * size);
                let (in_support, near) =
                    (square < support * support, distance_square < reach * reach);
                if !(in_support || near) {
                    continue;
                }
                if !kinship.joins(i, j) {
                    let in_support = in_support.then_some(square);
                    rows.far.push(Far { particle: j as u32, in_support, near });
                } else if in_support {
                    rows.index.push(j as u32);
                    rows.weight.push(cloud.weight(i, j, square, smoothing));
                }
            }
        });
        if !rows.far.is_empty() {
            join_far(rows, i, before, cloud, smoothing);
        }
        rows.counts.push((rows.index.len() - before) as u32);
    }
}

/// Parts the particles near `i` that were far from it into those that belong to it, which join its row from `first` on, and
/// the others.
fn join_far<const D: usize>(
    rows: &mut Rows,
    i: usize,
    first: usize,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
) {
    let kinship = cloud.kinship;
    let far = std::mem::take(&mut rows.far);
    // Those that belonged to it before: its neighbours, to which new ones have to belong as well.
    let was_bond = |far: &&Far| {
        let j = far.particle as usize;
        far.in_support.is_some() && kinship.may_join(i, j) && kinship.is_bond(i, j)
    };
    let near_ones = rows.index.len();
    rows.index.extend(far.iter().filter(was_bond).map(|far| far.particle));
    let belonging = rows.index.len();
    for far in &far {
        let j = far.particle as usize;
        let is_common = |k: u32| {
            let k = k as usize;
            let reach = smoothing.support() * kinship.size(k, j);
            k != j
                && cloud.squares(k, j).1 < reach * reach
                && (kinship.joins(k, j) || kinship.is_bond(k, j))
        };
        let joins = far.in_support.filter(|_| {
            let old = rows.index[near_ones..belonging].contains(&far.particle);
            old || kinship.grows
                && kinship.may_join(i, j)
                && rows.index[first..belonging].iter().filter(|&&k| is_common(k)).nth(D).is_some()
        });
        match joins {
            Some(square) => {
                rows.index.push(far.particle);
                rows.weight.push(cloud.weight(i, j, square, smoothing));
                if kinship.id[i] < kinship.id[j] {
                    rows.bonds.push(kinship.bond(i, j));
                }
            }
            None if far.near => rows.self_contact.push((i as u32, far.particle)),
            None => {}
        }
    }
    // The old ones stand there twice.
    rows.index.drain(near_ones..belonging);
    rows.far = far;
}

/// Room for `needed` values without the doubling of `Vec`: what all are expected to be, and a sixteenth.
fn make_room<T>(values: &mut Vec<T>, needed: usize, expected: usize) {
    if values.capacity() < needed {
        values.reserve_exact(expected.max(needed) + expected / 16 - values.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two blocks of rows of particles at distances of 1, the upper displaced.
    struct Blocks {
        origin: Vec<Vector<2>>,
        bonds: Vec<(u64, u64)>,
        bodies: u32,
    }

    const REACH: f64 = 4.0;
    const LENGTH: usize = 60;
    const ROWS: usize = 8;

    impl Blocks {
        fn new() -> Self {
            let place = |k: usize| [(k % LENGTH) as f64, (k / LENGTH) as f64];
            Self { origin: (0..LENGTH * ROWS).map(place).collect(), bonds: Vec::new(), bodies: 1 }
        }

        fn is_upper(origin: &Vector<2>) -> bool {
            origin[1] >= 0.5 * ROWS as f64
        }

        /// Displaces the upper block; the neighbours of each particle and the pairs of self-contact, by the numbers of the particles.
        fn neighbours(
            &mut self,
            displacement: Vector<2>,
            grows: bool,
        ) -> (Vec<Vec<u64>>, Vec<(u64, u64)>) {
            let moved = |x: &Vector<2>| {
                let d = if Self::is_upper(x) { displacement } else { [0.0; 2] };
                [x[0] + d[0], x[1] + d[1]]
            };
            let positions: Vec<Vector<2>> = self.origin.iter().map(moved).collect();
            let mut cells = Cells::default();
            cells.lay(&positions, 3.0);
            let id: Vec<u64> = cells.order.iter().map(|&i| u64::from(i)).collect();
            let at = |all: &[Vector<2>]| -> Vec<Vector<2>> {
                cells.order.iter().map(|&i| all[i as usize]).collect()
            };
            let (positions, origin) = (at(&positions), at(&self.origin));
            let volumes = vec![1.0; id.len()];
            let body_of = |x: &Vector<2>| if Self::is_upper(x) { self.bodies - 1 } else { 0 };
            let body: Vec<u32> = origin.iter().map(body_of).collect();
            let kinship = Kinship {
                id: &id,
                bonds: &self.bonds,
                grows,
                body: &body,
                origin: &origin,
                bonded: false,
                reach: REACH,
                sizes: &[],
            };
            let factors = DMatrix::from_element(1, 1, 1.0);
            let rows = ([].as_slice(), &factors);
            let cloud =
                Cloud { positions: &positions, volumes: &volumes, kinship, metrics: &[], rows };
            let smoothing = Smoothing { kernel: KernelChoice::WendlandC2, length: 1.5 };
            let (mut list, mut contact) = (NeighbourList::default(), Vec::new());
            let bonds = build_list(&mut list, &cells, &cloud, smoothing, (&mut contact, 1.8));
            self.bonds = bonds;
            let mut neighbours = vec![Vec::new(); id.len()];
            for (i, own) in id.iter().enumerate() {
                let (index, weight) = list.row(i);
                let mut row: Vec<u64> = index.iter().map(|&j| id[j as usize]).collect();
                for (&j, &w) in index.iter().zip(weight) {
                    let (back, weights) = list.row(j as usize);
                    let place = back.iter().position(|&k| k as usize == i);
                    assert_eq!(
                        weights[place.expect("each pair from both sides")].to_bits(),
                        w.to_bits()
                    );
                }
                row.sort_unstable();
                neighbours[*own as usize] = row;
            }
            let pair = |&(i, j): &(u32, u32)| (id[i as usize], id[j as usize]);
            (neighbours, contact.iter().map(pair).collect())
        }
    }

    #[test]
    fn blocks_that_slide_past_each_other_stay_one_piece() {
        let mut blocks = Blocks::new();
        let mut way = 0.0;
        while way < 30.0 {
            way += 0.25;
            blocks.neighbours([way, 0.0], true);
        }
        let before = blocks.bonds.clone();
        let (neighbours, contact) = blocks.neighbours([way, 0.0], true);
        assert!(contact.is_empty(), "{contact:?}");
        // Of the last row below, where the upper block is above it and where it has left.
        let row = (ROWS / 2 - 1) * LENGTH;
        let (under, free) = (&neighbours[row + 45], &neighbours[row + 15]);
        assert_eq!((under.len(), free.len()), (24, 14));
        let above = under.iter().filter(|&&j| j as usize >= LENGTH * ROWS / 2);
        assert!(above.clone().count() > 4);
        for &j in above {
            let there = blocks.origin[j as usize][0];
            assert!((there + 30.0 - 45.0).abs() < 3.0, "{there}");
        }
        // A restart finds what there was, without anything new.
        assert_eq!(blocks.bonds, before);
        let (again, _) = blocks.neighbours([way, 0.0], false);
        assert!(again == neighbours && blocks.bonds == before);
    }

    #[test]
    fn surfaces_that_meet_stay_two() {
        let mut blocks = Blocks::new();
        // Parted, carried along out of reach, and laid down again.
        blocks.neighbours([0.0, 10.0], true);
        for height in [10.0, 4.0, 2.5, 1.5, 0.5, 0.0] {
            blocks.neighbours([20.0, height], true);
        }
        let (neighbours, contact) = blocks.neighbours([20.0, 0.0], true);
        assert!(blocks.bonds.is_empty());
        let row = (ROWS / 2 - 1) * LENGTH;
        assert_eq!(neighbours[row + 40].len(), 14);
        // Straight and slanting to three above.
        let touched = contact.iter().filter(|(i, _)| *i as usize == row + 40);
        assert_eq!(touched.count(), 3);
        assert!(contact.iter().all(|&(i, j)| contact.contains(&(j, i))));
    }

    #[test]
    fn different_bodies_never_join() {
        let mut blocks = Blocks { bodies: 2, ..Blocks::new() };
        for way in 0..12 {
            let (neighbours, contact) = blocks.neighbours([f64::from(way), 0.0], true);
            assert_eq!(neighbours[(ROWS / 2 - 1) * LENGTH + 30].len(), 14);
            assert!(!contact.is_empty() && blocks.bonds.is_empty());
        }
    }
}
