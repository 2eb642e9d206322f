//! Runs of the closed form, with the scatter that particle runs have, as a library: what is concealed in other cuts of the same
//! model must be found with it.

use super::{Change, PairedRun, PairedRuns, changes, support};
use crate::{
    Active, ClaimVerdict, ClosedForm, DiagnosisRequest, Fit, InstrumentPriors, Predictor,
    Recording, Recordings, STATES, compare_rerun, diagnose, rerun_changes, rerun_conditions,
    unseen_fits,
};
use sphcut_analytic::OrthogonalCut;
use sphcut_greybox::Random;
use sphcut_physics::{BATCH_SCATTER, Channel, CuttingCondition};
const WEAR_LENGTH: f64 = 500.0;

fn is_in_closed_form(key: &str) -> bool {
    sphcut_analytic::find(key).is_some_and(sphcut_analytic::Effect::is_in_closed_form)
}

fn at(place: usize) -> CuttingCondition {
    CuttingCondition::new(
        0.5 * 13.3_f64.powf((place % 8) as f64 / 7.0),
        3e-5 * 8.0_f64.powf((place / 8) as f64 / 4.0),
    )
}

/// log of F_c, F_f and temperature of the cut with a change.
fn cut(model: &ClosedForm, condition: &CuttingCondition, change: &Change) -> Vec<f64> {
    let mut logs = [0.0; 6];
    for (key, x) in &change.nuisances {
        logs[BATCH_SCATTER.iter().position(|(k, _)| k == key).unwrap()] += x;
    }
    let place = |key: &str| model.effects().iter().position(|effect| effect.key == key).unwrap();
    let mut active: Vec<Active> = change
        .effects
        .iter()
        .map(|(key, values)| Active { effect: place(key), values: values.clone() })
        .collect();
    let mut condition = *condition;
    if let Some(land) = change.wear_land {
        condition.cut_length = WEAR_LENGTH;
        active.push(Active { effect: place("flank_wear"), values: vec![land / WEAR_LENGTH] });
    }
    model.log_observables(&condition, &logs, &active)
}

/// Runs with a scatter of `noise` (F_c, F_f, others).
fn library(model: &ClosedForm, noise: [f64; 3], seed: u64) -> PairedRuns {
    let mut random = Random::new(seed, &[3]);
    let all: Vec<CuttingCondition> = (0..40).map(at).collect();
    let [speeds, sizes] = support(&all, [[None; 2]; 2]);
    let mut runs = Vec::new();
    for change in changes(&BATCH_SCATTER, is_in_closed_form) {
        for (&cutting_speed, &uncut_chip_thickness) in
            speeds.iter().flat_map(|v| sizes.iter().map(move |h| (v, h)))
        {
            let condition = CuttingCondition { cutting_speed, uncut_chip_thickness, ..at(0) };
            // The base runs are four times as long.
            let length = if change.is_none() { 0.5 } else { 1.0 };
            let mut means = [None; Channel::RECORDED.len()];
            for (channel, log) in model.channels().iter().zip(cut(model, &condition, &change)) {
                let sd = length * noise[channel.index().min(2)];
                let mean = (log + sd * random.normal()).exp();
                means[channel.index()] = Some((mean, Some(sd * mean)));
            }
            runs.push(PairedRun { condition, change: change.clone(), means });
        }
    }
    PairedRuns::new(&runs, &BATCH_SCATTER).unwrap()
}

fn recorded(model: &ClosedForm, change: &Change, seed: u64) -> Recordings {
    let mut random = Random::new(seed, &[9]);
    let mut places: Vec<usize> = (0..40).collect();
    random.shuffle(&mut places);
    let mut change = change.clone();
    change.nuisances = BATCH_SCATTER.iter().map(|&(key, s)| (key, s * random.normal())).collect();
    let cuts = places.iter().enumerate().map(|(order, &place)| {
        let condition = CuttingCondition { run_order: order as f64, ..at(place) };
        let logs = cut(model, &condition, &change);
        let (mut values, mut deviations) =
            ([None; Channel::RECORDED.len()], [None; Channel::RECORDED.len()]);
        for (channel, log) in model.channels().iter().zip(logs) {
            let value = (log + 0.02 * random.normal()).exp();
            values[channel.index()] = Some(value);
            deviations[channel.index()] = Some(0.02 * value);
        }
        Recording { condition, count: None, values, deviations }
    });
    Recordings::new(cuts.collect(), model.channels()).unwrap()
}

fn request(recordings: &Recordings) -> DiagnosisRequest<'_> {
    DiagnosisRequest {
        recordings,
        reference: None,
        instruments: InstrumentPriors { gain: 0.01, offset: 3.0, drift: 0.02 },
        self_test: 0,
        control: 0,
        held_out: true,
        model_error: None,
        batch: 4,
        range: None,
        seed: 1,
        told: crate::ProgressListener::NOBODY,
    }
}

#[test]
fn a_library_predicts_what_it_was_made_of() {
    let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
    let library = library(&model, [1e-4; 3], 1);
    let lacks = |key: &&str| !library.effects().iter().any(|effect| effect.key == *key);
    let lacking: Vec<&str> = super::run_effects().into_iter().filter(lacks).collect();
    assert_eq!(lacking, ["pressure_dependent_friction", "damage"]);
    let forces = |logs: Vec<f64>| [logs[0], logs[1]];
    for place in [9, 20, 30] {
        let condition = at(place);
        let known = forces(library.log_observables(&condition, &[0.0; 6], &[]));
        let true_logs = forces(cut(&model, &condition, &Change::default()));
        for (a, b) in known.iter().zip(&true_logs) {
            assert!((a - b).abs() < 0.01, "{place}: {a} {b}");
        }
        // Halfway between two strengths that were run.
        for (key, values) in
            [("edge_radius", vec![25e-6]), ("speed_dependent_friction", vec![0.15])]
        {
            let effect = library.effects().iter().position(|e| e.key == key).unwrap();
            let active = [Active { effect, values: values.clone() }];
            let with = forces(library.log_observables(&condition, &[0.0; 6], &active));
            let change = Change { effects: vec![(key, values)], ..Change::default() };
            let truth = forces(cut(&model, &condition, &change));
            for channel in 0..2 {
                let (a, b) = (with[channel] - known[channel], truth[channel] - true_logs[channel]);
                assert!((a - b).abs() < 0.02 + 0.1 * b.abs(), "{key} {place}: {a} {b}");
            }
        }
    }
}

#[test]
fn what_scatters_in_the_runs_is_not_known() {
    let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
    let deviation = |noise: f64| {
        let library = library(&model, [noise; 3], 1);
        let known = library.base_uncertainty(Channel::FeedForce, &[at(20)]).unwrap();
        let effect = library.effects().iter().position(|e| e.key == "viscous_drag").unwrap();
        let at_half = [Active { effect, values: vec![0.15] }];
        let more = library.effect_uncertainty(Channel::FeedForce, &[at(20)], &at_half).unwrap();
        [known[(0, 0)].sqrt(), more[(0, 0)].sqrt()]
    };
    let (quiet, loud) = (deviation(0.002), deviation(0.05));
    assert!(loud[0] > 3.0 * quiet[0] && loud[1] > 2.0 * quiet[1], "{quiet:?} {loud:?}");
}

/// Effects are named with a library whose forces scatter by 1 % (F_c) and 3 %; cuts in which nothing is missing raise no alarm.
#[test]
fn concealed_effects_are_found_with_scattering_runs() {
    let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
    let library = library(&model, [0.01, 0.03, 0.01], 2);
    for (key, value) in [("edge_radius", 25e-6), ("speed_dependent_friction", 0.3)] {
        let change = Change { effects: vec![(key, vec![value])], ..Change::default() };
        let data = recorded(&model, &change, 1);
        let found = diagnose(&request(&data), &library).unwrap();
        let effect = library.effects().iter().position(|e| e.key == key).unwrap();
        assert!(found.finding.inclusion[effect] > 0.9, "{key}: {:?}", found.finding);
        let best = &found.fits[found.repair.unwrap()];
        let estimates = found.estimates(&library, best);
        let [low, high] = estimates.iter().find(|e| e.effect == effect).unwrap().interval;
        assert!(low < value && value < high, "{key}: {low} {high}");
    }
    for seed in 1..=5 {
        let quiet = recorded(&model, &Change::default(), seed);
        let verdict = diagnose(&request(&quiet), &library).unwrap().finding.verdict;
        assert_eq!(verdict, ClaimVerdict::NoAlarm, "{seed}");
    }
}

/// The repair that a library finds, put into the model itself, follows the recordings better than fitting the nuisances again.
#[test]
fn a_repair_is_run_again_where_it_was_recorded() {
    let model = ClosedForm::new(OrthogonalCut::aisi_1045(), &BATCH_SCATTER);
    let library = library(&model, [0.003, 0.01, 0.003], 5);
    let hidden = Change { effects: vec![("edge_radius", vec![30e-6])], ..Change::default() };
    let data = recorded(&model, &hidden, 1);
    let found = diagnose(&request(&data), &library).unwrap();
    let conditions = rerun_conditions(&found.problem, 6);
    assert_eq!(conditions.len(), 6);
    let repair = &found.fits[found.repair.unwrap()];
    let (null, repair) = unseen_fits(&found.problem, &library, repair, &conditions).unwrap();
    let fits = (&null, &repair);
    // What was recorded there has no say in the fits, what was recorded elsewhere has.
    let other = |there: bool| {
        let mut changed = found.problem.clone();
        for row in 0..changed.rows.len() {
            let own = *changed.condition(row);
            if conditions.iter().any(|c| crate::data::recordings::same_cut(c, &own)) == there {
                changed.rows[row].log_value += 0.1;
            }
        }
        unseen_fits(&changed, &library, &repair, &conditions).unwrap()
    };
    let apart = |(a, b): &(Fit, Fit)| {
        (&a.unknowns - &null.unknowns).norm() + (&b.unknowns - &repair.unknowns).norm()
    };
    assert!(apart(&other(true)) < 1e-3 && apart(&other(false)) > 0.1);
    // A third of them at most.
    assert_eq!(rerun_conditions(&found.problem, 30).len(), 40 / 3);
    let fastest = (0..40).map(|k| at(k).cutting_speed).fold(0.0, f64::max);
    assert_eq!(conditions[0].cutting_speed, fastest);
    let runs: Vec<[Option<PairedRun>; STATES]> = conditions
        .iter()
        .map(|condition| {
            let changes = rerun_changes(&found.problem, &library, fits, condition).unwrap();
            let as_far = Change { repeat: 1, ..Change::default() };
            assert!(changes[0] == as_far && changes[1].effects.is_empty());
            changes.map(|change| {
                let mut means = [None; Channel::RECORDED.len()];
                for (channel, log) in model.channels().iter().zip(cut(&model, condition, &change)) {
                    means[channel.index()] = Some((log.exp(), None));
                }
                Some(PairedRun { condition: *condition, change, means })
            })
        })
        .collect();
    let rerun = compare_rerun(&found.problem, fits, &runs, 1).unwrap();
    let feed = rerun.channels.iter().find(|one| one.channel == Channel::FeedForce).unwrap();
    assert_eq!((rerun.conditions, feed.values), (6, 6));
    // 2 % of noise; fitting again leaves more than twice that.
    assert!(feed.errors[2] < 0.03 && feed.errors[1] > 0.04, "{feed:?}");
    assert!(feed.errors[0] > feed.errors[1] && feed.ratio[2] < 1.0, "{feed:?}");
}
