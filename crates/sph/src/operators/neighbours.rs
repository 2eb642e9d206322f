//! Neighbour lists over a fixed reference configuration, by cells of the
//! kernel's support and counting sort.
//!
//! Every particle lists all its neighbours (no half lists): each gathers over
//! its own ordered list, so that results do not depend on the thread count.

use crate::kernel::KernelChoice;
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

/// Cells of the size of the support, covering the bounding box of the particles.
#[derive(Debug)]
pub(crate) struct Cells<const D: usize> {
    origin: Vector<D>,
    inverse_size: f64,
    counts: [usize; 3],
    /// First particle of each cell, after sorting.
    start: Vec<u32>,
    /// Cell of each particle.
    cell_of: Vec<u32>,
    /// Where the next particle of each cell comes; only while sorting.
    next: Vec<u32>,
    /// The particles in the order in which they are to be stored.
    pub(crate) order: Vec<u32>,
    /// Largest size of the particles of each cell; empty where all are 1.
    largest: Vec<f64>,
    /// Largest of these.
    coarsest: f64,
    /// Support of a particle of size 1 over the cells' size.
    support: f64,
}

impl<const D: usize> Default for Cells<D> {
    fn default() -> Self {
        Self {
            origin: [0.0; D],
            inverse_size: 1.0,
            counts: [1; 3],
            start: Vec::new(),
            cell_of: Vec::new(),
            next: Vec::new(),
            order: Vec::new(),
            largest: Vec::new(),
            coarsest: 1.0,
            support: 1.0,
        }
    }
}

/// Upper limit on the number of cells: a far-flung particle must not exhaust the memory.
const MAX_CELLS_PER_PARTICLE: usize = 64;

impl<const D: usize> Cells<D> {
    /// Lays cells of at least `size` over `positions` and sorts these by cell, stably: `order` is the order in
    /// which the particles are to be stored.
    pub(crate) fn lay(&mut self, positions: &[Vector<D>], size: f64) {
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for position in positions {
            for k in 0..D {
                low[k] = low[k].min(position[k]);
                high[k] = high[k].max(position[k]);
            }
        }
        let support = size;
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
                self.start.clear();
                self.start.resize(counts[0] * counts[1] * counts[2] + 1, 0);
                (self.origin, self.inverse_size, self.counts) = (low, 1.0 / size, counts);
                self.support = support / size;
                return self.sort(positions);
            }
            size *= 1.5;
        }
    }

    /// Notes how large the particles are, which are in their order now; `sizes` is empty where all are 1.
    pub(crate) fn note_sizes(&mut self, sizes: &[f64]) {
        self.largest.clear();
        if !sizes.is_empty() {
            let largest = |cell: &[u32]| {
                let own = &sizes[cell[0] as usize..cell[1] as usize];
                own.iter().copied().fold(0.0, f64::max)
            };
            self.largest.extend(self.start.windows(2).map(largest));
        }
        self.coarsest = self.largest.iter().copied().fold(1.0, f64::max);
    }

    /// Memory in bytes.
    pub(crate) fn memory(&self) -> usize {
        4 * (self.start.capacity()
            + 2 * self.largest.capacity()
            + self.cell_of.capacity()
            + self.next.capacity()
            + self.order.capacity())
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

    fn sort(&mut self, positions: &[Vector<D>]) {
        let mut cell_of = std::mem::take(&mut self.cell_of);
        cell_of.clear();
        cell_of.extend(positions.iter().map(|at| self.flat(self.coordinates(at)) as u32));
        for &cell in &cell_of {
            self.start[cell as usize + 1] += 1;
        }
        for cell in 1..self.start.len() {
            self.start[cell] += self.start[cell - 1];
        }
        self.next.clone_from(&self.start);
        self.order.resize(positions.len(), 0);
        for (particle, &cell) in cell_of.iter().enumerate() {
            let place = &mut self.next[cell as usize];
            self.order[*place as usize] = particle as u32;
            *place += 1;
        }
        self.cell_of = cell_of;
    }

    /// Calls `visit` with each range of particles in the cells around `position` that may lie within its support, where a
    /// particle of `size` is; the support of two is that of their mean size.
    pub(crate) fn around(
        &self,
        position: &Vector<D>,
        size: f64,
        mut visit: impl FnMut(std::ops::Range<usize>),
    ) {
        let cell = self.coordinates(position);
        let reach = |largest: f64| 0.5 * (size + largest) * self.support;
        let cells = if self.largest.is_empty() { 1 } else { reach(self.coarsest).ceil() as usize };
        let low = |k: usize| cell[k].saturating_sub(cells);
        let high = |k: usize| (cell[k] + cells).min(self.counts[k] - 1);
        for plane in low(2)..=high(2) {
            for row in low(1)..=high(1) {
                let first = self.flat([low(0), row, plane]);
                let last = self.flat([high(0), row, plane]);
                if self.largest.is_empty() {
                    visit(self.start[first] as usize..self.start[last + 1] as usize);
                    continue;
                }
                for (column, place) in (low(0)..=high(0)).zip(first..) {
                    let between = |k: usize, there: usize| there.abs_diff(cell[k]).max(1) - 1;
                    let apart = [between(0, column), between(1, row), between(2, plane)];
                    let square = apart.iter().map(|cells| cells * cells).sum::<usize>() as f64;
                    let largest = self.largest[place];
                    if largest > 0.0 && square < reach(largest).powi(2) {
                        visit(self.start[place] as usize..self.start[place + 1] as usize);
                    }
                }
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

/// Who belongs together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kinship<'a, const D: usize> {
    pub(crate) body: &'a [u32],
    pub(crate) origin: &'a [Vector<D>],
    /// Whether different bodies are one continuum.
    pub(crate) bonded: bool,
    /// Largest undeformed distance of kin of size 1, in m.
    pub(crate) reach: f64,
    /// Spacing of each particle over the particle spacing; empty where all are the same.
    pub(crate) sizes: &'a [f64],
}

impl<const D: usize> Kinship<'_, D> {
    /// Whether `i` and `j` are parts of one piece of material.
    #[inline]
    pub(crate) fn joins(&self, i: usize, j: usize) -> bool {
        let apart = minus(&self.origin[j], &self.origin[i]);
        let reach = self.reach * self.size(i, j);
        dot(&apart, &apart) < reach * reach && (self.bonded || self.body[i] == self.body[j])
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
}

impl Rows {
    fn clear(&mut self) {
        self.counts.clear();
        self.index.clear();
        self.weight.clear();
        self.self_contact.clear();
    }

    fn memory(&self) -> usize {
        4 * (self.counts.capacity() + self.index.capacity() + 2 * self.self_contact.capacity())
            + 8 * self.weight.capacity()
    }
}

/// Builds the list, and finds the pairs of self-contact: closer than `reach` without belonging together, each from both sides, in the order of the first. `reach` and every support must not exceed the cells.
pub(crate) fn build_list<const D: usize>(
    list: &mut NeighbourList,
    cells: &Cells<D>,
    cloud: &Cloud<D>,
    smoothing: Smoothing,
    (self_contact, reach): (&mut Vec<(u32, u32)>, f64),
) {
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
        }
    }
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
    let Cloud { positions, volumes, kinship, metrics, rows: (classes, factors) } = *cloud;
    let support = smoothing.support();
    for i in own {
        let before = rows.index.len();
        cells.around(&positions[i], kinship.size(i, i), |range| {
            for j in range {
                let separation = minus(&positions[j], &positions[i]);
                let distance_square = dot(&separation, &separation);
                let square = if metrics.is_empty() {
                    distance_square
                } else {
                    let both = sum_scaled(&metrics[i], 1.0, &metrics[j]);
                    0.5 * dot(&separation, &apply(&both, &separation))
                };
                let size = kinship.size(i, j);
                let (support, reach) = (support * size, reach * size);
                let (in_support, near) =
                    (square < support * support, distance_square < reach * reach);
                if !(in_support || near) || j == i {
                    continue;
                }
                if !kinship.joins(i, j) {
                    if near {
                        rows.self_contact.push((i as u32, j as u32));
                    }
                } else if in_support {
                    let weight = smoothing.kernel.weight(square.sqrt(), smoothing.length * size, D);
                    rows.index.push(j as u32);
                    let factor = if classes.is_empty() {
                        1.0
                    } else {
                        factors[(classes[i] as usize, classes[j] as usize)]
                    };
                    rows.weight.push(volumes[j] * weight * factor);
                }
            }
        });
        rows.counts.push((rows.index.len() - before) as u32);
    }
}

/// Room for `needed` values without the doubling of `Vec`: what all are expected to be, and a sixteenth.
fn make_room<T>(values: &mut Vec<T>, needed: usize, expected: usize) {
    if values.capacity() < needed {
        values.reserve_exact(expected.max(needed) + expected / 16 - values.len());
    }
}
