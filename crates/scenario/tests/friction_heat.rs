//! Where the heat of friction goes: all of it into the workpiece, or parted with a tool that takes heat.

use sphcut_input::{Origin, Problem};
use sphcut_scenario::{LoadOptions, Scenario, parse};
use sphcut_sph::{ChannelId, Simulation};
use std::path::Path;

const CUT: &str = r#"
title = "A small cut"

[workpiece]
material = "aisi1045_table5"
length = "0.8 mm"
height = "0.3 mm"

[tool]
rake_angle = "5 deg"
clearance_angle = "7 deg"
edge_radius = "20 um"
friction = { law = "coulomb", friction_coefficient = 0.25 }

[process]
cutting_speed = "150 m/min"
uncut_chip_thickness = "0.1 mm"
width_of_cut = "3 mm"

[resolution]
particle_spacing = "20 um"

[numerics]
mass_scaling = 1000

[output]
sampling_travel = "4 um"

[stop]
travel = "0.1 mm"
"#;

fn read(more: &str) -> Result<Scenario, Vec<Problem>> {
    parse(&format!("{CUT}{more}"), "cut.toml", None, &LoadOptions::default())
}

/// The share of the setup; `sphcut check` must say the same.
fn share(scenario: &Scenario, origin: Origin) -> f64 {
    let share = scenario.setup.heat.values.get("friction_heat_share");
    let told: Vec<_> =
        scenario.description.iter().filter(|entry| entry.key == "friction_heat_share").collect();
    assert_eq!(told.len(), 1);
    assert_eq!((told[0].number, told[0].origin), (Some(share), origin));
    share
}

fn complaint(scenario: &Scenario) -> Option<&String> {
    scenario.warnings.iter().find(|text| text.contains("leaves the model"))
}

#[test]
fn a_tool_of_angles_is_carbide_without_being_told() {
    let (told, untold) = (read("[tool.heat]\n").unwrap(), read("").unwrap());
    assert_eq!(untold.setup.tool.as_ref().unwrap().heat, told.setup.tool.as_ref().unwrap().heat);
    assert_eq!(share(&untold, Origin::Derived), share(&told, Origin::Derived));
    assert_eq!(complaint(&untold), None);
}

#[test]
fn a_tool_without_heat_leaves_all_of_it_to_the_chip() {
    let takes = |scenario: &Scenario| scenario.setup.tool.as_ref().unwrap().heat.is_some();
    let adiabatic = read("[heat]\nfriction_heat_share = 1.0\n").unwrap();
    assert!(!takes(&adiabatic));
    assert_eq!((share(&adiabatic, Origin::Given), complaint(&adiabatic)), (1.0, None));
    // What conducts nothing gives nothing.
    let still = read("[heat]\nconduction = false\n").unwrap();
    assert!(!takes(&still));
    assert_eq!((share(&still, Origin::Derived), complaint(&still)), (1.0, None));
    // Where a drawn tool is cut off is not known.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good");
    let text = std::fs::read_to_string(folder.join("cut_with_outline.toml")).unwrap();
    let drawn = parse(&text, "cut.toml", Some(&folder), &LoadOptions::default()).unwrap();
    assert!(!takes(&drawn));
    assert_eq!((share(&drawn, Origin::Derived), complaint(&drawn)), (1.0, None));
}

#[test]
fn a_written_share_holds_and_what_is_lost_is_told() {
    let scenario = read("[heat]\nfriction_heat_share = 0.4\n").unwrap();
    assert_eq!(share(&scenario, Origin::Given), 0.4);
    let told = complaint(&scenario).unwrap();
    assert!(told.contains("friction_heat_share = 0.4") && told.contains("60 %"), "{told}");
    // With heat in the tool nothing is lost.
    let scenario = read("[heat]\nfriction_heat_share = 0.4\n[tool.heat]\n").unwrap();
    assert_eq!(share(&scenario, Origin::Given), 0.4);
    assert_eq!(complaint(&scenario), None);
}

#[test]
fn an_empty_table_is_carbide_and_parts_the_heat_by_the_effusivities() {
    let scenario = read("[tool.heat]\n").unwrap();
    let tool = scenario.setup.tool.as_ref().unwrap();
    let heat = tool.heat.as_ref().unwrap();
    let substrate = &heat.substrate;
    assert_eq!(substrate.density, 14_850.0);
    assert_eq!(substrate.specific_heat.value(300.0), 202.0);
    assert_eq!(substrate.thermal_conductivity.value(300.0), 100.0);
    assert_eq!(heat.contact_conductance, 1e7);
    // AISI 1045 of Table 5: sqrt(50.7 * 7850 * 486) = sqrt(1.93426e8) = 13907.8; carbide 17319.6 (see
    // `sphcut_physics::heat`). 13907.8 / 31227.4 = 0.44537.
    let found = share(&scenario, Origin::Derived);
    assert!((found - 0.44537).abs() < 1e-5, "{found}");
    assert_eq!(complaint(&scenario), None);
}

#[test]
fn what_conducts_better_takes_more() {
    let diamond = "[tool.heat]\ndensity = \"3500 kg/m^3\"\nspecific_heat = \"500 J/(kg K)\"\n\
                   thermal_conductivity = \"1000 W/(m K)\"\n";
    let of = |text: &str| share(&read(text).unwrap(), Origin::Derived);
    assert!(of(diamond) < of("[tool.heat]\n"));
    // A coating changes the mesh, not the share.
    let coated = "[tool.heat]\n[tool.heat.coating]\nthickness = \"3 um\"\ndensity = \"4000 kg/m^3\"\n\
                  specific_heat = \"800 J/(kg K)\"\nthermal_conductivity = \"4.6 W/(m K)\"\n";
    assert_eq!(of(coated), of("[tool.heat]\n"));
}

#[test]
fn without_heat_of_friction_there_is_no_share() {
    let scenario = read("[heat]\nfriction_heating = false\n").unwrap();
    assert!(!scenario.description.iter().any(|entry| entry.key == "friction_heat_share"));
    assert_eq!(complaint(&scenario), None);
}

/// What a run with `[tool.heat]` alone books: heat of friction in chip and tool is its work, and what the damping dissipates heats as
/// plastic work does.
#[test]
fn no_heat_of_friction_or_damping_is_lost() {
    let scenario = read("[tool.heat]\n").unwrap();
    let share = share(&scenario, Origin::Derived);
    let mut simulation = Simulation::new(scenario.setup).unwrap();
    let mut samples = Vec::new();
    while !simulation.is_finished() {
        samples.extend(simulation.step().unwrap().sample);
    }
    let last = samples.last().unwrap();
    let work = last.get(ChannelId::FrictionWork);
    assert!(work > 0.0);
    let tool = last.get(ChannelId::ToolFrictionHeat);
    // Rounding of sums over some thousand contacts.
    assert!((tool - (1.0 - share) * work).abs() < 1e-12 * work);
    let plastic = 0.9 * last.get(ChannelId::PlasticWork);
    let chip = last.get(ChannelId::HeatSupplied) + last.get(ChannelId::HeatIntoTool) - plastic;
    let numerical = last.get(ChannelId::NumericalHeat);
    assert!((chip + tool - work - numerical).abs() < 1e-10 * work, "{chip} {tool} {work}");
    // It stands for plastic work that the spacing does not resolve. The springs of the damping still store a hundredth of what they took at most.
    let taken = last.get(ChannelId::HourglassWork) + last.get(ChannelId::ViscosityWork);
    assert!(numerical <= 0.9 * taken && numerical > 0.89 * taken, "{numerical} {taken}");
}
