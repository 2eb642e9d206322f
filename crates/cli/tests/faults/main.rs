//! A disk that fails, or power that goes, at any operation of a command: never exit 0 with another answer, and the same
//! command then goes on to the answer of one that nobody disturbed.

#![cfg(target_os = "linux")]

#[allow(dead_code, reason = "each test binary uses its own part")]
#[path = "../end_to_end/common.rs"]
mod common;
#[path = "../../../record/tests/support/faults.rs"]
mod faults;

use common::Workshop;
use faults::{Fault, Shim, at_every_place};
use serde_json::Value;
use sphcut_record::{Run, RunFiles};
use std::path::{Path, PathBuf};

/// Short: 13 samples.
fn shop(name: &str) -> Option<(Workshop, Shim)> {
    let shop = Workshop::new(name);
    shop.tiny_with("travel = \"0.2 mm\"", "travel = \"0.01 mm\"");
    let shim = Shim::compiled(&shop.path(""))?;
    Some((shop, shim))
}

/// An answer without what a clock says.
fn timeless(mut summary: Value) -> Value {
    summary.as_object_mut().unwrap().remove("performance");
    summary
}

/// Everything that a finished run answers.
fn run_answer(shop: &Workshop, out: &str) -> String {
    shop.sphcut(&["verify", out]).expect_code(0);
    let run = Run::load(&RunFiles::in_dir(&shop.path(out)).record()).unwrap();
    let snapshots: Vec<_> =
        (0..run.snapshots.len()).map(|k| run.snapshots.get(k).unwrap()).collect();
    let summary = serde_json::from_str(&shop.read(&format!("{out}/summary.json"))).unwrap();
    assert!(shop.read(&format!("{out}/report.html")).trim_end().ends_with("</html>"));
    let forces = shop.read(&format!("{out}/forces.csv"));
    format!("{:?} {:?} {snapshots:?} {} {forces}", run.samples, run.outcome, timeless(summary))
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// `reset` gets the output folder, removed before.
fn runs(name: &str, reset: impl Fn(&Workshop, &Shim, &Path)) {
    let Some((shop, shim)) = shop(name) else { return };
    let out = shop.path("out");
    let shown = out.to_string_lossy().into_owned();
    let command = ["run", "tiny.toml", "--quiet", "--threads", "1", "--resume", "--out", &shown];
    at_every_place(
        (name, &shim, &[4]),
        || {
            let _ = std::fs::remove_dir_all(&out);
            reset(&shop, &shim, &out);
        },
        |fault| shim.run(shop.command(&command), &out, fault),
        || run_answer(&shop, "out"),
    );
}

#[test]
fn a_run_on_a_failing_disk() {
    runs("faults_run", |_, _, _| ());
}

#[test]
fn a_resumed_run_on_a_failing_disk() {
    runs("faults_resume", |shop, shim, out| {
        let kept = shop.path("interrupted");
        if !kept.exists() {
            let shown = kept.to_string_lossy().into_owned();
            let command = ["run", "tiny.toml", "--quiet", "--threads", "1", "--out", &shown];
            let fault = Fault { kind: "interrupt", at: 12 };
            assert_eq!(shim.run(shop.command(&command), &kept, Some(fault)), Some(130));
        }
        copy(&kept, out);
    });
}

const SWEEP: &str = "title = \"Speeds\"\nbase = \"tiny.toml\"\n[[vary]]\nkey = \"process.cutting_speed\"\n\
                     values = [\"150 m/min\", \"300 m/min\"]\n";

/// Folders of results below `folder`.
fn results(folder: &Path) -> Vec<PathBuf> {
    let inside = |folder: &Path| -> Vec<PathBuf> {
        std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path()).collect()
    };
    let mut found: Vec<_> = inside(folder).iter().flat_map(|shard| inside(shard)).collect();
    found.sort();
    found
}

#[test]
fn a_sweep_on_a_failing_disk() {
    let Some((shop, shim)) = shop("faults_sweep") else { return };
    shop.write("sweep.toml", SWEEP);
    let out = shop.path("out");
    let shown = out.to_string_lossy().into_owned();
    let command = ["sweep", "sweep.toml", "--quiet", "--threads", "1", "--out", &shown];
    at_every_place(
        ("faults_sweep", &shim, &[3, 4]),
        || drop(std::fs::remove_dir_all(&out)),
        |fault| shim.run(shop.command(&command), &out, fault),
        || {
            shop.sphcut(&["store", "verify", "out/store"]).expect_code(0);
            assert!(shop.read("out/sweep.html").trim_end().ends_with("</html>"));
            let forces = results(&out.join("store/results")).into_iter().map(|result| {
                let forces = std::fs::read_to_string(result.join("forces.csv")).unwrap();
                let summary = std::fs::read_to_string(result.join("summary.json")).unwrap();
                format!("{result:?} {forces} {}", timeless(serde_json::from_str(&summary).unwrap()))
            });
            (forces.collect::<Vec<_>>(), shop.read("out/simulated.csv"))
        },
    );
}

/// What no sweep needs is removed as a whole folder; what one needs stays, and what is half removed is removed by the next.
#[test]
fn a_cleaning_of_a_store_on_a_failing_disk() {
    let Some((shop, shim)) = shop("faults_gc") else { return };
    shop.write("sweep.toml", SWEEP);
    let command = ["sweep", "sweep.toml", "--quiet", "--threads", "1", "--out", "kept"];
    shop.sphcut(&command).expect_code(0);
    shop.write("sweep.toml", &SWEEP.replace("150 m/min\", \"300", "300"));
    shop.sphcut(&command).expect_code(0);
    let (kept, out) = (shop.path("kept"), shop.path("out"));
    let needed = shop.sphcut(&["store", "gc", "kept/store"]).expect_code(0).out;
    assert!(needed.contains("1 not needed"), "{needed}");
    let shown = out.join("store").to_string_lossy().into_owned();
    at_every_place(
        ("faults_gc", &shim, &[4]),
        || {
            let _ = std::fs::remove_dir_all(&out);
            copy(&kept, &out);
        },
        |fault| shim.run(shop.command(&["store", "gc", &shown, "--remove"]), &out, fault),
        || {
            shop.sphcut(&["store", "verify", "out/store"]).expect_code(0);
            let left = results(&out.join("store/results"));
            left.into_iter()
                .map(|result| std::fs::read(result.join("run.h5")).unwrap())
                .collect::<Vec<_>>()
        },
    );
}

/// The process of one run is killed in its middle: it is told, and the other run is done.
#[test]
fn a_run_that_aborts_does_not_end_its_sweep() {
    let Some((shop, shim)) = shop("faults_apart") else { return };
    shop.write("sweep.toml", SWEEP);
    let command = ["sweep", "sweep.toml", "--threads", "1", "--out", "out"];
    shop.sphcut(&command).expect_code(0);
    let address = results(&shop.path("out/store/results"))[0].file_name().unwrap().to_owned();
    std::fs::remove_dir_all(shop.path("out")).unwrap();
    let work = shop.path("out/store/work").join(address);
    // The sweep itself changes two things there before the run's process begins.
    let fault = Fault { kind: "kill", at: 12 };
    assert_eq!(shim.run(shop.command(&command), &work, Some(fault)), Some(3));
    assert_eq!(results(&shop.path("out/store/results")).len(), 1);
    let ended = shop.sphcut(&command).expect_code(0);
    assert!(
        ended.out.contains("1 runs computed") && ended.out.contains("1 there already"),
        "{ended:?}"
    );
}

#[test]
fn recordings_on_a_failing_disk() {
    let Some((shop, shim)) = shop("faults_recordings") else { return };
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/recordings");
    copy(&example, &shop.path(""));
    let out = shop.path("out");
    let shown = out.to_string_lossy().into_owned();
    let command = ["recordings", "example.toml", "--force", "--out", &shown];
    at_every_place(
        ("faults_recordings", &shim, &[4]),
        || drop(std::fs::remove_dir_all(&out)),
        |fault| shim.run(shop.command(&command), &out, fault),
        || {
            shop.sphcut(&["verify", "out/recordings.h5"]).expect_code(0);
            ["forces.csv", "cuts.csv", "recordings.json", "recordings.html"]
                .map(|name| shop.read(&format!("out/{name}")))
        },
    );
}
