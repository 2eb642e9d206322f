//! Renewal of the reference configuration: storage order, neighbours, corrections, time step.

use crate::contact::reduced;
use crate::contact::self_contact::Kinship;
use crate::engine::{Engine, Frame, MaterialData};
use crate::operators::laplacian;
use crate::operators::neighbours::{CHUNK, Cells, Cloud, NeighbourList, TURN, build_list};
use crate::particles::motion::Motion;
use crate::tensor::{
    Matrix, Vector, apply, clamped_spectrum, determinant, dot, identity, inverse_nonsingular,
    minus, plus_scaled, trace, zero,
};
use rayon::prelude::*;

/// Spread of the displacements since the last refresh, in particle spacings, that triggers one.
const REFRESH_SPREAD: f64 = 0.25;
/// Particles within this many spacings of the surface are watched for contact until the next refresh.
const CONTACT_MARGIN: f64 = 1.0;
/// The same for strangers, beyond the spacing at which they touch.
const STRANGER_MARGIN: f64 = 0.8;
/// A moment matrix flatter than this (determinant over that of the isotropic one of the same
/// trace) has no inverse worth using: such a particle has neighbours on a line only, sees no
/// velocity gradient and bears no stress until it meets others.
const FLATTEST_MOMENT: f64 = 0.02;
/// Smallest eigenvalue of a moment over the mean of all: those of a rectangular corner are 0.36.
const THINNEST_MOMENT: f64 = 0.15;
/// Share of the explicit limit of the hourglass damping that the time step may use.
const DAMPING_SAFETY: f64 = 0.8;
/// The same for the oscillation of a particle on the contact penalty, in terms of (m/k)^(1/2).
const CONTACT_SAFETY: f64 = 0.5;
/// Share of the explicit limit of conduction, `C_i / (2 s_i k)`, that a conduction step may use. A
/// pair weighs at most 2 [`laplacian::LARGEST`] instead of 2, so a quarter keeps every new
/// temperature between its neighbours'.
const CONDUCTION_SAFETY: f64 = 1.0 / laplacian::LARGEST;
/// The time step never falls below this share of its value on the undisturbed lattice.
const SMALLEST_TIME_STEP: f64 = 0.1;

impl<const D: usize> Engine<D> {
    /// Whether strain or displacement since the last refresh demand a new one.
    pub(crate) fn refresh_is_due(&self) -> bool {
        let since = &self.since_refresh;
        if since.strain >= self.numerics.refresh_strain {
            return true;
        }
        let (mut low, mut high) = (since.low, since.high);
        if let Some(tool) = &self.tool {
            let mut moved: Vector<D> = reduced(&tool.way(self.refresh_time, self.time));
            if let Some(axes) = &self.tilted_axes {
                moved = apply(axes, &moved);
            }
            for k in 0..D {
                low[k] = low[k].min(moved[k]);
                high[k] = high[k].max(moved[k]);
            }
        }
        (0..D).any(|k| high[k] - low[k] > REFRESH_SPREAD * self.spacing)
    }

    /// Makes the present configuration the reference.
    pub(crate) fn refresh(&mut self) {
        self.carry_shapes();
        let mut cells = std::mem::take(&mut self.cells);
        cells.lay(&self.position, self.support_reach);
        self.reorder(&cells.order);
        for (motion, position) in self.motion.iter_mut().zip(&self.position) {
            motion.set_reference(*position);
        }
        self.refresh_time = self.time;
        for (point, frame) in self.point.iter_mut().zip(&mut self.frame) {
            point.deformation = identity();
            frame.volume_ratio = point.volume_ratio;
        }
        let reference = std::mem::take(&mut self.position);
        self.rebuild(&cells, &reference);
        self.cells = cells;
        self.position = reference;
    }

    /// Rebuilds everything that follows from reference positions, those of `self.motion`, and volumes.
    pub(crate) fn rebuild(&mut self, cells: &Cells<D>, reference: &[Vector<D>]) {
        for i in 0..self.volume.len() {
            self.reference_volume[i] = self.volume[i] * self.frame[i].volume_ratio;
        }
        let mut list = std::mem::take(&mut self.list);
        let kinship = Kinship {
            body: &self.body,
            origin: &self.origin,
            bonded: self.bonded,
            reach_square: (self.numerics.bonding_distance * self.spacing).powi(2),
        };
        let cloud = Cloud {
            positions: reference,
            volumes: &self.reference_volume,
            kinship,
            metrics: &self.metrics(),
        };
        let reach = (1.0 + STRANGER_MARGIN) * self.spacing;
        let strangers = (&mut self.strangers, reach);
        build_list(&mut list, cells, &cloud, self.smoothing, strangers);
        self.list = list;
        self.find_crowded();
        let limits = self.correct_operators();
        self.set_time_step(&limits);
        if let Some(mut tool) = self.tool.take() {
            let margin = CONTACT_MARGIN * self.spacing;
            tool.refresh(reference, &self.list, self.refresh_time, margin);
            self.tool = Some(tool);
        }
        self.since_refresh = crate::output::account::Tally::default();
        self.conduction_tensor.clear();
    }

    /// Stores the particles in `order`.
    fn reorder(&mut self, order: &[u32]) {
        let mut marks = std::mem::take(&mut self.marks);
        marks.resize(order.len(), false);
        let done = &mut marks;
        permute(&mut self.id, order, done);
        permute(&mut self.body, order, done);
        permute(&mut self.material, order, done);
        permute(&mut self.hold, order, done);
        permute(&mut self.position, order, done);
        permute(&mut self.origin, order, done);
        if !self.shape.is_empty() {
            permute(&mut self.shape, order, done);
        }
        if !self.history.is_empty() {
            permute(&mut self.history, order, done);
        }
        permute(&mut self.motion, order, done);
        permute(&mut self.volume, order, done);
        permute(&mut self.point, order, done);
        permute(&mut self.force, order, done);
        self.marks = marks;
        if let Some(tool) = &mut self.tool {
            self.new_place.resize(order.len(), 0);
            for (place, &old) in order.iter().enumerate() {
                self.new_place[old as usize] = place as u32;
            }
            tool.reorder(&self.new_place);
            if let Some(heat) = &mut self.tool_heat {
                heat.reorder(&self.new_place);
            }
        }
    }

    /// Corrections B and moments; returns what limits the time step.
    fn correct_operators(&mut self) -> Limits {
        let (list, motion) = (&self.list, &self.motion);
        self.frame
            .par_chunks_mut(CHUNK)
            .enumerate()
            .with_max_len(TURN)
            .map(|(chunk, frames)| {
                let mut limits = Limits::default();
                for (offset, frame) in frames.iter_mut().enumerate() {
                    correct(frame, list, motion, chunk * CHUNK + offset, &mut limits);
                }
                limits
            })
            // The largest is the largest in any order.
            .reduce(Limits::default, |a, b| Limits {
                gradient: a.gradient.max(b.gradient),
                weight: a.weight.max(b.weight),
            })
    }

    /// The time step from p-waves, hourglass damping, contact penalty and conduction.
    ///
    /// p-wave: `CFL h_s / c` on the undisturbed lattice, shortened as the discrete gradient
    /// operator grows where particles crowd.
    fn set_time_step(&mut self, limits: &Limits) {
        if self.lattice_gradient == 0.0 {
            self.lattice_gradient = limits.gradient;
        }
        self.largest_weight = limits.weight;
        let crowding = (self.lattice_gradient / limits.gradient).clamp(SMALLEST_TIME_STEP, 1.0);
        let (mut mechanical, mut thermal) = (f64::INFINITY, f64::INFINITY);
        let best_conductor =
            self.materials.iter().map(MaterialData::best_conductivity).fold(0.0, f64::max);
        for data in &self.materials {
            let wave = self.numerics.courant * self.smoothing.length / data.wave_speed * crowding;
            let wave = wave * self.compression_shortening(data);
            let wave = wave * viscous_shortening(data, self.smoothing.length, limits.gradient);
            let density = data.density * self.numerics.mass_scaling;
            let damping = if data.hourglass > 0.0 {
                DAMPING_SAFETY * density / (2.0 * limits.weight * data.hourglass)
            } else {
                f64::INFINITY
            };
            let contact =
                CONTACT_SAFETY * self.spacing / data.wave_speed / self.contact_stiffness.sqrt();
            let touches = self.tool.is_some() || !self.strangers.is_empty() || !self.bonded;
            let contact = if touches { contact } else { f64::INFINITY };
            mechanical = mechanical.min(wave).min(damping).min(contact);
            if self.conducts && data.best_conductivity() > 0.0 {
                let capacity = data.density * data.least_specific_heat();
                // The harmonic mean with any other material stays below both.
                let conductivity = best_conductor.min(2.0 * data.best_conductivity());
                thermal = thermal
                    .min(CONDUCTION_SAFETY * capacity / (2.0 * limits.weight * conductivity));
            }
        }
        self.conduction_interval = thermal;
        let sources = self.heat_sources.iter().map(|source| source.longest_step(self.spacing));
        let moving = sources.fold(f64::INFINITY, f64::min);
        let tool = self.tool_heat.as_ref().map_or(f64::INFINITY, |heat| heat.interval);
        let resting = thermal.min(self.longest_step).min(tool);
        self.time_step = if self.mechanics { mechanical } else { resting };
        self.time_step = self.time_step.min(moving);
    }
}

/// Puts `values[order[k]]` at place k, cycle by cycle: a second copy of the particles would double the
/// memory at its peak. `done` is room for one mark per value.
fn permute<T: Copy>(values: &mut [T], order: &[u32], done: &mut [bool]) {
    done.fill(false);
    for first in 0..values.len() {
        if done[first] {
            continue;
        }
        let displaced = values[first];
        let mut place = first;
        loop {
            done[place] = true;
            let source = order[place] as usize;
            if source == first {
                break;
            }
            values[place] = values[source];
            place = source;
        }
        values[place] = displaced;
    }
}

/// How much bulk viscosity shortens the explicit step of a p-wave: `(1 + z^2)^(1/2) - z` with the
/// damping ratio `z = alpha h_s S / 2` of the shortest mode, S = sum_j |w B X| (Belytschko, Liu,
/// Moran, Nonlinear Finite Elements, 2000, section 6.2: central differences with damping).
fn viscous_shortening(data: &MaterialData, smoothing_length: f64, gradient: f64) -> f64 {
    let impedance = data.inertial_density() * data.wave_speed * smoothing_length;
    let ratio = 0.5 * data.linear_viscosity / impedance * smoothing_length * gradient;
    ratio.hypot(1.0) - ratio
}

/// What limits the time step.
#[derive(Debug, Clone, Copy, Default)]
struct Limits {
    /// Largest sum_j |w B X| in 1/m.
    gradient: f64,
    /// Largest sum_j w in 1/m^2.
    weight: f64,
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

fn correct<const D: usize>(
    frame: &mut Frame<D>,
    list: &NeighbourList,
    motion: &[Motion<D>],
    i: usize,
    limits: &mut Limits,
) {
    let (index, weight) = list.row(i);
    let mut second = zero();
    let mut first = [0.0; D];
    let mut total = 0.0;
    for (&j, &w) in index.iter().zip(weight) {
        let separation = minus(motion[j as usize].reference(), motion[i].reference());
        total += w;
        first = plus_scaled(&first, w, &separation);
        for row in 0..D {
            for column in 0..D {
                second[row][column] += w * separation[row] * separation[column];
            }
        }
    }
    let mean = trace(&second) / D as f64;
    let power = i32::try_from(D).expect("2 or 3");
    let usable = mean > 0.0 && determinant(&second) > FLATTEST_MOMENT * mean.powi(power);
    frame.correction = if usable { inverse_nonsingular(&filled(second, mean)) } else { zero() };
    frame.moment = first;
    frame.lean = apply(&frame.correction, &first);
    frame.weight = total;
    let gradient: f64 = index
        .iter()
        .zip(weight)
        .map(|(&j, &w)| {
            let separation = minus(motion[j as usize].reference(), motion[i].reference());
            let vector = apply(&frame.correction, &separation);
            w * dot(&vector, &vector).sqrt()
        })
        .sum();
    limits.gradient = limits.gradient.max(gradient);
    limits.weight = limits.weight.max(total);
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

    #[test]
    fn values_are_put_in_order_in_place() {
        // A cycle of four, a pair that changes places and one that stays.
        let order = [2, 1, 5, 4, 3, 6, 0];
        let mut values = [10, 11, 12, 13, 14, 15, 16];
        permute(&mut values, &order, &mut [true; 7]);
        assert_eq!(values, [12, 11, 15, 14, 13, 16, 10]);
    }
}
