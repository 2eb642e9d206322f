//! Cross-validated errors beside those of scikit-learn and xgboost: same data, folds and settings.
//!
//! Data and figures were made by `tests/data/parity.py`, which lies beside them.

use serde_json::Value;
use sphcut_greybox::TrainingRows;
use sphcut_greybox::regressor::{
    BoostingSettings, ForestSettings, GaussianProcessSettings, InputScale, NetworkSettings,
    PolynomialSettings, Regressor, RegressorSettings, SupportVectorSettings,
};
use std::fmt::Write;
use std::path::PathBuf;

/// Share by which an error may be larger than the reference.
const TOLERANCE: f64 = 0.10;
/// Seeds over which forests and networks are averaged, as in the reference.
const SEEDS: u64 = 10;

fn data(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn set(number: usize) -> (TrainingRows, Vec<usize>) {
    let (mut samples, mut folds) = (TrainingRows::default(), Vec::new());
    for line in data(&format!("set_{number}.csv")).lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        samples.inputs.push([cells[0], cells[1]]);
        samples.targets.push(cells[2]);
        // The reference draws the rows that watch a network's training one by one.
        samples.groups.push(folds.len());
        folds.push(cells[3] as usize);
    }
    (samples, folds)
}

/// The settings of the reference, and whether they use random numbers.
fn regressors() -> Vec<(&'static str, RegressorSettings, bool)> {
    let polynomial = |degree| RegressorSettings::Polynomial(PolynomialSettings { degree });
    let linear = InputScale::Linear;
    vec![
        ("linear", polynomial(1), false),
        ("quadratic", polynomial(2), false),
        ("quartic", polynomial(4), false),
        (
            "support_vector",
            RegressorSettings::SupportVector(SupportVectorSettings {
                penalty: 100.0,
                tube: 0.05,
                sharpness: 0.3,
                input_scale: linear,
            }),
            false,
        ),
        (
            "forest",
            RegressorSettings::Forest(ForestSettings {
                trees: 200,
                max_depth: 64,
                min_leaf: 2,
                inputs_per_split: 2,
            }),
            true,
        ),
        (
            "boosting",
            RegressorSettings::Boosting(BoostingSettings {
                trees: 200,
                max_depth: 3,
                learning_rate: 0.1,
                lambda: 1.0,
                split_penalty: 0.0,
                min_leaf: 1,
            }),
            false,
        ),
        (
            "network",
            RegressorSettings::Network(NetworkSettings {
                neurons: [16, 16],
                decay: 1e-4,
                learning_rate: 0.01,
                validation_share: 0.15,
                patience: 60,
                epochs: 1500,
                input_scale: linear,
            }),
            true,
        ),
        (
            "gaussian_process",
            RegressorSettings::GaussianProcess(GaussianProcessSettings {
                input_scales: vec![linear],
            }),
            false,
        ),
    ]
}

fn held_out_error(
    settings: &RegressorSettings,
    samples: &TrainingRows,
    folds: &[usize],
    seed: u64,
) -> f64 {
    let mut sum = 0.0;
    for fold in 0..10 {
        let model = settings.fit(&samples.filtered(|row| folds[row] != fold), seed);
        let held = samples.filtered(|row| folds[row] == fold);
        sum += held
            .inputs
            .iter()
            .zip(&held.targets)
            .map(|(&x, y)| (model.predict(x) - y).abs())
            .sum::<f64>();
    }
    sum / samples.len() as f64
}

#[test]
fn errors_are_within_a_tenth_of_the_reference() {
    let figures: Value = serde_json::from_str(&data("figures.json")).unwrap();
    let mut table = "set, regressor, here, reference, ratio\n".to_owned();
    let mut worst: f64 = 0.0;
    for number in 1..=4 {
        let (samples, folds) = set(number);
        for (name, settings, random) in regressors() {
            let seeds = if random { SEEDS } else { 1 };
            let here = (0..seeds)
                .map(|seed| held_out_error(&settings, &samples, &folds, seed))
                .sum::<f64>()
                / seeds as f64;
            let reference = figures["mae"][number - 1][name].as_f64().unwrap();
            writeln!(table, "{number}, {name}, {here:.4}, {reference:.4}, {:.3}", here / reference)
                .unwrap();
            worst = worst.max(here / reference);
        }
    }
    println!("{table}");
    assert!(worst <= 1.0 + TOLERANCE, "\n{table}");
}
