//! The moving window: same bits at any thread count and after a restart, closed books, and the forces of the
//! cut that is followed whole.

mod support;

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::Values;
use sphcut_sph::setup::{
    Body, CuttingFrame, Dimension, Grading, Lattice, MovingWindow, Setup, Shape, Support,
    VelocityField,
};
use sphcut_sph::{ChannelId, Sample, SetupError, Simulation, options};
use std::sync::LazyLock;
use support::{SPACING, SPEED, bits, cut, run, wedge};

/// Long enough for material to come and to go.
fn long_cut(rotation: f64) -> Setup {
    let mut setup = cut(rotation, Lattice::Square);
    if let Shape::Box { max, .. } = &mut setup.bodies[0].shape {
        max[0] = 1.4e-3;
    }
    setup.end_time = 0.8e-3 / SPEED;
    setup.sampling_interval = 10e-6 / SPEED;
    setup.uncut_chip_thickness = Some(0.1e-3);
    setup.numerics = Values::resolve(options::NUMERICS, &[("mass_scaling", 2500.0)]).unwrap();
    setup
}

fn windowed(rotation: f64) -> Setup {
    let window = Some(MovingWindow { ahead: 0.51e-3, behind: 0.3e-3 });
    Setup { window, ..long_cut(rotation) }
}

/// The cut in its window, computed once.
static IN_WINDOW: LazyLock<(Simulation, Vec<Sample>)> = LazyLock::new(|| run(windowed(0.0)));

fn mean(samples: &[Sample], id: ChannelId) -> f64 {
    let late = &samples[3 * samples.len() / 10..];
    late.iter().map(|sample| sample.get(id)).sum::<f64>() / late.len() as f64
}

#[test]
fn material_comes_and_goes_with_closed_books() {
    let start = Simulation::new(windowed(0.0)).unwrap();
    // Columns of 14 particles, 25 um apart, 0.51 mm in front and 0.3 mm behind.
    assert_eq!(start.particle_count(), 21 * 14);
    assert_eq!(start.estimate().particles, 33 * 14);
    // The start shows all material, later snapshots what is there.
    assert_eq!(start.snapshot().id, (0..56 * 14).collect::<Vec<_>>());
    let (simulation, samples) = &*IN_WINDOW;
    let counts = samples.iter().map(|sample| sample.get(ChannelId::Particles) as usize);
    let most = counts.max().unwrap();
    assert!(most > 33 * 14 && most < 40 * 14, "{most}");
    let shown = simulation.snapshot();
    assert_eq!(shown.id.len(), simulation.particle_count());
    assert!(shown.id.is_sorted());

    let last = samples.last().unwrap();
    let work = last.get(ChannelId::ToolWork);
    assert!(last.get(ChannelId::RetiredEnergy) > 0.0);
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * work);
    let (content, supplied) = (last.get(ChannelId::HeatContent), last.get(ChannelId::HeatSupplied));
    assert!((content - supplied).abs() < 1e-6 * supplied, "{content} {supplied}");
    let mut before = 0.0;
    let mut impulse = 0.0;
    for sample in samples {
        let interval = sample.get(ChannelId::Time) - before;
        before = sample.get(ChannelId::Time);
        impulse += interval
            * (sample.get(ChannelId::CuttingForce) + sample.get(ChannelId::ReactionCutting));
    }
    let momentum = last.get(ChannelId::MomentumCutting);
    assert!((impulse - momentum).abs() < 1e-9 * momentum.abs().max(impulse.abs()));
}

#[test]
fn a_window_does_not_change_the_forces() {
    let (_, whole) = run(long_cut(0.0));
    let (_, window) = &*IN_WINDOW;
    let ratio = |id| mean(window, id) / mean(&whole, id);
    let (cutting, feed) = (ratio(ChannelId::CuttingForce), ratio(ChannelId::FeedForce));
    assert!((cutting - 1.0).abs() < 0.03, "F_c changes by a factor of {cutting}");
    assert!((feed - 1.0).abs() < 0.15, "F_f changes by a factor of {feed}");
}

#[test]
fn a_window_over_everything_is_no_window() {
    let setup = long_cut(0.0);
    let wide = Setup { window: Some(MovingWindow { ahead: 5e-3, behind: 5e-3 }), ..setup.clone() };
    let (whole, all) = (run(setup).0.checkpoint(), run(wide).0.checkpoint());
    for (name, values) in &whole.reals {
        assert!(all.real(name) == Some(values), "{name}");
    }
}

/// The cut in space, six particles wide between sliding sides: along x, the feed along z.
fn in_space(mut setup: Setup) -> Setup {
    let width = 6.0 * SPACING;
    setup.dimension = Dimension::Three;
    setup.particle_spacing = SPACING;
    for shape in setup.bodies.iter_mut().map(|body| &mut body.shape) {
        if let Shape::Box { max, .. } = shape {
            max[2] = width;
        }
    }
    let side = |from: f64, to: f64| Support {
        name: "side".to_owned(),
        region: Shape::Box {
            min: [-1.0, -0.3e-3, from],
            max: [1.0, 1.0, to],
            rotation: 0.0,
            mirrored: false,
        },
        velocity: [None, None, Some(0.0)],
        temperature: None,
    };
    if let Shape::Box { min, max, .. } = &mut setup.supports[0].region {
        (min[2], max[2]) = (-1.0, 1.0);
    }
    setup.supports[0].velocity = [Some(0.0); 3];
    setup.supports.extend([side(-1.0, SPACING), side(width - SPACING, 1.0)]);
    let tool = setup.tool.as_mut().unwrap();
    let ends = [-width, 2.0 * width];
    let vertices = ends.iter().flat_map(|z| wedge().into_iter().map(|[x, y]| [x, y, *z]));
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for k in 0..4 {
        let next = (k + 1) % 4;
        triangles.extend([[k, next, next + 4], [k, next + 4, k + 4]]);
    }
    tool.surface = ToolSurface::Triangles { vertices: vertices.collect(), triangles };
    setup.frame =
        CuttingFrame { cutting: [1.0, 0.0, 0.0], feed: [0.0, 0.0, 1.0], passive: [0.0, -1.0, 0.0] };
    setup
}

#[test]
fn a_window_in_space_has_the_forces_of_the_whole_and_closed_books() {
    let short = |setup: Setup| Setup { end_time: 0.5e-3 / SPEED, ..in_space(setup) };
    let (_, whole) = run(short(long_cut(0.0)));
    let (simulation, window) = run(short(windowed(0.0)));
    let last = |id: ChannelId| window.last().unwrap().get(id);
    // Columns of 14 by 6 came and went.
    assert!(last(ChannelId::RetiredEnergy) > 0.0 && simulation.particle_count() < 36 * 84);
    let ratio = |id| mean(&window, id) / mean(&whole, id);
    let (cutting, passive) = (ratio(ChannelId::CuttingForce), ratio(ChannelId::PassiveForce));
    assert!((cutting - 1.0).abs() < 0.03, "F_c changes by a factor of {cutting}");
    assert!((passive - 1.0).abs() < 0.15, "F_p changes by a factor of {passive}");
    let work = last(ChannelId::ToolWork);
    assert!(last(ChannelId::EnergyError).abs() < 1e-3 * work);
    let (content, supplied) = (last(ChannelId::HeatContent), last(ChannelId::HeatSupplied));
    assert!((content - supplied).abs() < 1e-6 * supplied, "{content} {supplied}");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| bits(&run(windowed(0.0)).0.checkpoint()))
    };
    assert!(with_threads(1) == with_threads(3));
}

#[test]
fn a_restored_window_goes_on_with_the_same_bits() {
    let mut graded = windowed(0.0);
    graded.discretisation.grading = Some(Grading { band: [-0.15e-3, -0.1e-3], below: 2, above: 1 });
    restored_window_is_the_same(graded);
    restored_window_is_the_same(windowed(0.0));
}

fn restored_window_is_the_same(setup: Setup) {
    let whole = run(setup.clone()).0.checkpoint();
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    while interrupted.time() < 0.8 * setup.end_time {
        interrupted.step().unwrap();
    }
    let state = interrupted.checkpoint();
    let mut resumed = Simulation::restore(setup.clone(), &state).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(bits(&whole) == bits(&resumed.checkpoint()));
    assert!(whole.integers == resumed.checkpoint().integers);

    // A state without a window is another one's.
    let refused = Simulation::restore(Setup { window: None, ..setup }, &state);
    assert!(matches!(refused, Err(SetupError::Checkpoint { .. })));
}

#[test]
fn a_rotated_window_is_the_same_window() {
    let (straight, turned) = (&IN_WINDOW.1, &run(windowed(37_f64.to_radians())).1);
    let count = |samples: &[Sample]| samples[20].get(ChannelId::Particles);
    assert_eq!(count(straight), count(turned));
    let early = |samples: &[Sample]| {
        samples[..20].iter().map(|s| s.get(ChannelId::CuttingForce)).sum::<f64>()
    };
    let (straight, turned) = (early(straight), early(turned));
    assert!((straight - turned).abs() < 0.01 * straight, "{straight} {turned}");
}

/// Upwards, away from tool and workpiece.
const FLIGHT: f64 = 60.0;

/// One particle above the workpiece, without any neighbour.
fn lone() -> Body {
    Body {
        name: "crumb".to_owned(),
        material: 0,
        shape: Shape::Box {
            min: [0.1e-3, 0.5e-3, 0.0],
            max: [0.1e-3 + SPACING, 0.5e-3 + SPACING, 0.0],
            rotation: 0.0,
            mirrored: false,
        },
        velocity: VelocityField::Uniform([0.0, FLIGHT, 0.0]),
        temperature: 293.15,
    }
}

/// Mass with scaling times velocity: 2500 * 7870 kg/m^3 * (25 um)^2 * 60 m/s.
const MOMENTUM: f64 = 2500.0 * 7870.0 * SPACING * SPACING * FLIGHT;
const ENERGY: f64 = 0.5 * MOMENTUM * FLIGHT;

fn last(samples: &[Sample], id: ChannelId) -> f64 {
    samples.last().unwrap().get(id)
}

#[test]
fn a_particle_without_neighbours_flies_on_with_its_momentum_and_its_energy() {
    let mut free = long_cut(0.0);
    free.bodies.push(lone());
    free.tool = None;
    free.end_time = 20e-6;
    free.sampling_interval = 2e-6;
    let (simulation, samples) = run(free);
    for sample in &samples {
        assert_eq!(sample.get(ChannelId::MinNeighbours), 0.0);
        // The workpiece rests to the last bit; the rest is rounding of a product.
        let (kinetic, feed) =
            (sample.get(ChannelId::KineticEnergy), sample.get(ChannelId::MomentumFeed));
        assert!((kinetic / ENERGY - 1.0).abs() < 1e-12, "{kinetic} {ENERGY}");
        assert!((feed / -MOMENTUM - 1.0).abs() < 1e-12, "{feed} {MOMENTUM}");
        assert!(sample.get(ChannelId::EnergyError).abs() < 1e-12 * ENERGY);
    }
    let shown = simulation.snapshot();
    let highest = shown.position.iter().map(|place| place[1]).fold(f64::MIN, f64::max);
    let expected = 0.5e-3 + 0.5 * SPACING + FLIGHT * simulation.time();
    assert!((highest / expected - 1.0).abs() < 1e-12, "{highest} {expected}");
}

#[test]
fn a_window_that_leaves_such_a_particle_behind_keeps_its_energy_and_momentum() {
    let mut setup = windowed(0.0);
    setup.bodies.push(lone());
    let (simulation, samples) = run(setup);
    let (_, without) = &*IN_WINDOW;
    let highest = simulation.snapshot().position.iter().map(|p| p[1]).fold(f64::MIN, f64::max);
    assert!(highest < 0.5e-3, "it has not left: {highest}");
    let retired = last(&samples, ChannelId::RetiredEnergy);
    let others = last(without, ChannelId::RetiredEnergy);
    // What else has left differs by chance of two cuts, by less than itself.
    assert!((retired - ENERGY).abs() < 2.0 * others + 1e-9 * ENERGY, "{retired} {ENERGY} {others}");
    assert!(others < 0.3 * ENERGY, "{others} {ENERGY}");
    // The bar of a cut in a window (above).
    let work = last(&samples, ChannelId::ToolWork);
    assert!(last(&samples, ChannelId::EnergyError).abs() < 1e-3 * work);
    let (mut before, mut impulse) = (0.0, 0.0);
    for sample in &samples {
        let interval = sample.get(ChannelId::Time) - before;
        before = sample.get(ChannelId::Time);
        let force = sample.get(ChannelId::FeedForce) + sample.get(ChannelId::ReactionFeed);
        impulse += interval * force;
    }
    // Up is against the feed.
    let change = last(&samples, ChannelId::MomentumFeed) + MOMENTUM;
    assert!((impulse - change).abs() < 1e-9 * MOMENTUM, "{impulse} {change}");
}
