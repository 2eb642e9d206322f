//! `sphcut calibrate-friction` from the outside.

use crate::common::{TINY, Workshop};
use serde_json::Value;

/// The forces of a run in N.
fn forces(shop: &Workshop, folder: &str) -> [f64; 2] {
    let summary: Value =
        serde_json::from_str(&shop.read(&format!("{folder}/summary.json"))).unwrap();
    ["cutting", "feed"].map(|force| summary["forces"][force]["mean_n"].as_f64().unwrap())
}

/// Measurements of a machine whose friction coefficient is `coefficient`: two runs and their forces.
fn measure(shop: &Workshop, coefficient: &str) -> String {
    let mut table = "v_c [m/min],F_c [N],F_n [N]\n".to_owned();
    for speed in ["150", "300"] {
        let text = TINY
            .replace(
                "friction_coefficient = 0.25",
                &format!("friction_coefficient = {coefficient}"),
            )
            .replace("150 m/min", &format!("{speed} m/min"));
        shop.write("machine.toml", &text);
        let folder = format!("machine{speed}");
        shop.sphcut(&["run", "machine.toml", "--quiet", "--threads", "1", "--out", &folder])
            .expect_code(0);
        let [cutting, feed] = forces(shop, &folder);
        table.push_str(&format!("{speed},{cutting},{feed}\n"));
    }
    table
}

#[test]
fn a_known_coefficient_is_found_again() {
    let shop = Workshop::new("calibrate_known");
    let table = measure(&shop, "0.35");
    shop.write("turning.csv", &table);
    shop.write("tiny.toml", &format!("{TINY}# made by hand\n"));
    let command = [
        "calibrate-friction",
        "tiny.toml",
        "--measured",
        "turning.csv",
        "--out",
        "mu",
        "--from",
        "0.2",
        "--to",
        "0.6",
        "--points",
        "3",
        "--refine",
        "2",
        "--threads",
        "1",
    ];
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(ended.out.contains("friction_coefficient = 0.35\n"), "{}", ended.out);
    let found: Value = serde_json::from_str(&shop.read("mu/calibration.json")).unwrap();
    assert_eq!(found["friction_coefficient"], 0.35);
    assert_eq!(found["cutting_speed_m_per_min"], 300.0);
    // 0.2, 0.4, 0.6, two beside the best, two beside the best of these. The grid holds the coefficient of
    // the machine, so its run is that of the machine: only the rounding of the table's numbers is left.
    assert_eq!(found["scan"].as_array().unwrap().len(), 7);
    let best =
        found["scan"].as_array().unwrap().iter().find(|run| run["friction_coefficient"] == 0.35);
    assert!(best.unwrap()["error"].as_f64().unwrap() < 1e-9, "{found}");
    let predicted = &found["predictions"][0];
    assert_eq!(predicted["cutting_speed_m_per_min"], 150.0);
    assert!(predicted["error"].as_f64().unwrap() < 1e-9, "{predicted}");
    // Elsewhere the error is an error.
    assert!(found["scan"][0]["error"].as_f64().unwrap() > 0.01, "{found}");
    let page = shop.read("mu/calibration.html");
    for text in ["What these figures say", "least error", "not fitted, at 150 m/min", "<svg"] {
        assert!(page.contains(text), "{text}");
    }
    let expected = format!("{TINY}# made by hand\n").replace("= 0.25", "= 0.35");
    assert_eq!(shop.read("mu/calibrated.toml"), expected);
    assert_eq!(shop.read("mu/calibration.csv").lines().count(), 9);

    // A comment does not change what was run; a lost run is computed again, and only that one.
    shop.sphcut(&command).expect_code(2).expect_err("--force");
    shop.write("tiny.toml", &format!("{TINY}# made by another hand\n"));
    std::fs::remove_dir_all(shop.path("mu/runs/v300_mu0.4")).unwrap();
    let again = shop.sphcut(&[command.as_slice(), &["--force"]].concat()).expect_code(0);
    assert_eq!(again.err.matches(": used again").count(), 7, "{}", again.err);
    assert_eq!(again.err.matches("v300_mu0.4: computed").count(), 1, "{}", again.err);

    // Another cut: kept unless it is said that it may be replaced.
    for name in ["calibration.html", "calibration.json", "calibration.csv", "calibrated.toml"] {
        std::fs::remove_file(shop.path("mu").join(name)).unwrap();
    }
    shop.tiny_with("edge_radius = \"20 um\"", "edge_radius = \"10 um\"");
    shop.sphcut(&command).expect_code(2).expect_err("--force");
    let short = ["--force", "--json", "--from", "0.5", "--points", "2", "--refine", "0"];
    let mut other = command[..6].to_vec();
    other.extend(["--to", "0.6", "--threads", "1"]);
    let json = shop.sphcut(&[other.as_slice(), &short].concat()).expect_code(0);
    let last: Value = serde_json::from_str(json.out.lines().last().unwrap()).unwrap();
    assert_eq!(last["event"], "done");
    // Both coefficients are ends of the range: which one is the better does not matter.
    let found: Value = serde_json::from_str(&shop.read("mu/calibration.json")).unwrap();
    let standing = found["standing"].as_str().unwrap();
    assert!(["at_border", "undetermined"].contains(&standing), "{standing}");
    assert!(found["friction_coefficient"].as_f64().unwrap() >= 0.5, "{found}");
}

#[test]
fn mistakes_are_told_before_anything_runs() {
    let shop = Workshop::new("calibrate_mistakes");
    shop.write("tiny.toml", TINY);
    let good = "v_c [m/min],F_c [N],F_n [N]\n150,600,200\n";
    shop.write("turning.csv", good);
    let try_with = |more: &[&str]| {
        let start = ["calibrate-friction", "tiny.toml", "--measured", "turning.csv", "--out", "mu"];
        shop.sphcut(&[&start[..], more].concat())
    };
    try_with(&["--points", "1"]).expect_code(2).expect_err("--points");
    try_with(&["--from", "0.5", "--to", "0.5"]).expect_code(2).expect_err("is not below --to");
    try_with(&["--from=-0.1"])
        .expect_code(2)
        .expect_err("outside the range of `shear_capped_coulomb`");
    try_with(&["--to", "nan"]).expect_code(2).expect_err("outside the range");
    shop.write("turning.csv", "v_c [m/min],F_c [N]\n150,600\n");
    try_with(&[]).expect_code(2).expect_err("`turning.csv`, line 2: `F_n` or `F_f` is missing");
    let recorded =
        "v_c [m/min],h [mm],b [mm],F_c [N],F_f [N],F_c_sd [N],n\n150,0.1,2,600,200,5,3\n";
    shop.write("turning.csv", recorded);
    try_with(&[])
        .expect_code(2)
        .expect_err("its cuts are 2.0000 mm wide, that of the scenario 3.0000 mm");
    shop.write("turning.csv", &recorded.replace(",0.1,", ",0.2,"));
    try_with(&[]).expect_code(2).expect_err("no line has the h of the scenario, 0.1000 mm");
    shop.write("turning.csv", &format!("{good}151,600,200\n"));
    try_with(&[]).expect_code(2).expect_err("line 3: this cutting speed is there twice");
    shop.write("turning.csv", good);
    shop.tiny_with("friction_coefficient = 0.25", "friction_coefficient = 0.25\nslip = 1");
    try_with(&[]).expect_code(2).expect_err("slip");
    std::fs::remove_file(shop.path("turning.csv")).unwrap();
    shop.write("tiny.toml", TINY);
    try_with(&[]).expect_code(4).expect_err("turning.csv");
    assert!(!shop.path("mu").exists());
}
