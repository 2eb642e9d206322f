//! Properties over temperature: a constant table changes no bit, heat and energy are kept.

use approx::assert_relative_eq;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{TemperatureTable, Values, flow_stress, friction};
use sphcut_sph::setup::{
    Body, Dimension, HeatSource, HeatSourceForm, Material, Setup, Shape, Support, Switch,
    TemperatureTables, Tool, VelocityField,
};
use sphcut_sph::{ChannelId, Sample, Simulation, options};

const SPACING: f64 = 1e-4;

fn table(pairs: &[(f64, f64)]) -> Option<TemperatureTable> {
    Some(TemperatureTable::new(pairs).unwrap())
}

fn block(min: [f64; 2], max: [f64; 2]) -> Shape {
    Shape::Box {
        min: [min[0], min[1], 0.0],
        max: [max[0], max[1], 0.0],
        rotation: 0.0,
        mirrored: false,
    }
}

/// A block of 2 mm by 1 mm at `temperature`, of one material.
fn setup(law: &str, values: &[(&str, f64)], tables: TemperatureTables, temperature: f64) -> Setup {
    let law = flow_stress::find(law).unwrap();
    let mut setup = Setup::empty(Dimension::Two, SPACING, 1e-6);
    setup.sampling_interval = setup.end_time / 10.0;
    setup.materials.push(Material {
        name: "steel".to_owned(),
        density: 8000.0,
        moduli: ElasticModuli::from_young(200e9, 0.3),
        specific_heat: 500.0,
        thermal_conductivity: 40.0,
        tables,
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, values).unwrap(),
    });
    setup.bodies.push(Body {
        name: "block".to_owned(),
        material: 0,
        shape: block([0.0; 2], [2e-3, 1e-3]),
        velocity: VelocityField::Uniform([0.0; 3]),
        temperature,
    });
    setup
}

/// The block of Johnson-Cook steel thrown against a rough wall: plastic and friction heat,
/// conduction, a held temperature.
fn impact(tables: TemperatureTables) -> Setup {
    let values = [
        ("initial_yield", 553.1e6),
        ("hardening_modulus", 600.8e6),
        ("hardening_exponent", 0.234),
        ("rate_coefficient", 0.0134),
        ("softening_exponent", 1.0),
        ("melting_temperature", 1733.0),
    ];
    let mut setup = setup("johnson_cook", &values, tables, 293.15);
    setup.end_time = 4e-6;
    setup.sampling_interval = 4e-7;
    setup.bodies[0].velocity = VelocityField::Uniform([-200.0, -40.0, 0.0]);
    setup.supports.push(Support {
        name: "warm side".to_owned(),
        region: block([1.5e-3, -1e-3], [3e-3, 2e-3]),
        velocity: [None; 3],
        temperature: Some(350.0),
    });
    let coulomb = friction::find("coulomb").unwrap();
    setup.tool = Some(Tool {
        heat: None,
        surface: ToolSurface::HalfSpace {
            point: [-0.5 * SPACING, 0.0, 0.0],
            normal: [1.0, 0.0, 0.0],
        },
        velocity: [0.0; 3],
        velocity_changes: Vec::new(),
        edge_radius: None,
        friction: coulomb,
        friction_values: Values::resolve(coulomb.parameters, &[("friction_coefficient", 0.3)])
            .unwrap(),
    });
    setup
}

fn run(setup: &Setup) -> Vec<Sample> {
    let mut simulation = Simulation::new(setup.clone()).unwrap();
    let mut samples = Vec::new();
    while !simulation.is_finished() {
        samples.extend(simulation.step().unwrap().sample);
    }
    samples
}

fn last(setup: &Setup) -> Sample {
    run(setup).pop().unwrap()
}

/// Linear tables of the size of those of steel.
fn steel_tables() -> TemperatureTables {
    TemperatureTables {
        young_modulus: table(&[(293.15, 200e9), (800.0, 140e9)]),
        specific_heat: table(&[(293.15, 500.0), (800.0, 760.0)]),
        thermal_conductivity: table(&[(293.15, 40.0), (800.0, 25.0)]),
    }
}

#[test]
fn a_table_of_one_value_changes_no_bit() {
    let constant = TemperatureTables {
        young_modulus: table(&[(300.0, 200e9), (900.0, 200e9)]),
        specific_heat: table(&[(300.0, 500.0), (900.0, 500.0)]),
        thermal_conductivity: table(&[(300.0, 40.0)]),
    };
    assert_eq!(run(&impact(TemperatureTables::default())), run(&impact(constant)));
}

#[test]
fn energy_and_heat_are_closed_with_all_tables() {
    let closures = |setup: &Setup| {
        let end = last(setup);
        let initial = 0.5 * 8000.0 * 2e-6 * (200.0_f64.powi(2) + 40.0_f64.powi(2));
        let heat = end.get(ChannelId::HeatContent) - end.get(ChannelId::HeatSupplied);
        (end.get(ChannelId::EnergyError).abs() / initial, heat.abs() / initial, end)
    };
    let (plain_energy, plain_heat, plain) = closures(&impact(TemperatureTables::default()));
    let (energy, heat, end) = closures(&impact(steel_tables()));
    assert_eq!(plain.get(ChannelId::ThermoelasticWork), 0.0);
    // The block gets 100 K warmer and more where it flows: the modulus falls by some per cent.
    assert!(end.get(ChannelId::MaxTemperature) > 350.0);
    assert!(end.get(ChannelId::ThermoelasticWork).abs() > 1e-6 * end.get(ChannelId::PlasticWork));
    // Time integration leaves the same error with constants; heat is closed to rounding of its
    // content, 8000 * 500 * 2e-6 * 300 = 2400 J/m against an initial energy of 333 J/m.
    assert!(energy < 1.5 * plain_energy + 1e-9, "{energy} {plain_energy}");
    assert!(plain_heat < 1e-11 && heat < 1e-11, "{heat} {plain_heat}");
}

/// `rho int_T0^T cp dT = q t`: with cp = c_0 + s (T - T_0) a parabola.
#[test]
fn a_bar_with_a_linear_heat_capacity_reaches_the_exact_temperature() {
    let capacity = table(&[(300.0, 400.0), (800.0, 900.0)]);
    let tables = TemperatureTables { specific_heat: capacity, ..TemperatureTables::default() };
    let mut setup = setup("elastic", &[], tables, 300.0);
    setup.mechanics = Switch::Off;
    setup.end_time = 1e-2;
    setup.sampling_interval = 1e-3;
    setup.heat_sources.push(HeatSource {
        name: "everywhere".to_owned(),
        form: HeatSourceForm::Box { min: [-1e-3, -1e-3, 0.0], max: [3e-3, 2e-3, 0.0] },
        // 1e-2 s of 1.2e11 W/m^3 on 4 mm by 3 mm: 1.2e9 J/m^3, 150000 J/kg.
        power: 1.2e11 * 4e-3 * 3e-3,
        velocity: [0.0; 3],
    });
    let end = last(&setup);
    // 400 d + d^2/2 = 150000: d = -400 + sqrt(160000 + 300000) = 278.233 K after 1e-2 s; the last
    // step ends a little later.
    let rise = -400.0 + (160_000.0 + 3e7 * end.get(ChannelId::Time)).sqrt();
    assert_relative_eq!(rise, 278.233, max_relative = 1e-2);
    // Rounding of the steps only: how many there are does not matter.
    assert_relative_eq!(end.get(ChannelId::MaxTemperature), 300.0 + rise, max_relative = 1e-11);
    assert_relative_eq!(end.get(ChannelId::MinTemperature), 300.0 + rise, max_relative = 1e-11);
    let supplied = end.get(ChannelId::HeatSupplied);
    assert_relative_eq!(end.get(ChannelId::HeatContent), supplied, max_relative = 1e-11);
}

/// A wave at 550 K with E(550 K) from the table is the wave of a material with that modulus.
#[test]
fn a_hot_wave_has_the_speed_of_the_hot_modulus() {
    let wave = |mut setup: Setup| {
        setup.bodies[0].velocity =
            VelocityField::LongitudinalSine { amplitude: 1.0, wavelength: 2e-3 };
        // 0.35 periods of 2 mm / 5400 m/s.
        setup.end_time = 1.3e-7;
        setup.sampling_interval = 1.3e-8;
        last(&setup).get(ChannelId::KineticEnergy)
    };
    let young_modulus = table(&[(293.15, 200e9), (806.85, 100e9)]);
    let tables = TemperatureTables { young_modulus, ..TemperatureTables::default() };
    // Half way: 550 K has 150 GPa.
    let hot = wave(setup("elastic", &[], tables, 550.0));
    let mut equal = setup("elastic", &[], TemperatureTables::default(), 550.0);
    equal.materials[0].moduli = ElasticModuli::from_young(150e9, 0.3);
    // The same steps: those of the largest modulus.
    let courant = equal.numerics.get("courant") * 0.75_f64.sqrt();
    equal.numerics = Values::resolve(options::NUMERICS, &[("courant", courant)]).unwrap();
    let equal = wave(equal);
    let cold = wave(setup("elastic", &[], TemperatureTables::default(), 550.0));
    // The hourglass terms belong to the largest and the cold modulus: some 1e-3 at ten particles
    // per half wave; the speed of the cold modulus gives something else altogether.
    assert_relative_eq!(hot, equal, max_relative = 5e-3);
    assert!((hot - cold).abs() > 0.1 * hot, "{hot} {cold}");
}
