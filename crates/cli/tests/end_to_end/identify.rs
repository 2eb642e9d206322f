//! `sphcut identify` from the outside.

use crate::common::{TINY, Workshop};
use std::path::Path;

/// A, B in Pa, n, C, m of the generator.
const TRUTH: [(&str, f64); 5] = [
    ("initial_yield", 331e6),
    ("hardening_modulus", 614e6),
    ("hardening_exponent", 0.26),
    ("rate_coefficient", 0.07),
    ("softening_exponent", 1.19),
];

fn shop(name: &str) -> Workshop {
    let shop = Workshop::new(name);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/identification");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, shop.path(path.file_name().unwrap().to_str().unwrap())).unwrap();
    }
    shop
}

#[test]
fn raw_tests_give_the_parameters_back_and_a_material_that_runs() {
    let shop = shop("identify_example");
    let command = ["identify", "example.toml", "--out", "steel"];
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(ended.out.contains("Johnson-Cook follows the curves to"), "{}", ended.out);
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("steel/identification.json")).unwrap();
    for (key, truth) in TRUTH {
        let found = &numbers["fits"][0]["parameters"][key];
        let (value, half) = (found["value"].as_f64().unwrap(), found["ci95"].as_f64().unwrap());
        // Five 95 % intervals; how often they hold is measured in crates/identify/tests/table_5.rs.
        assert!((value - truth).abs() < 1.5 * half, "{key}: {found} {truth}");
        assert!(half < 0.2 * truth, "{key}: {found}");
    }
    let page = shop.read("steel/identification.html");
    for text in ["What these figures say", "Where Johnson-Cook cannot follow", "by sequence"] {
        assert!(page.contains(text), "{text}");
    }
    for law in ["johnson_cook", "tanh_johnson_cook", "tabulated"] {
        for file in [format!("{law}.toml"), "tabulated.csv".to_owned()] {
            shop.write(&file, &shop.read(&format!("steel/{file}")));
        }
        let scenario = TINY.replace("\"aisi1045_table5\"", &format!("\"{law}.toml\""));
        shop.write("tiny.toml", &scenario);
        let checked = shop.sphcut(&["check", "tiny.toml", "--no-measure"]).expect_code(0);
        assert!(checked.out.contains(law), "{}", checked.out);
        // Bars reach rates of 1e3 1/s, a cut 1e5.
        let told = checked.out.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(told.contains("the flow stress was fitted to tests up to"), "{told}");
    }
    let run = ["run", "tiny.toml", "--quiet", "--threads", "1", "--out", "cut"];
    shop.sphcut(&run).expect_code(0);
    shop.sphcut(&command).expect_code(2).expect_err("--force");
}

#[test]
fn what_is_wrong_is_told_at_its_place() {
    let shop = shop("identify_wrong");
    let text = shop.read("example.toml");
    let run = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        shop.write("wrong.toml", &text.replacen(from, to, 1));
        shop.sphcut(&["identify", "wrong.toml", "--out", "steel"])
    };
    run("1733 K", "20 degC").expect_code(2).expect_err("does not lie above the reference");
    run("[bar]\n", "[rod]\n").expect_code(2).expect_err("the tests need the bar");
    run("length = \"15 mm\"", "length = \"5 mm\"").expect_code(2).expect_err("reaches the length");
    run("compression_1.csv", "bar_1.csv").expect_code(2).expect_err("no such column");
    run("compression_1.csv", "none.csv").expect_code(2).expect_err("there is no such file");
    run("strain_rate = \"4e-3 1/s\"", "strain_rate = \"4e-3 s\"")
        .expect_code(2)
        .expect_err("a time");
    let few = text.split("\n[[compression]]").take(3).collect::<Vec<_>>().join("\n[[compression]]");
    shop.write("few.toml", &few);
    shop.sphcut(&["identify", "few.toml", "--out", "steel"])
        .expect_code(2)
        .expect_err("needs more than five curves");
}
