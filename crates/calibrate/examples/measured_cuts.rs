//! Ten cuts of the tables of docs/calibration.md, two of them measured and one of a twin, drawn at random, the others predicted: beside a power law,
//! the scenario with its errors regressed, and a quadratic of logarithms.
//!
//! `cargo run --release -p sphcut-calibrate --example measured_cuts [draws] [cuts]`
//!
//! In place of the particle solver stands its table of runs with the constants as published, moved by the changes of another physics of cutting with
//! the constants: the fit has the library as its quick model.

use nalgebra::{DMatrix, DVector};
use sphcut_analytic::Physics;
use sphcut_calibrate::{
    CalibrationRequest, ClosedCut, CutEvaluator, CutValues, FreeConstant, MeasuredCut, RunPoint,
    calibrate, free_constants, measured_cuts, published_sets,
};
use sphcut_diagnose::{ClosedForm, Predictor, closed_form_cut};
use sphcut_greybox::Random;
use sphcut_input::read_cut_table;
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_scenario::{LoadOptions, load};
use std::convert::Infallible;
use std::path::{Path, PathBuf};

const CHANNELS: [Channel; 2] = [Channel::CuttingForce, Channel::FeedForce];
/// Scatter of a run.
const SCATTER: [f64; 2] = [0.005, 0.015];

struct Tabled<'a> {
    runs: &'a [MeasuredCut],
    form: &'a ClosedForm,
    constants: &'a [FreeConstant],
    random: Random,
}

impl Tabled<'_> {
    fn of(&self, condition: &CuttingCondition, t: &[f64], channel: Channel) -> f64 {
        let answer = |t: &[f64]| {
            let changes: Vec<f64> =
                self.constants.iter().zip(t).map(|(c, &t)| c.log_factor(t)).collect();
            let place = self.form.channels().iter().position(|c| *c == channel).expect("a force");
            self.form.log_observables(condition, &changes, &[])[place]
        };
        let stated: Vec<f64> = self.constants.iter().map(|c| c.coordinate(c.stated)).collect();
        let near = self.runs.iter().find(|r| {
            (r.condition.cutting_speed / condition.cutting_speed - 1.0).abs() < 1e-6
                && (r.condition.uncut_chip_thickness / condition.uncut_chip_thickness - 1.0).abs()
                    < 1e-6
        });
        let base = near.and_then(|r| r.values[channel.index()]).map(|(log, _)| log);
        base.map_or_else(|| answer(t), |log| log + answer(t) - answer(&stated))
    }
}

impl CutEvaluator for Tabled<'_> {
    type Error = Infallible;

    fn evaluate(&mut self, _: &str, points: &[RunPoint]) -> Result<Vec<CutValues>, Infallible> {
        let mut found = Vec::new();
        for point in points {
            let mut values = CutValues::default();
            for (channel, scatter) in CHANNELS.into_iter().zip(SCATTER) {
                let log = self.of(&point.condition, &point.t, channel);
                if log.is_finite() {
                    let moved = log + scatter * self.random.normal();
                    values[channel.index()] = Some((moved, scatter * scatter));
                }
            }
            found.push(values);
        }
        Ok(found)
    }
}

/// Mean absolute error of a quadratic of logarithms of speed and thickness.
fn quadratic(cuts: &[MeasuredCut], held: &[MeasuredCut], channel: Channel) -> f64 {
    let terms = |c: &MeasuredCut| {
        let (v, h) = (c.condition.cutting_speed.ln(), c.condition.uncut_chip_thickness.ln());
        [1.0, v, h, v * v, v * h, h * h]
    };
    let of = |c: &MeasuredCut| c.values[channel.index()].map(|(log, _)| log);
    let known: Vec<(&MeasuredCut, f64)> = cuts.iter().filter_map(|c| Some((c, of(c)?))).collect();
    let design = DMatrix::from_fn(known.len(), 6, |i, j| terms(known[i].0)[j]);
    let target = DVector::from_iterator(known.len(), known.iter().map(|k| k.1));
    let found = design.svd(true, true).solve(&target, 1e-9).expect("a design");
    let errors: Vec<f64> = held
        .iter()
        .filter_map(|c| {
            let log: f64 = terms(c).iter().zip(found.iter()).map(|(a, b)| a * b).sum();
            Some((log - of(c)?).exp_m1().abs())
        })
        .collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn table(path: PathBuf, width: f64) -> Vec<MeasuredCut> {
    let text = std::fs::read_to_string(path).expect("a table of the ledger");
    measured_cuts(&read_cut_table(&text).expect("a table of cuts"), width, None)
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse::<usize>().ok());
    let (draws, count) = (numbers.next().unwrap_or(10), numbers.next().unwrap_or(10));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    println!(
        "cuts: mean absolute error in % of the prediction, a power law, the scenario with its errors regressed, a quadratic; in 95 %"
    );
    for (name, scenario, measured, simulated, width) in [
        (
            "AISI 1045, 110",
            "aisi1045_orthogonal.toml",
            "greybox_twin/measured.csv",
            "aisi1045_sweep/simulated.csv",
            3e-3,
        ),
        ("Ti6Al4V, 49", "ti6al4v_orthogonal.toml", "greybox_klippel/second_series.csv", "", 1e-3),
        ("Ti6Al4V, 71", "ti6al4v_orthogonal.toml", "greybox_klippel/measured.csv", "", 1e-3),
    ] {
        let path = root.join("scenarios").join(scenario);
        let options = LoadOptions::default();
        let scenario = load(&path, &options).expect("a shipped scenario");
        let sets = published_sets((&scenario, &path), None, &options);
        let wanted = ["A", "C", "m", "mu", "r_n"].map(str::to_owned);
        let constants = free_constants(&scenario, &wanted, &sets).expect("Johnson and Cook");
        let quick = ClosedCut::new(&scenario, &constants).expect("a cut of the closed form");
        let keys: Vec<(&'static str, f64)> = constants.iter().map(|c| (c.rule.key, 1.0)).collect();
        let mut cut = closed_form_cut(&scenario).expect("a cut of the closed form");
        cut.physics = Physics::OPPONENT_ALL;
        let form = ClosedForm::new(cut, &keys);
        let all = table(root.join("validation").join(measured), width);
        let runs = if simulated.is_empty() {
            Vec::new()
        } else {
            table(root.join("validation").join(simulated), width)
        };
        let mut sums = [[0.0; 5]; 2];
        for draw in 1..=draws as u64 {
            let mut random = Random::new(draw, &[1]);
            let mut order: Vec<(f64, &MeasuredCut)> =
                all.iter().map(|c| (random.uniform(), c)).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut order: Vec<MeasuredCut> = order.into_iter().map(|(_, c)| c.clone()).collect();
            let held = order.split_off(count);
            let request = CalibrationRequest {
                constants: &constants,
                cuts: &order,
                held_out: &held,
                model: &quick,
                refreshes: 2,
            };
            let mut solver = Tabled {
                runs: &runs,
                form: &form,
                constants: &constants,
                random: Random::new(draw, &[2]),
            };
            let Ok(found) = calibrate(&request, &mut solver);
            let found = found.expect("forces were measured");
            for (sum, channel) in sums.iter_mut().zip(CHANNELS) {
                let own = found.errors.iter().find(|e| e.by == "held out" && e.channel == channel);
                let own = own.expect("cuts were held out");
                let rest = quadratic(&order, &held, channel);
                let all = [
                    own.calibrated,
                    own.regression.unwrap(),
                    own.corrected.unwrap(),
                    rest,
                    own.covered,
                ];
                sum.iter_mut().zip(all).for_each(|(s, x)| *s += x / draws as f64);
            }
        }
        for (sum, channel) in sums.iter().zip(CHANNELS) {
            let [a, b, c, d, e] = sum.map(|x| 100.0 * x);
            println!("{name}, {}: {a:.1} {b:.1} {c:.1} {d:.1}; {e:.0} %", channel.symbol());
        }
    }
}
