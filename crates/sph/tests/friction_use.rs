//! How much of the friction that the law allows a particle uses.

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress, friction};
use sphcut_sph::setup::{
    Body, Dimension, Material, Setup, Shape, TemperatureTables, Tool, VelocityField,
};
use sphcut_sph::{Simulation, Snapshot};

const SPACING: f64 = 1e-3;

/// An elastic block without lateral contraction thrown against a plane at 0.5 m/s and, along it,
/// with `tangential`; pressed for 3 us, less than the two passages of the wave.
fn pressed(tangential: f64) -> Simulation {
    let law = flow_stress::find("elastic").unwrap();
    let mut setup = Setup::empty(Dimension::Two, SPACING, 3e-6);
    setup.materials.push(Material {
        name: "steel".to_owned(),
        density: 7850.0,
        moduli: ElasticModuli::from_young(200e9, 0.0),
        specific_heat: 480.0,
        thermal_conductivity: 50.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &[]).unwrap(),
    });
    setup.bodies.push(Body {
        name: "block".to_owned(),
        material: 0,
        shape: Shape::Box {
            min: [-10e-3, 0.0, 0.0],
            max: [10e-3, 10e-3, 0.0],
            rotation: 0.0,
            mirrored: false,
        },
        velocity: VelocityField::Uniform([tangential, -0.5, 0.0]),
        temperature: 300.0,
    });
    let coulomb = friction::find("coulomb").unwrap();
    setup.tool = Some(Tool {
        surface: ToolSurface::HalfSpace { point: [0.0; 3], normal: [0.0, 1.0, 0.0] },
        velocity: [0.0; 3],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: coulomb,
        friction_values: Values::resolve(coulomb.parameters, &[("friction_coefficient", 0.3)])
            .unwrap(),
        heat: None,
    });
    Simulation::new(setup).unwrap()
}

fn finished(mut simulation: Simulation) -> Snapshot {
    while !simulation.is_finished() {
        simulation.step().unwrap();
    }
    simulation.snapshot()
}

/// Tangential force of a particle in contact over its share of the regularised normal force: that of its
/// neighbours too, by 1, 2/3 and 1/3 over the sum of 3 (a radius of three spacings, all press, one spacing apart).
fn ratio(snapshot: &Snapshot, i: usize) -> f64 {
    let weight = |j: usize| {
        let apart = (snapshot.position[j][0] - snapshot.position[i][0]).abs() / SPACING;
        (1.0 - apart / 3.0).max(0.0) / 3.0
    };
    let normal: f64 =
        (0..snapshot.id.len()).map(|j| weight(j) * snapshot.contact_force[j][1]).sum();
    snapshot.contact_force[i][0].abs() / normal
}

#[test]
fn a_sliding_block_uses_all_and_a_sticking_one_its_share() {
    let touching = |snapshot: &Snapshot| -> Vec<usize> {
        (0..snapshot.id.len()).filter(|&i| snapshot.contact_force[i][1] > 0.0).collect()
    };
    let sliding = finished(pressed(1.0));
    let found = touching(&sliding);
    assert_eq!(found.len(), 20);
    // The shear wave needs less friction than 0.3 p only below about 0.2 m/s.
    assert!(found.iter().all(|&i| sliding.friction_use[i] == 1.0));
    let inside = (0..sliding.id.len()).filter(|i| !found.contains(i));
    assert!(inside.into_iter().all(|i| sliding.friction_use[i] == 0.0));
    let sticking = finished(pressed(0.05));
    let middle: Vec<usize> =
        touching(&sticking).into_iter().filter(|&i| sticking.position[i][0].abs() < 5e-3).collect();
    assert!(middle.len() > 5);
    for i in middle {
        let used = sticking.friction_use[i];
        // F_t / (mu F_n) by definition (the block is strained by 0.05 / c_s = 2e-5), and far from the limit: by rho c_s 0.05 / (rho c_p 0.5 mu)
        // = 0.7 * 0.1 / 0.3 = 0.24 in the waves that start at the wall.
        assert!((used - ratio(&sticking, i) / 0.3).abs() < 1e-4 * used, "{used}");
        assert!(used < 0.9, "{used}");
    }
}

#[test]
fn it_is_kept_in_a_checkpoint() {
    let mut simulation = pressed(0.05);
    for _ in 0..40 {
        simulation.step().unwrap();
    }
    let state = simulation.checkpoint();
    let again = Simulation::restore(pressed(0.05).setup().clone(), &state).unwrap();
    let snapshot = simulation.snapshot();
    assert!(snapshot.friction_use.iter().any(|used| *used > 0.0));
    assert_eq!(again.snapshot(), snapshot);
}
