//! The bad files of `tests/bad_identification`, and good ones.

use sphcut_identify::{TestCurve, load_identification};
use sphcut_input::OutsideFiles;
use std::path::Path;

#[path = "../../input/tests/shared/mod.rs"]
mod shared;

#[test]
fn every_bad_file_is_refused_with_the_messages_it_names() {
    shared::refuses("bad_identification", 12, &|path| {
        load_identification(path, OutsideFiles::default()).expect_err("a bad file")
    });
}

#[test]
fn the_shipped_example_is_good() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/identification/example.toml");
    let plan = load_identification(&path, OutsideFiles::default()).unwrap();
    assert_eq!(plan.tests.len(), 16);
    assert_eq!((plan.reference_rate, plan.melting_temperature), (4e-3, 1733.0));
    assert_eq!(plan.bar, Some([0.02, 210e9, 5231.0]));
    let TestCurve::Compression { specimen, temperature, points, .. } = &plan.tests[0] else {
        panic!("{:?}", plan.tests[0]);
    };
    assert!((specimen[1] - 10.0156e-3).abs() < 1e-12 && (temperature - 298.15).abs() < 1e-9);
    assert!((points[1][0] - 33_736.70).abs() < 1e-9 && (points[1][1] - 0.046_165e-3).abs() < 1e-15);
}

/// Beside the bad files lies one that has nothing but flow curves, split where rate or temperature change.
#[test]
fn flow_curves_alone_are_enough() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/good_identification/curves.toml");
    let plan = load_identification(&path, OutsideFiles::default()).unwrap();
    let curves: Vec<(f64, f64, usize)> = plan
        .tests
        .iter()
        .map(|test| match test {
            TestCurve::Flow { rate, temperature, points, .. } => {
                (*rate, *temperature, points.len())
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(curves, [(1e-3, 298.15, 4), (1e-3, 573.15, 2), (1000.0, 298.15, 2)]);
    assert_eq!((plan.bar, plan.smallest_strain), (None, 0.005));
}
