//! `sphcut calibrate` from the outside.

use crate::common::{TINY, Workshop};
use serde_json::Value;

const CUTS: &str = "\
v_c [m/min],h [mm],F_c [N],F_f [N]
100,0.08,700,380
100,0.12,930,450
150,0.1,800,400
200,0.08,670,360
200,0.12,900,420
";

const CALIBRATE: [&str; 6] = ["calibrate", "cut.toml", "--measured", "cuts.csv", "--out", "twin"];

const CLOSED_FORM: [&str; 2] = ["--model", "closed-form"];

fn windowed() -> String {
    TINY.replace("[resolution]", "[window]\n\n[resolution]").replace("0.8 mm", "2.5 mm")
}

fn numbers(shop: &Workshop, folder: &str) -> Value {
    serde_json::from_str(&shop.read(&format!("{folder}/calibration.json"))).unwrap()
}

#[test]
fn the_closed_form_answers_at_once_and_its_patch_and_material_run() {
    let shop = Workshop::new("calibrate_closed_form");
    shop.write("cut.toml", &windowed());
    shop.write("cuts.csv", CUTS);
    let command = [&CALIBRATE[..], &CLOSED_FORM].concat();
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(ended.out.contains("Calibrated to 5 cuts"), "{}", ended.out);
    let found = numbers(&shop, "twin");
    assert_eq!(found["constants"].as_array().unwrap().len(), 6);
    // The two published sets of the steel: Jaspers' and that of the scenario, each once.
    assert_eq!(found["published_sets"].as_array().unwrap().len(), 2);
    for constant in found["constants"].as_array().unwrap() {
        let [low, high] = [0, 1].map(|k| constant["interval"][k].as_f64().unwrap());
        let value = constant["value"].as_f64().unwrap();
        assert!(low < value && value < high, "{constant}");
    }
    let page = shop.read("twin/calibration.html");
    for text in ["What these figures say", "Sets of constants", "Cuts left out", "Before and after"]
    {
        assert!(page.contains(text), "{text}");
    }
    let patched = ["check", "cut.toml", "--patch", "twin/scenario.patch.toml", "--no-measure"];
    shop.sphcut(&patched).expect_code(0);
    let material = shop.read("twin/material.toml");
    assert!(!material.contains("tested"), "constants of cuts know no range of tests: {material}");
    shop.write("material.toml", &material);
    shop.write("other.toml", &TINY.replace("\"aisi1045_table5\"", "\"material.toml\""));
    shop.sphcut(&["check", "other.toml", "--no-measure"]).expect_code(0);
    shop.sphcut(&command).expect_code(2).expect_err("--force");
    let last = ended.out.lines().last().unwrap_or_default();
    assert!(last.starts_with("next  ") && last.contains("--patch twin/scenario"), "{last}");
    let dry = [&command[..], &["--dry-run"]].concat();
    let said = shop.sphcut(&dry).expect_code(0).out;
    assert!(said.contains("Intervals to be expected"), "{said}");
}

#[test]
fn mistakes_of_single_cuts_are_told_before_anything_runs() {
    let shop = Workshop::new("calibrate_wrong");
    shop.write("cut.toml", &windowed());
    let run = |table: &str, more: &[&str]| {
        shop.write("cuts.csv", table);
        shop.sphcut(&[&CALIBRATE[..], more].concat())
    };
    run(&CUTS.replace("800,400", "0.8,400"), &[]).expect_code(2).expect_err(
        "line 3 of the table (150 m/min, 0.1 mm): F_c is about a thousand times too small",
    );
    run(&CUTS.replace("150,0.1,", "150,100,"), &[])
        .expect_code(2)
        .expect_err("(150 m/min, 100 mm): nobody cuts such h, probably um under a head in mm");
    run(&CUTS.replace("[m/min]", "[m/s]"), &[])
        .expect_code(2)
        .expect_err("the column probably holds m/min and is headed `v_c [m/s]`");
    shop.write("others.csv", "v_c [m/min],h [mm],F_c [N]\n150,0.1,0.8\n");
    run(CUTS, &["--held-out", "others.csv"]).expect_code(2).expect_err(
        "`others.csv`: line 1 of the table (150 m/min, 0.1 mm): F_c is about a thousand",
    );
    shop.write("others.csv", "v_c [m/min],h [mm],rake [deg],F_c [N]\n150,0.1,5,800\n");
    run(CUTS, &["--held-out", "others.csv"]).expect_code(2).expect_err("`rake` is only here");
    run(CUTS, &["--fit", "A,x"]).expect_code(2).expect_err("`x` is no constant");
    run(CUTS, &["--published", "steel"]).expect_code(2).expect_err("begins with `steel`");
    run(&CUTS.replace("F_c [N]", "F_c"), &[]).expect_code(2).expect_err("the unit is missing");
}

/// Three runs, four that move mu, two at the optimum; a second time none of them is computed.
#[test]
fn a_friction_coefficient_is_found_with_particle_runs() {
    let shop = Workshop::new("calibrate_particles");
    // Five rows across the chip: with four, two cuts with the same friction differ by more than their intervals.
    let cut = windowed().replace("25 um", "20 um");
    shop.write("cut.toml", &cut);
    let truth = cut.replace("friction_coefficient = 0.25", "friction_coefficient = 0.5");
    shop.write("truth.toml", &truth);
    // Cuts of the solver itself, with more friction than the scenario has.
    shop.write("cuts.csv", "v_c [m/min],h [mm],F_c [N],F_f [N]\n150,0.1,1,1\n");
    let sweep = "title = \"t\"\nbase = \"truth.toml\"\n[design]\nkind = \"list\"\n\
                 [[vary]]\nkey = \"process.cutting_speed\"\nvalues = [\"100 m/min\", \"150 m/min\", \"200 m/min\"]\n\
                 [[vary]]\nkey = \"stop.travel\"\nvalues = [\"0.6 mm\", \"0.6 mm\", \"0.6 mm\"]\n";
    shop.write("truth_sweep.toml", sweep);
    shop.sphcut(&["sweep", "truth_sweep.toml", "--out", "truth", "--quiet", "--threads", "1"])
        .expect_code(0);
    shop.write("cuts.csv", &shop.read("truth/simulated.csv"));
    let more = ["--fit", "mu", "--travel", "6", "--refreshes", "1", "--threads", "1"];
    let command = [&CALIBRATE[..], &more].concat();
    let dry = shop.sphcut(&[&command[..], &["--dry-run"]].concat()).expect_code(0).out;
    assert!(dry.contains("9 runs") && dry.contains("processor time"), "{dry}");
    // The first round elsewhere: what is listed is a sweep, and its store is looked into.
    let list = [&command[..], &["--list-runs"]].concat();
    let listed = shop.sphcut(&list).expect_code(130).out;
    assert!(listed.contains("as stated: 3 runs, 3 of them to be computed"), "{listed}");
    let sweep = [
        "sweep",
        "twin/runs/as_stated/runs.toml",
        "--out",
        "twin/runs/as_stated",
        "--store",
        "twin/runs/store",
        "--allow-outside",
    ];
    assert!(listed.contains(&format!("sphcut {}", sweep.join(" "))), "{listed}");
    shop.sphcut(&[&sweep[..], &["--quiet", "--threads", "1"]].concat()).expect_code(0);
    let listed = shop.sphcut(&list).expect_code(130).out;
    assert!(listed.contains("changes: 3 runs, 3 of them to be computed"), "{listed}");
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(!ended.err.contains("as stated"), "{}", ended.err);
    let found = numbers(&shop, "twin");
    let mu = &found["constants"][0];
    let [low, high] = [0, 1].map(|k| mu["interval"][k].as_f64().unwrap());
    assert!(low < 0.5 && 0.5 < high && low > 0.25, "{mu}");
    let again = shop.sphcut(&[&command[..], &["--force"]].concat()).expect_code(0);
    assert!(!again.err.contains("to be computed"), "{}", again.err);
    assert_eq!(numbers(&shop, "twin"), found);
}

/// A law beside that of the scenario: its strength, whether the cuts want it, and a patch that has it.
#[test]
fn an_effect_is_fitted_and_its_patch_runs() {
    let shop = Workshop::new("calibrate_effects");
    shop.write("cut.toml", &windowed());
    shop.write("cuts.csv", CUTS);
    let more = ["--fit", "A,mu", "--effects", "speed_dependent_friction"];
    let command = [&CALIBRATE[..], &CLOSED_FORM, &more].concat();
    let said = shop.sphcut(&command).expect_code(0).out;
    assert!(said.contains("speed_dependent_friction"), "{said}");
    let found = numbers(&shop, "twin");
    assert_eq!(found["constants"][2]["effect"], "speed_dependent_friction");
    assert!(found["effects"][0]["log_evidence"].as_f64().unwrap().is_finite());
    assert!(shop.read("twin/scenario.patch.toml").contains("speed_exponent"));
    let patched =
        ["check", "cut.toml", "--patch", "twin/scenario.patch.toml", "--no-measure", "--all"];
    let checked = shop.sphcut(&patched).expect_code(0).out;
    assert!(checked.contains("speed_dependent"), "{checked}");
    let wrong = [&command[..11], &["gain", "--force"]].concat();
    shop.sphcut(&wrong).expect_code(2).expect_err("tanh_softening");
}

/// Bar and compression tests of the same steel make the intervals of its constants narrower.
#[test]
fn tests_of_the_material_are_joined_with_cuts() {
    let shop = Workshop::new("calibrate_tests");
    let folder =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/identification");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, shop.path(path.file_name().unwrap().to_str().unwrap())).unwrap();
    }
    shop.sphcut(&["identify", "example.toml", "--out", "steel"]).expect_code(0);
    shop.write("cut.toml", &windowed());
    shop.write("cuts.csv", CUTS);
    let command =
        ["calibrate", "cut.toml", "--measured", "cuts.csv", "--model", "closed-form", "--out"];
    shop.sphcut(&[&command[..], &["alone"]].concat()).expect_code(0);
    let joined = [&command[..], &["joined", "--material-tests", "steel"]].concat();
    shop.sphcut(&joined).expect_code(0);
    let width = |folder: &str, key: &str, of: &str| {
        let found = numbers(&shop, folder);
        let all = found["constants"].as_array().unwrap();
        let one = all.iter().find(|constant| constant["key"] == key).unwrap();
        let interval = if of == "prior" { &one["prior"]["interval"] } else { &one["interval"] };
        (interval[1].as_f64().unwrap() / interval[0].as_f64().unwrap()).ln()
    };
    for key in ["initial_yield", "hardening_exponent", "rate_coefficient", "softening_exponent"] {
        assert!(width("joined", key, "prior") < 0.6 * width("alone", key, "prior"), "{key}");
        assert!(width("joined", key, "found") < width("alone", key, "found"), "{key}");
    }
    let friction = |folder| width(folder, "friction_coefficient", "prior");
    assert_eq!(friction("joined"), friction("alone"));
    assert!(shop.read("joined/calibration.html").contains("Tests of the material count"));
    let none = [&command[..], &["other", "--material-tests", "alone"]].concat();
    shop.sphcut(&none).expect_code(2).expect_err("sphcut identify");
}

/// Which cuts to make, the same table filled in, and which to make next.
#[test]
fn cuts_are_chosen_before_any_is_made_and_further_ones_after() {
    let shop = Workshop::new("calibrate_next");
    shop.write("cut.toml", &windowed());
    let all = "v_c [m/min],h [mm]\n100,0.08\n100,0.12\n150,0.1\n200,0.08\n200,0.12\n150,0.08\n";
    shop.write("possible.csv", all);
    let design =
        ["calibrate", "cut.toml", "--candidates", "possible.csv", "--next", "5", "--out", "first"];
    let said = shop.sphcut(&design).expect_code(0).out;
    assert!(said.contains("of 6 that could be made") && said.contains("without a cut"), "{said}");
    let table = shop.read("first/next.csv");
    assert_eq!(table.lines().next(), Some("v_c [m/min],h [mm],F_c [N],F_f [N]"));
    assert_eq!(table.lines().count(), 6);
    shop.sphcut(&design).expect_code(2).expect_err("--force");
    let filled: Vec<String> = table
        .lines()
        .map(|line| {
            let place = line.split(',').nth(1).and_then(|h| h.parse::<f64>().ok());
            place.map_or_else(
                || line.to_owned(),
                |h| line.replace(",,", &format!(",{},{}", 200.0 + 6000.0 * h, 180.0 + 2500.0 * h)),
            )
        })
        .collect();
    shop.write("cuts.csv", &filled.join("\n"));
    let command = [&CALIBRATE[..], &CLOSED_FORM, &["--next", "2"]].concat();
    let said = shop.sphcut(&[&command[..], &["--dry-run"]].concat()).expect_code(0).out;
    assert!(said.contains("Most telling cuts"), "{said}");
    let said = shop.sphcut(&command).expect_code(0).out;
    // Corners of the grid are measured already.
    let corners = ["100,0.08", "100,0.12", "200,0.08", "200,0.12"];
    let made = corners.iter().filter(|corner| table.contains(*corner)).count();
    assert!(said.contains(&format!("of {} that could be made", 36 - made)), "{said}");
    assert_eq!(numbers(&shop, "twin")["next"]["cuts"].as_array().unwrap().len(), 2);
    assert!(shop.read("twin/calibration.html").contains("Further cuts"));
    assert_eq!(shop.read("twin/next.csv").lines().count(), 3);
    let without = ["calibrate", "cut.toml", "--candidates", "possible.csv"];
    shop.sphcut(&without).expect_code(2).expect_err("--next");
    let many: Vec<String> = (0..401).map(|k| format!("{},0.1", 100 + k)).collect();
    shop.write("possible.csv", &format!("v_c [m/min],h [mm]\n{}\n", many.join("\n")));
    shop.sphcut(&[&design[..], &["--force"]].concat()).expect_code(2).expect_err("400 is the most");
}
