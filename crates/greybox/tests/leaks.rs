//! Nothing of a held-out row may reach its prediction.

use sphcut_greybox::regressor::{Method, Regressor};
use sphcut_greybox::validation::{Inner, Scoring, assemble, hold_out, tune};
use sphcut_greybox::{Random, TrainingRows, grouped_folds};

const INNER: Inner = Inner { folds: 5, seed: 3, scoring: Scoring::Always };

/// Thirty conditions measured three times; targets drawn once per condition, from nothing.
fn noise() -> TrainingRows {
    let mut random = Random::new(11, &[]);
    let mut samples = TrainingRows::default();
    for condition in 0..30 {
        let input = [1.0 + 3.0 * random.uniform(), 1e-4 * (1.0 + random.uniform())];
        let target = 100.0 + 20.0 * random.normal();
        for _ in 0..3 {
            samples.inputs.push(input);
            samples.targets.push(target + 0.1 * random.normal());
            samples.groups.push(condition);
        }
    }
    samples
}

fn r_squared(samples: &TrainingRows, predicted: &[f64]) -> f64 {
    let mean = samples.targets.iter().sum::<f64>() / samples.len() as f64;
    let error: f64 = samples.targets.iter().zip(predicted).map(|(y, p)| (y - p).powi(2)).sum();
    1.0 - error / samples.targets.iter().map(|y| (y - mean).powi(2)).sum::<f64>()
}

fn cross_validated(method: Method, samples: &TrainingRows, folds: &[usize]) -> Vec<f64> {
    let parts: Vec<_> =
        (0..10).map(|fold| hold_out(method, samples, folds, fold, &INNER)).collect();
    assemble(&parts, samples.len()).0
}

#[test]
fn targets_from_nothing_cannot_be_predicted() {
    let samples = noise();
    let folds = grouped_folds(&samples.groups, 10, 1);
    for method in Method::ALL {
        let found = r_squared(&samples, &cross_validated(method, &samples, &folds));
        // The truth is 0 or below; the standard error of R^2 from thirty values of noise is about 0.1.
        assert!(found < 0.2, "{}: R^2 of {found} from noise", method.name());
    }
}

#[test]
fn the_detector_would_find_repeats_in_several_folds() {
    let samples = noise();
    let by_row: Vec<usize> = (0..samples.len()).collect();
    let leaky = grouped_folds(&by_row, 10, 1);
    for method in [Method::Forest, Method::GaussianProcess] {
        let found = r_squared(&samples, &cross_validated(method, &samples, &leaky));
        assert!(found > 0.5, "{}: R^2 of {found}: the leak is not seen", method.name());
    }
}

#[test]
fn held_out_targets_change_no_bit_of_their_predictions() {
    let samples = noise();
    let folds = grouped_folds(&samples.groups, 10, 1);
    let spoilt: Vec<f64> = samples
        .targets
        .iter()
        .zip(&folds)
        .map(|(target, fold)| if *fold == 4 { -1e6 * target } else { *target })
        .collect();
    let spoilt = samples.with_targets(spoilt);
    for method in Method::ALL {
        let (clean, other) = (
            hold_out(method, &samples, &folds, 4, &INNER),
            hold_out(method, &spoilt, &folds, 4, &INNER),
        );
        // Settings, models and predictions: whatever looked at fold 4 would differ.
        assert_eq!(clean, other, "{}", method.name());
        let changed = hold_out(method, &spoilt, &folds, 5, &INNER);
        assert_ne!(hold_out(method, &samples, &folds, 5, &INNER).predicted, changed.predicted);
    }
}

#[test]
fn settings_chosen_with_the_held_out_rows_would_flatter() {
    // What a search that is not nested reports: the best score of the grid on the very folds it was chosen by.
    let samples = noise();
    let folds = grouped_folds(&samples.groups, 10, INNER.seed);
    let tuned = tune(Method::SupportVector, &samples, 10, INNER.seed, Scoring::Always);
    let nested = cross_validated(Method::SupportVector, &samples, &folds);
    let square: f64 = samples.targets.iter().zip(&nested).map(|(y, p)| (y - p).powi(2)).sum();
    let nested = square / samples.len() as f64;
    let flattered = tuned.score.unwrap();
    assert!(flattered < nested, "search {flattered}, nested {nested}");
    let model = tuned.settings.fit(&samples, INNER.seed);
    assert!(model.predict(samples.inputs[0]).is_finite());
}
