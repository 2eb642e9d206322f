//! Writes `scenarios/diagnosis/cuts.csv`: 20 conditions, each cut twice in random order, by the closed-form model with
//! another batch of steel, a dynamometer with gain, offset and drift, 3 % of noise and one concealed effect:
//! `cargo run --release -p sphcut-diagnose --example diagnosis_example > scenarios/diagnosis/cuts.csv`

use sphcut_analytic::{ActiveEffect, FlowStress, OrthogonalCut, predict};
use sphcut_greybox::Random;
use sphcut_physics::CuttingCondition;

/// What is concealed.
const CONCEALED: (&str, &str, f64) = ("speed_dependent_friction", "speed_exponent", 0.25);
const NOISE: f64 = 0.03;
const REPEATS: usize = 2;

fn main() {
    let mut random = Random::new(7, &[1]);
    let mut cut = OrthogonalCut::aisi_1045();
    if let FlowStress::JohnsonCook(law) = &mut cut.workpiece.flow_stress {
        law.initial_yield *= (0.08 * random.normal()).exp();
        law.hardening_modulus *= (0.08 * random.normal()).exp();
        law.rate_coefficient *= (0.25 * random.normal()).exp();
    }
    cut.friction_coefficient *= (0.15 * random.normal()).exp();
    let (effect, parameter, value) = CONCEALED;
    let active = [ActiveEffect::new(effect, &[(parameter, value)]).expect("in range")];
    let mut plan: Vec<(f64, f64)> = [30.0, 60.0, 110.0, 210.0, 400.0]
        .into_iter()
        .flat_map(|speed| [0.03, 0.06, 0.12, 0.24].map(|thickness| (speed, thickness)))
        .flat_map(|pair| [pair; REPEATS])
        .collect();
    random.shuffle(&mut plan);
    let gains = [0.01 * random.normal(), 0.01 * random.normal()];
    let offsets = [3.0 * random.normal(), 3.0 * random.normal()];
    println!("v_c [m/min],h [mm],order,F_c [N],F_f [N],chip_thickness [mm]");
    for (order, (speed, thickness)) in plan.iter().enumerate() {
        let condition = CuttingCondition::new(speed / 60.0, thickness * 1e-3);
        let seen = predict(&cut, &condition, &active).expect("a cut within the model");
        let drift = 0.01 * (order as f64 / 39.0 - 0.5);
        let mut noise = || (NOISE * random.normal()).exp();
        let cutting = (seen.cutting_force * (1.0 + gains[0] + drift) + offsets[0]) * noise();
        let feed = (seen.feed_force * (1.0 + gains[1] + drift) + offsets[1]) * noise();
        let chip = seen.chip_thickness * 1e3 * noise();
        println!("{speed},{thickness},{},{cutting:.1},{feed:.1},{chip:.4}", order + 1);
    }
}
