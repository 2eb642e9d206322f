//! A small cut with the real solver: 600 particles of AISI 1045, a plain wedge.

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress, friction};
use sphcut_sph::Setup;
use sphcut_sph::options;
use sphcut_sph::setup::{
    Body, Dimension, Material, Shape, Support, TemperatureTables, Tool, VelocityField,
};

const SPACING: f64 = 1e-5;
const SPEED: f64 = 10.0;
const TRAVEL: f64 = 3e-5;

/// The setup of the cut.
pub fn small_cut() -> Setup {
    let mut setup = Setup::empty(Dimension::Two, SPACING, TRAVEL / SPEED);
    setup.sampling_interval = setup.end_time / 50.0;
    setup.width_of_cut = 3e-3;
    setup.uncut_chip_thickness = Some(4e-5);
    // Large steps: the test is about the record, not about the forces.
    setup.numerics = Values::resolve(options::NUMERICS, &[("mass_scaling", 100.0)]).unwrap();
    setup.materials = vec![steel()];
    setup.bodies = vec![Body {
        name: "workpiece".to_owned(),
        material: 0,
        shape: rectangle([0.0, -1.5e-4], [4e-4, 0.0]),
        velocity: VelocityField::Uniform([0.0; 3]),
        temperature: 293.15,
    }];
    setup.supports = vec![Support {
        name: "bottom".to_owned(),
        region: rectangle([0.0, -1.5e-4], [4e-4, -1.3e-4]),
        velocity: [Some(0.0); 3],
        temperature: Some(293.15),
    }];
    setup.tool = Some(wedge());
    setup
}

fn rectangle(min: [f64; 2], max: [f64; 2]) -> Shape {
    Shape::Box {
        min: [min[0], min[1], 0.0],
        max: [max[0], max[1], 0.0],
        rotation: 0.0,
        mirrored: false,
    }
}

fn steel() -> Material {
    let law = flow_stress::find("johnson_cook").unwrap();
    let values = [
        ("initial_yield", 5.53e8),
        ("hardening_modulus", 6.0e8),
        ("hardening_exponent", 0.234),
        ("rate_coefficient", 0.0134),
        ("softening_exponent", 1.0),
        ("reference_rate", 1.0),
        ("reference_temperature", 293.15),
        ("melting_temperature", 1733.0),
    ];
    Material {
        name: "AISI 1045".to_owned(),
        density: 7850.0,
        moduli: ElasticModuli::from_young(2.1e11, 0.3),
        specific_heat: 470.0,
        thermal_conductivity: 50.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &values).unwrap(),
    }
}

fn wedge() -> Tool {
    let law = friction::LAWS.iter().find(|law| law.key == "coulomb").unwrap();
    let front = -1e-6;
    Tool {
        surface: ToolSurface::Polygon(vec![
            [front, -4e-5],
            [front, 3e-4],
            [front - 2e-4, 3e-4],
            [front - 2e-4, -1e-5],
        ]),
        velocity: [SPEED, 0.0, 0.0],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: law,
        friction_values: Values::resolve(law.parameters, &[("friction_coefficient", 0.2)]).unwrap(),
        heat: None,
    }
}
