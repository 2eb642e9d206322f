//! A change of the solver that changes its numbers has to raise `sphcut_sph::RESULTS_VERSION`: stored results
//! would be taken for those of the new solver otherwise.

use sphcut_scenario::{LoadOptions, parse};
use sphcut_sph::{ChannelId, RESULTS_VERSION, Simulation};

const CUT: &str = r#"title = "A tiny cut"
[workpiece]
material = "aisi1045_table5"
length = "0.8 mm"
height = "0.3 mm"
[tool]
rake_angle = "5 deg"
clearance_angle = "7 deg"
edge_radius = "20 um"
[tool.friction]
law = "shear_capped_coulomb"
friction_coefficient = 0.25
[process]
cutting_speed = "150 m/min"
uncut_chip_thickness = "0.1 mm"
width_of_cut = "3 mm"
[resolution]
particle_spacing = "25 um"
# Defaults may change without the solver.
[heat]
friction_heat_share = 0.5
[numerics]
mass_scaling = 1000
[output]
sampling_travel = "10 um"
[stop]
travel = "0.05 mm"
"#;

/// Of version 6: F_c and F_f in N/m and the highest temperature in K at the last sample. Regression: they say
/// nothing of right or wrong.
const FROZEN: [f64; 3] = [209_372.222_842_241_5, 59_919.494_164_553_44, 413.111_154_950_866_8];

#[test]
fn the_version_goes_up_when_the_numbers_change() {
    let scenario = parse(CUT, "cut.toml", None, &LoadOptions::default()).unwrap();
    let mut simulation = Simulation::new(scenario.setup).unwrap();
    let mut last = None;
    while !simulation.is_finished() {
        last = simulation.step().unwrap().sample.or(last);
    }
    let sample = last.unwrap();
    let found = [ChannelId::CuttingForce, ChannelId::FeedForce, ChannelId::MaxTemperature]
        .map(|channel| sample.get(channel));
    // The mathematical functions of a system differ in the last digit; over these few steps that grows to less
    // than 1e-9 of a force.
    let close = found.iter().zip(FROZEN).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs());
    assert!(
        close && RESULTS_VERSION == 6,
        "the solver gives {found:?}, not {FROZEN:?}: raise RESULTS_VERSION and freeze the new numbers here"
    );
}
