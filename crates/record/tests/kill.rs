//! A process that is killed without warning loses nothing: resumed as often as
//! needed, it ends with the bits of a run that nobody disturbed.

#![cfg(unix)]

mod support;

use sphcut_record::driver::{self, Control, RunOptions, Source, Start};
use sphcut_record::{Outcome, RunError, RunFiles, recover};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use support::cut::small_cut;
use support::{Fake, Folder, Random, assert_same_bits, options, provenance};

/// Names the folder of the victim; not set when the tests run in the ordinary way.
const FOLDER: &str = "SPHCUT_KILL_TEST_FOLDER";

fn fake() -> Fake {
    Fake {
        particles: 400,
        steps: 1500,
        sampling: 7,
        delay: Duration::from_micros(50),
        ..Fake::default()
    }
}

fn run_in(folder: &Path, source: &impl Source) -> Result<Outcome, RunError> {
    let options = RunOptions {
        snapshots: 12,
        checkpoint_interval: Duration::from_millis(15),
        ..options(folder, Start::Resume)
    };
    driver::run(source, &provenance(), &options, &mut |_| Control::Continue).map(|run| run.outcome)
}

/// What a killed process runs: a made-up simulation.
#[test]
fn victim_made_up() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        assert_eq!(run_in(Path::new(&folder), &fake()).unwrap(), Outcome::Finished);
    }
}

/// What a killed process runs: a cut with the solver.
#[test]
fn victim_cut() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        assert_eq!(run_in(Path::new(&folder), &small_cut()).unwrap(), Outcome::Finished);
    }
}

fn start_victim(name: &str, folder: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--test-threads", "1", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// Kills the victim after `moment` unless it is done before; tells whether it was killed.
fn kill_after(mut victim: Child, moment: Duration) -> bool {
    std::thread::sleep(moment);
    if let Some(status) = victim.try_wait().unwrap() {
        assert!(status.success(), "{status}");
        return false;
    }
    victim.kill().unwrap();
    !victim.wait().unwrap().success()
}

/// Kills and resumes the test `victim` at least `kills` times, in as many runs as that takes, and
/// compares each with an undisturbed run of `source`. No moment is later than `patience` times the
/// number of attempts: later and later, so that a slow machine gets to the end as well.
fn kill_and_compare(victim: &str, source: &impl Source, kills: usize, patience: Duration) {
    let undisturbed = Folder::in_memory(&format!("undisturbed-{victim}"));
    run_in(&undisturbed.0, source).unwrap();
    let expected = RunFiles::in_dir(&undisturbed.0);
    let mut random = Random(20_260_101);
    let (mut killed, mut rounds) = (0, 0);
    while killed < kills {
        rounds += 1;
        let folder = Folder::in_memory(&format!("{victim}-{rounds}"));
        let files = RunFiles::in_dir(&folder.0);
        let mut saved_samples = 0;
        for attempt in 1.. {
            let moment = random.below(attempt * patience.as_micros() as u64);
            if !kill_after(start_victim(victim, &folder.0), Duration::from_micros(moment)) {
                break;
            }
            killed += 1;
            if files.partial().join("origin.bin").exists() {
                let recovered = recover(&folder.0).unwrap();
                assert!(recovered.samples.len() >= saved_samples, "saved samples were lost");
                saved_samples = recovered.samples.len();
            }
        }
        assert_same_bits(&expected.record(), &files.record());
        let bytes = |files: &RunFiles| std::fs::read(files.forces()).unwrap();
        assert!(bytes(&expected) == bytes(&files), "the force histories differ");
        assert!(!files.partial().exists());
    }
    eprintln!("{killed} kills in {rounds} runs");
}

#[test]
fn a_killed_run_ends_with_the_same_bits() {
    kill_and_compare("victim_made_up", &fake(), 30, Duration::from_millis(60));
}

#[test]
fn a_killed_cut_ends_with_the_same_bits() {
    kill_and_compare("victim_cut", &small_cut(), 20, Duration::from_millis(300));
}
