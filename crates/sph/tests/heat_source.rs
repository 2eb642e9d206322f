//! Moving heat sources: their power arrives, and a restart changes no bit.

use approx::assert_relative_eq;
use sphcut_physics::elasticity::ElasticModuli;
use sphcut_physics::{Values, flow_stress};
use sphcut_sph::setup::{
    Body, Dimension, HeatSource, HeatSourceForm, Material, Setup, Shape, Switch, TemperatureTables,
    VelocityField,
};
use sphcut_sph::{ChannelId, Sample, Simulation};

const SPACING: f64 = 1e-4;

/// A block of 4 mm by 2 mm (by 1 mm) at 300 K with one source.
fn heated(dimension: Dimension, form: HeatSourceForm, end_time: f64) -> Setup {
    let law = flow_stress::find("elastic").unwrap();
    let mut setup = Setup::empty(dimension, SPACING, end_time);
    setup.sampling_interval = end_time / 10.0;
    setup.mechanics = Switch::Off;
    setup.materials.push(Material {
        name: "steel".to_owned(),
        density: 8000.0,
        moduli: ElasticModuli::from_young(200e9, 0.3),
        specific_heat: 500.0,
        thermal_conductivity: 40.0,
        tables: TemperatureTables::default(),
        equation_of_state: None,
        flow_stress: law,
        flow_stress_values: Values::resolve(law.parameters, &[]).unwrap(),
    });
    setup.bodies.push(Body {
        name: "block".to_owned(),
        material: 0,
        shape: Shape::Box {
            min: [0.0; 3],
            max: [4e-3, 2e-3, 1e-3],
            rotation: 0.0,
            mirrored: false,
        },
        velocity: VelocityField::Uniform([0.0; 3]),
        temperature: 300.0,
    });
    setup.heat_sources.push(HeatSource {
        name: "beam".to_owned(),
        form,
        power: 1e3,
        velocity: [0.1, 0.02, 0.0],
    });
    setup
}

fn last(setup: Setup) -> Sample {
    let mut simulation = Simulation::new(setup).unwrap();
    let mut last = None;
    while !simulation.is_finished() {
        last = simulation.step().unwrap().sample.or(last);
    }
    last.expect("the end closes an interval")
}

#[test]
fn a_gaussian_inside_a_body_gives_its_whole_power() {
    // Ten and five standard deviations from the sides; in 3D five from the nearest.
    for (dimension, width) in [(Dimension::Two, 2e-4), (Dimension::Three, 1e-4)] {
        let centre = [1.5e-3, 1e-3, 0.5e-3];
        let form = HeatSourceForm::Gaussian { centre, standard_deviation: width };
        let sample = last(heated(dimension, form, 5e-3));
        let supplied = sample.get(ChannelId::HeatSupplied);
        let expected = 1e3 * sample.get(ChannelId::Time);
        // Beyond five standard deviations lie 6e-7 of the power for each of at most four sides;
        // the lattice sum is 1e-8 off.
        assert_relative_eq!(supplied, expected, max_relative = 3e-6);
        // Conduction keeps heat to rounding.
        assert_relative_eq!(sample.get(ChannelId::HeatContent), supplied, max_relative = 1e-9);
    }
}

#[test]
fn a_box_gives_its_whole_power_while_it_moves() {
    let form = HeatSourceForm::Box { min: [1e-3, 0.5e-3, 0.0], max: [1.5e-3, 1e-3, 1.0] };
    let sample = last(heated(Dimension::Two, form, 5e-3));
    // Five by five spacings hold 25 particles wherever they stand: the density is exact but for
    // rounding where a side meets a particle, in few of the hundred and more steps.
    let expected = 1e3 * sample.get(ChannelId::Time);
    assert_relative_eq!(sample.get(ChannelId::HeatSupplied), expected, max_relative = 5e-3);
}

#[test]
fn half_of_a_source_on_a_surface_heats_nothing() {
    let form = HeatSourceForm::Gaussian { centre: [1.5e-3, 2e-3, 0.0], standard_deviation: 2e-4 };
    let mut setup = heated(Dimension::Two, form, 5e-3);
    setup.heat_sources[0].velocity = [0.1, 0.0, 0.0];
    let sample = last(setup);
    let expected = 0.5e3 * sample.get(ChannelId::Time);
    assert_relative_eq!(sample.get(ChannelId::HeatSupplied), expected, max_relative = 3e-6);
}

#[test]
fn the_peak_heats_at_the_rate_of_the_formula() {
    let form =
        HeatSourceForm::Gaussian { centre: [1.95e-3, 1.05e-3, 0.0], standard_deviation: 4e-4 };
    let mut setup = heated(Dimension::Two, form, 1e-3);
    setup.heat_sources[0].velocity = [0.0; 3];
    setup.heat.conduction = Switch::Off;
    let sample = last(setup);
    // 1000 W/m / (2 pi 0.16e-6 m^2) / 4e6 J/(m^3 K) = 248.680 K/s at the particle in the centre.
    let rise = sample.get(ChannelId::MaxTemperature) - 300.0;
    assert_relative_eq!(rise, 248.680 * sample.get(ChannelId::Time), max_relative = 1e-5);
}

#[test]
fn a_restored_run_goes_on_with_the_same_bits() {
    for mechanics in [Switch::Off, Switch::On] {
        let form = HeatSourceForm::Gaussian { centre: [1e-3, 1e-3, 0.0], standard_deviation: 2e-4 };
        let mut setup = heated(Dimension::Two, form, 5e-3);
        setup.mechanics = mechanics;
        if mechanics.is_on() {
            setup.end_time = 2e-6;
        }
        let steps = 100;
        let mut whole = Simulation::new(setup.clone()).unwrap();
        let mut state = None;
        for step in 0..2 * steps {
            if step == steps {
                state = Some(whole.checkpoint());
            }
            whole.step().unwrap();
        }
        let mut resumed = Simulation::restore(setup, &state.unwrap()).unwrap();
        for _ in 0..steps {
            resumed.step().unwrap();
        }
        let (whole, resumed) = (whole.checkpoint(), resumed.checkpoint());
        let bits = |state: &sphcut_sph::CheckpointState| -> Vec<u64> {
            state.reals.iter().flat_map(|(_, v)| v.iter().map(|x| x.to_bits())).collect()
        };
        assert!(bits(&whole) == bits(&resumed));
    }
}
