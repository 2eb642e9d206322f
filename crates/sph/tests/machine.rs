//! Compliance and run-out in the small cut.

mod support;

use sphcut_physics::process::{Oscillator, RunOut};
use sphcut_sph::setup::{Lattice, Setup};
use sphcut_sph::{ChannelId, Sample, Simulation};
use std::f64::consts::TAU;
use support::{bits, cut, run};

/// A holder that gives way normal to the surface: for the 1 m of width of the small cut. Period 14 us of the
/// 24 us that the cut takes, strongly damped.
const HOLDER: Oscillator = Oscillator { stiffness: 5e8, mass: 0.0025, damping_ratio: 0.7 };

fn soft() -> Setup {
    let mut setup = cut(0.0, Lattice::Square);
    setup.machine.feed = Some(HOLDER);
    setup.sampling_interval *= 0.25;
    setup
}

/// Run-out with four periods over the cut.
fn out_of_true(amplitude: f64) -> Setup {
    let mut setup = cut(0.0, Lattice::Square);
    let angular_frequency = TAU * 4.0 / setup.end_time;
    setup.machine.run_out = Some(RunOut { amplitude, angular_frequency });
    setup
}

fn late_mean(samples: &[Sample], channel: ChannelId) -> f64 {
    let late = &samples[samples.len() / 2..];
    late.iter().map(|sample| sample.get(channel)).sum::<f64>() / late.len() as f64
}

#[test]
fn a_soft_holder_is_pushed_out_of_the_surface_and_the_forces_fall() {
    let rigid = run(cut(0.0, Lattice::Square)).1;
    let samples = run(soft()).1;
    // The equation of motion, integrated apart from the solver with the mean forces of the intervals: they
    // push the tool out of the surface.
    let (mut deflection, mut velocity, mut time) = (0.0, 0.0, 0.0);
    for sample in &samples {
        let steps = 1000;
        let step = (sample.get(ChannelId::Time) - time) / f64::from(steps);
        for _ in 0..steps {
            let force = -sample.get(ChannelId::FeedForce);
            velocity += step * HOLDER.acceleration(deflection, velocity, force);
            deflection += step * velocity;
        }
        time = sample.get(ChannelId::Time);
        let found = sample.get(ChannelId::ToolOffsetFeed);
        // 2 % of 10 um: within an interval, an eightieth of the period, the force is not constant.
        assert!((found - deflection).abs() < 2e-7, "{time}: {found} {deflection}");
    }
    assert!(deflection < -1e-5, "{deflection}");
    // Less is cut, so both forces are lower.
    for channel in [ChannelId::FeedForce, ChannelId::CuttingForce] {
        let (with, without) = (late_mean(&samples, channel), late_mean(&rigid, channel));
        assert!(with < 0.98 * without, "{with} {without}");
    }
    assert_eq!(late_mean(&rigid, ChannelId::ToolOffsetFeed), 0.0);
    let last = samples.last().unwrap();
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * last.get(ChannelId::ToolWork));
}

#[test]
fn a_spindle_out_of_true_moves_the_tool_as_the_formula_says_and_the_force_follows() {
    let amplitude = 3e-6;
    let setup = out_of_true(amplitude);
    let end = setup.end_time;
    let samples = run(setup).1;
    let opposite = run(out_of_true(-amplitude)).1;
    for sample in &samples {
        let exact = amplitude * (TAU * 4.0 * sample.get(ChannelId::Time) / end).sin();
        assert!((sample.get(ChannelId::ToolOffsetFeed) - exact).abs() < 1e-12 * amplitude);
        assert_eq!(sample.get(ChannelId::ToolOffsetCutting), 0.0);
    }
    // The difference of the forces with opposite run-outs over the last three periods, without its linear
    // trend; the samples of both cuts end at nearly the same times.
    let change: Vec<(f64, f64)> = samples
        .iter()
        .zip(&opposite)
        .map(|(with, without)| {
            let force = |sample: &Sample| sample.get(ChannelId::FeedForce);
            (with.get(ChannelId::Time) / end, force(with) - force(without))
        })
        .filter(|(time, _)| *time > 0.25)
        .collect();
    let count = change.len() as f64;
    let mean = |value: &dyn Fn(&(f64, f64)) -> f64| change.iter().map(value).sum::<f64>() / count;
    let (middle, level) = (mean(&|c| c.0), mean(&|c| c.1));
    let slope =
        mean(&|c| (c.0 - middle) * (c.1 - level)) / mean(&|c| (c.0 - middle) * (c.0 - middle));
    let share = |periods: f64| {
        let part = |turn: fn(f64) -> f64| {
            mean(&|c| (c.1 - level - slope * (c.0 - middle)) * turn(TAU * periods * c.0))
        };
        part(f64::cos).hypot(part(f64::sin))
    };
    // Whole numbers of periods of the three of the spindle.
    for other in [1.0, 2.0, 4.0, 5.0, 6.0, 7.0, 8.0] {
        let (own, other) = (share(4.0), share(4.0 / 3.0 * other));
        assert!(own > 1.5 * other, "{own} {other}");
    }
    let last = samples.last().unwrap();
    assert!(last.get(ChannelId::EnergyError).abs() < 1e-3 * last.get(ChannelId::ToolWork));
}

#[test]
fn no_amplitude_changes_no_bit() {
    let rigid = bits(&run(cut(0.0, Lattice::Square)).0.checkpoint());
    assert!(rigid == bits(&run(out_of_true(0.0)).0.checkpoint()));
}

#[test]
fn a_restored_holder_goes_on_with_the_same_bits() {
    let mut setup = soft();
    setup.machine.cutting = setup.machine.feed;
    setup.machine.run_out = out_of_true(1e-6).machine.run_out;
    let whole = run(setup.clone()).0.checkpoint();
    let mut interrupted = Simulation::new(setup.clone()).unwrap();
    for _ in 0..317 {
        interrupted.step().unwrap();
    }
    let mut resumed = Simulation::restore(setup, &interrupted.checkpoint()).unwrap();
    while !resumed.is_finished() {
        resumed.step().unwrap();
    }
    assert!(bits(&whole) == bits(&resumed.checkpoint()));
}
