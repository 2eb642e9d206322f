//! What the model predicts over cutting speed and uncut chip thickness, as CSV on standard output, and what a condition costs
//! on standard error.
//!
//! `cargo run --release -p sphcut-analytic --example table`

use sphcut_analytic::{ActiveEffect, Observables, OrthogonalCut, Physics, predict, solution};
use sphcut_physics::CuttingCondition;
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), sphcut_analytic::Error> {
    let names: Vec<&str> = Observables::CHANNELS.iter().map(|channel| channel.key()).collect();
    println!(
        "physics,cutting_speed,uncut_chip_thickness,{},sticking_share,rate_constant,layer",
        names.join(",")
    );
    let physics = [
        ("library", Physics::LIBRARY),
        ("oxley", Physics::OXLEY),
        ("opponent_heat", Physics::OPPONENT_HEAT),
        ("opponent_all", Physics::OPPONENT_ALL),
    ];
    for (name, physics) in physics {
        let mut cut = OrthogonalCut::aisi_1045();
        cut.physics = physics;
        for speed in [30.0, 50.0, 75.0, 100.0, 125.0, 150.0, 175.0, 200.0, 250.0, 300.0, 400.0] {
            for thickness in [0.02, 0.04, 0.06, 0.09, 0.12, 0.15, 0.2, 0.25] {
                let condition = CuttingCondition::new(speed / 60.0, thickness * 1e-3);
                let found = match predict(&cut, &condition, &[]) {
                    Ok(found) => found,
                    // Oxley's closure has no answer where the cut is slow and thin.
                    Err(_) => continue,
                };
                let inside = solution(&cut, &condition, &[])?;
                let values: Vec<String> = Observables::CHANNELS
                    .iter()
                    .map(|channel| found.get(*channel).to_string())
                    .collect();
                println!(
                    "{name},{},{},{},{},{},{}",
                    condition.cutting_speed,
                    condition.uncut_chip_thickness,
                    values.join(","),
                    inside.sticking_share,
                    inside.rate_constant,
                    inside.layer
                );
            }
        }
        cost(name, &cut)?;
    }
    Ok(())
}

/// Microseconds per condition, without effects and with two that act on the flow stress, on one core.
fn cost(name: &str, cut: &OrthogonalCut) -> Result<(), sphcut_analytic::Error> {
    let two = [
        ActiveEffect::new("viscous_drag", &[("drag_coefficient", 0.1)])?,
        ActiveEffect::new("tanh_softening", &[("tanh_exponent", 0.1)])?,
    ];
    for effects in [&[][..], &two[..]] {
        let repeats = if cut.physics == Physics::OXLEY { 20 } else { 5000 };
        let start = Instant::now();
        for repeat in 0..repeats {
            let condition = CuttingCondition::new(3.0 + 1e-4 * f64::from(repeat), 0.2e-3);
            black_box(predict(cut, &condition, effects).ok());
        }
        let each = start.elapsed().as_secs_f64() / f64::from(repeats) * 1e6;
        eprintln!("{name}, {} effects: {each:.1} us per condition", effects.len());
    }
    Ok(())
}
