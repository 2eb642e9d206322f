//! The reference configuration: where particles were when the operators were last corrected, their neighbours and the
//! corrections.

use crate::lanes::{Lanes, order, with_lanes};
use crate::ledger::Tally;
use crate::numerics::Numerics;
use crate::operators::cells::Cells;
use crate::operators::kinship::{Kinship, pair_mean};
use crate::operators::neighbours::{Cloud, NeighbourList, Watched, build_list};
use crate::parallel::{CHUNK, TURN};
use crate::particles::Particles;
use crate::particles::lattice::RowClasses;
use crate::particles::motion::Motion;
use crate::setup::{CuttingFrame, Setup};
use crate::tensor::{
    Matrix, Vector, apply, clamped_spectrum, determinant, dot, identity, inverse_nonsingular,
    minus, reduced, trace, zero,
};
use glam::DVec3;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// A moment matrix flatter than this (determinant over that of the isotropic one of the same
/// trace) has no inverse worth using: such a particle has neighbours on a line only, sees no
/// velocity gradient and bears no stress until it meets others.
const FLATTEST_MOMENT: f64 = 0.02;
/// Smallest eigenvalue of a moment over the mean of all: those of a rectangular corner are 0.36.
const THINNEST_MOMENT: f64 = 0.15;
/// The discrete operators of one particle in the reference configuration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame<const D: usize> {
    /// B.
    pub(crate) correction: Matrix<D>,
    /// c = sum_j w_ij X_ij.
    pub(crate) moment: Vector<D>,
    /// q = B c.
    pub(crate) lean: Vector<D>,
    /// s = sum_j w_ij in 1/m^2.
    pub(crate) weight: f64,
    /// V / V_0 of the reference.
    pub(crate) volume_ratio: f64,
}

impl<const D: usize> Default for Frame<D> {
    fn default() -> Self {
        Self {
            correction: zero(),
            moment: [0.0; D],
            lean: [0.0; D],
            weight: 0.0,
            volume_ratio: 1.0,
        }
    }
}

/// Neighbours and operators of the particles where they were at the last update.
#[derive(Debug)]
pub(crate) struct ReferenceConfiguration<const D: usize> {
    pub(crate) frame: Vec<Frame<D>>,
    /// Volume of each particle in m^3 (m^2).
    pub(crate) volume: Vec<f64>,
    /// Spacing of each particle over the particle spacing; empty where all are the same.
    pub(crate) sizes: Vec<f64>,
    /// Class of each particle's row; empty where all are the same.
    row_classes: Vec<u8>,
    /// psi of pairs of classes ([`crate::particles::row_pairs`]).
    factors: DMatrix<f64>,
    pub(crate) list: NeighbourList,
    /// Kept from one update to the next for its room.
    pub(crate) cells: Cells<D>,
    /// When it was in s.
    pub(crate) time: f64,
    /// Strain and displacements since then.
    pub(crate) since: Tally,
    /// Largest distance of neighbours in m.
    pub(crate) reach: f64,
    pub(crate) limits: OperatorLimits,
    /// Largest sum_j |w_ij B_i X_ij| at the start: unit of the time step; 0 until known.
    pub(crate) lattice_gradient: f64,
    /// Directions of cut, feed and edge as rows, where they are not the axes: what triggers an update is
    /// measured along them, so that a rotated scenario updates at the same times.
    pub(crate) tilted_axes: Option<Matrix<D>>,
    /// Undeformed distance in m up to which particles of one body belong together wherever they meet.
    bonding_distance: f64,
    /// Pairs that belong together though they were farther apart: [`Kinship::bonds`].
    pub(crate) bonds: Vec<(u64, u64)>,
}

/// What may belong together after an update of the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bonding {
    /// Pairs between which flow has left no gap.
    Anew,
    /// Those that did before.
    Kept,
}

impl<const D: usize> ReferenceConfiguration<D> {
    /// None yet.
    pub(crate) fn none(setup: &Setup, numerics: &Numerics) -> Self {
        Self {
            frame: Vec::new(),
            volume: Vec::new(),
            sizes: Vec::new(),
            row_classes: Vec::new(),
            factors: RowClasses::of(setup).factors,
            list: NeighbourList::default(),
            cells: Cells::default(),
            time: 0.0,
            since: Tally::default(),
            reach: numerics.coarsest * numerics.smoothing.support(),
            limits: OperatorLimits::default(),
            lattice_gradient: 0.0,
            tilted_axes: tilted_axes(&setup.frame),
            bonding_distance: setup.numerics.get("bonding_distance") * numerics.spacing,
            bonds: Vec::new(),
        }
    }

    /// Gives every particle its place.
    pub(crate) fn resize(&mut self, count: usize) {
        self.frame.resize(count, Frame::default());
        self.volume.resize(count, 0.0);
    }

    /// The strain since the update, and the spread of the displacements with that of the tool, which went `way`.
    pub(crate) fn changes(&self, way: Option<DVec3>) -> (f64, f64) {
        let (mut low, mut high) = (self.since.low, self.since.high);
        if let Some(way) = way {
            let mut moved: Vector<D> = reduced(way.as_ref());
            if let Some(axes) = &self.tilted_axes {
                moved = apply(axes, &moved);
            }
            for k in 0..D {
                low[k] = low[k].min(moved[k]);
                high[k] = high[k].max(moved[k]);
            }
        }
        (self.since.strain, (0..D).map(|k| high[k] - low[k]).fold(0.0, f64::max))
    }

    /// Takes the present configuration as the reference: the particles change to the order of storage.
    pub(crate) fn take(&mut self, particles: &mut Particles<D>, numerics: &Numerics, time: f64) {
        self.lay_cells(&particles.position, numerics);
        particles.reorder(&self.cells.order);
        for (motion, position) in particles.motion.iter_mut().zip(&particles.position) {
            motion.set_reference(*position);
        }
        self.time = time;
        for (point, frame) in particles.point.iter_mut().zip(&mut self.frame) {
            point.deformation = identity();
            frame.volume_ratio = point.volume_ratio;
        }
    }

    /// Lays the cells over the places of the particles in the reference, of which `order` is that of storage.
    pub(crate) fn lay_cells(&mut self, places: &[Vector<D>], numerics: &Numerics) {
        self.cells.lay(places, self.reach / numerics.coarsest);
    }

    /// Finds neighbours and corrections of the particles, which are at their places in the reference and in the order of the
    /// cells; and the pairs to be watched.
    pub(crate) fn rebuild(
        &mut self,
        particles: &Particles<D>,
        numerics: &Numerics,
        [self_contact, pairing]: [Watched; 2],
        bonding: Bonding,
    ) {
        (self.sizes, self.row_classes) = particles.sizes_and_classes();
        self.cells.note_sizes(&self.sizes);
        for (i, volume) in self.volume.iter_mut().enumerate() {
            *volume = particles.volume[i] * self.frame[i].volume_ratio;
        }
        let kinship = Kinship {
            id: &particles.id,
            bonds: &self.bonds,
            grows: bonding == Bonding::Anew,
            body: &particles.body,
            origin: &particles.origin,
            bonded: numerics.bonded,
            reach: self.bonding_distance,
            sizes: &self.sizes,
        };
        let metrics: Vec<Matrix<D>> = particles.shape.iter().map(inverse_nonsingular).collect();
        let cloud = Cloud {
            positions: &particles.position,
            volumes: &self.volume,
            kinship,
            metrics: &metrics,
            rows: (&self.row_classes, &self.factors),
        };
        let smoothing = numerics.smoothing;
        self.bonds =
            build_list(&mut self.list, &self.cells, &cloud, smoothing, self_contact, pairing);
        self.limits = self.correct_operators(&particles.motion);
        if self.lattice_gradient == 0.0 {
            self.lattice_gradient = self.limits.gradient;
        }
        self.since = Tally::default();
    }

    /// Corrections B and moments; returns what limits the time step.
    fn correct_operators(&mut self, motion: &[Motion<D>]) -> OperatorLimits {
        with_lanes!(lanes => self.correct_operators_with(lanes, motion))
    }

    fn correct_operators_with<L: Lanes>(
        &mut self,
        lanes: L,
        motion: &[Motion<D>],
    ) -> OperatorLimits {
        let (list, sizes) = (&self.list, self.sizes.as_slice());
        self.frame
            .par_chunks_mut(CHUNK)
            .enumerate()
            .with_max_len(TURN)
            .map(|(chunk, frames)| {
                lanes.run(
                    #[inline(always)]
                    || {
                        let mut limits = OperatorLimits::default();
                        for (offset, frame) in frames.iter_mut().enumerate() {
                            let i = chunk * CHUNK + offset;
                            correct(lanes, frame, (list, sizes), motion, i, &mut limits);
                        }
                        limits
                    },
                )
            })
            // The largest is the largest in any order.
            .reduce(OperatorLimits::default, |a, b| OperatorLimits {
                gradient: a.gradient.max(b.gradient),
                weight: a.weight.max(b.weight),
                damping: a.damping.max(b.damping),
            })
    }
}

/// The directions of a frame as rows; `None` where they are axes.
fn tilted_axes<const D: usize>(frame: &CuttingFrame) -> Option<Matrix<D>> {
    let directions = [frame.cutting, frame.feed, frame.passive];
    let rows: Matrix<D> = std::array::from_fn(|k| reduced(&directions[k]));
    let is_axis = |row: &Vector<D>| row.iter().all(|x| *x == 0.0 || x.abs() == 1.0);
    (!rows.iter().all(is_axis)).then_some(rows)
}

/// What limits the time step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct OperatorLimits {
    /// Largest sum_j |w B X| in 1/m.
    pub(crate) gradient: f64,
    /// Largest sum_j w in 1/m^2.
    pub(crate) weight: f64,
    /// Largest sum_j w times the mean size of the two, in 1/m^2.
    pub(crate) damping: f64,
}

/// The moment with its eigenvalues raised to [`THINNEST_MOMENT`] of their mean. Where a particle
/// has neighbours almost on a line (crumbs at the edge, the rim of a chip) the gradient across it is
/// read from next to nothing, B grows without need, and one such particle would shorten the time
/// step of all to a tenth. Raised, its gradient across the line is too small: such a
/// particle resists rigid rotation a little and angular momentum is not exact for it. Energy and
/// momentum hold for any symmetric B.
fn filled<const D: usize>(moment: Matrix<D>, mean: f64) -> Matrix<D> {
    let power = i32::try_from(D).expect("2 or 3");
    // In the plane the determinant is l (2 - l) mean^2 for a smallest eigenvalue of l; in space it is
    // at most l ((3 - l)/2)^2 mean^3.
    let rest = (D as f64 - THINNEST_MOMENT) / (D as f64 - 1.0);
    let least = THINNEST_MOMENT * rest.powi(power - 1) * mean.powi(power);
    if determinant(&moment) >= least {
        return moment;
    }
    clamped_spectrum(&moment, THINNEST_MOMENT * mean, f64::INFINITY).0
}

/// Neighbours whose terms of the gradient's limit are found at a time.
const BLOCK: usize = 32;

#[inline(always)]
fn correct<const D: usize, L: Lanes>(
    lanes: L,
    frame: &mut Frame<D>,
    (list, sizes): (&NeighbourList, &[f64]),
    motion: &[Motion<D>],
    i: usize,
    limits: &mut OperatorLimits,
) {
    let (index, weight) = list.row(i);
    let here = lanes.load(motion[i].numbers(), 0);
    // In the plane all four components of sum w X (x) X in the first; in space one row in each.
    let (mut second, mut first) = ([lanes.all(0.0); 3], lanes.all(0.0));
    let (mut total, mut damped) = (0.0, 0.0);
    for (&j, &w) in index.iter().zip(weight) {
        let there = lanes.load(motion[j as usize].numbers(), 0);
        total += w;
        damped += w * pair_mean(sizes, i, j as usize);
        let separation = lanes.sub(there, here);
        let weighted = lanes.mul(lanes.all(w), separation);
        first = lanes.add(first, weighted);
        if D == 2 {
            let row = lanes.pick::<{ order([0, 0, 1, 1]) }>(weighted);
            let column = lanes.pick::<{ order([0, 1, 0, 1]) }>(separation);
            second[0] = lanes.add(second[0], lanes.mul(row, column));
        } else {
            let rows = [
                lanes.pick::<{ order([0, 0, 0, 0]) }>(weighted),
                lanes.pick::<{ order([1, 1, 1, 1]) }>(weighted),
                lanes.pick::<{ order([2, 2, 2, 2]) }>(weighted),
            ];
            for (sum, row) in second.iter_mut().zip(rows) {
                *sum = lanes.add(*sum, lanes.mul(row, separation));
            }
        }
    }
    let (rows, first) = (second.map(|row| lanes.values(row)), lanes.values(first));
    let second: Matrix<D> = std::array::from_fn(|row| {
        std::array::from_fn(
            |column| if D == 2 { rows[0][2 * row + column] } else { rows[row][column] },
        )
    });
    let mean = trace(&second) / D as f64;
    let power = i32::try_from(D).expect("2 or 3");
    let usable = mean > 0.0 && determinant(&second) > FLATTEST_MOMENT * mean.powi(power);
    frame.correction = if usable { inverse_nonsingular(&filled(second, mean)) } else { zero() };
    frame.moment = std::array::from_fn(|k| first[k]);
    frame.lean = apply(&frame.correction, &frame.moment);
    frame.weight = total;
    let mut gradient = 0.0;
    for (index, weight) in index.chunks(BLOCK).zip(weight.chunks(BLOCK)) {
        let mut terms = [0.0; BLOCK];
        for (term, &j) in terms.iter_mut().zip(index) {
            let separation = minus(motion[j as usize].reference(), motion[i].reference());
            let vector = apply(&frame.correction, &separation);
            *term = dot(&vector, &vector);
        }
        terms.iter_mut().for_each(|term| *term = term.sqrt());
        for (term, w) in terms.iter().zip(weight) {
            gradient += w * term;
        }
    }
    limits.gradient = limits.gradient.max(gradient);
    limits.weight = limits.weight.max(total);
    limits.damping = limits.damping.max(damped);
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn only_thin_moments_are_filled() {
        // Sums of w X X over a quadrant: eigenvalues 0.41 and 0.09, 0.36 of their mean 0.25.
        let corner = [[0.25, 0.16], [0.16, 0.25]];
        assert_eq!(filled(corner, 0.25), corner);
        // An octant in space: 0.285, 0.045, 0.045 with the mean 0.125.
        let corner = [[0.125, 0.08, 0.08], [0.08, 0.125, 0.08], [0.08, 0.08, 0.125]];
        for (row, expected) in filled(corner, 0.125).iter().zip(corner) {
            for (value, expected) in row.iter().zip(expected) {
                assert_relative_eq!(*value, expected, max_relative = 1e-14);
            }
        }
        // Nearly a line: mean 0.505, so the smaller eigenvalue becomes 0.15 x 0.505 = 0.07575.
        let line = filled([[1.0, 0.0], [0.0, 0.01]], 0.505);
        assert_relative_eq!(line[0][0], 1.0, max_relative = 1e-14);
        assert_relative_eq!(line[1][1], 0.075_75, max_relative = 1e-14);
    }
}
