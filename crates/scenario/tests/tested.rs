//! How far a material was tested, and the cuts that go farther.

use sphcut_scenario::{LoadOptions, parse};
use std::path::Path;

/// The warning of the quick start with `changes` in its text.
fn told(changes: &[(&str, &str)]) -> Option<String> {
    let mut text = include_str!("../../../scenarios/quickstart.toml").to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let scenario = parse(&text, "cut.toml", None, &LoadOptions::default()).unwrap();
    scenario.warnings.into_iter().find(|warning| warning.contains("extrapolation"))
}

const STEEL: &str = "material = \"aisi1045_table5\"";
const ALUMINIUM: &str = "material = \"aa7075_t651\"";

#[test]
fn a_cut_within_the_tests_is_not_warned_of() {
    assert_eq!(told(&[]), None);
    assert_eq!(told(&[(STEEL, "material = \"aisi1045_jaspers\"")]), None);
}

#[test]
fn a_cut_that_gets_hotter_than_the_tests_is_warned_of() {
    let warning = told(&[(STEEL, ALUMINIUM)]).expect("tests up to 250 degC");
    assert!(warning.contains("tests up to 250 degC;"), "{warning}");
    let cold = "[heat]\nplastic_heating = false\n\n[tool.heat]";
    assert_eq!(told(&[(STEEL, ALUMINIUM), ("[tool.heat]", cold)]), None);
}

#[test]
fn an_override_says_how_far_its_own_constants_were_tested() {
    let with = |rest: &str| told(&[(STEEL, &format!("{STEEL}\noverride = {{ {rest} }}"))]);
    let own = with("tested = { plastic_strain = 0.3, strain_rate = \"0.01 1/s\" }").unwrap();
    assert!(own.contains("up to a strain of 0.3 and 0.01 1/s;"), "{own}");
    let constants =
        format!("{ALUMINIUM}\noverride = {{ flow_stress = {{ initial_yield = \"500 MPa\" }} }}");
    assert_eq!(told(&[(STEEL, &constants)]), None, "other constants were fitted to other tests");
}

#[test]
fn a_table_was_tested_as_far_as_it_goes() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tested");
    std::fs::create_dir_all(&folder).unwrap();
    let text = include_str!("good/cut_with_table.toml");
    let whole = include_str!("good/flow_stress.csv");
    let told = |table: &str| {
        std::fs::write(folder.join("flow_stress.csv"), table).unwrap();
        let parsed = parse(text, "cut.toml", Some(&folder), &LoadOptions::default());
        let warnings = parsed.unwrap_or_else(|problems| panic!("{problems:?}")).warnings;
        warnings.into_iter().find(|warning| warning.contains("extrapolation"))
    };
    assert_eq!(told(whole), None, "it goes to a strain of 5, 1e6 1/s and 1459 degC");
    let slow: Vec<&str> = whole.lines().filter(|line| !line.contains(", 1e+06, ")).collect();
    let warning = told(&slow.join("\n")).expect("rates end before those of a cut");
    assert!(warning.contains(" 1/s; the shear zone"), "{warning}");
}
