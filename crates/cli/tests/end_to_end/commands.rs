//! The commands beside `run`, from the outside.

use crate::common::{TINY, Workshop, diverging};

#[test]
fn help_teaches_with_examples() {
    let shop = Workshop::new("commands_help");
    let help = shop.sphcut(&["--help"]).expect_code(0);
    for text in ["Examples:", "sphcut run scenarios/quickstart.toml", "Exit codes:", "130"] {
        assert!(help.out.contains(text), "{text}: {}", help.out);
    }
    for command in ["run", "check", "catalogue", "completions"] {
        let page = shop.sphcut(&[command, "--help"]).expect_code(0);
        assert!(page.out.contains("Usage: sphcut"), "{command}: {}", page.out);
    }
    shop.sphcut(&[]).expect_code(2).expect_err("Usage: sphcut");
}

#[test]
fn check_shows_both_units_the_cost_and_warnings() {
    let shop = Workshop::new("commands_check");
    shop.write("tiny.toml", TINY);
    let page = shop.sphcut(&["check", "tiny.toml", "--threads", "1", "--all"]).expect_code(0).out;
    let expected = [
        "A tiny cut",
        "150 m/min",
        "= 2.5 m/s",
        "(default)",
        // 0.1 mm / 25 um and 20 um / 25 um
        "4 particles across the uncut chip thickness",
        "0.8 particles across the edge radius",
        // 0.8 mm x 0.3 mm / (25 um)^2
        "391 particles",
        "on 1 thread (",
        "warnings",
    ];
    for text in expected {
        assert!(page.contains(text), "`{text}` is not in:\n{page}");
    }
    assert!(!shop.path("out").exists(), "check writes nothing");
    let short = shop.sphcut(&["check", "tiny.toml", "--no-measure"]).expect_code(0).out;
    let place = |text: &str| short.find(text).unwrap_or_else(|| panic!("{text}: {short}"));
    assert!(place("cost") < place("warnings") && place("warnings") < place("resolution"));
    assert!(!short.contains("= 2.5 m/s"), "{short}");
}

#[test]
fn check_draws_the_setup_and_speaks_json() {
    let shop = Workshop::new("commands_preview");
    shop.write("tiny.toml", TINY);
    let arguments = ["check", "tiny.toml", "--no-measure", "--preview", "page/cut.html", "--json"];
    let found: serde_json::Value =
        serde_json::from_str(&shop.sphcut(&arguments).expect_code(0).out).unwrap();
    assert_eq!(found["cost"]["particles"], 391);
    assert_eq!(found["resolution"]["across_uncut_chip_thickness"], 4.0);
    assert!(found["cost"]["seconds"].is_null());
    let page = shop.read("page/cut.html");
    // 0.1 mm / 25 um, 20 um / 25 um, and particles near the edge.
    for text in
        ["4 particles across", "0.8 particles across", "h = 100 \u{b5}m", "sphcut run tiny.toml"]
    {
        assert!(page.contains(text), "{text}");
    }
    assert!(page.matches("<circle").count() > 50);
    // A cut in space: whole, and the edge.
    let turning = format!("{CASES}/../scenarios/al6262_turning.toml");
    shop.sphcut(&["check", &turning, "--no-measure", "--preview", "turning.html"]).expect_code(0);
    let page = shop.read("turning.html");
    assert_eq!(page.matches("src=\"data:image/png").count(), 2);
    assert!(page.contains("The edge and the particles before it"));
}

#[test]
fn every_command_has_a_folder_of_its_own_and_says_what_to_do_next() {
    let shop = Workshop::new("commands_next");
    shop.write("tiny.toml", &TINY.replace("travel = \"0.2 mm\"", "travel = \"0.02 mm\""));
    let top = format!("{CASES}/..");
    let last = |arguments: &[&str]| {
        let ended = shop.sphcut(arguments).expect_code(0);
        let line = ended.out.lines().last().unwrap_or_default().to_owned();
        assert!(line.starts_with("next  "), "{arguments:?}: {line}");
        line
    };
    assert!(last(&["check", "tiny.toml", "--no-measure"]).ends_with("sphcut run tiny.toml"));
    assert!(last(&["run", "tiny.toml", "--threads", "1"]).contains("travel"));
    assert!(last(&["report", "out/tiny"]).contains("travel"));
    last(&["wear", &format!("{CASES}/diagnosis_wear/reference.csv")]);
    assert!(shop.path("out/reference_wear/wear.html").is_file());
    last(&["recordings", &format!("{top}/scenarios/recordings/example.toml")]);
    assert!(shop.path("out/example_recordings/forces.csv").is_file());
    let law = last(&["identify", &format!("{top}/scenarios/identification/example.toml")]);
    assert!(law.contains("out/example_identify/johnson_cook.toml"), "{law}");
    let sweep = format!("{top}/scenarios/ti6al4v_four_cuts_sweep.toml");
    last(&["sweep", &sweep, "--dry-run", "--no-measure"]);
    assert!(!shop.path("out/ti6al4v_four_cuts_sweep").exists(), "a dry run writes nothing");
}

#[test]
fn check_and_run_refuse_the_same_mistakes() {
    let shop = Workshop::new("commands_check_mistake");
    shop.tiny_with("25 um", "25 kg");
    let run = shop.sphcut(&["run", "tiny.toml"]).expect_code(2);
    let check = shop.sphcut(&["check", "tiny.toml"]).expect_code(2);
    assert_eq!(run.err, check.err);
}

#[test]
fn the_catalogue_has_an_overview_and_details() {
    let shop = Workshop::new("commands_catalogue");
    let overview = shop.sphcut(&["catalogue"]).expect_code(0).out;
    for text in ["johnson_cook", "shear_capped_coulomb", "aisi1045_table5", "numerics"] {
        assert!(overview.contains(text), "{text}: {overview}");
    }
    let law = shop.sphcut(&["catalogue", "shear_capped_coulomb"]).expect_code(0).out;
    for text in ["tau = min(mu p, m_s sigma_y / sqrt(3))", "0 < m_s <= 1", "default 1", "source"] {
        assert!(law.contains(text), "{text}: {law}");
    }
    let material = shop.sphcut(&["catalogue", "aisi1045_table5"]).expect_code(0).out;
    assert!(material.contains("331 MPa") && material.contains("source"), "{material}");
    shop.sphcut(&["catalogue", "jonson"]).expect_code(2).expect_err("johnson_cook");
}

#[test]
fn materials_are_compared() {
    let shop = Workshop::new("commands_materials");
    let page = shop.sphcut(&["materials"]).expect_code(0).out;
    // 553 + 601 x 0.1^0.234 = 903.6 MPa at 1 1/s and room temperature.
    let jaspers = page.lines().find(|line| line.starts_with("aisi1045_jaspers")).unwrap();
    assert_eq!(jaspers.split_whitespace().nth(1), Some("904"), "{page}");
    assert!(page.contains("also aisi1045_temperature_dependent"), "{page}");
    assert!(shop.read("out/materials.html").contains("ti6al4v seo 2005"));
    shop.sphcut(&["materials"]).expect_code(2).expect_err("--force");
    let near = ["materials", "aisi1045", "--out", "other.html"];
    shop.sphcut(&near).expect_code(2).expect_err("did you mean `aisi1045_table5`?");
}

#[test]
fn every_command_has_a_manual_page() {
    let shop = Workshop::new("commands_man");
    let page = |words: &[&str]| shop.sphcut(&[&["man"], words].concat()).expect_code(0).out;
    let all = page(&[]);
    assert!(all.contains(".TH sphcut 1") && all.contains("sphcut\\-diagnose"), "{all}");
    let run = page(&["run"]);
    assert!(run.contains(".TH sphcut-run 1") && run.contains("\\-\\-resume"), "{run}");
    assert!(page(&["greybox", "fit"]).contains("\\-\\-simulated"));
    shop.sphcut(&["man", "fly"]).expect_code(2).expect_err("has no command `fly`");
}

#[test]
fn completions_are_scripts() {
    let shop = Workshop::new("commands_completions");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = shop.sphcut(&["completions", shell]).expect_code(0).out;
        assert!(script.contains("allow-outside"), "{shell}");
    }
}

#[test]
fn export_writes_the_snapshots_again() {
    let shop = Workshop::new("commands_export");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.02 mm\"");
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--out", "result"]).expect_code(0);
    shop.sphcut(&["export", "result"]).expect_code(2).expect_err("--force");
    shop.sphcut(&["export", "result", "--to", "particles.vtkhdf"]).expect_code(0);
    let ours = std::fs::read(shop.path("particles.vtkhdf")).unwrap();
    // The signature of every HDF5 file.
    assert_eq!(ours[..8], *b"\x89HDF\r\n\x1a\n");
    assert!(shop.path("tool.vtkhdf").is_file());
    let onto = ["export", "result", "--to", "tool.vtkhdf", "--force"];
    shop.sphcut(&onto).expect_code(2).expect_err("choose another name");
    shop.sphcut(&["export", "nowhere"]).expect_code(4).expect_err("nowhere");
    std::fs::create_dir(shop.path("foreign")).unwrap();
    shop.write("foreign/run.h5", "this is a letter");
    shop.sphcut(&["export", "foreign"]).expect_code(4).expect_err("foreign/run.h5");
}

#[test]
fn the_schema_is_printed_or_written_once() {
    let shop = Workshop::new("commands_schema");
    let printed = shop.sphcut(&["schema"]).expect_code(0).out;
    let schema: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert!(schema.pointer("/properties/process/properties/cutting_speed").is_some());
    shop.sphcut(&["schema", "--write"]).expect_code(0);
    assert_eq!(shop.read("scenario.schema.json"), printed);
    assert!(shop.read(".taplo.toml").contains("scenario.schema.json"));
    shop.sphcut(&["schema", "--write"]).expect_code(2).expect_err("--force");
    shop.sphcut(&["schema", "--write", ".", "--force"]).expect_code(0);
    shop.sphcut(&["schema", "--write", "nowhere"]).expect_code(4).expect_err("nowhere");
}

#[test]
fn a_report_can_be_written_again_also_of_a_run_that_blew_up() {
    let shop = Workshop::new("commands_report");
    shop.write("tiny.toml", &diverging());
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--out", "wild"]).expect_code(3);
    let ended = shop.sphcut(&["report", "wild"]).expect_code(0);
    assert!(ended.out.contains("report.html"), "{}", ended.out);
    assert!(shop.read("wild/report.html").contains("A tiny cut"));
    assert!(shop.path("wild/summary.json").exists());
    shop.sphcut(&["report", "nowhere"]).expect_code(4).expect_err("nowhere");
}

/// The top of the repository, where the cases are.
const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");

#[test]
fn validate_lists_and_runs_cases_and_knows_their_names() {
    let shop = Workshop::new("commands_validate");
    let list = shop.sphcut(&["validate", "--list", "--folder", CASES]).expect_code(0).out;
    assert!(list.contains("johnson_cook_points") && list.contains("quick"), "{list}");
    let verdict =
        shop.sphcut(&["validate", "johnson_cook_points", "--folder", CASES]).expect_code(0).out;
    assert!(verdict.contains("1 case: 1 passed"), "{verdict}");
    shop.sphcut(&["validate", "johnson", "--folder", CASES])
        .expect_code(2)
        .expect_err("johnson_cook_points");
    shop.sphcut(&["validate"]).expect_code(4).expect_err("--folder");
}

#[test]
fn a_case_that_does_not_hold_is_not_passed() {
    let shop = Workshop::new("commands_validate_wrong");
    let case = shop.path("cases/johnson_cook_points");
    std::fs::create_dir_all(&case).unwrap();
    for file in std::fs::read_dir(format!("{CASES}/johnson_cook_points")).unwrap() {
        let file = file.unwrap();
        if file.path().is_dir() {
            continue; // values of earlier runs
        }
        let text = std::fs::read_to_string(file.path()).unwrap();
        // Another metal than the reference was computed for.
        let wrong = text.replace("\"aisi1045_jaspers\"", "\"ofhc_copper_johnson_cook\"");
        std::fs::write(case.join(file.file_name()), wrong).unwrap();
    }
    let verdict = shop.sphcut(&["validate", "--folder", "cases"]).expect_code(1).out;
    assert!(verdict.contains("FAIL"), "{verdict}");
}
