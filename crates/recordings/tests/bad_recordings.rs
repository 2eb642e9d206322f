//! The bad files of `tests/bad_recordings`, and good ones.

use sphcut_input::OutsideFiles;
use sphcut_physics::Channel;
use sphcut_recordings::load_recordings;
use std::path::Path;

#[path = "../../input/tests/shared/mod.rs"]
mod shared;

#[test]
fn every_bad_file_is_refused_with_the_messages_it_names() {
    shared::refuses("bad_recordings", 12, &|path| {
        load_recordings(path, OutsideFiles::default()).expect_err("a bad file")
    });
}

#[test]
fn the_shipped_example_is_good() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/recordings/example.toml");
    let plan = load_recordings(&path, OutsideFiles::default()).unwrap();
    assert_eq!(plan.cuts.len(), 7);
    assert_eq!(plan.settings.channels[1].component, Channel::FeedForce);
    assert_eq!(plan.settings.low_pass, Some((4, 200.0)));
    // 150 m/min around 60 mm.
    assert!((plan.cuts[0].conditions.revolution.unwrap() - 13.263).abs() < 1e-3);
}
