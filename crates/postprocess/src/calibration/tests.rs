//! Scans with known answers.

use super::*;

fn force(mean: f64, ci95: f64) -> Force {
    Force { mean, ci95, mean_per_width: mean, ci95_per_width: ci95 }
}

/// A run whose feed force is off by `deviation` and whose forces are known to `interval`, both relative to
/// the measured ones.
fn trial(coefficient: f64, deviation: f64, interval: f64) -> Trial {
    Trial {
        name: format!("mu_{coefficient}"),
        coefficient,
        measured: MeasuredForces { cutting_speed: 7.5, cutting_force: 200.0, normal_force: 100.0 },
        cutting: force(200.0, 200.0 * interval),
        feed: force(100.0 * (1.0 + deviation), 100.0 * interval),
        steady: true,
    }
}

/// Feed force linear in the coefficient, met at `exact`.
fn scan(exact: f64, interval: f64) -> Scan {
    let coefficients = [0.5, 0.1, 0.2, 0.3, 0.4];
    Scan::new(coefficients.map(|mu| trial(mu, mu - exact, interval)).to_vec()).unwrap()
}

#[test]
fn the_error_is_the_root_mean_square_of_both_deviations() {
    let mut off = trial(0.2, -0.3, 0.02);
    off.cutting = force(280.0, 8.0);
    // d = (0.4, -0.3): sqrt((0.16 + 0.09)/2) = 0.353553; half widths (0.04, 0.02): sqrt(0.002/2) = 0.0316228.
    let misfit = off.misfit();
    assert!((misfit.error - 0.353_553_4).abs() < 1e-7, "{misfit:?}");
    assert!((misfit.half_width - 0.031_622_8).abs() < 1e-7, "{misfit:?}");
}

#[test]
fn an_enclosed_minimum_is_found_with_its_neighbours() {
    let sharp = scan(0.31, 0.001);
    assert_eq!(sharp.best().coefficient, 0.3);
    assert_eq!((sharp.standing(), sharp.range()), (Standing::Enclosed, [0.3, 0.3]));
    // Errors 0.0071 at 0.3, 0.0636 at 0.4, 0.0778 at 0.2; told apart beyond sqrt(2) 0.04 = 0.0566: 0.4 is not
    // (0.0566 - rounding), 0.2 is.
    let wide = scan(0.31, 0.0405);
    assert_eq!((wide.standing(), wide.range()), (Standing::Enclosed, [0.3, 0.4]));
}

#[test]
fn what_reaches_the_border_is_told() {
    assert_eq!(scan(0.9, 0.001).standing(), Standing::AtBorder);
    assert_eq!(scan(0.05, 0.001).standing(), Standing::AtBorder);
    assert_eq!(scan(0.2, 0.07).standing(), Standing::ReachesBorder);
    assert_eq!(scan(0.2, 0.07).range(), [0.1, 0.3]);
    assert_eq!(scan(0.3, 1.0).standing(), Standing::Undetermined);
    let blind = scan(0.3, f64::INFINITY);
    assert_eq!((blind.best().coefficient, blind.standing()), (0.3, Standing::Undetermined));
    assert!(Scan::new(Vec::new()).is_none());
    assert!(Scan::new(vec![trial(0.1, f64::NAN, 0.1)]).is_none());
}

#[test]
fn forces_that_level_off_are_told_from_a_range_that_is_too_narrow() {
    // Feed force 100 (1 + deviation): -40, -20 % and then level, 8 % short of the measured one.
    let levels = |interval| {
        let of = |(mu, deviation)| trial(mu, deviation, interval);
        Scan::new([(0.2, -0.4), (0.4, -0.2), (0.6, -0.09), (0.8, -0.08)].map(of).to_vec()).unwrap()
    };
    assert_eq!(
        (levels(0.02).standing(), levels(0.02).saturated_from()),
        (Standing::Saturated, Some(0.6))
    );
    // Known too badly: the line through the first two is no better known than what is missing on it.
    assert_eq!((levels(0.1).standing(), levels(0.1).saturated_from()), (Standing::AtBorder, None));
    // A straight line whose last two runs lie within their intervals.
    assert_eq!(scan(0.9, 0.075).saturated_from(), None);
    assert_eq!(scan(0.9, 0.001).saturated_from(), None);
    // Level, but the best is before.
    let of = |(mu, deviation)| trial(mu, deviation, 0.02);
    let before = [(0.2, -0.2), (0.4, 0.0), (0.6, 0.11), (0.8, 0.12)].map(of);
    assert_eq!(Scan::new(before.to_vec()).unwrap().standing(), Standing::Enclosed);
}

#[test]
fn files_hold_scan_and_predictions() {
    let calibration = Calibration {
        scenario: "cut".to_owned(),
        version: "0.1.0".to_owned(),
        law: "coulomb".to_owned(),
        scan: scan(0.31, 0.001),
        predictions: vec![trial(0.3, 0.1, f64::INFINITY)],
    };
    let page: serde_json::Value = serde_json::from_str(&calibration_json(&calibration)).unwrap();
    assert_eq!(page["friction_coefficient"], 0.3);
    assert_eq!(page["standing"], "enclosed");
    assert_eq!(page["cutting_speed_m_per_min"], 450.0);
    assert_eq!(page["scan"].as_array().unwrap().len(), 5);
    assert!(page["predictions"][0]["error_half_width"].is_null());
    let table = calibration_csv(&calibration);
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 7);
    assert!(lines[6].starts_with("prediction,0.3,450,200,,110"), "{}", lines[6]);
}
