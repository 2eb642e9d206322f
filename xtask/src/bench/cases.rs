//! What is measured: a cut at two sizes and an impact in three dimensions.

use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress, friction};
use sphcut_sph::options;
use sphcut_sph::setup::{
    Body, Dimension, Material, Setup, Shape, Support, TemperatureTables, Tool, ToolSurface,
    VelocityField,
};

/// A case of the benchmark.
pub struct Case {
    /// Name in the table.
    pub name: &'static str,
    /// Steps before the measurement.
    pub warm_up: u64,
    /// What is computed.
    pub setup: fn() -> Setup,
}

/// All cases.
pub fn all() -> Vec<Case> {
    vec![
        Case { name: "2D cut, heat on", warm_up: 2000, setup: || cut(14.4e-6) },
        Case { name: "2D cut, heat on", warm_up: 150, setup: || cut(3.53e-6) },
        Case { name: "3D Taylor bar", warm_up: 50, setup: taylor_bar },
    ]
}

const PART: &str = "the built-in tables have this entry and these keys";

/// An orthogonal cut of steel: 2.5 mm x 0.5 mm, h 0.1 mm, 150 m/min, rake 5, clearance 7 degrees.
fn cut(spacing: f64) -> Setup {
    let speed = 2.5;
    let mut setup = Setup::empty(Dimension::Two, spacing, 1.0);
    setup.numerics = Values::resolve(options::NUMERICS, &[("mass_scaling", 100.0)]).expect(PART);
    setup.sampling_interval = 1e-6;
    setup.uncut_chip_thickness = Some(1e-4);
    setup.materials.push(steel());
    setup.bodies.push(Body {
        name: "workpiece".to_owned(),
        material: 0,
        shape: rectangle([0.0, -0.5e-3], [2.5e-3, 0.0]),
        velocity: VelocityField::Uniform([0.0; 3]),
        temperature: 293.15,
    });
    setup.supports.push(Support {
        name: "bottom".to_owned(),
        region: rectangle([0.0, -0.5e-3], [2.5e-3, -0.5e-3 + 3.0 * spacing]),
        velocity: [Some(0.0); 3],
        temperature: None,
    });
    let coefficient = [("friction_coefficient", 0.25)];
    let law = friction::find("shear_capped_coulomb").expect(PART);
    setup.tool = Some(Tool {
        heat: None,
        surface: ToolSurface::Polygon(wedge(0.6 * spacing)),
        velocity: [speed, 0.0, 0.0],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: law,
        friction_values: Values::resolve(law.parameters, &coefficient).expect(PART),
    });
    setup
}

/// A sharp wedge, rake 5 and clearance 7 degrees, its tip `gap` left of the workpiece at depth h.
fn wedge(gap: f64) -> Vec<[f64; 2]> {
    let (tip, height) = ([-gap, -1e-4], 1e-3);
    let (rake, clearance) = (5.0_f64.to_radians(), 7.0_f64.to_radians());
    vec![
        tip,
        [tip[0] - rake.tan() * height, tip[1] + height],
        [tip[0] - 1e-3, tip[1] + height],
        [tip[0] - 1e-3, tip[1] + clearance.tan() * 1e-3],
    ]
}

fn rectangle(min: [f64; 2], max: [f64; 2]) -> Shape {
    Shape::Box {
        min: [min[0], min[1], 0.0],
        max: [max[0], max[1], 0.0],
        rotation: 0.0,
        mirrored: false,
    }
}

/// Johnson-Cook steel of ordinary strength; the constants only have to keep the solver busy.
fn steel() -> Material {
    let law = flow_stress::find("johnson_cook").expect(PART);
    let constants = [
        ("initial_yield", 553.1e6),
        ("hardening_modulus", 600.8e6),
        ("hardening_exponent", 0.234),
        ("rate_coefficient", 0.0134),
        ("softening_exponent", 1.0),
        ("reference_rate", 1.0),
        ("reference_temperature", 293.15),
        ("melting_temperature", 1733.0),
    ];
    Material {
        name: "steel".to_owned(),
        density: 7850.0,
        moduli: ElasticModuli::from_young(210e9, 0.3),
        specific_heat: 480.0,
        thermal_conductivity: 45.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &constants).expect(PART),
    }
}

/// A copper-like bar, 32.4 mm x R3.2 mm, against a wall at 227 m/s.
fn taylor_bar() -> Setup {
    let spacing = 0.26e-3;
    let mut setup = Setup::empty(Dimension::Three, spacing, 1.0);
    setup.sampling_interval = 1e-6;
    let law = flow_stress::find("linear_hardening").expect(PART);
    let constants = [("initial_yield", 400e6), ("hardening_modulus", 100e6)];
    setup.materials.push(Material {
        name: "copper".to_owned(),
        density: 8930.0,
        moduli: ElasticModuli::from_young(117e9, 0.35),
        specific_heat: 385.0,
        thermal_conductivity: 390.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &constants).expect(PART),
    });
    setup.bodies.push(Body {
        name: "bar".to_owned(),
        material: 0,
        shape: Shape::Cylinder {
            centre: [0.0; 3],
            radius: 3.2e-3,
            inner_radius: 0.0,
            length: 32.4e-3,
        },
        velocity: VelocityField::Uniform([0.0, 0.0, -227.0]),
        temperature: 293.15,
    });
    let wall = friction::find("coulomb").expect(PART);
    setup.tool = Some(Tool {
        heat: None,
        surface: ToolSurface::HalfSpace {
            point: [0.0, 0.0, -0.6 * spacing],
            normal: [0.0, 0.0, 1.0],
        },
        velocity: [0.0; 3],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: wall,
        friction_values: Values::resolve(wall.parameters, &[("friction_coefficient", 0.0)])
            .expect(PART),
    });
    setup
}
