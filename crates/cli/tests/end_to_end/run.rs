//! `sphcut run` from the outside: files, exit codes, interruption.

use crate::common::{Ended, TINY, Workshop, diverging};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// The data lines of a `forces.csv`, without the header.
fn rows(csv: &str) -> Vec<&str> {
    csv.lines().filter(|line| !line.starts_with('#')).skip(1).collect()
}

#[test]
fn a_run_leaves_its_files_in_the_default_folder() {
    let shop = Workshop::new("run_default");
    shop.write("tiny.toml", &TINY.replace("pictures = false\n", ""));
    let ended = shop.sphcut(&["run", "tiny.toml"]).expect_code(0);
    assert!(ended.err.contains("100 %"), "plain progress lines: {}", ended.err);
    assert!(ended.out.contains("391 particles"), "{}", ended.out);
    for name in
        ["run.h5", "forces.csv", "snapshots.vtkhdf", "tool.vtkhdf", "summary.json", "report.html"]
    {
        assert!(shop.path("out/tiny").join(name).exists(), "{name}");
    }
    assert!(!shop.path("out/tiny/run.partial").exists(), "nothing half done is left");
    let forces = shop.read("out/tiny/forces.csv");
    assert!(rows(&forces).len() > 300, "{} rows", rows(&forces).len());
    // Six fields, the tool, the layers, the whole workpiece.
    let pictures = shop.read("out/tiny/report.html").matches("data:image/png").count();
    assert!(pictures >= 9, "{pictures}");
}

#[test]
fn the_summary_has_the_numbers_that_scripts_read() {
    let shop = Workshop::new("run_summary");
    shop.write("tiny.toml", TINY);
    shop.sphcut(&["run", "tiny.toml", "--quiet"]).expect_code(0);
    let summary: Value = serde_json::from_str(&shop.read("out/tiny/summary.json")).unwrap();
    let numbers = [
        "/forces/cutting/mean_n_per_mm",
        "/forces/cutting/ci95_n_per_mm",
        "/forces/feed/mean_n_per_mm",
        "/steady/window_mm/0",
        "/temperature/max_k",
        "/contact/length_mm",
        "/balances/energy_closure",
        "/balances/numerical_dissipation",
        "/balances/momentum_closure",
        "/performance/updates_per_second",
    ];
    for key in numbers {
        assert!(summary.pointer(key).is_some_and(Value::is_number), "{key}: {summary}");
    }
    assert_eq!(summary["performance"]["particles"], 391);
    assert!(summary["warnings"].is_array() && summary["steady"]["reached"].is_boolean());
    // Too short to be steady, and it says so.
    assert_eq!(summary["steady"]["reached"], false);
}

#[test]
fn an_existing_result_is_only_replaced_on_request() {
    let shop = Workshop::new("run_force");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.02 mm\"");
    let arguments = ["run", "tiny.toml", "--out", "result", "--quiet"];
    shop.sphcut(&arguments).expect_code(0);
    let before = std::fs::read(shop.path("result/run.h5")).unwrap();
    shop.sphcut(&arguments).expect_code(2).expect_err("--force");
    assert_eq!(std::fs::read(shop.path("result/run.h5")).unwrap(), before);
    shop.sphcut(&[&arguments[..], &["--force"]].concat()).expect_code(0);
}

#[test]
fn a_patch_changes_the_scenario_and_stands_in_its_result() {
    let shop = Workshop::new("run_patch");
    shop.write("tiny.toml", TINY);
    shop.write("edge.toml", "[scenario]\ntool.edge_radius = \"33 um\"\n");
    let check = ["check", "tiny.toml", "--no-measure", "--all"];
    let before = shop.sphcut(&check).expect_code(0);
    let after = shop.sphcut(&[&check[..], &["--patch", "edge.toml"]].concat()).expect_code(0);
    assert!(!before.out.contains("33 um") && after.out.contains("33 um"), "{}", after.out);
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--patch", "edge.toml"]).expect_code(0);
    shop.write("patched.toml", &TINY.replace("[process]", "[process] # the same\n"));
    shop.sphcut(&["run", "patched.toml", "--quiet", "--out", "plain"]).expect_code(0);
    let forces = |folder: &str| rows(&shop.read(&format!("{folder}/forces.csv"))).join("\n");
    assert_ne!(forces("out/tiny"), forces("plain"));
    assert!(shop.read("out/tiny/report.html").contains("33 um"));
    // What was patched goes on with the same patch, and with no other.
    let list = "title = \"a\"\nbase = \"tiny.toml\"\n[design]\nkind = \"list\"\n[[vary]]\n\
                key = \"process.cutting_speed\"\nvalues = [\"300 m/min\"]\n";
    shop.write("sweep.toml", list);
    let sweep = |more: &[&str]| {
        let command = ["sweep", "sweep.toml", "--out", "s", "--dry-run"];
        let ended = shop.sphcut(&[&command[..], more].concat()).expect_code(0);
        let run = ended.out.lines().find(|line| line.starts_with('1')).unwrap().to_owned();
        run.split_whitespace().last().unwrap().to_owned()
    };
    assert_ne!(sweep(&[]), sweep(&["--patch", "edge.toml"]), "the address of the run");
}

#[test]
fn a_patch_with_a_mistake_is_told() {
    let shop = Workshop::new("run_patch_mistake");
    shop.write("tiny.toml", TINY);
    shop.write("none.toml", "[provenance]\nseed = 1\n");
    shop.write("wrong.toml", "[scenario]\ntool.edge_radius = \"-3 um\"\n");
    let with = |patch: &str| shop.sphcut(&["check", "tiny.toml", "--patch", patch]);
    with("none.toml").expect_code(2).expect_err("no keys under [scenario]");
    with("wrong.toml").expect_code(2).expect_err("as `wrong.toml` patches it");
    with("missing.toml").expect_code(4).expect_err("missing.toml");
}

#[test]
fn quiet_says_nothing_but_warnings() {
    let shop = Workshop::new("run_quiet");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.02 mm\"");
    let ended = shop.sphcut(&["run", "tiny.toml", "--quiet"]).expect_code(0);
    assert_eq!(ended.out, "");
    assert!(ended.err.lines().all(|line| line.starts_with("warning: ")), "{}", ended.err);
}

#[test]
fn a_reader_that_goes_away_does_not_end_the_run() {
    let shop = Workshop::new("run_pipe");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.05 mm\"");
    for style in [&["--json"][..], &[][..]] {
        let mut child = shop
            .command(&[&["run", "tiny.toml", "--force"], style].concat())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().expect("the program ends").code(), Some(0));
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let shop = Workshop::new("run_threads");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.08 mm\"");
    for threads in ["1", "2", "3"] {
        shop.sphcut(&["run", "tiny.toml", "--quiet", "--threads", threads, "--out", threads])
            .expect_code(0);
    }
    let one = shop.read("1/forces.csv");
    assert_eq!(rows(&one), rows(&shop.read("2/forces.csv")));
    assert_eq!(rows(&one), rows(&shop.read("3/forces.csv")));
}

#[test]
fn json_is_one_object_per_line() {
    let shop = Workshop::new("run_json");
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.05 mm\"");
    let ended = shop.sphcut(&["run", "tiny.toml", "--json"]).expect_code(0);
    let events: Vec<Value> =
        ended.out.lines().map(|line| serde_json::from_str(line).expect(line)).collect();
    let names: Vec<&str> = events.iter().filter_map(|event| event["event"].as_str()).collect();
    assert_eq!(names.first(), Some(&"start"));
    assert_eq!(names.last(), Some(&"done"));
    assert!(names.contains(&"progress"), "{names:?}");
    let done = events.last().expect("there are events");
    assert!(done["summary"]["forces"]["cutting"]["mean_n_per_mm"].is_number(), "{done}");
    assert_eq!(ended.err, "");
}

#[test]
fn mistakes_are_told_at_their_place_all_at_once() {
    let shop = Workshop::new("run_mistakes");
    let text = TINY.replace("150 m/min", "150 mm").replace("rake_angle", "rake_angel");
    shop.write("tiny.toml", &text);
    let ended = shop
        .sphcut(&["run", "tiny.toml"])
        .expect_code(2)
        .expect_err("tiny.toml:10:1")
        .expect_err("did you mean `rake_angle`?")
        .expect_err("`cutting_speed` must be a speed");
    assert!(ended.err.contains("m/min"), "{}", ended.err);
    assert!(!shop.path("out").exists(), "nothing is written for a bad scenario");
    let json = shop.sphcut(&["run", "tiny.toml", "--json"]).expect_code(2);
    let event: Value = serde_json::from_str(json.out.trim()).unwrap();
    assert_eq!((&event["event"], &event["exit_code"]), (&"error".into(), &2.into()));
}

#[test]
fn a_scenario_that_is_not_there_is_an_input_output_error() {
    let shop = Workshop::new("run_missing");
    shop.sphcut(&["run", "nowhere.toml"]).expect_code(4).expect_err("nowhere.toml");
}

#[test]
fn wrong_arguments_are_bad_input() {
    let shop = Workshop::new("run_arguments");
    shop.sphcut(&["run"]).expect_code(2).expect_err("<SCENARIO>");
    shop.sphcut(&["run", "a.toml", "--thread", "2"]).expect_code(2).expect_err("--threads");
}

#[test]
fn a_run_that_blows_up_says_where_and_keeps_what_it_has() {
    let shop = Workshop::new("run_diverged");
    shop.write("tiny.toml", &diverging());
    shop.sphcut(&["run", "tiny.toml"])
        .expect_code(3)
        .expect_err("diverged in step")
        .expect_err("of particle");
    assert!(shop.path("out/tiny/run.h5").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_an_input_output_error() {
    let shop = Workshop::new("run_unwritable");
    shop.write("tiny.toml", TINY);
    shop.write("file", "not a folder");
    let ended = shop.sphcut(&["run", "tiny.toml", "--out", "file/result"]).expect_code(4);
    assert!(ended.err.contains("file/result"), "{}", ended.err);
    assert_eq!(shop.read("file"), "not a folder");
}

#[test]
fn files_outside_the_scenarios_folder_need_permission() {
    let shop = Workshop::new("run_outside");
    let outline = "x,y\n0,0\n-0.02,0.3\n-0.3,0.3\n-0.3,0.05\n";
    shop.write("tool.csv", outline);
    std::fs::create_dir(shop.path("inner")).unwrap();
    let angles = "rake_angle = \"5 deg\"\nclearance_angle = \"7 deg\"\nedge_radius = \"20 um\"\n";
    let text = TINY.replace(angles, "outline = \"../tool.csv\"\n");
    shop.write("inner/tiny.toml", &text);
    let refused = shop.sphcut(&["check", "inner/tiny.toml", "--no-measure"]).expect_code(2);
    refused.expect_err("inner/tiny.toml:10:11").expect_err("--allow-outside");
    shop.sphcut(&["check", "inner/tiny.toml", "--no-measure", "--allow-outside"]).expect_code(0);
}

/// Starts a run, sends it SIGINT as soon as its first sample is there, and waits for its end.
#[cfg(unix)]
fn interrupted(shop: &Workshop, arguments: &[&str]) -> Ended {
    let mut child = shop
        .command(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stdout.take().expect("its output is a pipe")).lines();
    let first = lines.find(|line| line.as_ref().is_ok_and(|line| line.contains("progress")));
    assert!(first.is_some(), "the run ended before its first progress line");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("there is a kill command").success());
    let rest: Vec<String> = lines.map_while(Result::ok).collect();
    let mut ended = Ended::from(child.wait_with_output().expect("the program ends"));
    ended.out = rest.join("\n");
    ended
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_goes_on_with_the_same_bits() {
    let shop = Workshop::new("run_interrupt");
    // Lighter inertia: enough steps to be interrupted in the middle.
    shop.tiny_with("mass_scaling = 1000", "mass_scaling = 50");
    shop.sphcut(&["run", "tiny.toml", "--quiet", "--out", "whole"]).expect_code(0);
    let arguments = ["run", "tiny.toml", "--json", "--out", "parts"];
    let ended = interrupted(&shop, &arguments).expect_code(130);
    assert!(ended.out.contains("\"interrupted\""), "{}", ended.out);
    let so_far = rows(&shop.read("parts/forces.csv")).len();
    let whole = shop.read("whole/forces.csv");
    assert!(so_far < rows(&whole).len(), "{so_far} rows: it was not interrupted in the middle");

    shop.sphcut(&["run", "tiny.toml", "--quiet", "--out", "parts"])
        .expect_code(2)
        .expect_err("--resume");
    let resumed = ["run", "tiny.toml", "--quiet", "--out", "parts", "--resume"];
    shop.sphcut(&resumed).expect_code(0);
    assert_eq!(shop.read("parts/forces.csv"), whole);
    // A finished run has nothing left to do.
    shop.sphcut(&resumed).expect_code(0);
    assert_eq!(shop.read("parts/forces.csv"), whole);
}

#[cfg(unix)]
#[test]
fn a_changed_scenario_does_not_go_on_with_an_old_run() {
    let shop = Workshop::new("run_changed");
    shop.tiny_with("mass_scaling = 1000", "mass_scaling = 50");
    interrupted(&shop, &["run", "tiny.toml", "--json"]).expect_code(130);
    shop.tiny_with("mass_scaling = 1000", "mass_scaling = 60");
    shop.sphcut(&["run", "tiny.toml", "--resume"]).expect_code(2).expect_err("mass_scaling = 60");
}

#[test]
fn a_run_stops_once_its_mean_is_known_well_enough() {
    let shop = Workshop::new("run_steady");
    // A lax criterion: the test is about stopping early, not about when a cut is steady.
    let text = TINY
        .replace("length = \"0.8 mm\"", "length = \"1.8 mm\"")
        .replace("snapshots = 4", "snapshots = 4\nsampling_travel = \"1 um\"")
        .replace(
            "travel = \"0.2 mm\"",
            "travel = \"1.4 mm\"\n\
             steady = { relative_half_width = 0.2, minimum_travel = \"0.2 mm\" }",
        );
    // Little friction: with more of it so short a cut is still heating at its end. A little finer than the others: the
    // contact of four particles over the uncut chip thickness comes and goes.
    let text = text
        .replace("friction_coefficient = 0.25", "friction_coefficient = 0.1")
        .replace("particle_spacing = \"25 um\"", "particle_spacing = \"20 um\"");
    shop.write("tiny.toml", &text);
    let ended = shop.sphcut(&["run", "tiny.toml"]).expect_code(0);
    assert!(ended.out.contains("steady, stopped early"), "{}", ended.out);
    let travelled = rows(&shop.read("out/tiny/forces.csv")).len();
    assert!((200..1400).contains(&travelled), "{travelled} um");
    let summary: Value = serde_json::from_str(&shop.read("out/tiny/summary.json")).unwrap();
    assert_eq!(summary["steady"]["reached"], true);
}
