//! Tests: what passes from one spacing into another.

use crate::contact::surface_point::tests::block;
use crate::engine::Engine;
use crate::material::point::MaterialPoint;
use crate::operators::sweeps::tests::forces_balance;
use crate::setup::{Dimension, Grading, Lattice, Setup, Shape, Support, Switch};
use crate::tensor::{Matrix, Vector, apply};
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress};

const SPACING: f64 = 0.05;

/// A bar along y between -4 and 4, 2 wide (in space 0.8, and 0.6 deep), whose spacing doubles below y = 0, `levels` times; its motion across
/// the components in `held` is none.
fn bar(dimension: Dimension, levels: u8, held: [bool; 3]) -> Setup {
    let mut setup = block(dimension, Lattice::Square, 1.0);
    setup.particle_spacing = SPACING;
    setup.materials[0].moduli = ElasticModuli::from_young(1e9, 0.3);
    let half = if dimension == Dimension::Two { 1.0 } else { 0.4 };
    let (min, max) = ([-half, -4.0, -0.3], [half, 4.0, 0.3]);
    let shape = Shape::Box { min, max, rotation: 0.0, mirrored: false };
    setup.supports.push(Support {
        name: "guide".to_owned(),
        region: shape.clone(),
        velocity: held.map(|held| held.then_some(0.0)),
        temperature: None,
    });
    setup.bodies[0].shape = shape;
    setup.discretisation.grading =
        (levels > 0).then_some(Grading { band: [0.0, 4.0], below: levels, above: 0 });
    setup
}

/// Largest velocity behind and in front of the transition over that of a pulse that has passed it, at the middle of the bar.
fn passed<const D: usize>(dimension: Dimension, levels: u8, axis: usize, width: f64) -> (f64, f64) {
    let held = std::array::from_fn(|k| k != axis);
    let mut engine = Engine::<D>::new(&bar(dimension, levels, held)).unwrap();
    let data = &engine.particles.materials[0];
    let (bulk, shear) = (data.elasticity.moduli.bulk, data.elasticity.moduli.shear);
    let modulus = if axis == 1 { bulk + 4.0 / 3.0 * shear } else { shear };
    let speed = (modulus / data.density).sqrt();
    const SIZE: f64 = 1e-6;
    for i in 0..engine.particles.count() {
        // A wave v(y + c t): strain v / c.
        let along = (engine.particles.position[i][1] - 2.0) / width;
        let strain = SIZE * (-0.5 * along * along).exp();
        let mut velocity = [0.0; D];
        velocity[axis] = speed * strain;
        engine.particles.motion[i].set_velocity(velocity);
        let point = &mut engine.particles.point[i];
        if axis == 1 {
            point.volume_ratio = 1.0 + strain;
            for k in 0..D {
                let own = if k == 1 { strain } else { 0.0 };
                point.deviator[k][k] = 2.0 * shear * (own - strain / 3.0);
            }
        } else {
            point.deviator[0][1] = shear * strain;
            point.deviator[1][0] = shear * strain;
        }
    }
    engine.find_internal_forces();
    while speed * engine.clock.time < 4.0 {
        engine.advance(&mut |_| ()).unwrap();
    }
    let largest = |low: f64, high: f64| {
        let inside = |x: &Vector<D>| (low..high).contains(&x[1]) && x[0].abs() < 0.2;
        let speeds = engine.particles.position.iter().zip(&engine.particles.motion);
        speeds
            .filter(|(x, _)| inside(x))
            .map(|(_, motion)| motion.velocity()[axis].abs())
            .fold(0.0, f64::max)
            / (speed * SIZE)
    };
    (largest(0.5, 3.5), largest(-3.0, -1.0))
}

/// A pulse whose standard deviation is three of the coarse spacings passes with less than 2 % reflected, in the plane and in
/// space, compression and shear.
#[test]
fn waves_pass_a_transition() {
    for axis in [1, 0] {
        let (reflected, passing) = passed::<2>(Dimension::Two, 1, axis, 0.3);
        assert!(reflected < 0.02 && passing > 0.9, "plane, along {axis}: {reflected} {passing}");
        let (reflected, passing) = passed::<3>(Dimension::Three, 1, axis, 0.3);
        assert!(reflected < 0.02 && passing > 0.9, "space, along {axis}: {reflected} {passing}");
    }
}

/// Linear fields have their exact gradient on both sides and in between, and internal forces have neither resultant nor moment,
/// whatever stresses and velocities.
fn operators_are_exact<const D: usize>(dimension: Dimension) {
    let mut setup = bar(dimension, 2, [false; 3]);
    setup.discretisation.lattice = Lattice::Disordered;
    let mut engine = Engine::<D>::new(&setup).unwrap();
    let field: Matrix<D> = std::array::from_fn(|row| {
        std::array::from_fn(|column| 0.3 * row as f64 - 0.7 * column as f64 + 0.2)
    });
    for i in 0..engine.particles.count() {
        let velocity = apply(&field, &engine.particles.position[i]);
        engine.particles.motion[i].set_velocity(velocity);
    }
    engine.update_stresses(1e-9).unwrap();
    for point in &engine.particles.point {
        for row in 0..D {
            for column in 0..D {
                let rate = (point.deformation[row][column] - f64::from(row == column)) / 1e-9;
                // What is left of a change of 1e-9 against one.
                assert!((rate - field[row][column]).abs() < 1e-6);
            }
        }
    }
    forces_balance(engine);
}

#[test]
fn linear_fields_and_both_momenta_are_exact_across_a_transition() {
    operators_are_exact::<2>(Dimension::Two);
    operators_are_exact::<3>(Dimension::Three);
}

/// Heat from a normal distribution of standard deviation s spreads as `s^2 + 2 k t / (rho c)`.
fn heat_spreads<const D: usize>(dimension: Dimension) -> f64 {
    let mut setup = bar(dimension, 1, [true; 3]);
    setup.mechanics = Switch::Off;
    setup.materials[0].thermal_conductivity = 1000.0;
    let mut engine = Engine::<D>::new(&setup).unwrap();
    let (centre, start, content) = (0.4, 0.3, engine.particles.heat_content());
    let rise = |y: f64, time: f64| {
        let variance = start * start + 2.0 * time;
        100.0 * start / variance.sqrt() * (-0.5 * (y - centre).powi(2) / variance).exp()
    };
    let total = |engine: &Engine<D>| engine.particles.heat_content() - content;
    for (point, position) in engine.particles.point.iter_mut().zip(&engine.particles.position) {
        point.temperature += rise(position[1], 0.0);
    }
    let before = total(&engine);
    while engine.clock.time < 0.2 {
        engine.advance(&mut |_| ()).unwrap();
    }
    assert!((total(&engine) - before).abs() < 1e-9 * before);
    let time = engine.clock.time - engine.conduction.pending;
    let points = engine.particles.point.iter().zip(&engine.particles.position);
    let error = |(point, x): (&MaterialPoint<D>, &Vector<D>)| {
        (point.temperature - 300.0 - rise(x[1], time)).abs()
    };
    points.map(error).fold(0.0, f64::max) / rise(centre, time)
}

#[test]
fn heat_passes_a_transition() {
    let plane = heat_spreads::<2>(Dimension::Two);
    let space = heat_spreads::<3>(Dimension::Three);
    assert!(plane < 0.01 && space < 0.01, "{plane} {space}");
}

/// A block that hardens is sheared by half between plates: plastic strain and shear stress at the middle, by height.
#[test]
fn uniform_shear_leaves_no_trace_of_a_transition() {
    let mut setup = bar(Dimension::Two, 1, [false; 3]);
    let law = flow_stress::find("johnson_cook").unwrap();
    let values = [
        ("initial_yield", 5e6),
        ("hardening_modulus", 5e6),
        ("hardening_exponent", 0.5),
        ("rate_coefficient", 0.0),
        ("softening_exponent", 1.0),
        ("melting_temperature", 9e3),
    ];
    setup.heat.plastic_heating = Switch::Off;
    setup.materials[0].flow_stress = law;
    setup.materials[0].flow_stress_values = Values::resolve(law.parameters, &values).unwrap();
    // 12 wide, 1.6 high, the transition in the middle.
    let shape = |low: f64, high: f64| Shape::Box {
        min: [-6.0, low, 0.0],
        max: [6.0, high, 0.0],
        rotation: 0.0,
        mirrored: false,
    };
    setup.bodies[0].shape = shape(-0.8, 0.8);
    let speed = 4.0;
    setup.supports = [(-0.8, -0.6, -speed), (0.65, 0.8, speed)]
        .map(|(low, high, speed)| Support {
            name: "plate".to_owned(),
            region: shape(low, high),
            velocity: [Some(speed), Some(0.0), None],
            temperature: None,
        })
        .to_vec();
    let mut engine = Engine::<2>::new(&setup).unwrap();
    for i in 0..engine.particles.count() {
        let along = (engine.particles.position[i][1] - 0.025) / 0.625;
        engine.particles.motion[i].set_velocity([speed * along.clamp(-1.0, 1.0), 0.0]);
    }
    while 2.0 * speed * engine.clock.time < 0.5 * 1.25 {
        engine.advance(&mut |_| ()).unwrap();
    }
    let points = engine.particles.point.iter().zip(&engine.particles.origin);
    let middle = |x: &Vector<2>| x[0].abs() < 1.0 && (-0.3..0.4).contains(&x[1]);
    let mut rows = std::collections::BTreeMap::<i64, Vec<f64>>::new();
    for (point, x) in points.filter(|(_, x)| middle(x)) {
        rows.entry((1e3 * x[1]).round() as i64).or_default().push(point.plastic_strain);
    }
    let mean = |strains: &[f64]| strains.iter().sum::<f64>() / strains.len() as f64;
    let all = mean(&rows.values().flatten().copied().collect::<Vec<f64>>());
    let traces = rows.values().map(|row| (mean(row) / all - 1.0).abs());
    let trace = traces.fold(0.0, f64::max);
    assert!(all > 0.25 && rows.len() == 11 && trace < 0.02, "{all} {trace}");
    // Along a row there is less.
    for row in rows.values() {
        let own = mean(row);
        assert!(row.iter().all(|strain| (strain / own - 1.0).abs() < 0.01), "{row:?}");
    }
}
