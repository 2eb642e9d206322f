//! Kept values of an earlier version of the solver, or of another scenario, do not pass for those of today.

use sphcut_sph::RESULTS_VERSION;
use sphcut_verification::store::Store;
use sphcut_verification::{Case, RunOptions, cases, judge_stored, run_case};
use std::path::Path;

fn kernels() -> Case {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    cases(&root).unwrap().into_iter().find(|case| case.name == "kernels").unwrap()
}

#[test]
fn values_of_an_earlier_version_are_named_and_computed_again() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("earlier_results");
    let _ = std::fs::remove_dir_all(&folder);
    let (case, store) = (kernels(), Store::new(&folder));
    let options = RunOptions { store: Some(store.clone()), ..RunOptions::default() };
    assert_eq!(judge_stored(&case, &store), Ok(None));
    let fresh = run_case(&case, &options, &mut |_| ());
    assert_eq!(judge_stored(&case, &store), Ok(Some(fresh)));

    let name = &case.runs[1].name;
    let mut stored = store.read(&case.name, name).unwrap().unwrap();
    assert_eq!(stored.results_version, RESULTS_VERSION);
    stored.results_version -= 1;
    store.write(&case.name, &stored).unwrap();
    assert_eq!(judge_stored(&case, &store).unwrap().unwrap().earlier, std::slice::from_ref(name));
    run_case(&case, &options, &mut |_| ());
    assert!(judge_stored(&case, &store).unwrap().unwrap().earlier.is_empty());

    stored.results_version = RESULTS_VERSION;
    stored.scenario.push('\n');
    store.write(&case.name, &stored).unwrap();
    assert_eq!(judge_stored(&case, &store), Ok(None));
}
