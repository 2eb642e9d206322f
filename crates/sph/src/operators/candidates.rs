//! Candidates for neighbours: all particles in the cells around one cell, four distances at a time.

use crate::lanes::Lanes;
use crate::operators::cells::Cells;
use crate::tensor::Vector;

/// Candidates whose distance is found at a time.
const BLOCK: usize = 4;
/// What rounding may add to a squared distance.
const ROUNDING: f64 = 1e-9;

/// The particles in the cells around one cell, which are candidates for the neighbours of all in it.
#[derive(Debug, Default)]
pub(crate) struct Candidates {
    /// Whose they are; `None` before the first.
    cell: Option<usize>,
    particle: Vec<u32>,
    /// Coordinate by coordinate, filled up to full blocks with places at infinity.
    place: [Vec<f64>; 3],
    /// The longest distance of neighbours in m.
    longest: f64,
}

impl Candidates {
    /// Has none, in the room of those before.
    pub(crate) fn forget(&mut self) {
        self.cell = None;
    }

    /// Takes those of the cell in which `position` lies, unless they are there already.
    pub(crate) fn gather<const D: usize>(
        &mut self,
        cells: &Cells<D>,
        position: &Vector<D>,
        positions: &[Vector<D>],
    ) {
        let cell = cells.cell_at(position);
        if self.cell == Some(cell) {
            return;
        }
        self.cell = Some(cell);
        self.particle.clear();
        self.place.iter_mut().for_each(Vec::clear);
        self.longest = cells.around(position, |range| {
            for (j, position) in range.clone().zip(&positions[range]) {
                self.particle.push(j as u32);
                for (place, along) in self.place.iter_mut().zip(position) {
                    place.push(*along);
                }
            }
        });
        let blocks = self.particle.len().div_ceil(BLOCK);
        self.place[..D].iter_mut().for_each(|place| place.resize(blocks * BLOCK, f64::INFINITY));
    }

    /// Calls `found` with each candidate that may be a neighbour at `position`, and with the square of its distance.
    #[inline(always)]
    pub(crate) fn within<const D: usize, L: Lanes>(
        &self,
        lanes: L,
        position: &Vector<D>,
        mut found: impl FnMut(usize, f64),
    ) {
        let limit = self.longest * self.longest * (1.0 + ROUNDING);
        for first in (0..self.particle.len()).step_by(BLOCK) {
            let mut square = lanes.all(0.0);
            for k in 0..D {
                let apart = lanes.sub(lanes.load(&self.place[k], first), lanes.all(position[k]));
                square = lanes.add(square, lanes.mul(apart, apart));
            }
            let mut hits = lanes.below(square, limit);
            if hits == 0 {
                continue;
            }
            let square = lanes.values(square);
            while hits != 0 {
                let hit = hits.trailing_zeros() as usize;
                found(self.particle[first + hit] as usize, square[hit]);
                hits &= hits - 1;
            }
        }
    }

    /// Memory in bytes.
    pub(crate) fn memory(&self) -> usize {
        4 * self.particle.capacity() + 8 * self.place.iter().map(Vec::capacity).sum::<usize>()
    }
}
