//! `sphcut sweep` from the outside.

use crate::common::{TINY, Workshop, diverging};
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Two speeds by two thicknesses of a cut of a few steps.
pub const SWEEP: &str = r#"title = "Speed and thickness"
base = "tiny.toml"

[[vary]]
key = "process.cutting_speed"
values = ["150 m/min", "300 m/min"]

[[vary]]
key = "process.uncut_chip_thickness"
from = "0.09 mm"
to = "0.10 mm"
step = "0.01 mm"
"#;

/// A folder with the sweep and its scenario.
pub fn shop(name: &str, sweep: &str) -> Workshop {
    let shop = Workshop::new(name);
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.02 mm\"");
    shop.write("sweep.toml", sweep);
    shop
}

#[test]
fn a_dry_run_prints_runs_cost_and_total_and_writes_nothing() {
    let shop = shop("sweep_dry", SWEEP);
    let arguments = ["sweep", "sweep.toml", "--out", "out", "--dry-run", "--threads", "1"];
    let ended = shop.sphcut(&arguments).expect_code(0);
    for text in
        ["300 m/min", "0.09 mm", "4 runs", "measured now", "on 1 thread", "warning (4 runs): "]
    {
        assert!(ended.out.contains(text), "{text}: {}", ended.out);
    }
    assert_eq!(ended.out.lines().filter(|line| line.contains("m/min")).count(), 4);
    assert!(!shop.path("out").exists());
    let quick = shop.sphcut(&[arguments.as_slice(), &["--no-measure"]].concat()).expect_code(0);
    assert!(!quick.out.contains("measured"), "{}", quick.out);
    shop.write("sweep.toml", &SWEEP.replace("cutting_speed", "cuting_speed"));
    let ended = shop.sphcut(&arguments).expect_code(2);
    ended.expect_err("sweep.toml:5:7").expect_err("did you mean `cutting_speed`?");
    shop.write("tiny.toml", &TINY.replace("law = ", "lwa = "));
    shop.sphcut(&arguments).expect_code(2).expect_err("tiny.toml:15:1");
    std::fs::remove_file(shop.path("sweep.toml")).unwrap();
    shop.sphcut(&arguments).expect_code(4).expect_err("sweep.toml");
}

const OUT: [&str; 7] = ["sweep", "sweep.toml", "--out", "out", "--threads", "1", "--quiet"];

/// The folders of all results with their `forces.csv`, by address.
pub fn forces(shop: &Workshop, store: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for shard in std::fs::read_dir(shop.path(store).join("results")).unwrap().flatten() {
        for result in std::fs::read_dir(shard.path()).unwrap().flatten() {
            let csv = std::fs::read_to_string(result.path().join("forces.csv")).unwrap();
            found.insert(result.file_name().to_string_lossy().into_owned(), csv);
        }
    }
    found
}

#[test]
fn a_sweep_computes_what_is_missing_and_gives_what_single_runs_give() {
    let shop = shop("sweep_whole", SWEEP);
    let ended = shop.sphcut(&["sweep", "sweep.toml", "--out", "out"]).expect_code(0);
    assert!(
        ended.out.contains("4 runs computed") && ended.err.contains("run 4 finished"),
        "{ended:?}"
    );
    let results = forces(&shop, "out/store");
    assert_eq!(results.len(), 4);
    // The scenario that was run is in the store, and a single run of it has the same bits.
    let found = shop.sphcut(&["store", "ls", "out/store", "--json"]).expect_code(0);
    let found: Value = serde_json::from_str(&found.out).unwrap();
    let first = &found["results"][0];
    let folder = first["folder"].as_str().unwrap();
    std::fs::copy(format!("{folder}/scenario.toml"), shop.path("one.toml")).unwrap();
    shop.sphcut(&["run", "one.toml", "--out", "one", "--quiet"]).expect_code(0);
    assert_eq!(shop.read("one/forces.csv"), results[first["address"].as_str().unwrap()]);
    let summary =
        |text: &str| -> Value { serde_json::from_str::<Value>(text).unwrap()["forces"].clone() };
    let stored = std::fs::read_to_string(format!("{folder}/summary.json")).unwrap();
    assert_eq!(summary(&stored), summary(&shop.read("one/summary.json")));
    // The record is one that other commands read.
    shop.sphcut(&["export", folder, "--to", "one.vtkhdf"]).expect_code(0);

    let again = shop.sphcut(&["sweep", "sweep.toml", "--out", "out"]).expect_code(0);
    assert!(
        again.out.contains("0 runs computed") && again.out.contains("4 there already"),
        "{}",
        again.out
    );
    // Another spelling and one more value: one more column of runs.
    let more = SWEEP.replace("\"300 m/min\"", "\"5 m/s\", \"250 m/min\"");
    shop.write("sweep.toml", &format!("# with more\n{more}"));
    let more = shop.sphcut(&["sweep", "sweep.toml", "--out", "out"]).expect_code(0);
    assert!(
        more.out.contains("2 runs computed") && more.out.contains("4 there already"),
        "{}",
        more.out
    );
}

#[test]
fn progress_as_json_tells_every_run() {
    let shop = shop("sweep_json", SWEEP);
    let ended = shop.sphcut(&["sweep", "sweep.toml", "--out", "out", "--json"]).expect_code(0);
    let events: Vec<Value> =
        ended.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&events[0]["event"], &events[0]["runs"]), (&"start".into(), &4.into()));
    let finished = events.iter().filter(|event| event["state"] == "finished").count();
    assert_eq!(finished, 4);
    assert_eq!(events.last().unwrap()["finished"], 4);
    shop.write("sweep.toml", "nonsense");
    let ended = shop.sphcut(&["sweep", "sweep.toml", "--out", "out", "--json"]).expect_code(2);
    assert!(ended.out.contains("\"event\":\"error\""), "{}", ended.out);
}

#[test]
fn a_run_that_diverges_is_told_and_the_others_finish() {
    let sweep = "title = \"t\"\nbase = \"tiny.toml\"\n[[vary]]\nkey = \"process.cutting_speed\"\n\
                 values = [\"150 m/min\", \"1000 m/s\"]\n";
    let shop = shop("sweep_diverged", sweep);
    shop.write("tiny.toml", &diverging());
    let ended = shop.sphcut(&OUT).expect_code(3);
    assert!(ended.err.contains("failed: process.cutting_speed = "), "{}", ended.err);
    assert_eq!(forces(&shop, "out/store").len(), 1);
    let listed = shop.sphcut(&["store", "ls", "out/store"]).expect_code(0);
    assert!(listed.out.contains("failed: "), "{}", listed.out);
    // It is known now: told again, not computed again.
    shop.sphcut(&OUT).expect_code(3).expect_err("failed: ");
}

#[test]
fn a_store_is_listed_checked_and_cleared() {
    let shop = shop("sweep_store", SWEEP);
    shop.sphcut(&OUT).expect_code(0);
    let listed = shop.sphcut(&["store", "ls", "out/store"]).expect_code(0);
    assert!(
        listed.out.contains("4 results") && listed.out.contains("A tiny cut"),
        "{}",
        listed.out
    );
    let whole = shop.sphcut(&["store", "verify", "out/store"]).expect_code(0);
    assert!(whole.out.contains("4 results, 0 damaged"), "{}", whole.out);
    let address = forces(&shop, "out/store").into_keys().next().unwrap();
    let csv = shop.path("out/store/results").join(&address[..2]).join(&address).join("forces.csv");
    std::fs::write(csv, "changed").unwrap();
    shop.sphcut(&["store", "verify", "out/store"]).expect_code(4).expect_err("damaged: ");
    shop.sphcut(&["store", "verify", "out/store", "--remove"]).expect_code(0);
    let again = shop.sphcut(&["sweep", "sweep.toml", "--out", "out"]).expect_code(0);
    assert!(again.out.contains("1 runs computed"), "{}", again.out);

    shop.write("sweep.toml", &SWEEP.replace("\"150 m/min\", ", ""));
    shop.sphcut(&OUT).expect_code(0);
    let shown = shop.sphcut(&["store", "gc", "out/store"]).expect_code(0);
    assert!(shown.out.contains("2 not needed") && shown.out.contains("--remove"), "{}", shown.out);
    assert_eq!(forces(&shop, "out/store").len(), 4);
    shop.sphcut(&["store", "gc", "out/store", "--remove"]).expect_code(0);
    assert_eq!(forces(&shop, "out/store").len(), 2);
    shop.sphcut(&["store", "ls", "nowhere"]).expect_code(4).expect_err("nowhere");
}

/// Twenty runs of which most time is spent in files: kills hit the steps, the record, and the store's writer.
const MANY: &str = "title = \"t\"\nbase = \"tiny.toml\"\n[[vary]]\nkey = \"tool.friction.friction_coefficient\"\n\
                    from = 0.01\nto = 0.20\nstep = 0.01\n";

#[cfg(unix)]
#[test]
fn a_sweep_that_is_killed_again_and_again_loses_nothing() {
    let shop = shop("sweep_killed", MANY);
    shop.sphcut(&OUT).expect_code(0);
    let undisturbed = forces(&shop, "out/store");
    assert_eq!(undisturbed.len(), 20);
    let arguments = ["sweep", "sweep.toml", "--out", "killed", "--threads", "2", "--quiet"];
    let mut kills = 0;
    loop {
        let mut child = shop.command(&arguments).spawn().unwrap();
        // Other moments every time.
        let until = Instant::now() + Duration::from_millis(60 + 37 * (kills % 9));
        let ended = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break Some(status);
            }
            if Instant::now() >= until && kills < 8 {
                child.kill().unwrap();
                child.wait().unwrap();
                break None;
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        match ended {
            Some(status) => break assert_eq!(status.code(), Some(0)),
            None => kills += 1,
        }
    }
    assert!(kills > 3, "the sweep was over before it could be killed");
    shop.sphcut(&["store", "verify", "killed/store"]).expect_code(0);
    assert!(
        forces(&shop, "killed/store") == undisturbed,
        "the bits of a sweep that nobody disturbed"
    );
    assert_eq!(std::fs::read_dir(shop.path("killed/store/work")).unwrap().count(), 0);
}

/// Three sweeps on one store, one of them killed: what it had begun is finished by the others.
#[cfg(unix)]
#[test]
fn sweeps_share_a_store_and_one_may_die() {
    let shop = shop("sweep_shared", MANY);
    let start = |out: &str| {
        let arguments =
            ["sweep", "sweep.toml", "--out", out, "--store", "shared", "--threads", "1", "--json"];
        shop.command(&arguments).stdout(Stdio::piped()).spawn().unwrap()
    };
    let mut dies = start("dies");
    let living = [start("one"), start("two")];
    std::thread::sleep(Duration::from_millis(150));
    dies.kill().unwrap();
    dies.wait().unwrap();
    let mut finished = 0;
    for child in living {
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        let out = String::from_utf8_lossy(&output.stdout);
        let last: Value = serde_json::from_str(out.lines().last().unwrap()).unwrap();
        let sum = last["finished"].as_u64().unwrap() + last["reused"].as_u64().unwrap();
        assert_eq!(sum, 20, "{last}");
        finished += last["finished"].as_u64().unwrap();
    }
    assert!(finished <= 20, "no run was computed twice: {finished}");
    assert_eq!(forces(&shop, "shared").len(), 20);
    shop.sphcut(&["store", "verify", "shared"]).expect_code(0);
    let gc = shop.sphcut(&["store", "gc", "shared"]).expect_code(0);
    assert!(gc.out.contains("0 not needed"), "{}", gc.out);
}

#[cfg(unix)]
#[test]
fn an_interrupted_sweep_goes_on() {
    let shop = Workshop::new("sweep_interrupted");
    shop.write("tiny.toml", TINY);
    shop.write("sweep.toml", SWEEP);
    let child = shop.command(&OUT).stderr(Stdio::piped()).spawn().unwrap();
    // Until it has claimed a run: from then on it heeds an interruption.
    let claims = shop.path("out/store/work");
    let start = std::time::Instant::now();
    while std::fs::read_dir(&claims).map_or(true, |mut claims| claims.next().is_none()) {
        assert!(start.elapsed() < Duration::from_secs(120), "no run was claimed");
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    let sent = std::process::Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("the same command goes on"), "{said}");
    shop.sphcut(&OUT).expect_code(0);
    assert_eq!(forces(&shop, "out/store").len(), 4);
}

/// The table has what the runs have, and the grey box reads it as it is.
#[test]
fn table_and_page_show_the_runs_and_feed_the_grey_box() {
    // Far enough to touch the material, on few particles.
    let sweep = SWEEP.replace("step = \"0.01 mm\"", "count = 5");
    let shop = shop("sweep_table", &sweep);
    shop.write("tiny.toml", &TINY.replace("0.2 mm", "0.1 mm").replace("25 um", "30 um"));
    let mut measured = "v_c [m/min],h [mm],F_c [N],F_f [N]\n".to_owned();
    for speed in [150, 300] {
        for h in ["0.09", "0.0925", "0.095", "0.0975", "0.1"] {
            measured +=
                &format!("{speed},{h},{},200\n", 100.0 + 6000.0 * h.parse::<f64>().unwrap());
        }
    }
    shop.write("measured.csv", &measured);
    let arguments = ["sweep", "sweep.toml", "--out", "out", "--measured", "measured.csv"];
    let ended = shop.sphcut(&arguments).expect_code(0);
    assert!(ended.out.contains("sweep.html"), "{}", ended.out);

    let table = shop.read("out/table.csv");
    let lines: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    // One line of heads, then the runs: what pandas reads without being told anything.
    assert_eq!(lines.len(), 11);
    assert!(lines.iter().all(|cells| cells.len() == lines[0].len()));
    let column = |name: &str| {
        lines[0]
            .iter()
            .position(|head| *head == name)
            .unwrap_or_else(|| panic!("{name}: {:?}", lines[0]))
    };
    assert_eq!(lines[10][column("process.cutting_speed [m/min]")], "300");
    assert_eq!(lines[10][column("v_c [m/min]")], "300");
    assert_eq!(lines[10][column("h [mm]")], "0.1");
    assert_eq!(lines[10][column("state")], "finished");
    let address = lines[10][column("address")];
    let folder = shop.path("out/store/results").join(&address[..2]).join(address);
    let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let force = summary["forces"]["cutting"]["mean_n"].as_f64().unwrap();
    assert!(force > 1.0, "the tool touches: {force}");
    for name in ["F_c [N]", "forces.cutting.mean_n"] {
        assert_eq!(lines[10][column(name)].parse::<f64>().unwrap(), force);
    }
    assert_eq!(lines[10][column("steady.reached")], "0");
    assert!(shop.path("out/table.h5").exists());

    // Both forces at two speeds.
    assert_eq!(shop.read("out/coefficients.csv").lines().count(), 5);
    let coefficients: Value = serde_json::from_str(&shop.read("out/coefficients.json")).unwrap();
    let first = &coefficients["coefficients"][0];
    assert_eq!((first["force"].as_str(), first["cuts"].as_u64()), (Some("F_c"), Some(5)));
    assert!(first["K_c"]["ci95"].as_f64().unwrap() > 0.0, "{first}");

    let page = shop.read("out/sweep.html");
    for text in [
        "Force coefficients",
        "What these runs say",
        "Cutting force",
        "The cuts",
        "data:image/png",
        "How to reproduce",
        "measured F",
    ] {
        assert!(page.contains(text), "{text}");
    }
    // A click on a run leads to the command that makes its page, and to the page once it is there.
    let stored = format!("out/store/results/{}/{address}", &address[..2]);
    let made = format!("store/results/{}/{address}/report.html", &address[..2]);
    assert!(page.contains(&format!("{stored}</code> makes it")), "{stored}");
    assert_eq!(page.matches("id=\"run-10\"").count(), 1);
    assert!(page.matches("href=\"#run-10\"").count() >= 1);
    shop.sphcut(&["report", &stored]).expect_code(0);
    shop.sphcut(&arguments).expect_code(0);
    let page = shop.read("out/sweep.html");
    assert!(shop.path("out").join(&made).is_file() && !page.contains("#run-10\""));
    assert!(page.matches(&format!("href=\"{made}\"")).count() >= 2, "row and picture");
    let fit = [
        "greybox",
        "fit",
        "--simulated",
        "out/simulated.csv",
        "--measured",
        "measured.csv",
        "--out",
        "grey",
    ];
    let fit = [fit.as_slice(), &["--regressors", "linear", "--quiet"]].concat();
    shop.sphcut(&fit).expect_code(0);
    assert_eq!(shop.read("grey/points.csv").lines().count(), 11);
    shop.sphcut(&[&arguments[..5], &["none.csv"]].concat()).expect_code(4).expect_err("none.csv");
}
