//! The small cut as a slab in space: a tool of triangles, plane strain by its sides.

mod support;

use sphcut_sph::setup::{Dimension, Lattice, Setup, Shape, Support, ToolSurface};
use sphcut_sph::{ChannelId, Sample, SetupError, Simulation};
use support::{SPACING, bits, cut, run, wedge};

/// Rows of particles across the slab.
const ROWS: f64 = 4.0;

/// The wedge from z = -1 mm to 2 mm.
fn prism() -> ToolSurface {
    let outline = wedge();
    let count = outline.len();
    let end = |z: f64| outline.iter().map(move |p| [p[0], p[1], z]);
    let vertices = end(-1e-3).chain(end(2e-3)).collect();
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

/// The plane cut as a slab whose particles keep their z.
fn slab() -> Setup {
    let width = ROWS * SPACING;
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
    setup.tool.as_mut().unwrap().surface = prism();
    setup
}

/// Mean over the later half of the run.
fn mean(samples: &[Sample], id: ChannelId) -> f64 {
    let later = &samples[samples.len() / 2..];
    later.iter().map(|sample| sample.get(id)).sum::<f64>() / later.len() as f64
}

/// Plane strain in space is plane strain. Not to rounding: a kernel in space weighs the neighbours
/// differently, and four rows have two free sides. The forces differ by 3.6 and 7.1 %.
#[test]
fn a_slab_held_at_its_sides_needs_the_forces_of_the_plane_cut() {
    let (_, plane) = run(cut(0.0, Lattice::Square));
    let (_, space) = run(slab());
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
    let setup = slab();
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
        let mut setup = slab();
        let tool = setup.tool.as_mut().unwrap();
        let ToolSurface::Triangles { triangles, .. } = &mut tool.surface else { panic!() };
        change(triangles);
        match Simulation::new(setup) {
            Err(SetupError::ToolSurface { reason }) => reason,
            other => panic!("{other:?}"),
        }
    };
    assert!(refused(&|triangles| triangles[3].swap(0, 1)).contains("facet"));
    let open = |triangles: &mut Vec<[usize; 3]>| triangles.truncate(triangles.len() - 1);
    assert!(refused(&open).contains("hole"));
    let all = |triangles: &mut Vec<[usize; 3]>| triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert!(refused(&all).contains("point into the tool"));
}
