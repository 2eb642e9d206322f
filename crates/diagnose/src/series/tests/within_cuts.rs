//! Known answers of what changes within cuts.

use crate::series::null::noise;
use crate::series::*;
use sphcut_greybox::Random;

const RATE: f64 = 2000.0;
const SECONDS: f64 = 4.0;

/// A cut whose force is 500 N times one plus what `law` says at a share of the cut and a time in s; noise of 15 N with a memory of 5 ms.
fn cut(index: usize, [speed, thickness]: [f64; 2], law: &dyn Fn(f64, f64) -> f64) -> SeriesCut {
    let count = (RATE * SECONDS) as usize;
    let random = Random::new(21, &[index as u64]);
    let force = noise(random, 0.9, count).into_iter().enumerate().map(|(k, noise)| {
        let t = k as f64 / RATE;
        500.0 * (1.0 + law(t / SECONDS, t)) + 15.0 * noise
    });
    SeriesCut {
        name: format!("cut_{index}"),
        cutting_speed: speed / 60.0,
        uncut_chip_thickness: thickness * 1e-3,
        revolution: None,
        rate: RATE,
        order: index as u32 + 1,
        window: [0, count],
        channels: vec![SeriesChannel {
            component: Channel::CuttingForce,
            force: force.collect(),
            zero: Some([1.0, 1.0, 9.0]),
        }],
    }
}

const PLAN: [[f64; 2]; 6] =
    [[60.0, 0.1], [60.0, 0.3], [110.0, 0.1], [110.0, 0.3], [180.0, 0.1], [180.0, 0.3]];

fn cuts(law: &dyn Fn(&[f64; 2], f64, f64) -> f64) -> Vec<SeriesCut> {
    PLAN.iter().enumerate().map(|(k, own)| cut(k, *own, &|x, t| law(own, x, t))).collect()
}

#[test]
fn a_trend_is_found_with_its_size() {
    let found = over_time(&cuts(&|_, x, _| 0.04 * x));
    let of = &found[0];
    assert!(of.trending.iter().all(|t| *t) && !of.running_in.contains(&true), "{of:?}");
    let (mut covered, mut independent) = (0, 0.0);
    for k in 0..6 {
        let [change, low, high] = of.change(k);
        // 4 % of 500 N over a mean of 510 N.
        covered += usize::from(low < 0.0392 && 0.0392 < high);
        assert!((change - 0.0392).abs() < high - low, "{change} {low} {high}");
        // Two thirds of it from the first third to the last.
        let [difference, half] = of.trends[k].thirds;
        assert!((difference - 20.0 * 2.0 / 3.0).abs() < 1.5 * half, "{difference} {half}");
        independent += of.trends[k].independent / 6.0;
    }
    assert!(covered >= 5, "{covered}");
    // tau = (1 + 0.9) / (1 - 0.9) = 19 samples of 8000; from 210 tau it is known to a quarter, from six such records to a tenth.
    assert!((independent / (8000.0 / 19.0) - 1.0).abs() < 0.3, "{independent}");
}

#[test]
fn the_interval_of_a_trend_covers_it_as_often_as_stated() {
    let trials = 200;
    let covered = (0..trials)
        .filter(|&k| {
            let found = trends(0, &cut(1000 + k, PLAN[0], &|x, _| 0.03 * x));
            let ([_, low, high], _) = found[0].line;
            (low..=high).contains(&15.0)
        })
        .count();
    // 95 % of 200 is 190 with a standard deviation of 3.1.
    assert!(covered >= 180, "{covered}");
}

#[test]
fn a_run_in_is_told_from_a_trend_and_its_law_is_named() {
    let length = |own: &[f64; 2]| 0.5 / (own[0] / 60.0);
    let found = over_time(&cuts(&|own, _, t| -0.3 * (-t / length(own)).exp()));
    let of = &found[0];
    assert!(of.running_in.iter().all(|r| *r) && !of.trending.contains(&true), "{of:?}");
    assert_eq!(of.law, Some(RunInLaw::Length), "{:?}", of.laws);
    assert!((of.constant.unwrap() / 0.5 - 1.0).abs() < 0.2, "{:?}", of.constant);
    let found = over_time(&cuts(&|_, _, t| -0.3 * (-t / 0.3).exp()));
    assert_eq!(found[0].law, Some(RunInLaw::Time), "{:?}", found[0].laws);
    let found = over_time(&cuts(&|own, _, t| {
        -0.3 * (-t / (3600.0 * own[1] * 1e-3 / (own[0] / 60.0))).exp()
    }));
    assert_eq!(found[0].law, Some(RunInLaw::Thicknesses), "{:?}", found[0].laws);
}

/// One thickness: a length and a number of thicknesses are the same.
#[test]
fn laws_of_a_run_in_that_cannot_be_told_apart_are_not() {
    let plan = [60.0, 100.0, 140.0, 200.0].map(|v| [v, 0.1]);
    let law = |own: &[f64; 2], t: f64| -0.3 * (-t / (0.5 / (own[0] / 60.0))).exp();
    let all: Vec<SeriesCut> =
        plan.iter().enumerate().map(|(k, own)| cut(k, *own, &|_, t| law(own, t))).collect();
    let found = over_time(&all);
    assert!(found[0].running_in.iter().all(|r| *r) && found[0].law.is_none(), "{:?}", found[0]);
}

#[test]
fn noise_has_neither_trend_nor_run_in() {
    let found = over_time(&cuts(&|_, _, _| 0.0));
    assert!(!found[0].trending.contains(&true) && !found[0].running_in.contains(&true));
    // The zero moves by 1 N with an error of 1 N.
    assert!(!found[0].drifting.contains(&true));
}

/// F rises by 2 % per cut under the same conditions.
#[test]
fn growth_from_cut_to_cut_is_found() {
    let all: Vec<SeriesCut> =
        (0..8).map(|k| cut(k, PLAN[k % 2], &move |_, _| 1.02_f64.powi(k as i32) - 1.0)).collect();
    let found = growth(&all)[0];
    let [value, low, high] = found.per_cut;
    assert!(low < 0.02 && 0.02 < high && (value - 0.02).abs() < 0.002, "{found:?}");
    assert!(found.chance < 0.01);
    assert!(growth(&all[..3]).is_empty());
}

#[test]
fn a_cut_of_few_blocks_is_not_judged() {
    let mut short = cut(0, PLAN[0], &|_, _| 0.0);
    short.channels[0].force.truncate(300);
    assert!(trends(0, &short).is_empty());
}
