//! A disk that fails, or power that goes, at any operation of a run: never another answer, and the run goes on to the
//! same bits.

#![cfg(target_os = "linux")]

#[path = "support/faults.rs"]
mod faults;
mod support;

use faults::{Shim, at_every_place};
use sphcut_record::driver::{self, Control, RunOptions, Start};
use sphcut_record::{Run, RunFiles, verify_run};
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use support::{Fake, Folder, options, provenance};

/// Names the folder of the victim; not set when the tests run in the ordinary way.
const FOLDER: &str = "SPHCUT_FAULT_TEST_FOLDER";

/// What the disk fails: a made-up simulation with many checkpoints.
#[test]
fn victim() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let options = RunOptions {
        snapshots: 5,
        checkpoint_interval: Duration::ZERO,
        ..options(Path::new(&folder), Start::Resume)
    };
    let fake = Fake { steps: 40, ..Fake::default() };
    let ended = driver::run(&fake, &provenance(), &options, &mut |_| Control::Continue);
    std::process::exit(if ended.is_ok() { 0 } else { 4 });
}

#[test]
fn a_run_on_a_failing_disk_ends_with_the_same_bits() {
    let folder = Folder::in_memory("faults");
    let Some(shim) = Shim::compiled(&folder.0) else { return };
    let out = folder.0.join("out");
    let files = RunFiles::in_dir(&out);
    at_every_place(
        ("record with a checkpoint in every step", &shim, &[4]),
        || drop(std::fs::remove_dir_all(&out)),
        |fault| {
            let mut command = Command::new(std::env::current_exe().unwrap());
            command.args(["--exact", "victim", "--test-threads", "1"]).env(FOLDER, &out);
            shim.run(command, &out, fault)
        },
        || {
            let found = verify_run(&files);
            assert!(found.iter().all(|(_, found)| found.is_ok()), "{found:?}");
            let run = Run::load(&files.record()).unwrap();
            let snapshots: Vec<_> =
                (0..run.snapshots.len()).map(|k| run.snapshots.get(k).unwrap()).collect();
            let forces = std::fs::read_to_string(files.forces()).unwrap();
            format!("{:?} {:?} {snapshots:?} {forces}", run.samples, run.outcome)
        },
    );
}
