//! Neighbour lists over a fixed reference configuration, by cells of the
//! kernel's support and counting sort.
//!
//! Every particle lists all its neighbours (no half lists): each gathers over
//! its own ordered list, so that results do not depend on the thread count.

use crate::kernel::KernelChoice;
use crate::strangers::Kinship;
use crate::tensor::{Matrix, Vector, apply, dot, minus, sum_scaled};
use rayon::prelude::*;

/// Particles handled by one task; fixed, so that sums over tasks have one order.
pub(crate) const CHUNK: usize = 64;
/// Chunks that a thread takes at a time. Chunks differ in cost (plastic flow, free surfaces), and left
/// to itself rayon hands out quarters of a sweep: one of two threads then waits for the other.
pub(crate) const TURN: usize = 2;

/// Neighbours of all particles in compressed rows.
#[derive(Debug, Default)]
pub(crate) struct NeighbourList {
    /// `start[i]..start[i + 1]` is the row of particle `i`.
    start: Vec<u32>,
    /// Index of the neighbour.
    index: Vec<u32>,
    /// `-W'(r)/r V_j` in 1/m^2.
    weight: Vec<f64>,
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
        4 * (self.start.capacity() + self.index.capacity()) + 8 * self.weight.capacity()
    }
}

/// Cells of the size of the support, covering the bounding box of the particles.
#[derive(Debug)]
pub(crate) struct Cells<const D: usize> {
    origin: Vector<D>,
    inverse_size: f64,
    counts: [usize; 3],
    /// First particle of each cell, after sorting.
    start: Vec<u32>,
}

/// Upper limit on the number of cells: a far-flung particle must not exhaust the memory.
const MAX_CELLS_PER_PARTICLE: usize = 64;

impl<const D: usize> Cells<D> {
    /// Lays cells of at least `size` over `positions`.
    pub(crate) fn new(positions: &[Vector<D>], size: f64) -> Self {
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for position in positions {
            for k in 0..D {
                low[k] = low[k].min(position[k]);
                high[k] = high[k].max(position[k]);
            }
        }
        let mut size = size;
        let limit = MAX_CELLS_PER_PARTICLE * positions.len().max(64);
        loop {
            let mut counts = [1_usize; 3];
            let mut total = 1.0;
            for k in 0..D {
                let extent = ((high[k] - low[k]) / size).floor() + 1.0;
                total *= extent;
                // Exact for the sizes admitted by `limit`; a larger value is retried with larger cells.
                counts[k] = extent.min(1e9) as usize;
            }
            if total <= limit as f64 {
                let start = vec![0; counts[0] * counts[1] * counts[2] + 1];
                return Self { origin: low, inverse_size: 1.0 / size, counts, start };
            }
            size *= 1.5;
        }
    }

    /// Cell coordinates of a position inside the bounding box.
    fn coordinates(&self, position: &Vector<D>) -> [usize; 3] {
        let mut cell = [0; 3];
        for k in 0..D {
            // Non-negative by construction; truncation is the floor.
            let along = ((position[k] - self.origin[k]) * self.inverse_size) as usize;
            cell[k] = along.min(self.counts[k] - 1);
        }
        cell
    }

    fn flat(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.counts[1] + cell[1]) * self.counts[0] + cell[0]
    }

    /// Sorts by cell, stably: the order in which the particles are to be stored.
    pub(crate) fn sort(&mut self, positions: &[Vector<D>]) -> Vec<u32> {
        let cell_of: Vec<u32> =
            positions.iter().map(|position| self.flat(self.coordinates(position)) as u32).collect();
        self.start.fill(0);
        for &cell in &cell_of {
            self.start[cell as usize + 1] += 1;
        }
        for cell in 1..self.start.len() {
            self.start[cell] += self.start[cell - 1];
        }
        let mut next = self.start.clone();
        let mut order = vec![0; positions.len()];
        for (particle, &cell) in cell_of.iter().enumerate() {
            let place = &mut next[cell as usize];
            order[*place as usize] = particle as u32;
            *place += 1;
        }
        order
    }

    /// Calls `visit` with each range of particles in the cells around `position`.
    pub(crate) fn around(
        &self,
        position: &Vector<D>,
        mut visit: impl FnMut(std::ops::Range<usize>),
    ) {
        let cell = self.coordinates(position);
        let low = |k: usize| cell[k].saturating_sub(1);
        let high = |k: usize| (cell[k] + 1).min(self.counts[k] - 1);
        for plane in low(2)..=high(2) {
            for row in low(1)..=high(1) {
                let first = self.flat([low(0), row, plane]);
                let last = self.flat([high(0), row, plane]);
                visit(self.start[first] as usize..self.start[last + 1] as usize);
            }
        }
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

/// Builds the list for particles already stored in cell order, strangers left out. `metrics` are
/// the inverse shapes of the supports, or none for round ones.
pub(crate) fn build_list<const D: usize>(
    list: &mut NeighbourList,
    cells: &Cells<D>,
    positions: &[Vector<D>],
    volumes: &[f64],
    kinship: Kinship<D>,
    smoothing: Smoothing,
    metrics: &[Matrix<D>],
) {
    let support = smoothing.support();
    let square_of = |i: usize, j: usize| {
        let separation = minus(&positions[j], &positions[i]);
        if metrics.is_empty() {
            return dot(&separation, &separation);
        }
        let both = sum_scaled(&metrics[i], 1.0, &metrics[j]);
        0.5 * dot(&separation, &apply(&both, &separation))
    };
    // Calls `found(j, r^2)` for each neighbour of `i`, always in the same order.
    let search = |i: usize, found: &mut dyn FnMut(usize, f64)| {
        cells.around(&positions[i], |range| {
            for j in range {
                let square = square_of(i, j);
                if square < support * support && j != i && kinship.joins(i, j) {
                    found(j, square);
                }
            }
        });
    };
    // Counting first and filling in place afterwards needs no second copy of the list.
    list.start.clear();
    list.start.resize(positions.len() + 1, 0);
    list.start[1..].par_chunks_mut(CHUNK).enumerate().with_max_len(TURN).for_each(
        |(chunk, counts)| {
            for (offset, count) in counts.iter_mut().enumerate() {
                search(chunk * CHUNK + offset, &mut |_, _| *count += 1);
            }
        },
    );
    for i in 1..list.start.len() {
        list.start[i] += list.start[i - 1];
    }
    let total = list.start[positions.len()] as usize;
    resize_sparingly(&mut list.index, total, 0);
    resize_sparingly(&mut list.weight, total, 0.0);
    let rows = rows_of_chunks(&list.start, &mut list.index, &mut list.weight);
    rows.into_par_iter().enumerate().with_max_len(TURN).for_each(|(chunk, (indices, weights))| {
        let first = chunk * CHUNK;
        let mut places = indices.iter_mut().zip(weights.iter_mut());
        for i in first..(first + CHUNK).min(positions.len()) {
            search(i, &mut |j, square| {
                let (index, weight) = places.next().expect("as many as were counted");
                *index = j as u32;
                *weight = volumes[j] * smoothing.kernel.weight(square.sqrt(), smoothing.length, D);
            });
        }
    });
}

/// Pairs closer than `reach` that do not belong together, each from both sides, in the order of
/// the first; `reach` must not exceed the cell size.
pub(crate) fn find_strangers<const D: usize>(
    cells: &Cells<D>,
    positions: &[Vector<D>],
    kinship: Kinship<D>,
    reach: f64,
) -> Vec<(u32, u32)> {
    let of_chunk = |(chunk, own): (usize, &[Vector<D>])| {
        let mut found = Vec::new();
        for (offset, position) in own.iter().enumerate() {
            let i = chunk * CHUNK + offset;
            cells.around(position, |range| {
                for j in range {
                    let separation = minus(&positions[j], position);
                    let near = dot(&separation, &separation) < reach * reach;
                    if near && j != i && !kinship.joins(i, j) {
                        found.push((i as u32, j as u32));
                    }
                }
            });
        }
        found
    };
    let chunks: Vec<_> =
        positions.par_chunks(CHUNK).enumerate().with_max_len(TURN).map(of_chunk).collect();
    chunks.concat()
}

/// Resizes without the doubling of `Vec`: a list grows by a few per cent at most.
fn resize_sparingly<T: Clone>(values: &mut Vec<T>, length: usize, filler: T) {
    if values.capacity() < length {
        values.reserve_exact(length + length / 16 - values.len());
    }
    values.resize(length, filler);
}

/// Splits the list into the parts that belong to the chunks of particles.
fn rows_of_chunks<'a>(
    start: &[u32],
    mut index: &'a mut [u32],
    mut weight: &'a mut [f64],
) -> Vec<(&'a mut [u32], &'a mut [f64])> {
    let count = start.len() - 1;
    let mut parts = Vec::with_capacity(count.div_ceil(CHUNK));
    for first in (0..count).step_by(CHUNK) {
        let length = (start[(first + CHUNK).min(count)] - start[first]) as usize;
        let (head, tail) = index.split_at_mut(length);
        let (weight_head, weight_tail) = weight.split_at_mut(length);
        parts.push((head, weight_head));
        (index, weight) = (tail, weight_tail);
    }
    parts
}
