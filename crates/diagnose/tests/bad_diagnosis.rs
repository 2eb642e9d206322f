//! The bad files of `tests/bad_diagnosis`.

use sphcut_diagnose::load_diagnosis_file;
use sphcut_scenario::LoadOptions;

#[path = "../../input/tests/shared/mod.rs"]
mod shared;

#[test]
fn every_bad_file_is_refused_with_the_messages_it_names() {
    shared::refuses("bad_diagnosis", 22, &|path| {
        load_diagnosis_file(path, &LoadOptions::default()).expect_err("a bad file")
    });
}
