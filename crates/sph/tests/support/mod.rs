//! The small cut that several tests share.

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress, friction};
use sphcut_sph::setup::{
    Body, CuttingFrame, Dimension, Discretisation, Lattice, Material, Setup, Shape, Support,
    TemperatureTables, Tool, VelocityField,
};
use sphcut_sph::{CheckpointState, Sample, Simulation, options};

pub const SPACING: f64 = 25e-6;
pub const SPEED: f64 = 2.5;

/// A wedge without rounding: tip 0.1 mm below the surface, rake 5 and clearance 7 degrees.
pub fn wedge() -> Vec<[f64; 2]> {
    let (rake, clearance) = (5_f64.to_radians(), 7_f64.to_radians());
    let tip = [-1.2 * SPACING, -0.1e-3];
    let top = [tip[0] - 0.5e-3 * rake.tan(), tip[1] + 0.5e-3];
    let back = [tip[0] - 0.5e-3, tip[1] + 0.5e-3 * clearance.tan()];
    vec![tip, top, [back[0], top[1]], back]
}

fn steel() -> Material {
    let law = flow_stress::find("johnson_cook").unwrap();
    let values = [
        ("initial_yield", 553.1e6),
        ("hardening_modulus", 600.8e6),
        ("hardening_exponent", 0.234),
        ("rate_coefficient", 0.0134),
        ("softening_exponent", 1.0),
        ("melting_temperature", 1733.0),
    ];
    Material {
        name: "AISI 1045".to_owned(),
        density: 7870.0,
        moduli: ElasticModuli::from_young(205e9, 0.29),
        specific_heat: 486.0,
        thermal_conductivity: 50.7,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &values).unwrap(),
    }
}

/// The cut, turned by `rotation` about the origin.
pub fn cut(rotation: f64, lattice: Lattice) -> Setup {
    let turned = |p: [f64; 2]| {
        let (sine, cosine) = rotation.sin_cos();
        [cosine * p[0] - sine * p[1], sine * p[0] + cosine * p[1]]
    };
    let region = |min: [f64; 3], max: [f64; 3]| Shape::Box { min, max, rotation, mirrored: false };
    let turned3 = |p: [f64; 2]| {
        let q = turned(p);
        [q[0], q[1], 0.0]
    };
    let mut setup = Setup::empty(Dimension::Two, SPACING, 0.06e-3 / SPEED);
    setup.materials.push(steel());
    setup.bodies.push(Body {
        name: "workpiece".to_owned(),
        material: 0,
        shape: region([0.0, -0.35e-3, 0.0], [0.6e-3, 0.0, 0.0]),
        velocity: VelocityField::Uniform([0.0; 3]),
        temperature: 293.15,
    });
    setup.supports.push(Support {
        name: "bottom".to_owned(),
        region: region([-1.0, -1.0, 0.0], [1.0, -0.3e-3, 0.0]),
        velocity: [Some(0.0), Some(0.0), None],
        temperature: Some(293.15),
    });
    let law = friction::find("shear_capped_coulomb").unwrap();
    setup.tool = Some(Tool {
        surface: ToolSurface::Polygon(wedge().into_iter().map(turned).collect()),
        velocity: turned3([SPEED, 0.0]),
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: law,
        heat: None,
        friction_values: Values::resolve(law.parameters, &[("friction_coefficient", 0.25)])
            .unwrap(),
    });
    setup.frame = CuttingFrame {
        cutting: turned3([1.0, 0.0]),
        feed: turned3([0.0, -1.0]),
        passive: [0.0, 0.0, 1.0],
    };
    setup.numerics = Values::resolve(options::NUMERICS, &[("mass_scaling", 400.0)]).unwrap();
    setup.discretisation = Discretisation { lattice, ..Discretisation::default() };
    setup.sampling_interval = 2e-6 / SPEED;
    setup
}

pub fn run(setup: Setup) -> (Simulation, Vec<Sample>) {
    let mut simulation = Simulation::new(setup).unwrap();
    let mut samples = Vec::new();
    while !simulation.is_finished() {
        samples.extend(simulation.step().unwrap().sample);
    }
    (simulation, samples)
}

/// Bits of a state; comparing floating-point numbers would let -0 and NaN slip through.
pub fn bits(state: &CheckpointState) -> Vec<u64> {
    state.reals.iter().flat_map(|(_, values)| values.iter().map(|v| v.to_bits())).collect()
}
