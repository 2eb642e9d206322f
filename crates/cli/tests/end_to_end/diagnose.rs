//! `sphcut diagnose` from the outside.

use crate::common::Workshop;
use std::path::Path;

fn shop(name: &str) -> Workshop {
    let shop = Workshop::new(name);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, shop.path(path.file_name().unwrap().to_str().unwrap())).unwrap();
    }
    shop
}

/// The example conceals a friction that falls with the sliding speed, exponent 0.25 (crates/diagnose/examples).
#[test]
fn what_the_example_conceals_is_among_what_is_claimed() {
    let shop = shop("diagnose_example");
    let few = shop.read("example.toml") + "\n[checks]\nself_test = 20\ncontrol = 5\n";
    shop.write("example.toml", &few);
    let command = ["diagnose", "example.toml", "--out", "missing", "--closed-form"];
    let ended = shop.sphcut(&command).expect_code(0);
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("missing/diagnosis.json")).unwrap();
    let set = numbers["set"].as_array().unwrap();
    assert!(set.iter().any(|key| key == "speed_dependent_friction"), "{}", ended.out);
    assert_eq!(numbers["false_alarms"]["trials"], 20);
    let named = numbers["verdict"] == "named";
    assert_eq!(shop.path("missing/scenario.patch.toml").exists(), named);
    let page = shop.read("missing/diagnosis.html");
    for heading in
        ["Where", "What", "Repair", "Does it help", "Can this be trusted", "What to measure next"]
    {
        assert!(page.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    assert!(!page.contains("NaN") && !page.contains("src=\"http"));
    shop.sphcut(&command).expect_code(2).expect_err("use --force");
}

#[test]
fn what_cannot_be_diagnosed_is_said() {
    let shop = shop("diagnose_refused");
    shop.sphcut(&["diagnose", "example.toml", "--out", "missing"])
        .expect_code(2)
        .expect_err("such runs are not made yet");
    let table = shop.read("cuts.csv");
    let few: Vec<&str> = table.lines().take(5).collect();
    shop.write("cuts.csv", &few.join("\n"));
    let closed = ["diagnose", "example.toml", "--out", "missing", "--closed-form"];
    shop.sphcut(&closed)
        .expect_code(2)
        .expect_err("different conditions are too few: 6 are needed");
    let once: Vec<&str> = {
        let mut seen = std::collections::HashSet::new();
        let place = |line: &&str| line.split(',').take(2).collect::<Vec<_>>().join(",");
        table.lines().filter(|line| seen.insert(place(line))).collect()
    };
    shop.write("cuts.csv", &once.join("\n"));
    shop.sphcut(&closed).expect_code(2).expect_err("the noise of F_c is unknown");
    assert!(!shop.path("missing").exists());
}

/// What is measured in validation/diagnosis_wear: names, amounts on every segment, and mistakes with their place.
#[test]
fn wear_is_named_and_followed_from_forces_alone() {
    let shop = Workshop::new("wear");
    let table =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/diagnosis_wear/reference.csv");
    std::fs::copy(table, shop.path("tools.csv")).unwrap();
    let command = ["wear", "tools.csv", "--out", "found"];
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(ended.out.contains("The edges wear"), "{}", ended.out);
    let numbers: serde_json::Value = serde_json::from_str(&shop.read("found/wear.json")).unwrap();
    assert!(numbers["probability_of_wear"].as_f64().unwrap() > 0.9);
    assert_eq!(numbers["left_out"].as_array().unwrap().len(), 7);
    let lines = shop.read("tools.csv").lines().count();
    assert_eq!(shop.read("found/wear.csv").lines().count(), lines);
    shop.sphcut(&command).expect_code(2).expect_err("use --force");
    shop.write("tools.csv", "tool,time [s],F_c [N],F_f [N]\n1,0,5,5\n");
    let bad = ["wear", "tools.csv", "--out", "bad"];
    shop.sphcut(&bad).expect_code(2).expect_err("the column `F_p [N]` is missing");
}
