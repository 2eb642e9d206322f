//! Where contact acts: the point of a particle's material that lies on the tool.
//!
//! A particle stands half a row inside the material. A force on its centre is one on that depth: on a half-space of a
//! square lattice, uniform pressure p needs forces of 1.33, -0.18, -0.14, -0.01 p dx on the first rows, and a
//! penalty on centres gives 1, 0, 0, 0, so that the first two rows bear 0.71 and 0.81 of p. So the tool meets
//! ```text
//! x_s = x_i - r n,   v_s = v_i - r L_i n = v_i - sum_j c_ij (v_j - v_i)
//! c_ij = w_ij X_ij^2 X_ij . M_i^-1 F_i^-1 r n,   M_i = sum_j w_ij X_ij^2 X_ij X_ij^T
//! ```
//! (r: half thickness of the particle along the tool's normal n; X: reference distance). The gradient is exact
//! for linear fields with any weight; w X^2 leaves the rows of that half-space a twentieth of p dx at most, w a sixth.
//! A force f on it acts as its transpose, which keeps its power, its sum and, on any linear field of velocity, its work:
//! ```text
//! f_i += (1 + sum_j c_ij) f,   f_j -= c_ij f
//! ```
//! **Half thickness.** r starts as half the cell of the lattice along n when the tool comes within a spacing, and follows the material
//! from there on, `r_dot = r n . L n`, so that the gap `g = (x_i - x_tool) . n - r` changes by `n . (v_s - v_tool)`: the penalty
//! stores and gives back energy and is no source. A row that is drawn out along the tool gets thinner and stays
//! at it.
//!
//! **Limits.** L is that of the particle, linear over half a row. r stays within [`THINNEST`] and [`THICKEST`]
//! spacings; at these limits the penalty's energy is not exact. n turns without turning what r was before.

use crate::contact::surface::make_room;
use crate::contact::touch::Touch;
use crate::operators::reference::ReferenceConfiguration;
use crate::particles::Particles;
use crate::particles::motion::Motion;
use crate::tensor::{
    Matrix, Vector, apply, determinant, dot, inverse_nonsingular, minus, plus_scaled, zero,
};

/// Least half thickness in spacings.
const THINNEST: f64 = 0.025;
/// Largest half thickness in spacings.
const THICKEST: f64 = 1.0;

/// What tells how the material around a particle moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Neighbourhood<'a, const D: usize> {
    pub(crate) particles: &'a Particles<D>,
    pub(crate) reference: &'a ReferenceConfiguration<D>,
}

impl<const D: usize> Neighbourhood<'_, D> {
    /// M_i^-1 of particle `i`; zero where its kernel gradient is not usable.
    pub(crate) fn inverse_moment(&self, i: usize) -> Matrix<D> {
        let motion = &self.particles.motion;
        let (index, weight) = self.reference.list.row(i);
        let here = *motion[i].reference();
        let mut second = zero::<D>();
        for (&j, &w) in index.iter().zip(weight) {
            let x = minus(motion[j as usize].reference(), &here);
            let w = w * dot(&x, &x);
            for r in 0..D {
                for c in 0..D {
                    second[r][c] += w * x[r] * x[c];
                }
            }
        }
        let usable = determinant(&self.reference.frame[i].correction) != 0.0;
        if usable { inverse_nonsingular(&second) } else { zero() }
    }

    /// The neighbours of particle `i` with the parts c_ij they have in its surface point, `lever` being r n.
    pub(crate) fn parts(
        &self,
        i: usize,
        lever: &Vector<D>,
        inverse_moment: &Matrix<D>,
    ) -> impl Iterator<Item = (usize, f64)> + '_ {
        let Particles { motion, point, .. } = self.particles;
        let carried = apply(&inverse_nonsingular(&point[i].deformation), lever);
        let direction = apply(inverse_moment, &carried);
        let (index, weight) = self.reference.list.row(i);
        let here = *motion[i].reference();
        index.iter().zip(weight).map(move |(&j, &w)| {
            let j = j as usize;
            let x = minus(motion[j].reference(), &here);
            (j, w * dot(&x, &x) * dot(&x, &direction))
        })
    }

    /// Velocity of the surface point in m/s.
    pub(crate) fn velocity(
        &self,
        i: usize,
        lever: &Vector<D>,
        inverse_moment: &Matrix<D>,
    ) -> Vector<D> {
        let motion = &self.particles.motion;
        let own = motion[i].velocity();
        self.parts(i, lever, inverse_moment).fold(*own, |sum, (j, part)| {
            plus_scaled(&sum, -part, &minus(motion[j].velocity(), own))
        })
    }

    /// The half thickness of particle `i` along the tool's `normal` after `time_step`, in m, with that of the lattice where
    /// the tool was not near; `spacing` of the particles.
    pub(crate) fn followed_half_thickness(
        &self,
        i: usize,
        normal: &Vector<D>,
        (time_step, spacing): (f64, f64),
        inverse_moment: &Matrix<D>,
    ) -> f64 {
        let before = self.particles.point[i].half_thickness;
        if before == 0.0 {
            return self.particles.half_thickness(i, normal);
        }
        // L n from the way of a lever of length 1.
        let moved = self.velocity(i, normal, inverse_moment);
        let apart = minus(self.particles.motion[i].velocity(), &moved);
        let spacing = spacing * self.particles.size(i);
        let limits = (THINNEST * spacing, THICKEST * spacing);
        (before * (1.0 + time_step * dot(normal, &apart))).clamp(limits.0, limits.1)
    }
}

/// The surface points of all touches: the particles with their parts in each. They hold until strains change or
/// the reference is updated.
#[derive(Debug)]
pub(crate) struct SurfacePoints<const D: usize> {
    /// Touch by touch: the particle itself with 1 + sum_j c_ij, then its neighbours with -c_ij.
    parts: Vec<(u32, f64)>,
    /// Where the parts of each touch start.
    starts: Vec<usize>,
}

impl<const D: usize> Default for SurfacePoints<D> {
    fn default() -> Self {
        Self { parts: Vec::new(), starts: Vec::new() }
    }
}

impl<const D: usize> SurfacePoints<D> {
    /// Room for so many `touches` of particles that have so many `neighbours` at most.
    pub(crate) fn make_room(&mut self, touches: usize, neighbours: usize) {
        make_room(&mut self.parts, touches.next_power_of_two() * (neighbours + 1));
        make_room(&mut self.starts, touches);
    }

    /// Has none.
    pub(crate) fn clear(&mut self) {
        self.parts.clear();
        self.starts.clear();
    }

    /// Adds that of `touch`.
    pub(crate) fn push(
        &mut self,
        touch: &Touch<D>,
        inverse_moment: &Matrix<D>,
        around: &Neighbourhood<'_, D>,
    ) {
        let start = self.parts.len();
        self.starts.push(start);
        self.parts.push((touch.particle, 1.0));
        for (j, part) in around.parts(touch.particle as usize, &touch.lever, inverse_moment) {
            self.parts[start].1 += part;
            self.parts.push((j as u32, -part));
        }
    }

    /// Those of `touches`.
    pub(crate) fn lay(&mut self, touches: &[Touch<D>], around: &Neighbourhood<'_, D>) {
        self.clear();
        for touch in touches {
            self.push(touch, &around.inverse_moment(touch.particle as usize), around);
        }
    }

    /// All parts, touch by touch.
    pub(crate) fn parts(&self) -> &[(u32, f64)] {
        &self.parts
    }

    /// Numbers of the parts of the touch at `place`; the first is that of the particle itself.
    pub(crate) fn range(&self, place: usize) -> std::ops::Range<usize> {
        let end = self.starts.get(place + 1).copied().unwrap_or(self.parts.len());
        self.starts[place]..end
    }

    /// Velocity of the surface point of the touch at `place` in m/s.
    pub(crate) fn velocity(&self, place: usize, motion: &[Motion<D>]) -> Vector<D> {
        let parts = &self.parts[self.range(place)];
        let own = motion[parts[0].0 as usize].velocity();
        parts[1..].iter().fold(*own, |sum, &(j, part)| {
            plus_scaled(&sum, part, &minus(motion[j as usize].velocity(), own))
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::engine::Engine;
    use crate::setup::{
        Body, Dimension, Discretisation, Lattice, Material, Setup, Shape, TemperatureTables,
        VelocityField,
    };
    use approx::assert_relative_eq;
    use sphcut_physics::Values;
    use sphcut_physics::elasticity::ElasticModuli;
    use sphcut_physics::flow_stress;

    pub(crate) fn around<const D: usize>(engine: &Engine<D>) -> Neighbourhood<'_, D> {
        Neighbourhood { particles: &engine.particles, reference: &engine.reference }
    }

    /// A block of 2 by 1.6 (by 0.6) m in cells of 0.1 m with the aspect given.
    pub(crate) fn block(dimension: Dimension, lattice: Lattice, lattice_aspect: f64) -> Setup {
        let mut setup = Setup::empty(dimension, 0.1, 1.0);
        let law = flow_stress::find("elastic").unwrap();
        setup.materials.push(Material {
            name: "rubber".to_owned(),
            density: 1000.0,
            moduli: ElasticModuli::from_young(1e7, 0.4),
            specific_heat: 1.0,
            thermal_conductivity: 0.0,
            tables: TemperatureTables::default(),
            equation_of_state: None,
            flow_stress: law,
            flow_stress_values: Values::defaults(law.parameters),
        });
        let max = [2.0, 1.6, 0.6];
        setup.bodies.push(Body {
            name: "block".to_owned(),
            material: 0,
            shape: Shape::Box { min: [0.0; 3], max, rotation: 0.0, mirrored: false },
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: 300.0,
        });
        setup.discretisation =
            Discretisation { lattice, lattice_aspect, ..Discretisation::default() };
        setup.seed = 11;
        setup
    }

    /// In a linear field of velocity the surface point moves as the field there, whatever the deformation since
    /// the reference; and a force on it has its power and its sum.
    fn linear<const D: usize>(dimension: Dimension) {
        let mut engine = Engine::<D>::new(&block(dimension, Lattice::Disordered, 1.0)).unwrap();
        let stretch: Matrix<D> = std::array::from_fn(|row| {
            std::array::from_fn(|column| if row == column { 1.1 } else { 0.05 * row as f64 })
        });
        let field: Matrix<D> = std::array::from_fn(|row| {
            std::array::from_fn(|column| 0.3 * row as f64 - 0.7 * column as f64 + 0.2)
        });
        let place =
            |engine: &Engine<D>, i: usize| apply(&stretch, engine.particles.motion[i].reference());
        for i in 0..engine.particles.motion.len() {
            engine.particles.point[i].deformation = stretch;
            let velocity = apply(&field, &place(&engine, i));
            engine.particles.motion[i].set_velocity(velocity);
        }
        let lever: Vector<D> = std::array::from_fn(|k| 0.05 - 0.03 * k as f64);
        let force: Vector<D> = std::array::from_fn(|k| 2.0 - k as f64);
        let around = around(&engine);
        for i in 0..engine.particles.motion.len() {
            let found = around.velocity(i, &lever, &around.inverse_moment(i));
            let expected = apply(&field, &minus(&place(&engine, i), &lever));
            let (mut sum, mut power) =
                ([0.0; D], dot(&force, engine.particles.motion[i].velocity()));
            for (j, part) in around.parts(i, &lever, &around.inverse_moment(i)) {
                let there = minus(
                    engine.particles.motion[j].velocity(),
                    engine.particles.motion[i].velocity(),
                );
                power -= part * dot(&force, &there);
                sum = plus_scaled(&sum, part, &force);
            }
            for k in 0..D {
                assert_relative_eq!(found[k], expected[k], epsilon = 1e-12);
            }
            assert_relative_eq!(power, dot(&force, &found), epsilon = 1e-12);
        }
    }

    #[test]
    fn the_surface_point_moves_with_a_linear_field() {
        linear::<2>(Dimension::Two);
        linear::<3>(Dimension::Three);
    }

    /// Uniform pressure in a block and the same pressure on its surface: what the rows are left with, in terms of the
    /// pressure times the surface of a particle, and its moment about the surface in terms of the height of a row.
    fn left_over(aspect: f64, lever: f64) -> (Vec<f64>, f64) {
        let setup = block(Dimension::Two, Lattice::Square, aspect);
        let mut engine = Engine::<2>::new(&setup).unwrap();
        for point in &mut engine.particles.point {
            point.volume_ratio = 0.9999;
        }
        engine.find_internal_forces();
        let rows = (1.6 / (0.1 / aspect.sqrt())).round();
        let height = 1.6 / rows;
        let count = engine.particles.point.len();
        let row = |engine: &Engine<2>, i: usize| {
            ((1.6 - engine.particles.position[i][1]) / height).floor() as usize
        };
        // Far from the sides of the block.
        let middle =
            |engine: &Engine<2>, i: usize| (engine.particles.position[i][0] - 1.0).abs() < 0.3;
        let of_row = |engine: &Engine<2>, number: usize| {
            let chosen: Vec<f64> = (0..count)
                .filter(|&i| middle(engine, i) && row(engine, i) == number)
                .map(|i| engine.particles.force[i][1])
                .collect();
            chosen.iter().sum::<f64>() / chosen.len() as f64
        };
        let whole: f64 = (0..12).map(|number| of_row(&engine, number)).sum();
        let into = [0.0, -lever * height];
        let surface: Vec<usize> = (0..count).filter(|&i| row(&engine, i) == 0).collect();
        for i in surface {
            let around = around(&engine);
            let parts: Vec<(usize, f64)> =
                around.parts(i, &into, &around.inverse_moment(i)).collect();
            for (j, part) in parts {
                engine.particles.force[j][1] += part * whole;
                engine.particles.force[i][1] -= part * whole;
            }
            engine.particles.force[i][1] -= whole;
        }
        let left: Vec<f64> = (0..12).map(|number| of_row(&engine, number) / whole).collect();
        let moment = left.iter().zip(0..).map(|(f, k)| f * (f64::from(k) + 0.5)).sum();
        (left, moment)
    }

    /// Pressure on the surface does the work of the pressure inside on any linear field: what is left has no
    /// moment, where forces on the centres leave half a row.
    #[test]
    fn pressure_on_the_surface_balances_uniform_pressure_inside() {
        for aspect in [1.0, 2.0] {
            let ((_, centres), (left, surface)) = (left_over(aspect, 0.0), left_over(aspect, 0.5));
            // The pressure of the material at a strain of 1e-4.
            assert!(surface.abs() < 1e-6, "{aspect}: {surface} {left:?}");
            assert_relative_eq!(centres, -0.5, epsilon = 1e-6);
        }
    }

    /// On a square lattice the rows are left with a twentieth at most, where forces on the centres leave a third.
    #[test]
    fn uniform_pressure_stays_uniform_to_a_twentieth() {
        let largest = |left: &[f64]| left.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        let (centres, surface) = (left_over(1.0, 0.0).0, left_over(1.0, 0.5).0);
        assert_relative_eq!(largest(&centres), 0.3303, epsilon = 1e-4);
        assert_relative_eq!(largest(&surface), 0.0522, epsilon = 1e-4);
    }
}
