use super::*;
use crate::random::Random;

/// A smooth surface over an 11 x 10 plan.
fn plan(noise: f64) -> TrainingRows {
    let mut random = Random::new(3, &[]);
    let inputs: Vec<Input> = (0..110)
        .map(|k| [(100.0 + 10.0 * f64::from(k % 11)) / 60.0, 1e-5 * f64::from(6 + k / 11)])
        .collect();
    let targets = inputs
        .iter()
        .map(|x| {
            100.0 + 80.0 * (3.0 * x[0]).sin() * x[1] * 1e4 - 30.0 * x[0] + noise * random.normal()
        })
        .collect();
    TrainingRows { inputs, targets, groups: (0..110).collect() }
}

fn error(model: &Model, samples: &TrainingRows) -> f64 {
    let errors = samples.inputs.iter().zip(&samples.targets);
    errors.map(|(&x, y)| (model.predict(x) - y).abs()).sum::<f64>() / samples.len() as f64
}

#[test]
fn every_method_learns_a_surface_better_than_its_mean() {
    let (noisy, truth) = (plan(3.0), plan(0.0));
    let flat = crate::samples::spread(&truth.targets);
    for method in Method::ALL {
        let best = method
            .grid()
            .iter()
            .map(|settings| error(&settings.fit(&noisy, 1), &truth))
            .fold(f64::INFINITY, f64::min);
        // A plane and a parabola cannot follow the sine.
        let limit = match method {
            Method::Linear => 0.95,
            Method::Quadratic => 0.5,
            _ => 0.25,
        };
        assert!(best < limit * flat, "{}: {best} of {flat}", method.name());
    }
}

#[test]
fn a_constant_target_is_predicted_as_such() {
    let samples = plan(0.0);
    let constant = samples.with_targets(vec![-42.5; samples.len()]);
    for method in Method::ALL {
        for settings in method.grid() {
            let model = settings.fit(&constant, 1);
            let found = model.predict([2.0, 1e-4]);
            // The network stops at a validation error of about 1e-3 of the unit.
            assert!((found + 42.5).abs() < 0.1, "{settings:?}: {found}");
        }
    }
}

#[test]
fn models_are_stored_and_read_to_the_same_bits() {
    let samples = plan(5.0);
    for method in Method::ALL {
        let model = method.grid()[0].fit(&samples, 1);
        let text = serde_json::to_string(&model).unwrap();
        let again: Model = serde_json::from_str(&text).unwrap();
        for k in 0..50 {
            let at = [1.5 + 0.05 * f64::from(k), 5e-5 + 2e-6 * f64::from(k)];
            assert_eq!(
                model.predict(at).to_bits(),
                again.predict(at).to_bits(),
                "{}",
                method.name()
            );
            assert_eq!(model.deviation(at), again.deviation(at));
        }
        assert_eq!(model, again);
    }
}

#[test]
fn the_same_seed_gives_the_same_model_and_another_one_does_not() {
    let samples = plan(5.0);
    for method in [Method::Forest, Method::Network] {
        let settings = &method.grid()[0];
        assert_eq!(settings.fit(&samples, 4), settings.fit(&samples, 4));
        assert_ne!(settings.fit(&samples, 4), settings.fit(&samples, 5));
    }
}

#[test]
fn a_polynomial_finds_the_coefficients_it_was_made_with() {
    let samples = plan(0.0);
    let exact =
        samples.inputs.iter().map(|x| 3.0 - 2.0 * x[0] * x[0] + 5e4 * x[0] * x[1]).collect();
    let model = RegressorSettings::Polynomial(PolynomialSettings { degree: 2 })
        .fit(&samples.with_targets(exact), 1);
    // Far outside the plan rounding is blown up by the square of the distance.
    for at in [[2.0, 1e-4], [10.0, 5e-4]] {
        let expected = 3.0 - 2.0 * at[0] * at[0] + 5e4 * at[0] * at[1];
        assert!((model.predict(at) - expected).abs() < 1e-9 * (1.0 + expected.abs()));
    }
}

#[test]
fn a_stump_splits_where_the_objective_falls_most() {
    // Targets 0, 0, 6 along v_c: mean 2, g = 2, 2, -4. Splits: after the first row
    // 1/2 [4/2 + 4/3 - 0] = 1.667, after the second 1/2 [16/3 + 16/2] = 6.667: threshold 2.5,
    // leaves -4/3 and 4/2 (lambda = 1).
    let samples = TrainingRows {
        inputs: vec![[1.0, 1.0], [2.0, 1.0], [3.0, 1.0]],
        targets: vec![0.0, 0.0, 6.0],
        groups: vec![0, 1, 2],
    };
    let settings = BoostingSettings {
        trees: 1,
        max_depth: 1,
        learning_rate: 1.0,
        lambda: 1.0,
        split_penalty: 0.0,
        min_leaf: 1,
    };
    let model = settings.fit(&samples);
    assert!((model.predict([2.4, 1.0]) - (2.0 - 4.0 / 3.0)).abs() < 1e-12);
    assert!((model.predict([2.6, 1.0]) - 4.0).abs() < 1e-12);
    assert_eq!(model.gain(), Some([1.0, 0.0]));
    let pruned = BoostingSettings { split_penalty: 6.7, ..settings }.fit(&samples);
    assert_eq!(pruned.predict([2.6, 1.0]), 2.0);
}

#[test]
fn support_vectors_keep_errors_within_the_tube() {
    let samples = plan(0.0);
    let flat = crate::samples::spread(&samples.targets);
    let settings = SupportVectorSettings {
        penalty: 1e4,
        tube: 0.1,
        sharpness: 1.0,
        input_scale: InputScale::Linear,
    };
    let model = settings.fit(&samples);
    for (&input, target) in samples.inputs.iter().zip(&samples.targets) {
        // The solver stops at a violation of 1e-3 standard deviations.
        assert!((model.predict(input) - target).abs() < 0.103 * flat);
    }
}

#[test]
fn a_gaussian_process_tells_its_noise_and_doubts_what_it_has_not_seen() {
    let samples = plan(5.0);
    let process =
        GaussianProcessSettings { input_scales: vec![InputScale::Linear] }.fit(&samples, 1);
    // 110 rows tell a standard deviation to about 7 %, and the fit takes some degrees of freedom.
    assert!((3.5..6.5).contains(&process.noise()), "{}", process.noise());
    let inside = process.deviation([2.5, 1e-4]).unwrap();
    let outside = process.deviation([6.0, 4e-4]).unwrap();
    assert!(inside < 1.2 * process.noise() && outside > 2.0 * inside, "{inside} {outside}");
}
