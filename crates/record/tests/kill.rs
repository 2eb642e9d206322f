//! A process that is killed without warning loses nothing: resumed as often as
//! needed, it ends with the bits of a run that nobody disturbed.

#![cfg(unix)]

mod support;

use sphcut_record::driver::{self, Control, RunOptions, Start};
use sphcut_record::{Outcome, RunError, RunFiles, recover};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use support::{Fake, Folder, assert_same_bits, options, provenance};

const FOLDER: &str = "SPHCUT_KILL_TEST_FOLDER";
const KILLS: usize = 30;

fn fake() -> Fake {
    Fake {
        particles: 400,
        steps: 1500,
        sampling: 7,
        delay: Duration::from_micros(50),
        ..Fake::default()
    }
}

fn run_in(folder: &Path) -> Result<Outcome, RunError> {
    let options = RunOptions {
        snapshots: 12,
        checkpoint_interval: Duration::from_millis(15),
        ..options(folder, Start::Resume)
    };
    driver::run(&fake(), &provenance(), &options, &mut |_| Control::Continue).map(|run| run.outcome)
}

/// What the killed process runs; does nothing when the tests run in the ordinary way.
#[test]
fn victim() {
    if let Ok(folder) = std::env::var(FOLDER) {
        assert_eq!(run_in(Path::new(&folder)).unwrap(), Outcome::Finished);
    }
}

fn start_victim(folder: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "victim", "--test-threads", "1"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// Small and good enough to choose moments (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits ^ (bits >> 31)) % limit
    }
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

#[test]
fn a_killed_run_ends_with_the_same_bits() {
    let undisturbed = Folder::new("undisturbed");
    run_in(&undisturbed.0).unwrap();
    let expected = RunFiles::in_dir(&undisturbed.0);
    let mut random = Random(20_260_101);
    let (mut kills, mut rounds) = (0, 0);
    while kills < KILLS {
        rounds += 1;
        let folder = Folder::new(&format!("killed-{rounds}"));
        let files = RunFiles::in_dir(&folder.0);
        let mut saved_samples = 0;
        for attempt in 1.. {
            // Later and later, so that a slow machine gets to the end as well.
            let moment = Duration::from_micros(random.below(60_000 * attempt));
            if !kill_after(start_victim(&folder.0), moment) {
                break;
            }
            kills += 1;
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
    eprintln!("{kills} kills in {rounds} runs");
}
