//! Twins of docs/calibration.md: twenty truths over the priors, cut by another physics of cutting than the one that the fit has as its quick model.
//!
//! `cargo run --release -p sphcut-calibrate --example twins [twins] [cuts]`

use sphcut_analytic::Physics;
use sphcut_calibrate::{
    CalibrationRequest, ClosedCut, CutEvaluator, CutValues, FreeConstant, MeasuredCut, RunPoint,
    calibrate, cut_calibration_words, free_constants, published_sets,
};
use sphcut_diagnose::{Active, ClosedForm, Predictor, closed_form_cut};
use sphcut_greybox::Random;
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_postprocess::statistics::median;
use sphcut_scenario::{LoadOptions, load};
use std::convert::Infallible;
use std::path::Path;

/// Noise of the cuts, and scatter of F_c, F_f and chip thickness of the runs.
const NOISE: f64 = 0.03;
const SCATTER: [(Channel, f64); 3] =
    [(Channel::CuttingForce, 0.01), (Channel::FeedForce, 0.03), (Channel::ChipThickness, 0.03)];

/// A physics that stands for the particle solver.
struct OtherPhysics<'a> {
    form: &'a ClosedForm,
    constants: &'a [FreeConstant],
    random: Random,
}

impl OtherPhysics<'_> {
    fn logs(&self, condition: &CuttingCondition, t: &[f64], active: &[Active]) -> CutValues {
        let all = self.constants.iter().zip(t);
        let changes: Vec<f64> = all.map(|(c, &t)| c.log_factor(t)).collect();
        let answer = self.form.log_observables(condition, &changes, active);
        let mut logs = CutValues::default();
        for (channel, log) in self.form.channels().iter().zip(answer) {
            let scatter = SCATTER.iter().find(|(own, _)| own == channel);
            if let (Some((_, scatter)), true) = (scatter, log.is_finite()) {
                logs[channel.index()] = Some((log, scatter * scatter));
            }
        }
        logs
    }
}

impl CutEvaluator for OtherPhysics<'_> {
    type Error = Infallible;

    fn evaluate(&mut self, _: &str, points: &[RunPoint]) -> Result<Vec<CutValues>, Infallible> {
        let all: Vec<CutValues> =
            points.iter().map(|p| self.logs(&p.condition, &p.t, &[])).collect();
        let mut scattered = |values: CutValues| {
            values.map(|v| v.map(|(log, var)| (log + var.sqrt() * self.random.normal(), var)))
        };
        Ok(all.into_iter().map(&mut scattered).collect())
    }
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse::<usize>().ok());
    let (twins, count) = (numbers.next().unwrap_or(20), numbers.next().unwrap_or(10));
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/ti6al4v_orthogonal.toml");
    let options = LoadOptions::default();
    let scenario = load(&path, &options).expect("a shipped scenario");
    let sets = published_sets((&scenario, &path), None, &options);
    let constants = free_constants(&scenario, &[], &sets).expect("Johnson and Cook");
    let quick = ClosedCut::new(&scenario, &constants).expect("a cut of the closed form");
    let keys: Vec<(&'static str, f64)> = constants.iter().map(|c| (c.rule.key, 1.0)).collect();
    println!(
        "physics, lacking: median errors of F_c, F_f, chip; values, constants in 95 %; said; regression of F_c, F_f; runs"
    );
    for (name, physics) in
        [("other heat and friction", Physics::OPPONENT_HEAT), ("all other", Physics::OPPONENT_ALL)]
    {
        let mut cut = closed_form_cut(&scenario).expect("a cut of the closed form");
        cut.physics = physics;
        let form = ClosedForm::new(cut, &keys);
        for (lacking, values) in
            [("", vec![]), ("edge_radius", vec![20e-6]), ("speed_dependent_friction", vec![0.3])]
        {
            let place = form.effects().iter().position(|effect| effect.key == lacking);
            let active: Vec<Active> =
                place.map(|effect| Active { effect, values }).into_iter().collect();
            let mut errors = vec![Vec::new(); SCATTER.len()];
            let (mut inside, mut held, mut known, mut said, mut runs) = (0, 0, 0, 0, 0);
            let mut rival = [0.0, 0.0];
            for seed in 1..=twins as u64 {
                let mut random = Random::new(seed, &[1]);
                let t: Vec<f64> =
                    constants.iter().map(|_| random.normal().clamp(-1.5, 1.5)).collect();
                let random_runs = Random::new(seed, &[2]);
                let mut solver =
                    OtherPhysics { form: &form, constants: &constants, random: random_runs };
                let mut measured = |k: usize| {
                    // A third of those held out lies outside.
                    let wide = if k >= count && k.is_multiple_of(3) { 1.5 } else { 1.0 };
                    let mut place = || wide * (random.uniform() - 0.5);
                    let condition = CuttingCondition::new(
                        2.0 * (1.8 * place()).exp(),
                        1e-4 * (1.6 * place()).exp(),
                    );
                    let values = solver
                        .logs(&condition, &t, &active)
                        .map(|v| v.map(|(log, _)| (log + NOISE * random.normal(), NOISE * NOISE)));
                    MeasuredCut { condition, lines: vec![k + 1], values }
                };
                let cuts: Vec<MeasuredCut> = (0..count + 20).map(&mut measured).collect();
                let request = CalibrationRequest {
                    constants: &constants,
                    cuts: &cuts[..count],
                    held_out: &cuts[count..],
                    model: &quick,
                    refreshes: 2,
                };
                let Ok(found) = calibrate(&request, &mut solver);
                let Some(found) = found else { continue };
                for (_, f) in &found.foreseen {
                    let truth = solver.logs(&found.cut(&f.value).condition, &t, &active);
                    let channel = SCATTER.iter().position(|(own, _)| *own == f.value.channel);
                    if let (Some(channel), Some((log, _))) =
                        (channel, truth[f.value.channel.index()])
                    {
                        errors[channel].push((f.log - log).exp_m1().abs());
                    }
                    inside += usize::from(f.score().abs() < 1.96);
                    held += 1;
                }
                known += (0..t.len())
                    .filter(|&k| {
                        (found.posterior.mean[k] - t[k]).abs() < 1.96 * found.posterior.deviation(k)
                    })
                    .count();
                said += usize::from(
                    cut_calibration_words(&found).join(" ").contains("No constants follow"),
                );
                runs += found.runs.len() - 20;
                for (k, channel) in
                    [Channel::CuttingForce, Channel::FeedForce].into_iter().enumerate()
                {
                    let own = found.errors.iter().find(|e| e.by == "cut" && e.channel == channel);
                    rival[k] +=
                        own.map_or(0.0, |e| e.calibrated / e.regression.unwrap_or(f64::NAN));
                }
            }
            let share = |a: usize, b: usize| 100.0 * a as f64 / b as f64;
            let [c, f, h] = [0, 1, 2].map(|k| 100.0 * median(&errors[k]));
            println!(
                "{name}, {lacking}: {c:.1} {f:.1} {h:.1} %; {:.0} %, {:.0} %; {said} of {twins}; {:.2} {:.2}; {:.0}",
                share(inside, held),
                share(known, twins * constants.len()),
                rival[0] / twins as f64,
                rival[1] / twins as f64,
                runs as f64 / twins as f64
            );
        }
    }
}
