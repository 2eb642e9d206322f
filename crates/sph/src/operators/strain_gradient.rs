//! The gradient of the equivalent plastic strain, for the effect `strain_gradient`.
//!
//! ```text
//! grad eps_p = F^-T B sum_j w_ij (eps_j - eps_i) X_ij
//! ```
//! exact for a linear field (the corrected operator, carried to the present configuration). It is found anew every
//! few steps: the strain then changes by some 1e-3 at most.

use crate::operators::reference::ReferenceConfiguration;
use crate::parallel::{CHUNK, TURN};
use crate::particles::Particles;
use crate::tensor::{apply, dot, inverse_nonsingular, minus, plus_scaled, transpose};
use rayon::prelude::*;

/// Steps between two evaluations.
const INTERVAL: u64 = 5;

/// Finds the gradients anew every few steps, where an effect needs them.
pub(crate) fn find_when_due<const D: usize>(
    particles: &mut Particles<D>,
    reference: &ReferenceConfiguration<D>,
    step: u64,
) {
    let needed = |particles: &Particles<D>| {
        particles.materials.iter().any(|data| data.memory.needs_strain_gradient())
    };
    if step.is_multiple_of(INTERVAL) && needed(particles) {
        find(particles, reference);
    }
}

fn find<const D: usize>(particles: &mut Particles<D>, reference: &ReferenceConfiguration<D>) {
    let Particles { motion, point, history, .. } = particles;
    let (motion, point) = (&*motion, &*point);
    let ReferenceConfiguration { list, frame, .. } = reference;
    history.par_chunks_mut(CHUNK).enumerate().with_max_len(TURN).for_each(|(chunk, histories)| {
        for (offset, past) in histories.iter_mut().enumerate() {
            let i = chunk * CHUNK + offset;
            let (index, weight) = list.row(i);
            let mut sum = [0.0; D];
            for (&j, &w) in index.iter().zip(weight) {
                let j = j as usize;
                let change = point[j].plastic_strain - point[i].plastic_strain;
                let separation = minus(motion[j].reference(), motion[i].reference());
                sum = plus_scaled(&sum, w * change, &separation);
            }
            let gradient = apply(&frame[i].correction, &sum);
            let carried = transpose(&inverse_nonsingular(&point[i].deformation));
            let gradient = apply(&carried, &gradient);
            past.strain_gradient = dot(&gradient, &gradient).sqrt();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Engine;
    use crate::setup::{
        Body, Dimension, Discretisation, Lattice, Material, Setup, Shape, TemperatureTables,
        VelocityField,
    };
    use crate::tensor::Matrix;
    use approx::assert_relative_eq;
    use sphcut_physics::Values;
    use sphcut_physics::effects::{self, ChosenEffect};
    use sphcut_physics::elasticity::ElasticModuli;
    use sphcut_physics::flow_stress;

    fn block(dimension: Dimension) -> Setup {
        let mut setup = Setup::empty(dimension, 0.1, 1.0);
        let law = flow_stress::find("elastic").unwrap();
        setup.materials.push(Material {
            name: "metal".to_owned(),
            density: 8000.0,
            moduli: ElasticModuli::from_young(200e9, 0.3),
            specific_heat: 500.0,
            thermal_conductivity: 0.0,
            tables: TemperatureTables::default(),
            equation_of_state: None,
            flow_stress: law,
            flow_stress_values: Values::defaults(law.parameters),
        });
        let max = [1.0, 0.8, 0.6];
        setup.bodies.push(Body {
            name: "block".to_owned(),
            material: 0,
            shape: Shape::Box { min: [0.0; 3], max, rotation: 0.0, mirrored: false },
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: 300.0,
        });
        let entry = effects::find("strain_gradient").unwrap();
        let values = Values::resolve(entry.parameters, entry.example).unwrap();
        setup.effects.push(ChosenEffect { entry, values });
        setup.discretisation =
            Discretisation { lattice: Lattice::Disordered, ..Discretisation::default() };
        setup.seed = 3;
        setup
    }

    /// eps_p = 5 + g.x on a disordered set, stretched since the reference update by
    /// x = F X: the gradient is g, at every particle, surfaces included.
    fn exact<const D: usize>(dimension: Dimension) {
        let mut engine = Engine::<D>::new(&block(dimension)).unwrap();
        let slope: [f64; D] = std::array::from_fn(|k| 0.7 - 0.4 * k as f64);
        let stretch: Matrix<D> = std::array::from_fn(|row| {
            std::array::from_fn(|column| if row == column { 1.05 } else { 0.03 * row as f64 })
        });
        for i in 0..engine.particles.point.len() {
            let place = apply(&stretch, engine.particles.motion[i].reference());
            engine.particles.point[i].deformation = stretch;
            engine.particles.point[i].plastic_strain = 5.0 + dot(&slope, &place);
        }
        find(&mut engine.particles, &engine.reference);
        let expected = dot(&slope, &slope).sqrt();
        for past in &engine.particles.history {
            // Rounding of some thirty terms of order ten over a spacing of 0.1.
            assert_relative_eq!(past.strain_gradient, expected, max_relative = 1e-11);
        }
    }

    #[test]
    fn a_linear_strain_has_its_exact_gradient() {
        exact::<2>(Dimension::Two);
        exact::<3>(Dimension::Three);
    }
}
