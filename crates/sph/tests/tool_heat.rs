//! Heat in the tool of a small cut: closed books, the same bits, and the signs it must have.

mod support;

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::{TemperatureTable, Values};
use sphcut_sph::setup::{Dimension, Lattice, Setup};
use sphcut_sph::{ChannelId, Sample, SetupError, Simulation};
use sphcut_tool_heat::{Coating, OuterBoundary, ThermalMaterial, ToolHeat};
use support::{SPACING, bits, cut, run, wedge};

fn material(conductivity: &[(f64, f64)], density: f64, specific_heat: f64) -> ThermalMaterial {
    let table = |pairs: &[(f64, f64)]| TemperatureTable::new(pairs).unwrap();
    ThermalMaterial {
        density,
        specific_heat: table(&[(293.15, specific_heat)]),
        thermal_conductivity: table(conductivity),
    }
}

/// Carbide with 3 um of AlTiN, its cut-off sides held at room temperature.
fn heat(contact_conductance: f64) -> ToolHeat {
    ToolHeat {
        substrate: material(&[(293.15, 100.0)], 14_850.0, 202.0),
        coating: Some(Coating {
            thickness: 3e-6,
            material: material(&[(273.15, 4.64), (1273.15, 5.18)], 4000.0, 800.0),
        }),
        temperature: 293.15,
        contact_conductance,
        outer_sides: vec![1, 2],
        outer: OuterBoundary::Fixed(293.15),
        fine_centre: [wedge()[0][0], wedge()[0][1], 0.0],
        fine_reach: 0.3e-3,
        element_size: 0.5 * SPACING,
        capacity_scaling: 1.0,
    }
}

fn heated_cut(contact_conductance: f64) -> Setup {
    let mut setup = cut(0.0, Lattice::Square);
    setup.tool.as_mut().unwrap().heat = Some(heat(contact_conductance));
    setup
}

fn mean_interface(samples: &[Sample]) -> f64 {
    let late = &samples[samples.len() / 2..];
    late.iter().map(|s| s.get(ChannelId::InterfaceTemperature)).sum::<f64>() / late.len() as f64
}

#[test]
fn heat_that_leaves_the_workpiece_is_in_the_tool() {
    let mut setup = heated_cut(1e6);
    let values = [("friction_heat_share", 0.45)];
    setup.heat.values = Values::resolve(sphcut_physics::heat::PARAMETERS, &values).unwrap();
    let (_, samples) = run(setup);
    let last = samples.last().unwrap();
    let into = last.get(ChannelId::HeatIntoTool);
    let friction = last.get(ChannelId::ToolFrictionHeat);
    assert!(into.abs() > 0.0 && friction > 0.0);
    // 1 - 0.45 of the friction heats the tool.
    let work = last.get(ChannelId::FrictionWork);
    assert!((friction - 0.55 * work).abs() < 1e-12 * work);
    let entered = into + friction + last.get(ChannelId::ToolBoundaryHeat);
    let content = last.get(ChannelId::ToolHeatContent);
    assert!((content - entered).abs() < 1e-11 * entered, "{content} {entered}");
    // The workpiece misses what passed; its own books close as without.
    let (found, supplied) = (last.get(ChannelId::HeatContent), last.get(ChannelId::HeatSupplied));
    assert!((found - supplied).abs() < 1e-6 * supplied, "{found} {supplied}");
}

#[test]
fn a_tool_that_conducts_heat_cools_the_chip_where_it_touches() {
    // All friction heat begins in the chip: what the tool does not get from the start it takes through
    // the contact. (Shared by halves, it heats the thin coating beyond the chip in the first moments.)
    let rubbed = |contact_conductance: f64| {
        let mut setup = heated_cut(contact_conductance);
        let values = [("friction_heat_share", 1.0)];
        setup.heat.values = Values::resolve(sphcut_physics::heat::PARAMETERS, &values).unwrap();
        run(setup)
    };
    let insulated = mean_interface(&rubbed(1e-3).1);
    let poor = mean_interface(&rubbed(1e5).1);
    let (simulation, samples) = rubbed(1e7);
    let good = mean_interface(&samples);
    assert!(insulated > poor && poor > good, "{insulated} {poor} {good}");
    // The hottest node lies on the rake face, above the tip.
    let snapshot = simulation.snapshot();
    let hottest = (0..snapshot.tool_temperature.len())
        .max_by(|a, b| snapshot.tool_temperature[*a].total_cmp(&snapshot.tool_temperature[*b]))
        .unwrap();
    let [tip, top] = [snapshot.tool[0], snapshot.tool[1]];
    let way = |from: [f64; 3], to: [f64; 3]| [to[0] - from[0], to[1] - from[1]];
    let (face, place) = (way(tip, top), way(tip, snapshot.tool_nodes[hottest]));
    let length = face[0].hypot(face[1]);
    let across = (face[0] * place[1] - face[1] * place[0]) / length;
    let along = (face[0] * place[0] + face[1] * place[1]) / length;
    assert!(across.abs() < 1e-9, "{across}");
    assert!(along > 0.0 && along < 0.2e-3, "{along}");
    let hottest = snapshot.tool_temperature[hottest];
    assert_eq!(hottest, samples.last().unwrap().get(ChannelId::ToolMaxTemperature));
    assert!(hottest > 310.0, "{hottest}");
}

#[test]
fn a_tool_that_takes_no_heat_is_no_tool_with_heat() {
    // With all friction heat in the workpiece and next to no conductance nothing passes: the
    // particles move by the same bits but for what 1e-12 of conductance takes.
    let without = cut(0.0, Lattice::Square);
    let mut insulated = heated_cut(1e-12);
    insulated.tool.as_mut().unwrap().heat.as_mut().unwrap().coating = None;
    let last = |setup| run(setup).1.last().unwrap().clone();
    let (a, b) = (last(without), last(insulated));
    for id in [ChannelId::CuttingForce, ChannelId::HeatContent, ChannelId::MaxTemperature] {
        let (a, b) = (a.get(id), b.get(id));
        assert!((a - b).abs() < 1e-6 * a.abs(), "{a} {b}");
    }
    assert_eq!(a.get(ChannelId::ToolMaxTemperature), 0.0);
}

#[test]
fn threads_and_interruptions_change_no_bit() {
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| run(heated_cut(1e6)).0.checkpoint())
    };
    let whole = with_threads(1);
    assert!(bits(&whole) == bits(&with_threads(3)));
    let setup = heated_cut(1e6);
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    for _ in 0..480 {
        interrupted.step().unwrap();
    }
    let state = interrupted.checkpoint();
    // Between two steps of the tool, with contacts that wait for the next.
    assert!(!state.real("tool_exposures").unwrap().is_empty());
    let mut resumed = Simulation::restore(setup, &state).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(bits(&whole) == bits(&resumed.checkpoint()));
    // A state without the tool's temperatures does not belong to this setup.
    let mut stripped = state;
    stripped.reals.retain(|(name, _)| name != "tool_temperature");
    let error = Simulation::restore(heated_cut(1e6), &stripped).unwrap_err();
    assert!(matches!(error, SetupError::Checkpoint { .. }), "{error}");
}

#[test]
fn what_cannot_be_meshed_says_why() {
    let mut thick = heated_cut(1e6);
    let tool = thick.tool.as_mut().unwrap();
    tool.heat.as_mut().unwrap().coating.as_mut().unwrap().thickness = 0.4e-3;
    let error = Simulation::new(thick).unwrap_err().to_string();
    assert!(error.contains("coating is too thick"), "{error}");
    let mut flat = heated_cut(1e6);
    flat.tool.as_mut().unwrap().surface =
        ToolSurface::HalfSpace { point: [-1.0, 0.0, 0.0], normal: [1.0, 0.0, 0.0] };
    let error = Simulation::new(flat.clone()).unwrap_err();
    assert!(matches!(error, SetupError::ToolHeat(_)), "{error}");
    flat.dimension = Dimension::Three;
    assert!(matches!(Simulation::new(flat), Err(SetupError::ToolHeat(_))));
}

#[test]
fn what_reaches_the_cut_off_sides_is_told() {
    // The back of the wedge lies 0.5 mm away: not in 24 us, when heat has come 60 um far. An outer side where
    // particles touch warms at once.
    let rise = |outer_sides: Vec<usize>| {
        let mut setup = heated_cut(1e6);
        let heat = setup.tool.as_mut().unwrap().heat.as_mut().unwrap();
        heat.coating = None;
        heat.outer = OuterBoundary::Adiabatic;
        heat.outer_sides = outer_sides;
        run(setup).1.last().unwrap().get(ChannelId::ToolOuterRise)
    };
    let (far, near) = (rise(vec![1, 2]), rise(vec![0]));
    assert!(far < 1e-3 && near > 1.0, "{far} {near}");
}
