//! The two sweeps over neighbours: velocity gradients with the stress update, and forces.

use crate::lanes::{Lanes, order, with_lanes};
use crate::ledger::{ParticleFailure, Tally};
use crate::material::data::MaterialData;
use crate::material::history::History;
use crate::material::point::MaterialPoint;
use crate::material::return_mapping::UpdateContext;
use crate::operators::neighbours::NeighbourList;
use crate::operators::reference::{Frame, ReferenceConfiguration};
use crate::parallel::{CHUNK, TURN};
use crate::particles::Particles;
use crate::particles::motion::Motion;
use crate::tensor::{
    Matrix, Vector, apply, contract, extended, minus, plus_scaled, product, sum_scaled, transpose,
};
use rayon::prelude::*;

/// Volume ratios outside this range are no metal any more.
const VOLUME_RATIO_RANGE: std::ops::RangeInclusive<f64> = 0.2..=5.0;

/// Sums over the neighbours of one particle.
struct VelocitySums<const D: usize> {
    /// sum w (v_j - v_i) (x) X_ij
    moment: Matrix<D>,
    /// sum w (v_j - v_i)
    difference: Vector<D>,
    /// sum w |v_j - v_i|^2
    square: f64,
}

/// `(X, v)` of a particle in four numbers in the plane, in twice four in space: X and v_1, X_3 and v.
#[inline(always)]
fn lanes_of<const D: usize, L: Lanes>(lanes: L, motion: &Motion<D>) -> [L::Four; 2] {
    let numbers = motion.numbers();
    [lanes.load(numbers, 0), lanes.load(numbers, 2 * D - 4)]
}

#[inline(always)]
fn gather_velocity<const D: usize, L: Lanes>(
    lanes: L,
    list: &NeighbourList,
    motion: &[Motion<D>],
    i: usize,
) -> VelocitySums<D> {
    let (index, weight) = list.row(i);
    let here = lanes_of(lanes, &motion[i]);
    let nothing = lanes.all(0.0);
    // In the plane all four components in the first; in space one row in each.
    let (mut moment, mut difference, mut square) = ([nothing; 3], nothing, nothing);
    for (&j, &w) in index.iter().zip(weight) {
        let there = lanes_of(lanes, &motion[j as usize]);
        let w = lanes.all(w);
        if D == 2 {
            let apart = lanes.sub(there[0], here[0]);
            let weighted = lanes.mul(w, apart);
            let velocity = lanes.pick::<{ order([2, 2, 3, 3]) }>(weighted);
            let separation = lanes.pick::<{ order([0, 1, 0, 1]) }>(apart);
            moment[0] = lanes.add(moment[0], lanes.mul(velocity, separation));
            difference = lanes.add(difference, weighted);
            square = lanes.add(square, lanes.mul(weighted, apart));
        } else {
            let separation = lanes.sub(there[0], here[0]);
            let apart = lanes.sub(there[1], here[1]);
            let weighted = lanes.mul(w, apart);
            let velocity = [
                lanes.pick::<{ order([1, 1, 1, 1]) }>(weighted),
                lanes.pick::<{ order([2, 2, 2, 2]) }>(weighted),
                lanes.pick::<{ order([3, 3, 3, 3]) }>(weighted),
            ];
            for (row, velocity) in moment.iter_mut().zip(velocity) {
                *row = lanes.add(*row, lanes.mul(velocity, separation));
            }
            difference = lanes.add(difference, weighted);
            square = lanes.add(square, lanes.mul(weighted, apart));
        }
    }
    let rows = moment.map(|row| lanes.values(row));
    // v takes the last D of the four numbers.
    let (difference, square) = (lanes.values(difference), lanes.values(square));
    VelocitySums {
        moment: std::array::from_fn(|row| {
            std::array::from_fn(
                |column| {
                    if D == 2 { rows[0][2 * row + column] } else { rows[row][column] }
                },
            )
        }),
        difference: std::array::from_fn(|k| difference[4 - D + k]),
        square: square[4 - D..].iter().sum(),
    }
}

/// Damping eta in Pa s: `chi_e rho c h`, in flowing material at most `chi_p sigma_y / (3 eps_p_dot)`.
///
/// The limit is the viscosity with which a flowing von Mises solid resists a small extra strain
/// rate across the direction of flow: damping beyond it would stiffen the shear zone.
#[inline]
fn damping_of<const D: usize>(
    point: &MaterialPoint<D>,
    data: &MaterialData,
    yield_fraction: f64,
) -> f64 {
    let flowing = yield_fraction * point.flow_stress;
    if flowing < 3.0 * point.plastic_strain_rate * data.hourglass {
        flowing / (3.0 * point.plastic_strain_rate)
    } else {
        data.hourglass
    }
}

/// Integrates the non-affine displacement `n` of a particle against its neighbours,
/// `n_dot = sum_j w_ij d_ij / s_i`, as a Maxwell element: plastic flow makes it forget with the
/// rate `3 kappa G eps_p_dot / (chi_p sigma_y)`. Returns the work that it took per volume in J/m^3, and what of it flow forgot.
#[inline]
fn remember<const D: usize>(
    point: &mut MaterialPoint<D>,
    data: &MaterialData,
    drift: &Vector<D>,
    weight: f64,
    dt: f64,
    yield_fraction: f64,
) -> [f64; 2] {
    let stiffness = data.hourglass_stiffness;
    if stiffness == 0.0 || weight == 0.0 || dt == 0.0 {
        return [0.0; 2];
    }
    let before = point.offset;
    let flowing = yield_fraction * point.flow_stress;
    let forgetting = if point.plastic_strain_rate > 0.0 && flowing.is_finite() {
        let rate = 3.0 * stiffness * point.plastic_strain_rate / flowing.max(f64::MIN_POSITIVE);
        1.0 / (1.0 + dt * rate)
    } else {
        1.0
    };
    let [mut work, mut forgotten] = [0.0; 2];
    for k in 0..D {
        let kept = before[k] + dt * drift[k] / weight;
        point.offset[k] = kept * forgetting;
        let force = 0.5 * stiffness * (before[k] + point.offset[k]);
        work += force * drift[k] * dt;
        forgotten += force * weight * (kept - point.offset[k]);
    }
    [work, forgotten]
}

fn check_point<const D: usize>(
    point: &MaterialPoint<D>,
    data: &MaterialData,
    i: usize,
    tally: &mut Tally,
) {
    let failed = |quantity, value| Some(ParticleFailure { index: i, quantity, value });
    if tally.failure.is_some() {
        return;
    }
    let too_dense = point.volume_ratio < data.elasticity.least_volume_ratio();
    if !VOLUME_RATIO_RANGE.contains(&point.volume_ratio) || too_dense {
        tally.failure = failed("the volume ratio V/V_0", point.volume_ratio);
    } else if !point.deviator[0][0].is_finite() {
        tally.failure = failed("the deviatoric stress", point.deviator[0][0]);
    } else if !point.temperature.is_finite() || point.temperature < 0.0 {
        tally.failure = failed("the temperature", point.temperature);
    }
}

/// Q F Q^T: a tensor in the axes that are the rows of Q.
#[inline]
fn turned<const D: usize>(tensor: &Matrix<D>, axes: &Matrix<D>) -> Matrix<D> {
    product(&product(axes, tensor), &transpose(axes))
}

/// Largest component of the Green strain `(F^T F - I) / 2`.
#[inline]
fn green_strain<const D: usize>(deformation: &Matrix<D>) -> f64 {
    let metric = product(&transpose(deformation), deformation);
    let mut largest = 0.0_f64;
    for (row, line) in metric.iter().enumerate() {
        for (column, value) in line.iter().enumerate() {
            largest = largest.max((value - f64::from(row == column)).abs());
        }
    }
    0.5 * largest
}

/// What the sweeps leave for each other and for the ledger.
#[derive(Debug, Default)]
pub(crate) struct Sweeps {
    /// What a neighbour needs to know of a particle in the sweep of the forces, [`exchange_width`] numbers for each.
    pub(crate) exchange: Vec<f64>,
    /// Reports of the chunks of particles.
    pub(crate) tallies: Vec<Tally>,
}

/// What the sweep of the gradients reads: nothing that it changes.
struct GradientSweep<'a, const D: usize> {
    list: &'a NeighbourList,
    frame: &'a [Frame<D>],
    motion: &'a [Motion<D>],
    position: &'a [Vector<D>],
    volume: &'a [f64],
    material: &'a [u8],
    materials: &'a [MaterialData],
    tilted_axes: Option<Matrix<D>>,
    yield_fraction: f64,
    time_step: f64,
}

impl<const D: usize> GradientSweep<'_, D> {
    /// Everything of particle `i` in one go, while it is in the registers: what it feels of its own of the internal force,
    /// which the sweep of the forces completes.
    #[inline(always)]
    fn update_particle<L: Lanes>(
        &self,
        lanes: L,
        i: usize,
        point: &mut MaterialPoint<D>,
        past: Option<&mut History<D>>,
        exchange: &mut [f64],
        tally: &mut Tally,
    ) -> Vector<D> {
        let (frame, volume, dt) = (&self.frame[i], self.volume[i], self.time_step);
        let data = &self.materials[self.material[i] as usize];
        // F_dot = sum w (v_j - v_i) (x) X B
        let sums = gather_velocity(lanes, self.list, self.motion, i);
        let rate = product(&sums.moment, &frame.correction);
        if let Some(table) = data.stiffness_table.as_ref().filter(|_| dt > 0.0) {
            tally.thermoelastic += point.follow_modulus(&data.elasticity, table) * volume;
        }
        let context = context(data, point, dt);
        if dt > 0.0 {
            self.update_stress(i, point, past, &context, &rate, tally);
        }
        // Dissipation of the damping: eta (sum w |v_j - v_i|^2 - F_dot : sum w (v_j - v_i) (x) X)
        let damping = damping_of(point, data, self.yield_fraction);
        let residual = sums.square - contract(&rate, &sums.moment);
        let viscous = damping * residual.max(0.0) * dt;
        // n_dot = (sum w (v_j - v_i) - F_dot c) / s, y = kappa G n
        let drift = minus(&sums.difference, &apply(&rate, &frame.moment));
        let [work, forgotten] =
            remember(point, data, &drift, frame.weight, dt, self.yield_fraction);
        let dissipation = (viscous + forgotten) * frame.volume_ratio;
        let heat = point.keep_dissipation(&context, dissipation) * volume;
        tally.heat += heat;
        tally.numerical_heat += heat;
        tally.hourglass += (viscous + work) * volume * frame.volume_ratio;
        let spring = point.offset.map(|n| data.hourglass_stiffness * n);
        // G = P B - eta F_dot - y (x) q
        let stress = product(&point.piola_stress(&data.elasticity), &frame.correction)
            .map(|row| row.map(|component| component / frame.volume_ratio));
        let mut flux = sum_scaled(&stress, -damping, &rate);
        for row in 0..D {
            for column in 0..D {
                flux[row][column] -= spring[row] * frame.lean[column];
            }
        }
        write_exchange(exchange, &flux, &spring, damping);
        // G c + eta sum w (v_j - v_i) + s y
        let own = plus_scaled(&apply(&flux, &frame.moment), damping, &sums.difference);
        plus_scaled(&own, frame.weight, &spring)
    }

    /// Stress and heat of particle `i` after the step at the deformation rate `rate`, with what that takes.
    #[inline(always)]
    fn update_stress(
        &self,
        i: usize,
        point: &mut MaterialPoint<D>,
        past: Option<&mut History<D>>,
        context: &UpdateContext,
        rate: &Matrix<D>,
        tally: &mut Tally,
    ) {
        let (volume, data) = (self.volume[i], &self.materials[self.material[i] as usize]);
        let work = point.advance(rate, context, past);
        tally.plastic += work.plastic * volume;
        tally.viscosity += work.viscosity * volume;
        tally.residue += work.residue * volume;
        tally.thermoelastic += work.thermal * volume;
        tally.heat += (work.heat + work.viscous_heat) * volume;
        tally.numerical_heat += work.viscous_heat * volume;
        let mut moved = minus(&self.position[i], self.motion[i].reference());
        let mut strain = green_strain(&point.deformation);
        if let Some(axes) = &self.tilted_axes {
            moved = apply(axes, &moved);
            strain = green_strain(&turned(&point.deformation, axes));
        }
        tally.strain = tally.strain.max(strain);
        tally.spread(&extended(&moved));
        check_point(point, data, i, tally);
    }
}

impl Sweeps {
    /// Gives every particle its place.
    pub(crate) fn resize<const D: usize>(&mut self, count: usize) {
        self.exchange.resize(count * exchange_width::<D>(), 0.0);
        self.tallies.resize(count.div_ceil(CHUNK), Tally::default());
    }

    /// Velocity gradients, stresses and damping of all particles; with `time_step` = 0 the stress stays. Leaves the
    /// terms of each particle itself in `force`.
    pub(crate) fn gradients<const D: usize>(
        &mut self,
        particles: &mut Particles<D>,
        reference: &ReferenceConfiguration<D>,
        yield_fraction: f64,
        time_step: f64,
    ) {
        let Particles {
            point, force, history, motion, position, volume, material, materials, ..
        } = particles;
        let sweep = GradientSweep {
            list: &reference.list,
            frame: &reference.frame,
            motion,
            position,
            volume,
            material,
            materials,
            tilted_axes: reference.tilted_axes,
            yield_fraction,
            time_step,
        };
        with_lanes!(lanes => self.gradients_with(lanes, &sweep, point, force, history));
    }

    fn gradients_with<const D: usize, L: Lanes>(
        &mut self,
        lanes: L,
        sweep: &GradientSweep<'_, D>,
        point: &mut [MaterialPoint<D>],
        force: &mut [Vector<D>],
        history: &mut [History<D>],
    ) {
        let forgetful = if history.is_empty() { self.tallies.len() } else { 0 };
        let none = (0..forgetful).into_par_iter().map(|_| None);
        let histories = history.par_chunks_mut(CHUNK).map(Some).chain(none);
        let width = exchange_width::<D>();
        point
            .par_chunks_mut(CHUNK)
            .zip(self.exchange.par_chunks_mut(CHUNK * width))
            .zip(force.par_chunks_mut(CHUNK))
            .zip(self.tallies.par_iter_mut())
            .zip(histories)
            .enumerate()
            .with_max_len(TURN)
            .for_each(|(chunk, ((((points, exchanges), forces), tally), mut histories))| {
                lanes.run(
                    #[inline(always)]
                    || {
                        *tally = Tally::default();
                        for (offset, point) in points.iter_mut().enumerate() {
                            let past =
                                histories.as_deref_mut().map(|of_chunk| &mut of_chunk[offset]);
                            let exchange = &mut exchanges[offset * width..(offset + 1) * width];
                            let i = chunk * CHUNK + offset;
                            forces[offset] =
                                sweep.update_particle(lanes, i, point, past, exchange, tally);
                        }
                    },
                )
            });
    }

    /// The chunks' reports in their order as one.
    pub(crate) fn whole(&self) -> Tally {
        self.tallies.iter().fold(Tally::default(), |whole, tally| whole.with(tally))
    }

    /// Internal forces `f_i = V_i sum_j w_ij [(G_i + G_j) X_ij + eta_i d + eta_j d]`.
    pub(crate) fn forces<const D: usize>(
        &self,
        particles: &mut Particles<D>,
        reference: &ReferenceConfiguration<D>,
    ) {
        with_lanes!(lanes => self.forces_with(lanes, particles, reference));
    }

    fn forces_with<const D: usize, L: Lanes>(
        &self,
        lanes: L,
        particles: &mut Particles<D>,
        reference: &ReferenceConfiguration<D>,
    ) {
        let Particles { force, motion, .. } = particles;
        let (motion, exchange) = (&**motion, &*self.exchange);
        let ReferenceConfiguration { list, volume, .. } = reference;
        force.par_chunks_mut(CHUNK).enumerate().with_max_len(TURN).for_each(|(chunk, forces)| {
            lanes.run(
                #[inline(always)]
                || {
                    for (offset, force) in forces.iter_mut().enumerate() {
                        let i = chunk * CHUNK + offset;
                        let sum = gather_force(lanes, list, motion, exchange, i, force);
                        *force = sum.map(|component| component * volume[i]);
                    }
                },
            );
        });
    }
}

/// Numbers that [`Sweeps::gradients`] leaves of each particle for its neighbours: the flux
/// `P B - eta F_dot - y (x) q` column by column, the hourglass force y = kappa G n in Pa m and eta in Pa s; in
/// the plane an eighth that fills a line of the cache.
pub(crate) const fn exchange_width<const D: usize>() -> usize {
    if D == 2 { 8 } else { D * D + D + 1 }
}

fn write_exchange<const D: usize>(
    exchange: &mut [f64],
    flux: &Matrix<D>,
    spring: &Vector<D>,
    damping: f64,
) {
    for row in 0..D {
        for column in 0..D {
            exchange[column * D + row] = flux[row][column];
        }
        exchange[D * D + row] = spring[row];
    }
    exchange[D * D + D] = damping;
}

/// `own + sum_j w [flux_j X_ij + eta_j (v_j - v_i) - y_j]`.
#[inline(always)]
fn gather_force<const D: usize, L: Lanes>(
    lanes: L,
    list: &NeighbourList,
    motion: &[Motion<D>],
    exchange: &[f64],
    i: usize,
    own: &Vector<D>,
) -> Vector<D> {
    let (index, weight) = list.row(i);
    let here = lanes_of(lanes, &motion[i]);
    let width = exchange_width::<D>();
    let mut sum = lanes.four([own[0], own[1], if D == 2 { 0.0 } else { own[D - 1] }, 0.0]);
    for (&j, &w) in index.iter().zip(weight) {
        let j = j as usize;
        let there = lanes_of(lanes, &motion[j]);
        let other = &exchange[j * width..(j + 1) * width];
        let rest = lanes.load(other, D * D);
        let force = if D == 2 {
            let apart = lanes.sub(there[0], here[0]);
            let separation = lanes.pick::<{ order([0, 0, 1, 1]) }>(apart);
            let stress = lanes.mul(lanes.load(other, 0), separation);
            let stress = lanes.add(stress, lanes.pick::<{ order([2, 3, 2, 3]) }>(stress));
            let velocity = lanes.pick::<{ order([2, 3, 2, 3]) }>(apart);
            let damping = lanes.pick::<{ order([2, 2, 2, 2]) }>(rest);
            lanes.add(stress, lanes.mul(damping, velocity))
        } else {
            let separation = lanes.sub(there[0], here[0]);
            let apart = lanes.sub(there[1], here[1]);
            let x = lanes.pick::<{ order([0, 0, 0, 0]) }>(separation);
            let y = lanes.pick::<{ order([1, 1, 1, 1]) }>(separation);
            let z = lanes.pick::<{ order([2, 2, 2, 2]) }>(separation);
            let stress = lanes.mul(lanes.load(other, 0), x);
            let stress = lanes.add(stress, lanes.mul(lanes.load(other, 3), y));
            let stress = lanes.add(stress, lanes.mul(lanes.load(other, 6), z));
            let velocity = lanes.pick::<{ order([1, 2, 3, 3]) }>(apart);
            let damping = lanes.pick::<{ order([3, 3, 3, 3]) }>(rest);
            lanes.add(stress, lanes.mul(damping, velocity))
        };
        // What lies beyond the D components is never read.
        sum = lanes.add(sum, lanes.mul(lanes.all(w), lanes.sub(force, rest)));
    }
    let sum = lanes.values(sum);
    std::array::from_fn(|k| sum[k])
}

#[inline]
fn context<'a, const D: usize>(
    data: &'a MaterialData,
    point: &MaterialPoint<D>,
    dt: f64,
) -> UpdateContext<'a> {
    UpdateContext {
        elasticity: &data.elasticity,
        law: data.law.as_ref(),
        time_step: dt,
        heating_share: data.heating_share(point),
        per_heat_capacity: 1.0 / (data.density * data.specific_heat_at(point.temperature)),
        heat_table: data.heat_table.as_ref().map(|table| (data.density, table)),
        linear_viscosity: data.linear_viscosity,
        quadratic_viscosity: data.quadratic_viscosity,
        memory: &data.memory,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::engine::Engine;
    use crate::lanes::Plain;
    use crate::setup::{Dimension, Lattice, Setup};
    use crate::tensor::{dot, identity};

    /// A disordered block of rubber.
    fn block(dimension: Dimension) -> Setup {
        crate::contact::surface_point::tests::block(dimension, Lattice::Disordered, 1.0)
    }

    fn gradient_is_exact<const D: usize>(dimension: Dimension) {
        let mut engine = Engine::<D>::new(&block(dimension)).unwrap();
        let field: Matrix<D> = std::array::from_fn(|row| {
            std::array::from_fn(|column| 0.3 * row as f64 - 0.7 * column as f64 + 0.2)
        });
        for i in 0..engine.particles.motion.len() {
            let velocity = apply(&field, &engine.particles.position[i]);
            engine.particles.motion[i].set_velocity(velocity);
        }
        for i in 0..engine.particles.motion.len() {
            let sums = gather_velocity(Plain, &engine.reference.list, &engine.particles.motion, i);
            let rate = product(&sums.moment, &engine.reference.frame[i].correction);
            for row in 0..D {
                for column in 0..D {
                    // Rounding of about 100 terms of order one.
                    assert!((rate[row][column] - field[row][column]).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_linear_field_on_a_disordered_set_has_its_exact_gradient() {
        gradient_is_exact::<2>(Dimension::Two);
        gradient_is_exact::<3>(Dimension::Three);
    }

    /// Whatever stresses, velocities and offsets: internal forces have no resultant, and, while
    /// the stress is symmetric, no moment.
    pub(crate) fn forces_balance<const D: usize>(mut engine: Engine<D>) {
        for i in 0..engine.particles.motion.len() {
            let wave = |k: usize| (3.1 * i as f64 + 1.7 * k as f64).sin();
            for row in 0..D {
                let mut velocity = *engine.particles.motion[i].velocity();
                velocity[row] = wave(row);
                engine.particles.motion[i].set_velocity(velocity);
                engine.particles.point[i].offset[row] = 1e-3 * wave(row + 7);
                for column in 0..D {
                    engine.particles.point[i].deviator[row][column] = 1e5 * wave(row * column + 3);
                }
            }
            engine.particles.point[i].volume_ratio = 1.0 + 0.01 * wave(11);
            engine.particles.point[i].deformation = identity();
        }
        engine.find_internal_forces();
        let scale: f64 = engine.particles.force.iter().map(|f| dot(f, f).sqrt()).sum();
        let mut resultant = [0.0; D];
        let mut moment = 0.0;
        for (force, position) in engine.particles.force.iter().zip(&engine.particles.position) {
            resultant = plus_scaled(&resultant, 1.0, force);
            moment += position[0] * force[1] - position[1] * force[0];
        }
        // Rounding only: 1e-16 times the number of terms.
        assert!(dot(&resultant, &resultant).sqrt() < 1e-12 * scale);
        assert!(moment.abs() < 1e-12 * scale, "{moment} {scale}");
    }

    #[test]
    fn internal_forces_keep_both_momenta() {
        forces_balance(Engine::<2>::new(&block(Dimension::Two)).unwrap());
        forces_balance(Engine::<3>::new(&block(Dimension::Three)).unwrap());
    }
}
