//! `sphcut springback` from the outside.

use crate::common::Workshop;

const TABLE: &str = "v_c [m/min],springback [um],uncertainty [um],F_c [N]\n150,1.2,0.85,600\n";

/// One pass on the groove of an earlier one, coarse.
const TURNING: &str = r#"title = "A small turning"
dimension = 3

[workpiece]
material = "en_aw_6262a_t8"
length = "0.8 mm"
height = "0.3 mm"
width = "1.1 mm"

[tool]
nose_radius = "0.4 mm"
edge_radius = "40 um"
rake_angle = "15 deg"
clearance_angle = "7 deg"
side_cutting_edge_angle = "5 deg"
front_cutting_edge_angle = "15 deg"
friction = { law = "coulomb", friction_coefficient = 0.3 }

[process]
cutting_speed = "300 m/min"
depth_of_cut = "80 um"
feed = "0.15 mm"
earlier_passes = 1

[window]
ahead = "0.4 mm"
behind = "0.5 mm"

[boundaries]
layers = 1

[resolution]
particle_spacing = "30 um"
grading = {}

[numerics]
mass_scaling = 2000

[output]
snapshots = 8

[stop]
travel = "0.25 mm"
"#;

#[test]
fn turning_in_a_window_is_measured_in_sections() {
    let shop = Workshop::new("springback_turning");
    shop.write("turning.toml", TURNING);
    let run = ["run", "turning.toml", "--quiet", "--threads", "1", "--out", "cut"];
    shop.sphcut(&run).expect_code(0);
    let summary: serde_json::Value = serde_json::from_str(&shop.read("cut/summary.json")).unwrap();
    let along = &summary["along_edge"];
    let sections = along["sections"].as_array().unwrap();
    assert_eq!(sections.len(), 9);
    // The section of a later pass is a_p f = 0.012 mm^2, as well as rows of 24 um tell.
    let area = along["uncut_section_mm2"].as_f64().unwrap();
    assert!((area / 0.012 - 1.0).abs() < 0.2, "{area}");
    let thickest = |key: &str| {
        let values = sections.iter().filter_map(|section| section[key].as_f64());
        values.fold(0.0, f64::max)
    };
    let derived = 1e-3 * 64.9;
    assert!((thickest("uncut_chip_thickness_mm") - derived).abs() < 0.02, "{along}");
    assert!(thickest("contact_rake_mm") > 0.02 && along["contact_area_mm2"].as_f64() > Some(0.0));
    assert!(shop.read("cut/report.html").contains("section of the largest uncut chip thickness"));
    // Clear of the tool is nothing yet.
    let ended = shop.sphcut(&["springback", "cut", "--out", "sb"]).expect_code(2);
    assert!(ended.err.contains("the cut is too short"), "{}", ended.err);
}

#[test]
fn a_cut_gets_its_page_its_numbers_and_its_verdict() {
    let shop = Workshop::new("springback_cut");
    // Clear of the tool are 4 + 20 spacings of 40 um: 1 mm behind 120 + 100 um, and what the tool went
    // before it cut.
    let scenario = shop.tiny_with("travel = \"0.2 mm\"", "travel = \"1.35 mm\"");
    let text = std::fs::read_to_string(&scenario).unwrap();
    let text = text
        .replace("25 um", "40 um")
        .replace("snapshots = 4", "snapshots = 60")
        .replace("length = \"0.8 mm\"", "length = \"1.6 mm\"");
    shop.write("tiny.toml", &text);
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--threads", "1", "--out", "cut"]).expect_code(0);
    shop.write("turning.csv", TABLE);
    let command = ["springback", "cut", "--measured", "turning.csv", "--out", "sb"];
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(
        ended.out.contains("cut: 150 m/min") && ended.out.contains("springback.html"),
        "{}",
        ended.out
    );
    let page = shop.read("sb/springback.html");
    for text in ["What these figures say", "cut (150 m/min)", "Residual stress", "measured 600"] {
        assert!(page.contains(text), "{text}");
    }
    assert!(page.contains("href=\"../cut/report.html\""), "the page of the run");
    let numbers: serde_json::Value =
        serde_json::from_str(&shop.read("sb/springback.json")).unwrap();
    let run = &numbers["runs"][0];
    assert_eq!(numbers["schema_version"], "1.4");
    assert_eq!(run["cutting_speed_m_per_min"], 150.0);
    // Within the spacing: the particles followed belong to the surface.
    assert!(run["springback_um"].as_f64().unwrap().abs() < 40.0, "{run}");
    assert!(run["overlap_um"].as_f64().unwrap() > 0.0, "{run}");
    assert_eq!(shop.read("sb/springback.csv").lines().count(), 2);

    // A sweep goes in as it is; what has no springback is left out and told.
    shop.write(
        "sweep.toml",
        "title = \"t\"\nbase = \"tiny.toml\"\n[[vary]]\nkey = \"stop.travel\"\nvalues = [\"1.35 mm\", \"0.02 mm\"]\n",
    );
    shop.sphcut(&["sweep", "sweep.toml", "--out", "swept", "--quiet"]).expect_code(0);
    let ended = shop.sphcut(&["springback", "swept", "--out", "sb2"]).expect_code(0);
    assert!(ended.out.contains("run 1: 150 m/min"), "{}", ended.out);
    assert!(ended.err.contains("run 2 is left out"), "{}", ended.err);
    // What was measured beside it came from the table, which the sweep was not given.
    let figures = |file: &str| -> Vec<String> {
        shop.read(file)
            .lines()
            .nth(1)
            .unwrap()
            .split(',')
            .skip(1)
            .take(7)
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(figures("sb2/springback.csv"), figures("sb/springback.csv"));

    shop.sphcut(&command).expect_code(2).expect_err("--force");
    shop.sphcut(&[command.as_slice(), &["--force"]].concat()).expect_code(0);
    shop.write("turning.csv", &TABLE.replace("1.2", "1;2"));
    shop.sphcut(&[command.as_slice(), &["--force"]].concat())
        .expect_code(2)
        .expect_err("`turning.csv`, line 2, column 2 `springback`: `1;2`: not a number");
}

#[test]
fn what_has_no_springback_is_refused() {
    let shop = Workshop::new("springback_refused");
    shop.sphcut(&["springback", "--out", "sb"]).expect_code(2).expect_err("RUN");
    shop.sphcut(&["springback", "nowhere", "--out", "sb"]).expect_code(4).expect_err("nowhere");
    shop.sphcut(&["springback", "nowhere", "--measured", "missing.csv", "--out", "sb"])
        .expect_code(4)
        .expect_err("missing.csv");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.02 mm\"");
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--threads", "1", "--out", "short"])
        .expect_code(0);
    shop.sphcut(&["springback", "short", "--out", "sb"]).expect_code(2).expect_err("too short");
    assert!(!shop.path("sb").exists());
}
