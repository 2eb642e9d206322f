//! Invariants of the solver on a small cut: same bits at any thread count and after a restart,
//! closed books, independence of direction.

mod support;

use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_physics::Values;
use sphcut_sph::setup::{Grading, Lattice, Setup, VelocityChange};
use sphcut_sph::{ChannelId, SetupError, Simulation, options};
use support::{SPACING, SPEED, bits, cut, run, wedge};

/// The cut with particles twice as large above and below the edge.
fn graded() -> Setup {
    let mut setup = cut(0.0, Lattice::Square);
    setup.discretisation.parting_height = Some(-0.1e-3);
    setup.discretisation.grading = Some(Grading { band: [-0.15e-3, -0.1e-3], below: 1, above: 1 });
    setup
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for setup in [cut(0.0, Lattice::Square), graded()] {
        let with_threads = |count: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
            pool.install(|| bits(&run(setup.clone()).0.checkpoint()))
        };
        let one = with_threads(1);
        assert!(one == with_threads(2));
        assert!(one == with_threads(3));
    }
}

#[test]
fn a_graded_cut_has_particles_of_two_sizes_and_closed_balances() {
    let (simulation, samples) = run(graded());
    let sizes = simulation.snapshot().relative_spacing;
    // From the bottom: 4 rows of 12 (0.2 mm), 2 of 24 in the band, 2 of 12 (0.1 mm).
    let fine = sizes.iter().filter(|size| **size == 1.0).count();
    assert_eq!((sizes.len(), fine), (4 * 12 + 2 * 24 + 2 * 12, 2 * 24));
    let last = samples.last().unwrap();
    let work = last.get(ChannelId::ToolWork);
    assert!(work > 0.0);
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * work);
    let (content, supplied) = (last.get(ChannelId::HeatContent), last.get(ChannelId::HeatSupplied));
    assert!((content - supplied).abs() < 1e-6 * supplied, "{content} {supplied}");
}

#[test]
fn a_restored_run_goes_on_with_the_same_bits() {
    restored_run_is_the_same(cut(0.0, Lattice::Square));
    restored_run_is_the_same(graded());
    let mut stretching = cut(0.0, Lattice::Square);
    let options = [("mass_scaling", 400.0), ("support_stretch", 1.7)];
    stretching.numerics = Values::resolve(options::NUMERICS, &options).unwrap();
    restored_run_is_the_same(stretching);
    restored_run_is_the_same(shifted());
}

/// The cut with shifted particles, of which those belong together from the start that are four spacings apart at most.
fn shifted() -> Setup {
    let mut setup = cut(0.0, Lattice::Square);
    let options = [("mass_scaling", 400.0), ("shifting_distance", 0.9), ("bonding_distance", 4.0)];
    setup.numerics = Values::resolve(options::NUMERICS, &options).unwrap();
    setup.end_time *= 3.0;
    setup
}

#[test]
fn shifted_particles_keep_books_and_bits() {
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| run(shifted()))
    };
    let ((one, samples), (two, _)) = (with_threads(1), with_threads(2));
    assert!(bits(&one.checkpoint()) == bits(&two.checkpoint()));
    let last = samples.last().unwrap();
    let work = last.get(ChannelId::ToolWork);
    assert!(work > 0.0);
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * work);
    let (content, supplied) = (last.get(ChannelId::HeatContent), last.get(ChannelId::HeatSupplied));
    assert!((content - supplied).abs() < 1e-6 * supplied, "{content} {supplied}");
    // It does something, and the new neighbours along the tool belong to it.
    let mut plain = shifted();
    plain.numerics =
        Values::resolve(options::NUMERICS, &[("mass_scaling", 400.0), ("bonding_distance", 4.0)])
            .unwrap();
    assert!(bits(&run(plain).0.checkpoint()) != bits(&one.checkpoint()));
    assert!(!one.checkpoint().integer("bonds").unwrap().is_empty());
}

fn restored_run_is_the_same(setup: Setup) {
    let whole = run(setup.clone()).0.checkpoint();
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    for _ in 0..317 {
        interrupted.step().unwrap();
    }
    assert!(!interrupted.is_finished());
    let mut resumed = Simulation::restore(setup, &interrupted.checkpoint()).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    // Not assert_eq: a failure would print every number of the state.
    assert!(bits(&whole) == bits(&resumed.checkpoint()));
    assert!(whole.integers == resumed.checkpoint().integers);
}

/// The cut, whose tool stops half way and turns back.
fn cut_and_back() -> Setup {
    let mut setup = cut(0.0, Lattice::Square);
    setup.end_time *= 2.0;
    let end = setup.end_time;
    let tool = setup.tool.as_mut().unwrap();
    let back = tool.velocity.map(|v| -0.5 * v);
    tool.velocity_changes = vec![
        VelocityChange { time: 0.5 * end, velocity: [0.0; 3] },
        VelocityChange { time: 0.7 * end, velocity: back },
    ];
    setup
}

#[test]
fn a_tool_that_turns_back_keeps_books_and_bits() {
    let setup = cut_and_back();
    let (whole, samples) = run(setup.clone());
    let last = samples.last().unwrap();
    let work = last.get(ChannelId::ToolWork);
    assert!(work > 0.0);
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * work);
    // 120 um x (0.5 - 0.3 / 2) = 42 um, a step too far at most.
    let step = SPEED * last.get(ChannelId::TimeStep);
    assert!((last.get(ChannelId::Travel) - 42e-6).abs() <= step);
    // Withdrawn, the tool no longer presses.
    let largest = samples.iter().map(|s| s.get(ChannelId::CuttingForce)).fold(0.0, f64::max);
    assert!(last.get(ChannelId::CuttingForce).abs() < 0.05 * largest);
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    while interrupted.time() < 0.6 * setup.end_time {
        interrupted.step().unwrap();
    }
    let mut resumed = Simulation::restore(setup, &interrupted.checkpoint()).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(bits(&whole.checkpoint()) == bits(&resumed.checkpoint()));
}

#[test]
fn energy_momentum_and_heat_close() {
    let (_, samples) = run(cut(0.0, Lattice::Square));
    let last = samples.last().unwrap();
    let work = last.get(ChannelId::ToolWork);
    assert!(work > 0.0);
    // The bar of the project is 1 %; the books of a work-conjugate pair close far better.
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * work);
    let impulse: f64 = samples
        .iter()
        .scan(0.0, |before, sample| {
            let interval = sample.get(ChannelId::Time) - *before;
            *before = sample.get(ChannelId::Time);
            let force =
                sample.get(ChannelId::CuttingForce) + sample.get(ChannelId::ReactionCutting);
            Some(interval * force)
        })
        .sum();
    let momentum = last.get(ChannelId::MomentumCutting);
    // Internal forces cancel in pairs: what remains is rounding.
    assert!((impulse - momentum).abs() < 1e-9 * momentum.abs().max(impulse.abs()));
    let (content, supplied) = (last.get(ChannelId::HeatContent), last.get(ChannelId::HeatSupplied));
    assert!((content - supplied).abs() < 1e-6 * supplied, "{content} {supplied}");
}

#[test]
fn a_rotated_cut_is_the_same_cut() {
    let mean = |rotation: f64| {
        let (_, samples) = run(cut(rotation, Lattice::Square));
        let late = &samples[samples.len() / 2..];
        late.iter().map(|s| s.get(ChannelId::CuttingForce)).sum::<f64>() / late.len() as f64
    };
    let (straight, turned) = (mean(0.0), mean(37_f64.to_radians()));
    // Rounding grows with the chaos of plastic flow; over this short path it stays small.
    assert!((straight - turned).abs() < 0.01 * straight, "{straight} {turned}");
}

#[test]
fn a_tool_inside_the_workpiece_is_an_error_that_says_where() {
    let mut setup = cut(0.0, Lattice::Square);
    if let Some(tool) = &mut setup.tool {
        tool.surface = ToolSurface::Polygon(
            wedge().into_iter().map(|p| [p[0] + 2.0 * SPACING, p[1]]).collect(),
        );
    }
    let error = Simulation::new(setup).unwrap_err();
    assert!(matches!(error, SetupError::InitialOverlap { count, .. } if count > 0), "{error}");
}

#[test]
fn a_tool_with_flipped_normals_is_an_error() {
    let mut setup = cut(0.0, Lattice::Square);
    if let Some(tool) = &mut setup.tool {
        tool.surface = ToolSurface::Polygon(wedge().into_iter().rev().collect());
    }
    assert!(matches!(Simulation::new(setup), Err(SetupError::ToolSurface(_))));
}

#[test]
fn a_foreign_checkpoint_is_refused() {
    let small = Simulation::new(cut(0.0, Lattice::Square)).unwrap().checkpoint();
    let hexagonal = cut(0.0, Lattice::Hexagonal);
    assert!(matches!(Simulation::restore(hexagonal, &small), Err(SetupError::Checkpoint { .. })));
}

#[test]
fn strong_bulk_viscosity_shortens_the_time_step_and_stays_stable() {
    let mut setup = cut(0.0, Lattice::Square);
    let plain = Simulation::new(setup.clone()).unwrap().estimate().time_step;
    setup.numerics =
        Values::resolve(options::NUMERICS, &[("mass_scaling", 400.0), ("linear_viscosity", 2.0)])
            .unwrap();
    let viscous = Simulation::new(setup.clone()).unwrap().estimate().time_step;
    assert!(viscous < 0.6 * plain, "{viscous} {plain}");
    let last = run(setup).1.pop().unwrap();
    let error = last.get(ChannelId::EnergyError) / last.get(ChannelId::ToolWork);
    // The bar of the project: an unstable step misses it by orders of magnitude.
    assert!(error.abs() < 0.01, "{error}");
}
