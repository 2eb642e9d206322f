use super::SIMULATED;
use crate::{Case, CaseOptions, CaseOutcome, CaseVerdict};
use std::fs;
use std::path::PathBuf;

const CASE: &str = r#"
title = "A sweep"
kind = "validation"
claim = "F_c is linear in h"
command = "sphcut sweep"
took = "1 s"
results_version = 1
measured = "measured.csv"
[[expect]]
force = "cutting"
measure = "slope_over_thickness"
cutting_speed = 150.0
reference = 2000.0
tolerance = 0.01
because = "made so"
[[expect]]
force = "feed"
measure = "exponent_of_speed_upper"
at_most = -0.19
because = "made so"
[[expect]]
force = "cutting"
measure = "mean_ratio"
at_most = 0.05
because = "what is hoped for"
known_gap = "a tenth too much by construction"
"#;

/// F_c = (100 + 2000 h) N and F_f = 50 v^-0.2 over a grid; measured cutting forces a tenth lower.
fn folder(name: &str, case: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("sphcut_trends_{}_{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let table = |factor: f64| {
        let mut text = "# a sweep\nv_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
        for v in [100.0, 150.0, 200.0_f64] {
            for h in [0.06, 0.1, 0.15_f64] {
                let (cutting, feed) = (factor * (100.0 + 2000.0 * h), 50.0 * v.powf(-0.2));
                text += &format!("{v},{h},{cutting},{feed}\n");
            }
        }
        text
    };
    fs::write(folder.join(SIMULATED), table(1.0)).unwrap();
    fs::write(folder.join("measured.csv"), table(1.0 / 1.1)).unwrap();
    fs::write(folder.join("trends.toml"), case).unwrap();
    folder
}

fn judged(case: &Case) -> CaseVerdict {
    case.run(&CaseOptions::default(), &|_| ())
}

#[test]
fn trends_are_judged() {
    let case = Case::read(&folder("judged", CASE)).unwrap();
    let verdict = judged(&case);
    assert_eq!(verdict.outcome, CaseOutcome::KnownGap, "{verdict:#?}");
    assert!((verdict.judgements[0].values[0] - 2000.0).abs() < 1e-6);
    assert!((verdict.judgements[1].values[0] + 0.2).abs() < 1e-6);
    assert!((verdict.judgements[2].values[0] - 0.1).abs() < 1e-9);
    assert_eq!(verdict.judgements[0].observable, "F_c: change per mm of h at 150 m/min");
    let closed = Case::read(&folder("closed", &CASE.replace("0.05", "0.2"))).unwrap();
    assert_eq!(judged(&closed).outcome, CaseOutcome::Failed, "a gap that is closed");
    let steep = Case::read(&folder("steep", &CASE.replace("2000.0", "2100.0"))).unwrap();
    assert_eq!(judged(&steep).outcome, CaseOutcome::Failed);
}

#[test]
fn cases_that_make_no_sense_are_refused() {
    let refused = |name: &str, from: &str, to: &str, expected: &str| {
        let error = Case::read(&folder(name, &CASE.replace(from, to))).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    };
    refused("no_limit", "at_most = -0.19\n", "", "`at_least` or `at_most` is needed");
    refused("no_tolerance", "tolerance = 0.01\n", "", "`reference` with `tolerance`");
    refused("no_speed", "cutting_speed = 150.0\n", "", "they need it");
    refused("no_measured", "measured = \"measured.csv\"\n", "", "no measured forces");
    refused("no_reason", "made so", " ", "`because` is empty");
}
