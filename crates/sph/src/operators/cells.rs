//! Cells over the particles, by counting sort: the order of storage, and who may be near.

use crate::tensor::Vector;

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

    /// The cell of a position inside the bounding box.
    pub(crate) fn cell_at(&self, position: &Vector<D>) -> usize {
        self.flat(self.coordinates(position))
    }

    /// Calls `visit` with each range of particles in the cells around that of `position` that may lie within the support of one in
    /// it, where the support of two is that of their mean size. Returns how far apart in m they may be at most.
    pub(crate) fn around(
        &self,
        position: &Vector<D>,
        mut visit: impl FnMut(std::ops::Range<usize>),
    ) -> f64 {
        let cell = self.coordinates(position);
        let size = self.largest.get(self.flat(cell)).copied().unwrap_or(1.0);
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
        reach(self.coarsest) / self.inverse_size
    }
}
