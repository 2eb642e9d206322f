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
    let ranking = numbers["ranking"].as_array().unwrap();
    assert_eq!(ranking[0]["effect"], "speed_dependent_friction");
    assert_eq!(numbers["false_alarms"]["trials"], 20);
    let named = numbers["verdict"] == "named";
    assert_eq!(shop.path("missing/scenario.patch.toml").exists(), named);
    if named {
        // What is written can be used as it is.
        let patched =
            ["check", "cut.toml", "--no-measure", "--patch", "missing/scenario.patch.toml"];
        let ended = shop.sphcut(&patched).expect_code(0);
        assert!(ended.out.contains("speed_dependent"), "{}", ended.out);
    }
    let held_out = shop.read("missing/held_out.csv");
    let head = held_out.lines().next().unwrap();
    assert!(head.starts_with("left_out,line,v_c [m/s],h [m],channel,unit,measured,as_simulated,"));
    let cells = head.split(',').count();
    assert!(held_out.lines().all(|line| line.split(',').count() == cells), "{head}");
    for part in ["blocks", "highest_speed", "thinnest_chip", "unfitted_channel"] {
        assert!(held_out.contains(&format!("\n{part},")), "{part}");
    }
    let page = shop.read("missing/diagnosis.html");
    for heading in [
        "Residual pattern",
        "Candidate effects",
        "Correction",
        "Held-out validation",
        "Limits",
        "Next experiment",
    ] {
        assert!(page.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    for unit in ["N", "%"] {
        assert!(page.contains(&format!("feed force: measured less recalibrated, in {unit}.<")));
    }
    assert!(page.contains(">Noise of a single cutting force<"));
    assert!(!page.contains("NaN") && !page.contains("src=\"http"));
    shop.sphcut(&command).expect_code(2).expect_err("use --force");
    corrected_forces_are_predicted(&shop);
}

/// At the measured conditions the corrected cutting force lies nearer than the simulated one, and its interval holds nearly all.
fn corrected_forces_are_predicted(shop: &Workshop) {
    let numbers = |text: &str| -> Vec<Vec<f64>> {
        let lines = text.lines().skip(1);
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let measured = numbers(&shop.read("cuts.csv"));
    let places = measured.iter().map(|cut| format!("{},{}\n", cut[0], cut[1]));
    shop.write("new.csv", &format!("v_c [m/min],h [mm]\n{}500,0.05\n", places.collect::<String>()));
    let command =
        ["predict", "--diagnosis", "missing", "--conditions", "new.csv", "--out", "forces.csv"];
    shop.sphcut(&command).expect_code(0);
    let text = shop.read("forces.csv");
    assert!(
        text.starts_with("v_c [m/min],h [mm],F_c_as_simulated [N],F_c_corrected [N],F_c_low [N]"),
        "{text}"
    );
    let predicted = numbers(&text);
    assert_eq!(predicted.len(), measured.len() + 1);
    let (mut errors, mut inside) = ([0.0; 2], 0);
    for (cut, own) in measured.iter().zip(&predicted) {
        // F_f: columns 4 and 6 on.
        errors[0] += (own[6] / cut[4]).ln().abs();
        errors[1] += (own[7] / cut[4]).ln().abs();
        inside += usize::from((own[8]..=own[9]).contains(&cut[4]));
    }
    assert!(errors[1] < errors[0], "{errors:?}");
    // Of 40 values 35 or fewer lie inside of 95 % intervals with a probability below 5 %.
    assert!(inside >= 35, "{inside}");
    shop.sphcut(&command).expect_code(2).expect_err("use --force");
    shop.write("bad.csv", "v_c [m/min]\n100\n");
    let bad = ["predict", "--diagnosis", "missing", "--conditions", "bad.csv", "--out", "b.csv"];
    shop.sphcut(&bad).expect_code(2).expect_err("`h");
}

#[test]
fn what_cannot_be_diagnosed_is_said() {
    let shop = shop("diagnose_refused");
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
    assert!(shop.read("found/wear.csv").lines().next().unwrap().ends_with("never_falling [N]"));
    assert!(shop.read("found/wear.html").contains("Limits"));
    shop.sphcut(&command).expect_code(2).expect_err("use --force");
    // Tools by name: the same numbers under other names.
    let table = shop.read("tools.csv");
    let named = table.lines().map(|line| {
        let (tool, rest) = line.split_once(',').unwrap();
        let name = if tool == "tool" { tool.to_owned() } else { format!("edge {tool}") };
        format!("{name},{rest}\n")
    });
    shop.write("named.csv", &named.collect::<String>());
    shop.sphcut(&["wear", "named.csv"]).expect_code(0);
    let [numbered, named] =
        ["found", "out/named_wear"].map(|at| shop.read(&format!("{at}/wear.csv")));
    assert_eq!(named.replace("\nedge ", "\n"), numbered);
    lands_follow_from_a_few_readings(&shop, &table, &numbered);
    shop.write("tools.csv", "tool,time [s],F_c [N],F_f [N]\n1,0,5,5\n");
    let bad = ["wear", "tools.csv", "--out", "bad"];
    shop.sphcut(&bad).expect_code(2).expect_err("the column `F_p [N]` is missing");
}

/// Made-up readings in proportion to the force of wear, in every fifth segment.
fn lands_follow_from_a_few_readings(shop: &Workshop, table: &str, forces: &str) {
    let read = |every: usize| -> String {
        let of = |(k, (line, found)): (usize, (&str, &str))| {
            let force: f64 = found.rsplit(',').next().unwrap().parse().unwrap_or(0.0);
            match k {
                0 => format!("{line},VB [um]\n"),
                k if k % every == 0 => format!("{line},{:.0}\n", (3.0 * force).max(0.0)),
                _ => format!("{line},\n"),
            }
        };
        table.lines().zip(forces.lines()).enumerate().map(of).collect()
    };
    shop.write("read.csv", &read(5));
    let said = shop.sphcut(&["wear", "read.csv", "--out", "land"]).expect_code(0).out;
    assert!(said.contains("Longest land") && said.contains("Each tool left out"), "{said}");
    let found = shop.read("land/wear.csv");
    assert!(found.lines().next().unwrap().ends_with("VB [um],VB_low [um],VB_high [um]"));
    for line in found.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (force, land) = (cells[5], cells[6]);
        assert!(force < 30.0 || (land / (3.0 * force) - 1.0).abs() < 0.15, "{line}");
        assert!(cells[7] <= cells[8], "{line}");
    }
    assert!(shop.read("land/wear.html").contains("Wear land of tool"));
    shop.write("read.csv", &read(90));
    let ended = shop.sphcut(&["wear", "read.csv", "--out", "few"]).expect_code(0);
    assert!(ended.err.contains("four are needed"), "{}", ended.err);
    assert!(!ended.out.contains("Longest land"), "{}", ended.out);
}

/// A cut so small that its runs take a tenth of a second; nine made-up measurements.
fn small_shop(name: &str) -> Workshop {
    let shop = Workshop::new(name);
    shop.write(
        "cut.toml",
        r#"
title = "Small cut"
[workpiece]
material = "aisi1045_jaspers"
length = "4 mm"
height = "0.32 mm"
[tool]
rake_angle = "5 deg"
clearance_angle = "7 deg"
edge_radius = "20 um"
[tool.friction]
law = "shear_capped_coulomb"
friction_coefficient = 0.3
[process]
cutting_speed = "150 m/min"
uncut_chip_thickness = "0.1 mm"
width_of_cut = "1 mm"
[window]
[resolution]
particle_spacing = "40 um"
[numerics]
inertia_number = 1.0
[output]
snapshots = 2
[stop]
travel = "0.3 mm"
"#,
    );
    let mut table = "v_c [m/min],h [mm],F_c [N],F_c_sd [N],F_f [N],F_f_sd [N]\n".to_owned();
    for speed in [60.0, 120.0, 240.0] {
        for thickness in [0.08, 0.12, 0.2_f64] {
            let force = 2200.0 * thickness.powf(0.85);
            let feed = 0.45 * force;
            table += &format!(
                "{speed},{thickness},{force:.1},{:.2},{feed:.1},{:.2}\n",
                0.02 * force,
                0.03 * feed
            );
        }
    }
    shop.write("cuts.csv", &table);
    shop.write(
        "case.toml",
        r#"
title = "Nine cuts"
source = "made up"
scenario = "cut.toml"
[measured]
file = "cuts.csv"
[runs]
travel = 5
[checks]
self_test = 5
control = 5
"#,
    );
    shop
}

/// The particle solver tells what each effect changes, once for all diagnoses of a scenario.
#[test]
fn paired_runs_explain_and_are_kept() {
    let shop = small_shop("diagnose_runs");
    let plan = shop.sphcut(&["diagnose", "case.toml", "--out", "missing", "--dry-run"]);
    assert!(plan.expect_code(0).out.contains("279 runs"));
    assert!(!shop.path("missing").exists());
    let first = ["diagnose", "case.toml", "--out", "missing", "--store", "kept"];
    let ended = shop.sphcut(&first).expect_code(0);
    let ended = ended.expect_err("279 runs of the particle solver, 279 of them");
    assert!(!ended.err.contains("warning"), "{}", ended.err);
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("missing/diagnosis.json")).unwrap();
    assert_eq!(numbers["model"], "paired runs of the particle solver");
    let page = shop.read("missing/diagnosis.html");
    assert!(page.contains("paired runs of the particle solver"));
    assert!(!without_embedded_data(&page).contains("NaN"));
    // Every run is a run of a sweep: what it sets, where it lies and what it gave.
    let runs = shop.read("missing/runs/library/table.csv");
    assert_eq!(runs.lines().filter(|line| line.contains(",finished,")).count(), 279);
    for law in ["speed_dependent", "temperature_dependent", "viscous_drag", "bump_height"] {
        assert!(runs.contains(law), "{law}");
    }
    // Another diagnosis of the same scenario computes nothing and says the same.
    let second = shop.sphcut(&["diagnose", "case.toml", "--out", "again", "--store", "kept"]);
    let second = second.expect_code(0);
    assert!(!second.err.contains("to be computed"), "{}", second.err);
    assert_eq!(shop.read("missing/diagnosis.json"), shop.read("again/diagnosis.json"));
    // And predicts from the same runs, which have to be there.
    shop.write("new.csv", "v_c [m/min],h [mm]\n120,0.1\n150,0.12\n");
    let predict = ["predict", "--diagnosis", "missing", "--conditions", "new.csv", "--out"];
    let ended = shop.sphcut(&[&predict[..], &["new_forces.csv"]].concat()).expect_code(130);
    assert!(ended.out.contains("279 runs, 279 of them to be computed"), "{}", ended.out);
    ended.expect_err("--store");
    let kept = [&predict[..], &["new_forces.csv", "--store", "kept"]].concat();
    shop.sphcut(&kept).expect_code(0);
    let forces = shop.read("new_forces.csv");
    let rows: Vec<Vec<f64>> = forces
        .lines()
        .skip(1)
        .map(|line| line.split(',').filter_map(|cell| cell.parse().ok()).collect())
        .collect();
    assert_eq!(rows.len(), 2, "{forces}");
    for row in rows {
        // v_c, h; of F_c as simulated, corrected, and the interval about it.
        assert!(row[2] > 0.0 && row[4] < row[3] && row[3] < row[5], "{forces}");
    }
}

/// The correction that the closed form finds, run in the particle solver: coarse runs of a tenth of a second, which decide nothing.
#[test]
fn a_correction_in_closed_form_is_confirmed_in_the_particle_solver() {
    let shop = Workshop::new("diagnose_confirm");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let cut = read("cut.toml")
        .replace("preset = \"standard\"", "particle_spacing = \"40 um\"")
        .replace("inertia_number = 0.012", "inertia_number = 1.0");
    shop.write("cut.toml", &cut);
    shop.write("cuts.csv", &read("cuts.csv"));
    let few = "[runs]\ntravel = 5\nrepaired = 2\n[checks]\nself_test = 5\ncontrol = 5\n";
    shop.write("case.toml", &format!("{}\n{few}", read("example.toml")));
    let command = ["diagnose", "case.toml", "--out", "missing", "--closed-form", "--confirm"];
    let ended = shop.sphcut(&command).expect_code(0).expect_err("6 runs of the particle solver");
    assert!(ended.out.contains("In the particle solver, at 2 of the conditions"), "{}", ended.out);
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("missing/diagnosis.json")).unwrap();
    assert_eq!(numbers["particle_solver"]["conditions"], 2);
    let runs = shop.read("missing/runs/repaired/table.csv");
    assert!(runs.contains("speed_dependent"), "{runs}");
    // Each condition as it was and corrected, side by side.
    let page = shop.read("missing/diagnosis.html");
    let (_, pairs) = page.split_once("The cut as simulated and corrected").expect("pictures");
    let (pairs, _) = pairs.split_once("</section>").unwrap();
    let count = |part: &str| pairs.matches(part).count();
    assert_eq!((count("<img"), count(">As simulated: F"), count(">Corrected: F")), (4, 2, 2));
    assert_eq!(pairs.matches("base64,").collect::<Vec<_>>().len(), 4);
    let without = ["diagnose", "case.toml", "--out", "other", "--confirm"];
    shop.sphcut(&without).expect_code(2).expect_err("--closed-form");
    let unused = ["diagnose", "case.toml", "--out", "other", "--closed-form", "--store", "kept"];
    shop.sphcut(&unused).expect_code(2).expect_err("add --confirm");
}

/// A page without its fonts and pictures, whose letters can be any.
fn without_embedded_data(page: &str) -> String {
    let is_data = |c: char| c.is_ascii_alphanumeric() || "+/=".contains(c);
    let mut parts = page.split("base64,");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.map(|part| part.trim_start_matches(is_data)).collect::<String>()
}

#[test]
fn runs_that_cannot_be_made_are_refused_before_the_first() {
    let shop = small_shop("diagnose_runs_refused");
    let command = ["diagnose", "case.toml", "--out", "missing"];
    let (case, cut) = (shop.read("case.toml"), shop.read("cut.toml"));
    shop.write("case.toml", &case.replace("travel = 5", "travel = 5\nmost = 100"));
    shop.sphcut(&command)
        .expect_code(2)
        .expect_err("279 runs are needed")
        .expect_err("raise `most`");
    shop.write("case.toml", &case);
    shop.write("cut.toml", &cut.replace("[window]\n", ""));
    shop.sphcut(&command).expect_code(2).expect_err("it follows the whole workpiece");
    shop.write("cut.toml", &cut.replace("shear_capped_coulomb", "coulomb"));
    shop.sphcut(&command).expect_code(2).expect_err("its friction is `coulomb`");
    shop.write("cut.toml", &cut);
    let turned = "lowest_speed = \"90 m/min\"\nhighest_speed = \"80 m/min\"";
    shop.write("case.toml", &case.replace("travel = 5", turned));
    shop.sphcut(&command).expect_code(2).expect_err("does not lie above `lowest_speed`");
    assert!(!shop.path("missing").exists());
}
