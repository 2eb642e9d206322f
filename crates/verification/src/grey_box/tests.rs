use crate::{Case, CaseBody, CaseOptions, CaseOutcome, CaseStore};
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::sync::Mutex;

const CASE: &str = r#"
title = "A straight error"
kind = "verification"
tier = "quick"
claim = "A straight line finds a straight error"

[[fit]]
name = "plan"
title = "five speeds, five thicknesses"
measured = "measured.csv"
regressors = ["linear"]

[[comparison]]
name = "later"
title = "the same, 10 N lower"
fit = "plan"
measured = "later.csv"

[[expect]]
of = "plan"
force = "cutting"
measure = "mae_reduction"
at_least = 0.999999
because = "the error of the simulation is a straight line of v_c and h"

[[expect]]
of = "later"
force = "feed"
measure = "bias_upper_end"
at_most = -9.99
because = "the later forces were made 10 N lower"
"#;

/// A folder with the tables of a plan whose simulation misses by a straight line, and a case.
fn folder(name: &str, case: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("sphcut_{name}_{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let header = "v_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
    let (mut simulated, mut measured, mut later) = (header.clone(), header.clone(), header);
    for k in 0..25 {
        let (speed, thickness) = (100 + 10 * (k % 5), 0.1 + 0.02 * f64::from(k / 5));
        let force = 2000.0 * thickness;
        let error = 0.5 * f64::from(speed) + 300.0 * thickness;
        let line = |text: &mut String, [cutting, feed]: [f64; 2]| {
            writeln!(text, "{speed},{thickness:.2},{cutting:.6},{feed:.6}").unwrap();
        };
        line(&mut simulated, [force, force / 2.0]);
        line(&mut measured, [force + error, force / 2.0 + error]);
        line(&mut later, [force + error - 10.0, force / 2.0 + error - 10.0]);
    }
    fs::write(folder.join("grey_box.toml"), case).unwrap();
    for (name, text) in [("simulated", simulated), ("measured", measured), ("later", later)] {
        fs::write(folder.join(format!("{name}.csv")), text).unwrap();
    }
    folder
}

#[test]
fn a_case_is_run_kept_judged_and_shown() {
    let folder = folder("grey_box_case", CASE);
    let case = Case::read(&folder).unwrap();
    let store = CaseStore::new(&std::env::temp_dir());
    let CaseBody::GreyBox(fits) = &case.body else { panic!("a case of the grey box") };
    let stored = || fits.stored(&case.head, &store).unwrap();
    assert_eq!(stored(), []);
    assert_eq!(case.judge_stored(&store), Ok(None));
    let options = CaseOptions { store: Some(store.clone()), ..CaseOptions::default() };
    let told = Mutex::new(0);
    let verdict = case.run(&options, &|_| *told.lock().unwrap() += 1);
    assert_eq!(verdict.outcome, CaseOutcome::Passed, "{:?}", verdict.judgements);
    assert!(*told.lock().unwrap() > 0);
    let bias = verdict.judgements[1].values[0];
    assert!((bias + 10.0).abs() < 1e-3, "{bias}");
    assert_eq!(case.judge_stored(&store), Ok(Some(verdict)));
    let shown = case.shown_beside(None, &store).unwrap();
    assert!(shown.contains("| plan, 25 rows, 25 conditions | F_c |"), "{shown}");
    assert!(shown.contains("| plan | later | F_f | 25, 25 |"), "{shown}");
    // Kept figures belong to their tables.
    let again = Mutex::new(0);
    case.run(&options, &|_| *again.lock().unwrap() += 1);
    assert_eq!(*again.lock().unwrap(), 0);
    let measured = fs::read_to_string(folder.join("measured.csv")).unwrap();
    fs::write(folder.join("measured.csv"), measured.replacen("100,", "101,", 1)).unwrap();
    assert_eq!(stored(), []);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_makes_no_sense_is_refused() {
    for (from, to, expected) in [
        ("fit = \"plan\"", "fit = \"none\"", "comparison `later`: no fit `none`"),
        ("of = \"plan\"", "of = \"none\"", "no fit or comparison has this name"),
        ("at_most = -9.99", "", "`at_least` or `at_most` is needed"),
        ("measure = \"mae_reduction\"", "measure = \"mae_over_fit\"", "not one of a fit"),
        ("name = \"later\"", "name = \"plan\"", "a name of its own"),
        ("regressors = [\"linear\"]", "made_by = \"hand\"", "shown, not judged"),
        ("because = \"the later forces were made 10 N lower\"", "because = \" \"", "`because` is"),
        ("[\"linear\"]", "[\"oracle\"]", "oracle"),
    ] {
        assert!(CASE.contains(from), "{from}");
        let folder = folder("grey_box_wrong", &CASE.replacen(from, to, 1));
        let message = Case::read(&folder).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}\nnot: {expected}");
        fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn tables_that_are_not_there_leave_the_kept_figures_standing() {
    let absent = CASE.replacen("regressors = [\"linear\"]", "regressors = [\"linear\"]\n[[fit]]\nname = \"more\"\ntitle = \"elsewhere\"\nmeasured = \"none.csv\"\nmade_by = \"hand\"", 1);
    let folder = folder("grey_box_absent", &absent);
    let case = Case::read(&folder).unwrap();
    let verdict = case.run(&CaseOptions::default(), &|_| ());
    assert_eq!(verdict.outcome, CaseOutcome::Passed, "{verdict:?}");
    fs::remove_dir_all(folder).unwrap();
}
