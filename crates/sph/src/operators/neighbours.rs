//! Neighbour lists over a fixed reference configuration, by cells of the kernel's support.
//!
//! Every particle lists all its neighbours (no half lists): each gathers over
//! its own ordered list, so that results do not depend on the thread count.

use crate::kernel::Smoothing;
use crate::lanes::{Lanes, with_lanes};
use crate::operators::candidates::Candidates;
use crate::operators::cells::Cells;
use crate::operators::kinship::Kinship;
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

    /// psi of the rows of `i` and `j`.
    #[inline]
    fn factor(&self, i: usize, j: usize) -> f64 {
        let (classes, factors) = self.rows;
        if classes.is_empty() { 1.0 } else { factors[(classes[i] as usize, classes[j] as usize)] }
    }
}

/// Tasks per thread whose rows wait to be joined to the list.
const BATCH: usize = 16;
/// The rows of one chunk of particles.
#[derive(Debug, Default)]
struct Rows {
    counts: Vec<u32>,
    index: Vec<u32>,
    /// Squared distances in terms of the shapes of the supports, which become the weights.
    weight: Vec<f64>,
    /// Smoothing length of each pair in m.
    length: Vec<f64>,
    /// Pairs that are near without belonging together.
    self_contact: Vec<(u32, u32)>,
    /// Neighbours at risk of the pairing instability.
    pairing: Vec<(u32, u32)>,
    /// Pairs that belong together though they were far apart, from the side of the lower id.
    bonds: Vec<(u64, u64)>,
    /// Particles near the present one that were far from it.
    far: Vec<Far>,
    candidates: Candidates,
}

/// Pairs to be watched until the next update of the reference, each from both sides, in the order of the first.
#[derive(Debug)]
pub(crate) struct Watched<'a> {
    pub(crate) pairs: &'a mut Vec<(u32, u32)>,
    /// How close they are, in m for particles of size 1.
    pub(crate) reach: f64,
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
        self.pairing.clear();
        self.bonds.clear();
        self.candidates.forget();
    }

    /// Notes a pair of neighbours if it is closer than `reach`.
    #[inline(always)]
    fn watch(&mut self, (i, j): (usize, usize), distance_square: f64, reach: f64) {
        if distance_square < reach * reach {
            self.pairing.push((i as u32, j as u32));
        }
    }

    fn memory(&self) -> usize {
        let pairs = self.self_contact.capacity() + self.pairing.capacity() + self.bonds.capacity();
        4 * (self.counts.capacity() + self.index.capacity())
            + 8 * (self.weight.capacity() + self.length.capacity() + 2 * pairs)
            + size_of::<Far>() * self.far.capacity()
            + self.candidates.memory()
    }
}

/// Builds the list, and finds the pairs of self-contact, which do not belong together, and the neighbours at risk of the pairing
/// instability. What is watched and every support must not exceed the cells.
/// Returns the pairs that belong together though they were far apart, as in [`Kinship::bonds`].
pub(crate) fn build_list<const D: usize>(
    list: &mut NeighbourList,
    cells: &Cells<D>,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    self_contact: Watched,
    pairing: Watched,
) -> Vec<(u64, u64)> {
    let watched = [self_contact, pairing];
    with_lanes!(lanes => build_list_with(lanes, list, cells, cloud, smoothing, watched))
}

fn build_list_with<const D: usize, L: Lanes>(
    lanes: L,
    list: &mut NeighbourList,
    cells: &Cells<D>,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    [self_contact, pairing]: [Watched; 2],
) -> Vec<(u64, u64)> {
    let reach = [self_contact.reach, pairing.reach];
    let mut bonds = Vec::new();
    let count = cloud.positions.len();
    let batch = BATCH * rayon::current_num_threads();
    self_contact.pairs.clear();
    pairing.pairs.clear();
    list.rows.resize_with(batch.min(count.div_ceil(CHUNK)), Rows::default);
    list.start.clear();
    make_room(&mut list.start, count + 1, count + 1);
    list.start.push(0);
    let mut pairs = 0;
    for first in (0..count).step_by(batch * CHUNK) {
        let last = (first + batch * CHUNK).min(count);
        let rows = &mut list.rows[..(last - first).div_ceil(CHUNK)];
        rows.par_iter_mut().enumerate().with_max_len(TURN).for_each(|(chunk, rows)| {
            let own = first + chunk * CHUNK;
            let own = own..(own + CHUNK).min(last);
            lanes.run(
                #[inline(always)]
                || find_rows(lanes, rows, own, cells, cloud, smoothing, reach),
            );
        });
        let before = pairs;
        for rows in &*rows {
            list.start.extend(rows.counts.iter().map(|count| {
                pairs += *count as usize;
                pairs as u32
            }));
            self_contact.pairs.extend_from_slice(&rows.self_contact);
            pairing.pairs.extend_from_slice(&rows.pairing);
            bonds.extend_from_slice(&rows.bonds);
        }
        let all = (pairs as f64 * count as f64 / last as f64) as usize;
        // What the last update left there is written over.
        if list.index.len() < pairs {
            make_room(&mut list.index, pairs, all);
            make_room(&mut list.weight, pairs, all);
            list.index.resize(pairs, 0);
            list.weight.resize(pairs, 0.0);
        }
        join(rows, &mut list.index[before..pairs], &mut list.weight[before..pairs]);
    }
    list.index.truncate(pairs);
    list.weight.truncate(pairs);
    bonds.sort_unstable();
    bonds
}

/// Copies the rows one after the other to their places, in halves that threads share.
fn join(rows: &[Rows], index: &mut [u32], weight: &mut [f64]) {
    if let [rows] = rows {
        index.copy_from_slice(&rows.index);
        weight.copy_from_slice(&rows.weight);
        return;
    }
    let (left, right) = rows.split_at(rows.len() / 2);
    let pairs = left.iter().map(|rows| rows.index.len()).sum();
    let (left_index, right_index) = index.split_at_mut(pairs);
    let (left_weight, right_weight) = weight.split_at_mut(pairs);
    rayon::join(|| join(left, left_index, left_weight), || join(right, right_index, right_weight));
}

#[inline(always)]
fn find_rows<const D: usize, L: Lanes>(
    lanes: L,
    rows: &mut Rows,
    own: std::ops::Range<usize>,
    cells: &Cells<D>,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    reach: [f64; 2],
) {
    rows.clear();
    let mut candidates = std::mem::take(&mut rows.candidates);
    let Cloud { positions, kinship, .. } = *cloud;
    let support = smoothing.support();
    for i in own {
        let before = rows.index.len();
        rows.far.clear();
        candidates.gather(cells, &positions[i], positions);
        candidates.within(
            lanes,
            &positions[i],
            #[inline(always)]
            |j, distance_square| {
                if j == i {
                    return;
                }
                let round = cloud.metrics.is_empty();
                let square = if round { distance_square } else { cloud.squares(i, j).1 };
                let size = kinship.size(i, j);
                let (support, near) = (support * size, reach[0] * size);
                let (in_support, near) =
                    (square < support * support, distance_square < near * near);
                if !(in_support || near) {
                    return;
                }
                if !kinship.joins(i, j) {
                    let in_support = in_support.then_some(square);
                    rows.far.push(Far { particle: j as u32, in_support, near });
                } else if in_support {
                    rows.index.push(j as u32);
                    rows.weight.push(square);
                    rows.watch((i, j), distance_square, reach[1] * size);
                }
            },
        );
        if !rows.far.is_empty() {
            join_far(rows, i, before, cloud, smoothing, reach[1]);
        }
        rows.counts.push((rows.index.len() - before) as u32);
        rows.length.clear();
        rows.length.extend(
            rows.index[before..].iter().map(|&j| smoothing.length * kinship.size(i, j as usize)),
        );
        let weights = &mut rows.weight[before..];
        smoothing.kernel.weigh(weights, &rows.length, D);
        for (weight, &j) in weights.iter_mut().zip(&rows.index[before..]) {
            *weight = cloud.volumes[j as usize] * *weight * cloud.factor(i, j as usize);
        }
    }
    rows.candidates = candidates;
}

/// Parts the particles near `i` that were far from it into those that belong to it, which join its row from `first` on, and
/// the others.
fn join_far<const D: usize>(
    rows: &mut Rows,
    i: usize,
    first: usize,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    pairing: f64,
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
                rows.weight.push(square);
                let distance_square = cloud.squares(i, j).0;
                rows.watch((i, j), distance_square, pairing * kinship.size(i, j));
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
    use crate::kernel::KernelChoice;
    use crate::operators::kinship::pair_mean;
    use crate::tensor::identity;

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
            let near = Watched { pairs: &mut contact, reach: 1.8 };
            let none = Watched { pairs: &mut Vec::new(), reach: 0.0 };
            let bonds = build_list(&mut list, &cells, &cloud, smoothing, near, none);
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

    /// Of a cloud of particles of two sizes, some with stretched supports, each row is what a search of all pairs finds, in
    /// their order, and so are the pairs to be watched.
    fn rows_are_those_of_all_pairs<const D: usize>(stretch: f64) {
        const SIDE: usize = 9;
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / 2.0_f64.powi(31)
        };
        let count = SIDE.pow(D as u32);
        let positions: Vec<Vector<D>> = (0..count)
            .map(|k| {
                std::array::from_fn(|d| (k / SIDE.pow(d as u32) % SIDE) as f64 + 0.8 * random())
            })
            .collect();
        let smoothing = Smoothing { kernel: KernelChoice::WendlandC2, length: 0.8 };
        let mut cells = Cells::default();
        cells.lay(&positions, smoothing.support() * stretch);
        let positions: Vec<_> = cells.order.iter().map(|&i| positions[i as usize]).collect();
        let size_of = |x: &Vector<D>| if x[0] > 4.0 { 2.0 } else { 1.0 };
        let sizes: Vec<f64> = positions.iter().map(size_of).collect();
        cells.note_sizes(&sizes);
        let mut metrics = vec![identity::<D>(); count];
        for metric in metrics.iter_mut().step_by(3) {
            metric[0][0] = 1.0 / (stretch * stretch);
        }
        let id: Vec<u64> = (0..count as u64).collect();
        let (body, volumes) = (vec![0; count], vec![1.0; count]);
        let kinship = Kinship {
            id: &id,
            bonds: &[],
            grows: false,
            body: &body,
            origin: &positions,
            bonded: false,
            // Some of the neighbours belong together, some only touch.
            reach: 1.3,
            sizes: &sizes,
        };
        let factors = DMatrix::from_element(1, 1, 1.0);
        let rows = ([].as_slice(), &factors);
        let cloud =
            Cloud { positions: &positions, volumes: &volumes, kinship, metrics: &metrics, rows };
        let (mut list, mut contact, mut close) = (NeighbourList::default(), Vec::new(), Vec::new());
        // The second time over what the first has left.
        for _ in 0..2 {
            let contact = Watched { pairs: &mut contact, reach: 1.5 };
            let close = Watched { pairs: &mut close, reach: 0.7 };
            build_list(&mut list, &cells, &cloud, smoothing, contact, close);
        }
        let (mut touching, mut crowded) = (Vec::new(), Vec::new());
        for i in 0..count {
            let mut row = Vec::new();
            for j in (0..count).filter(|j| *j != i) {
                let (distance_square, square) = cloud.squares(i, j);
                let size = pair_mean(&sizes, i, j);
                let near = |reach: f64| distance_square < (reach * size).powi(2);
                let in_support = square < (smoothing.support() * size).powi(2);
                if !near(1.3) {
                    touching.extend(near(1.5).then_some((i as u32, j as u32)));
                } else if in_support {
                    row.push((j as u32, square));
                    crowded.extend(near(0.7).then_some((i as u32, j as u32)));
                }
            }
            let (index, weight) = list.row(i);
            assert_eq!(index, row.iter().map(|pair| pair.0).collect::<Vec<_>>(), "{D}D, {i}");
            for ((j, square), weight) in row.into_iter().zip(weight) {
                let length = smoothing.length * pair_mean(&sizes, i, j as usize);
                let expected = smoothing.kernel.weight(square.sqrt(), length, D);
                assert_eq!(weight.to_bits(), expected.to_bits());
            }
        }
        assert!(contact == touching && close == crowded);
        assert!(touching.len() > count && crowded.len() > count / 4, "{}", crowded.len());
    }

    #[test]
    fn every_row_is_that_of_all_pairs() {
        for stretch in [1.0, 1.4] {
            rows_are_those_of_all_pairs::<2>(stretch);
            rows_are_those_of_all_pairs::<3>(stretch);
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
