//! The small cut as a slab in space: a tool of triangles, plane strain by its sides.

mod support;

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::{TemperatureTable, Values};
use sphcut_sph::setup::{Dimension, Lattice, Setup, Shape, Support};
use sphcut_sph::{ChannelId, Sample, SetupError, Simulation};
use sphcut_tool_heat::{Coating, OuterBoundary, ThermalMaterial, ToolHeat};
use support::{SPACING, bits, cut, run, wedge};

/// Rows of particles across the slab where forces count. The two at its free sides press two thirds as much as those inside, and
/// friction follows: of 4, 8 and 12 rows the feed force is 14, 8 and 8 % below that of the plane.
const ROWS: f64 = 12.0;
/// Where bits, balances or refusals count: none of them depends on the number of rows.
const FEW_ROWS: f64 = 4.0;

/// The wedge between two places along z.
fn prism(ends: [f64; 2]) -> ToolSurface {
    let outline = wedge();
    let count = outline.len();
    let end = |z: f64| outline.iter().map(move |p| [p[0], p[1], z]);
    let vertices = end(ends[0]).chain(end(ends[1])).collect();
    let mut triangles = Vec::new();
    for k in 0..count {
        let next = (k + 1) % count;
        triangles.push([k, next, count + next]);
        triangles.push([k, count + next, count + k]);
    }
    for k in 1..count - 1 {
        triangles.push([0, k + 1, k]);
        triangles.push([count, count + k, count + k + 1]);
    }
    ToolSurface::Triangles { vertices, triangles }
}

/// The plane cut as a slab of so many rows whose particles keep their z.
fn slab(rows: f64) -> Setup {
    let width = rows * SPACING;
    let mut setup = cut(0.0, Lattice::Square);
    setup.dimension = Dimension::Three;
    setup.width_of_cut = width;
    let wide = |shape: &mut Shape| {
        let Shape::Box { min, max, .. } = shape else { panic!("boxes") };
        (min[2], max[2]) = (0.0, width);
    };
    wide(&mut setup.bodies[0].shape);
    for support in &mut setup.supports {
        wide(&mut support.region);
        support.velocity[2] = Some(0.0);
    }
    let everywhere = Support {
        name: "plane".to_owned(),
        region: setup.bodies[0].shape.clone(),
        velocity: [None, None, Some(0.0)],
        temperature: None,
    };
    setup.supports.insert(0, everywhere);
    setup.tool.as_mut().unwrap().surface = prism([-1e-3, 2e-3]);
    setup
}

/// Mean over the later half of the run.
fn mean(samples: &[Sample], id: ChannelId) -> f64 {
    let later = &samples[samples.len() / 2..];
    later.iter().map(|sample| sample.get(id)).sum::<f64>() / later.len() as f64
}

/// Plane strain in space is plane strain. Not to rounding: a kernel in space weighs the neighbours
/// differently, and the slab has two free sides. The forces differ by 2.0 and 7.7 %.
#[test]
fn a_slab_held_at_its_sides_needs_the_forces_of_the_plane_cut() {
    let (_, plane) = run(cut(0.0, Lattice::Square));
    let (_, space) = run(slab(ROWS));
    let width = ROWS * SPACING;
    for (id, tolerance) in [(ChannelId::CuttingForce, 0.05), (ChannelId::FeedForce, 0.10)] {
        let (expected, found) = (mean(&plane, id), mean(&space, id) / width);
        assert!((found / expected - 1.0).abs() < tolerance, "{id:?}: {found} for {expected} N/m");
    }
    // Nothing pushes along the edge.
    let along = mean(&space, ChannelId::PassiveForce).abs();
    assert!(along < 1e-3 * mean(&space, ChannelId::CuttingForce), "{along}");
    let last = space.last().unwrap();
    let error = last.get(ChannelId::EnergyError) / last.get(ChannelId::ToolWork);
    assert!(error.abs() < 1e-3, "{error}");
}

#[test]
fn threads_and_an_interruption_change_no_bit_in_space() {
    let setup = slab(FEW_ROWS);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| run(setup.clone()).0)
    };
    let whole = with_threads(1);
    let most = whole.steps() * 3 / 4;
    let whole = whole.checkpoint();
    assert!(bits(&whole) == bits(&with_threads(3).checkpoint()));
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    let mut touched = false;
    for _ in 0..most {
        interrupted.step().unwrap();
        touched |= interrupted.snapshot().contact_force.iter().any(|force| force[0] != 0.0);
    }
    assert!(touched && !interrupted.is_finished());
    let mut resumed = Simulation::restore(setup, &interrupted.checkpoint()).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(bits(&whole) == bits(&resumed.checkpoint()));
}

#[test]
fn a_tool_in_space_that_is_open_or_inside_out_is_refused() {
    let refused = |change: &dyn Fn(&mut Vec<[usize; 3]>)| {
        let mut setup = slab(FEW_ROWS);
        let tool = setup.tool.as_mut().unwrap();
        let ToolSurface::Triangles { triangles, .. } = &mut tool.surface else { panic!() };
        change(triangles);
        match Simulation::new(setup) {
            Err(SetupError::ToolSurface(fault)) => fault.reason,
            other => panic!("{other:?}"),
        }
    };
    assert!(refused(&|triangles| triangles[3].swap(0, 1)).contains("facet"));
    let open = |triangles: &mut Vec<[usize; 3]>| triangles.truncate(triangles.len() - 1);
    assert!(refused(&open).contains("hole"));
    let all = |triangles: &mut Vec<[usize; 3]>| triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert!(refused(&all).contains("point into the tool"));
}

/// The slab with a tool of carbide that takes heat; all friction heat begins in the workpiece.
fn heated_slab(rows: f64, contact_conductance: f64, coating: Option<f64>) -> Setup {
    let table = |value: f64| TemperatureTable::new(&[(293.15, value)]).unwrap();
    let material = |density: f64, capacity: f64, conductivity: f64| ThermalMaterial {
        density,
        specific_heat: table(capacity),
        thermal_conductivity: table(conductivity),
    };
    let [x, y] = wedge()[0];
    let mut setup = slab(rows);
    let values = [("friction_heat_share", 1.0)];
    setup.heat.values = Values::resolve(sphcut_physics::heat::PARAMETERS, &values).unwrap();
    let tool = setup.tool.as_mut().unwrap();
    // As wide as the slab: no heat flows along z.
    tool.surface = prism([0.0, rows * SPACING]);
    tool.heat = Some(ToolHeat {
        substrate: material(14_850.0, 202.0, 100.0),
        coating: coating
            .map(|thickness| Coating { thickness, material: material(4000.0, 800.0, 5.0) }),
        temperature: 293.15,
        contact_conductance,
        // The back and the top of the wedge.
        outer_sides: vec![2, 3, 4, 5],
        outer: OuterBoundary::Fixed(293.15),
        fine_centre: [x, y, 0.5 * rows * SPACING],
        fine_reach: 0.15e-3,
        element_size: SPACING,
        capacity_scaling: 1.0,
    });
    setup
}

#[test]
fn heat_that_leaves_the_workpiece_is_in_the_tool_in_space() {
    let mut setup = heated_slab(FEW_ROWS, 1e6, Some(3e-6));
    let values = [("friction_heat_share", 0.5)];
    setup.heat.values = Values::resolve(sphcut_physics::heat::PARAMETERS, &values).unwrap();
    let (_, samples) = run(setup);
    let last = samples.last().unwrap();
    let into = last.get(ChannelId::HeatIntoTool);
    let friction = last.get(ChannelId::ToolFrictionHeat);
    assert!(into.abs() > 0.0 && friction > 0.0);
    let entered = into + friction + last.get(ChannelId::ToolBoundaryHeat);
    let content = last.get(ChannelId::ToolHeatContent);
    assert!((content - entered).abs() < 1e-11 * (into.abs() + friction), "{content} {entered}");
    let (found, supplied) = (last.get(ChannelId::HeatContent), last.get(ChannelId::HeatSupplied));
    assert!((found - supplied).abs() < 1e-6 * supplied, "{found} {supplied}");
}

#[test]
fn a_tool_in_space_that_takes_heat_cools_the_interface_as_in_the_plane() {
    let (simulation, samples) = run(heated_slab(ROWS, 1e7, None));
    let interface = |samples: &[Sample]| mean(samples, ChannelId::InterfaceTemperature);
    let [none, poor] = [1e-3, 1e5].map(|h| interface(&run(heated_slab(ROWS, h, None)).1));
    let good = interface(&samples);
    assert!(none > poor && poor > good, "{none} {poor} {good}");
    // The same share of the heat of friction enters the tool as in the plane, and a coating takes as much off it: not to rounding,
    // the cuts themselves differ.
    let flat = |coating: Option<f64>| {
        let mut setup = cut(0.0, Lattice::Square);
        let slab = heated_slab(ROWS, 1e7, coating);
        setup.heat = slab.heat;
        let mut heat = slab.tool.unwrap().heat.unwrap();
        heat.outer_sides = vec![1, 2];
        setup.tool.as_mut().unwrap().heat = Some(heat);
        run(setup).1
    };
    let share = |samples: &[Sample]| {
        let last = samples.last().unwrap();
        last.get(ChannelId::HeatIntoTool) / last.get(ChannelId::FrictionWork)
    };
    let rise = |samples: &[Sample]| interface(samples) - 293.15;
    let (bare, bare_plane) = (share(&samples), flat(None));
    let (coated, coated_plane) = (run(heated_slab(ROWS, 1e7, Some(3e-6))).1, flat(Some(3e-6)));
    let plane = share(&bare_plane);
    assert!((bare / plane - 1.0).abs() < 0.05, "{bare} {plane}");
    let (found, expected) = (share(&coated) / bare, share(&coated_plane) / plane);
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    for (space, plane) in [(&samples, &bare_plane), (&coated, &coated_plane)] {
        // It rises with the heat of friction: the feed force is that of the plane to 8 %.
        let friction = |samples: &[Sample]| samples.last().unwrap().get(ChannelId::FrictionWork);
        let heat = friction(space) / (ROWS * SPACING) / friction(plane);
        let (found, expected) = (rise(space), heat * rise(plane));
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    }
    // The hottest node lies on the surface, above the tip on the rake face.
    let snapshot = simulation.snapshot();
    let by_heat = |a: &usize, b: &usize| {
        snapshot.tool_temperature[*a].total_cmp(&snapshot.tool_temperature[*b])
    };
    let hottest = (0..snapshot.tool_temperature.len()).max_by(by_heat).unwrap();
    assert!(snapshot.tool_elements.contains(&(hottest as u32)));
    let [tip, top] = [wedge()[0], wedge()[1]];
    let shift = snapshot.tool[0][0] - tip[0];
    let place = snapshot.tool_nodes[hottest];
    let height = (place[1] - tip[1]) / (top[1] - tip[1]);
    let face = tip[0] + shift + height * (top[0] - tip[0]);
    assert!((place[0] - face).abs() < 2e-6 && height < 0.4, "{place:?} {face}");
    assert_eq!(
        snapshot.tool_temperature[hottest],
        samples.last().unwrap().get(ChannelId::ToolMaxTemperature)
    );
}

#[test]
fn threads_and_an_interruption_change_no_bit_of_a_heated_tool_in_space() {
    let setup = heated_slab(FEW_ROWS, 1e6, Some(3e-6));
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| run(setup.clone()).0)
    };
    let whole = with_threads(1);
    let most = whole.steps() * 3 / 4;
    let whole = whole.checkpoint();
    assert!(bits(&whole) == bits(&with_threads(3).checkpoint()));
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    while interrupted.steps() < most
        || interrupted.checkpoint().real("tool_exposures").unwrap().is_empty()
    {
        interrupted.step().unwrap();
    }
    let mut resumed = Simulation::restore(setup, &interrupted.checkpoint()).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(bits(&whole) == bits(&resumed.checkpoint()));
}

#[test]
fn what_cannot_be_meshed_in_space_says_why() {
    let refused = |change: &dyn Fn(&mut ToolHeat)| {
        let mut setup = heated_slab(ROWS, 1e6, Some(3e-6));
        change(setup.tool.as_mut().unwrap().heat.as_mut().unwrap());
        match Simulation::new(setup) {
            Err(SetupError::ToolHeat(fault)) => fault.reason,
            other => panic!("{other:?}"),
        }
    };
    assert!(refused(&|heat| heat.element_size = 1e-7).contains("larger element size"));
    assert!(refused(&|heat| heat.outer_sides = (0..12).collect()).contains("touch none"));
    let thick = |heat: &mut ToolHeat| heat.coating.as_mut().unwrap().thickness = 0.4e-3;
    assert!(refused(&thick).contains("too thick"));
}
