//! Kept values of an earlier version of the solver, or of another scenario, do not pass for those of today.

use sphcut_sph::RESULTS_VERSION;
use sphcut_verification::{Case, CaseBody, CaseOptions, CaseStore, cases};
use std::path::Path;

fn kernels() -> Case {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    cases(&root).unwrap().into_iter().find(|case| case.head.name == "kernels").unwrap()
}

#[test]
fn values_of_an_earlier_version_are_named_and_computed_again() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("earlier_results");
    let _ = std::fs::remove_dir_all(&folder);
    let (case, store) = (kernels(), CaseStore::new(&folder));
    let options = CaseOptions { store: Some(store.clone()), ..CaseOptions::default() };
    assert_eq!(case.judge_stored(&store), Ok(None));
    let fresh = case.run(&options, &|_| ());
    assert_eq!(case.judge_stored(&store), Ok(Some(fresh)));

    let CaseBody::Scenarios(runs) = &case.body else { panic!("a case of scenarios") };
    let name = &runs.runs[1].name;
    let mut stored = store.read(&case.head.name, name).unwrap().unwrap();
    assert_eq!(stored.results_version, RESULTS_VERSION);
    stored.results_version -= 1;
    store.write(&case.head.name, &stored).unwrap();
    assert_eq!(case.judge_stored(&store).unwrap().unwrap().earlier, std::slice::from_ref(name));
    case.run(&options, &|_| ());
    assert!(case.judge_stored(&store).unwrap().unwrap().earlier.is_empty());

    // The same text with another spacing: a default has changed.
    let today = store.read(&case.head.name, name).unwrap().unwrap().spacing;
    stored.results_version = RESULTS_VERSION;
    stored.spacing = 2.0 * today;
    store.write(&case.head.name, &stored).unwrap();
    case.run(&options, &|_| ());
    let renewed = store.read(&case.head.name, name).unwrap().unwrap();
    assert_eq!(renewed.spacing.to_bits(), today.to_bits());

    stored.scenario.push('\n');
    store.write(&case.head.name, &stored).unwrap();
    assert_eq!(case.judge_stored(&store), Ok(None));
}
