//! The Mie-Gruneisen equation of state in whole bodies: thermal stress, thermal expansion, a shock in
//! space, closed books.

mod support;

use approx::assert_relative_eq;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::equation_of_state::{self, MieGruneisen, ReferenceState};
use sphcut_physics::{TemperatureTable, Values, flow_stress};
use sphcut_sph::setup::{
    Body, Dimension, HeatSource, HeatSourceForm, Lattice, Material, Setup, Shape, Support, Switch,
    TemperatureTables, VelocityField,
};
use sphcut_sph::{ChannelId, Sample, Simulation, Snapshot, options};

const DENSITY: f64 = 8930.0;
const ROOM: f64 = 293.15;

/// The law of a copper whose capacity is 386 J/(kg K) at constant pressure.
fn law(density: f64, speed: f64) -> MieGruneisen {
    let entry = equation_of_state::find("mie_gruneisen").unwrap();
    let given =
        [("bulk_sound_speed", speed), ("shock_slope", 1.489), ("gruneisen_parameter", 1.99)];
    let values = Values::resolve(entry.parameters, &given).unwrap();
    entry.build.unwrap()(&values, &ReferenceState { density, specific_heat: 386.0 })
}

fn copper(young_modulus: f64) -> Material {
    let elastic = flow_stress::find("elastic").unwrap();
    Material {
        name: "copper".to_owned(),
        density: DENSITY,
        moduli: ElasticModuli::from_young(young_modulus, 0.34),
        specific_heat: 386.0,
        thermal_conductivity: 400.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: elastic,
        flow_stress_values: Values::defaults(elastic.parameters),
    }
    .with_equation_of_state(law(DENSITY, 3940.0))
}

fn block(min: [f64; 3], max: [f64; 3], speed: f64) -> Body {
    Body {
        name: "block".to_owned(),
        material: 0,
        shape: Shape::Box { min, max, rotation: 0.0, mirrored: false },
        velocity: VelocityField::Uniform([speed, 0.0, 0.0]),
        temperature: ROOM,
    }
}

fn held(velocity: [Option<f64>; 3]) -> Support {
    let region = Shape::Box { min: [-1.0; 3], max: [1.0; 3], rotation: 0.0, mirrored: false };
    Support { name: "held".to_owned(), region, velocity, temperature: None }
}

/// A block of 1 mm by 1 mm (by 0.5 mm) heated evenly by `rise` kelvin at constant volume over the run.
fn heated(dimension: Dimension, rise: f64, end_time: f64) -> Setup {
    let mut setup = Setup::empty(dimension, 1e-4, end_time);
    setup.sampling_interval = end_time / 50.0;
    setup.materials.push(copper(124e9));
    let depth = if dimension == Dimension::Two { 0.0 } else { 0.5e-3 };
    setup.bodies.push(block([0.0; 3], [1e-3, 1e-3, depth], 0.0));
    let room = if dimension == Dimension::Two { 1.0 } else { 4e-3 };
    let capacity = law(DENSITY, 3940.0).thermal_pressure_slope() / 1.99;
    setup.heat_sources.push(HeatSource {
        name: "everywhere".to_owned(),
        form: HeatSourceForm::Box { min: [-2e-3; 3], max: [2e-3; 3] },
        power: capacity * rise / end_time * 16e-6 * room,
        velocity: [0.0; 3],
    });
    setup
}

fn run(setup: &Setup) -> (Snapshot, Vec<Sample>) {
    let (simulation, samples) = support::run(setup.clone());
    (simulation.snapshot(), samples)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Nothing may move: the pressure rises by a dT, whatever the elastic moduli.
#[test]
fn a_body_that_cannot_expand_comes_under_thermal_pressure() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let mut setup = heated(dimension, 100.0, 2e-7);
        setup.supports.push(held([Some(0.0); 3]));
        let (end, _) = run(&setup);
        for (pressure, temperature) in end.pressure.iter().zip(&end.temperature) {
            let expected = law(DENSITY, 3940.0).thermal_pressure_slope() * (temperature - ROOM);
            assert!((temperature - ROOM - 100.0).abs() < 10.0, "{temperature}");
            assert_relative_eq!(*pressure, expected, max_relative = 1e-12);
        }
    }
}

/// Free in space: V/V_0 = 1 + alpha_v dT, and the heat supplied raises T at constant pressure.
#[test]
fn a_free_body_expands_and_takes_the_capacity_at_constant_pressure() {
    let mut setup = heated(Dimension::Three, 100.0, 6e-6);
    setup.numerics = Values::resolve(options::NUMERICS, &[("linear_viscosity", 1.0)]).unwrap();
    let (end, samples) = run(&setup);
    let rise = mean(&end.temperature) - ROOM;
    // c_v 100 K of heat: the rise at constant pressure is c_v/c_p of it, to second order in
    // Gamma_0 alpha_v dT = 1 %.
    let law = law(DENSITY, 3940.0);
    assert_relative_eq!(rise, 100.0 * law.heat_ratio(), max_relative = 5e-3);
    let expansion = DENSITY / mean(&end.density) - 1.0;
    // Of second order: K_T falls by alpha_v dT times its derivative, 1 %; what still vibrates is less.
    assert_relative_eq!(expansion, law.thermal_expansion() * rise, max_relative = 0.015);
    let last = samples.last().unwrap();
    let supplied = last.get(ChannelId::HeatSupplied);
    assert_relative_eq!(last.get(ChannelId::HeatContent), supplied, max_relative = 1e-11);
}

/// Held along x and (plane strain) z, free along y: sigma_xx = sigma_zz = -E alpha dT/(1 - nu).
#[test]
fn a_hot_layer_that_cannot_widen_is_pressed_along_the_surface() {
    let mut setup = heated(Dimension::Two, 40.0, 8e-6);
    setup.supports.push(held([Some(0.0), None, None]));
    setup.numerics = Values::resolve(options::NUMERICS, &[("linear_viscosity", 1.0)]).unwrap();
    let (end, _) = run(&setup);
    let component = |k: usize| mean(&end.stress.iter().map(|s| s[k]).collect::<Vec<_>>());
    let (law, shear) = (law(DENSITY, 3940.0), ElasticModuli::from_young(124e9, 0.34).shear);
    // The isothermal bulk modulus belongs to slow heating: K_T = a/alpha_v.
    let bulk = law.thermal_pressure_slope() / law.thermal_expansion();
    let moduli = ElasticModuli { bulk, shear };
    let poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
    let rise = mean(&end.temperature) - ROOM;
    let expected = -moduli.young() * law.thermal_expansion() / 3.0 * rise / (1.0 - poisson);
    // 125 MPa; strains of 1e-3 make relative errors of some 1e-3, what still vibrates is below 1 %.
    assert!(expected < -50e6, "{expected}");
    assert_relative_eq!(component(0), expected, max_relative = 0.015);
    assert_relative_eq!(component(2), expected, max_relative = 0.015);
    assert!(component(1).abs() < 0.015 * expected.abs(), "{}", component(1));
}

/// A rod of 5 mm against its mirror image: the jump conditions at u_p = 500 m/s (see
/// `validation/plate_impact`), in space and on a coarse lattice.
#[test]
fn a_shock_in_space_has_its_hugoniot() {
    let mut setup = Setup::empty(Dimension::Three, 1e-4, 8e-7);
    setup.materials.push(copper(1e6));
    setup.bodies.push(block([-5e-3, 0.0, 0.0], [0.0, 3e-4, 3e-4], 500.0));
    setup.bodies.push(block([0.0; 3], [5e-3, 3e-4, 3e-4], -500.0));
    setup.supports.push(held([None, Some(0.0), Some(0.0)]));
    setup.heat.plastic_heating = Switch::Off;
    setup.heat.friction_heating = Switch::Off;
    setup.heat.conduction = Switch::Off;
    let viscosity = [("linear_viscosity", 0.5), ("quadratic_viscosity", 1.5)];
    setup.numerics = Values::resolve(options::NUMERICS, &viscosity).unwrap();
    let first = Simulation::new(setup.clone()).unwrap().snapshot();
    let (end, samples) = run(&setup);
    assert_eq!(first.id, end.id);
    let slab: Vec<usize> =
        (0..first.id.len()).filter(|i| (1e-3..2e-3).contains(&first.position[*i][0])).collect();
    let of = |values: &[f64]| mean(&slab.iter().map(|i| values[*i]).collect::<Vec<_>>());
    // 10 to 20 spacings from the plane of impact: as in the plane at this distance, 1 % of pressure and
    // the excess heat of the first contact, 30 K; the isentrope alone would be 39 K below.
    assert_relative_eq!(of(&end.pressure), 20.916e9, max_relative = 0.01);
    assert_relative_eq!(of(&end.density), 9997.0, max_relative = 0.003);
    let temperature = of(&end.temperature);
    assert!(temperature > 401.2 && temperature < 436.0, "{temperature}");
    let (last, kinetic) =
        (samples.last().unwrap(), 0.5 * DENSITY * 1e-2 * 9e-8 * 500.0_f64.powi(2));
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * kinetic);
    let supplied = last.get(ChannelId::HeatSupplied);
    assert_relative_eq!(last.get(ChannelId::HeatContent), supplied, max_relative = 1e-10);
}

/// A cut with plastic and friction heat, conduction and tables of E, cp and k.
#[test]
fn a_cut_closes_its_books_and_goes_on_after_a_restart() {
    let mut setup = support::cut(0.0, Lattice::Square);
    let plain = run(&setup).1;
    let table = |pairs: &[(f64, f64)]| Some(TemperatureTable::new(pairs).unwrap());
    let material = &mut setup.materials[0];
    let speed = (material.moduli.bulk / material.density).sqrt();
    let young = material.moduli.young();
    material.tables = TemperatureTables {
        young_modulus: table(&[(ROOM, young), (1000.0, 0.6 * young)]),
        specific_heat: table(&[(ROOM, 386.0), (1000.0, 600.0)]),
        thermal_conductivity: table(&[(ROOM, 50.0), (1000.0, 30.0)]),
    };
    let law = law(material.density, speed);
    *material = material.clone().with_equation_of_state(law);
    let (whole, samples) = support::run(setup.clone());
    let (end, plain) = (samples.last().unwrap(), plain.last().unwrap());
    let work = end.get(ChannelId::ToolWork);
    assert!(end.get(ChannelId::EnergyError).abs() < 2e-3 * work);
    let supplied = end.get(ChannelId::HeatSupplied);
    assert!((end.get(ChannelId::HeatContent) - supplied).abs() < 1e-9 * supplied);
    assert!(end.get(ChannelId::ThermoelasticWork) != 0.0);
    assert_eq!(plain.get(ChannelId::ThermoelasticWork), 0.0);
    // The same cut: thermal pressure changes the forces by some per cent.
    assert_relative_eq!(work, plain.get(ChannelId::ToolWork), max_relative = 0.1);

    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    for _ in 0..150 {
        interrupted.step().unwrap();
    }
    assert!(!interrupted.is_finished());
    let mut resumed = Simulation::restore(setup.clone(), &interrupted.checkpoint()).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(support::bits(&whole.checkpoint()) == support::bits(&resumed.checkpoint()));
}
