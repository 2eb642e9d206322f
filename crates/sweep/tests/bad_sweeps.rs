//! The bad files of `tests/bad_sweeps`, and good ones.

use sphcut_scenario::LoadOptions;
use sphcut_sweep::{Levels, load_sweep};
use std::path::Path;

#[path = "../../input/tests/shared/mod.rs"]
mod shared;

#[test]
fn every_bad_file_is_refused_with_the_messages_it_names() {
    shared::refuses("bad_sweeps", 12, &|path| {
        load_sweep(path, &LoadOptions::default()).expect_err("a bad file")
    });
}

#[test]
fn the_shipped_sweep_is_good() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/aisi1045_sweep.toml");
    let sweep = load_sweep(&path, &LoadOptions::default()).unwrap();
    let Levels::Listed(speeds) = &sweep.axes[1].levels else { panic!("a range with steps") };
    assert_eq!((speeds.len(), speeds[1].as_str()), (11, "\"110 m/min\""));
    // What a person would write by hand into the base.
    let scenario = sweep.scenario(&["\"draft\"", "\"110 m/min\"", "\"0.07 mm\""]).unwrap();
    let by_hand = sweep
        .base
        .text
        .replace("150 m/min\"", "110 m/min\"")
        .replace("uncut_chip_thickness = \"0.1 mm\"", "uncut_chip_thickness = \"0.07 mm\"")
        .replace("preset = \"standard\"", "preset = \"draft\"");
    assert_eq!(scenario.text, by_hand);
}

#[test]
fn a_base_with_mistakes_is_told_as_itself() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_sweeps/bases");
    let problems = load_sweep(&folder.join("sweep.toml"), &LoadOptions::default()).unwrap_err();
    assert_eq!(problems.len(), 1);
    assert!(problems[0].file.ends_with("wrong.toml"), "{}", problems[0]);
    assert!(problems[0].to_string().contains("did you mean `law`?"), "{}", problems[0]);
}
