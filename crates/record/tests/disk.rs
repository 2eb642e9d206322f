//! Disks that are full or read-only: a clear error, nothing lost that was saved.
//!
//! Needs to mount small file systems in memory, hence root; says so and does
//! nothing where that is not allowed.

#![cfg(target_os = "linux")]

mod support;

use sphcut_record::driver::{self, Control, Progress, RunOptions, Start};
use sphcut_record::{Run, RunError, RunFiles, recover};
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use support::{Fake, Folder, assert_same_bits, options, provenance};

/// A file system in memory, gone when the test is over.
struct SmallDisk(Folder);

impl SmallDisk {
    fn new(name: &str, size: &str) -> Option<Self> {
        let folder = Folder::new(name);
        let mounted = mount(&["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"], &folder.0);
        if !mounted {
            eprintln!("skipped: a file system in memory cannot be mounted here");
        }
        mounted.then_some(Self(folder))
    }

    fn remount(&self, option: &str) {
        // Busy as long as a `mount` that another test is just starting holds copies of our files.
        let done = (0..100).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            mount(&["-o", &format!("remount,{option}")], &self.0.0)
        });
        assert!(done, "cannot remount with {option}");
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0.0).status();
    }
}

fn mount(arguments: &[&str], folder: &Path) -> bool {
    let output = Command::new("mount").args(arguments).arg(folder).output();
    output.is_ok_and(|output| output.status.success())
}

fn fake() -> Fake {
    Fake { particles: 300, ..Fake::default() }
}

fn run_counting(folder: &Path, start: Start, samples: &mut usize) -> Result<Run, RunError> {
    let options =
        RunOptions { checkpoint_interval: Duration::from_millis(1), ..options(folder, start) };
    let mut control = |progress: &Progress| {
        *samples = progress.samples.len();
        Control::Continue
    };
    driver::run(&fake(), &provenance(), &options, &mut control)
}

/// Runs until the disk of `size` is full, makes room, and goes on.
fn fill_and_go_on(size: &str, undisturbed: &RunFiles) {
    let Some(disk) = SmallDisk::new(&format!("disk-{size}"), size) else { return };
    let out = disk.0.0.join("out");
    let files = RunFiles::in_dir(&out);
    let mut seen = 0;
    let error = run_counting(&out, Start::New, &mut seen).unwrap_err();
    let RunError::Io { kept, .. } = &error else { panic!("{error:?}") };
    assert!(error.to_string().contains("the disk is full"), "{size}: {error}");
    disk.remount("size=32m");
    if !kept.is_empty() {
        assert!(kept.contains(&format!("{seen} samples")), "{size}: {error}");
        assert!(kept.contains("--resume"), "{size}: {error}");
        assert_eq!(recover(&out).unwrap().samples.len(), seen, "{size}: saved samples were lost");
    }
    run_counting(&out, Start::Resume, &mut seen).unwrap();
    assert_same_bits(&undisturbed.record(), &files.record());
    assert!(!files.partial().exists());
}

#[test]
fn a_run_that_filled_the_disk_goes_on_with_the_same_bits() {
    let folder = Folder::new("disk-undisturbed");
    run_counting(&folder.0, Start::New, &mut 0).unwrap();
    let undisturbed = RunFiles::in_dir(&folder.0);
    // From no room for the first file to no room for the last one.
    for size in ["4k", "16k", "32k", "64k", "128k", "256k", "384k", "512k", "640k", "768k"] {
        fill_and_go_on(size, &undisturbed);
    }
}

#[test]
fn a_read_only_folder_is_refused_before_the_first_step() {
    let Some(disk) = SmallDisk::new("read-only", "1m") else { return };
    disk.remount("ro");
    for out in [disk.0.0.clone(), disk.0.0.join("out")] {
        let mut seen = 0;
        let error = run_counting(&out, Start::New, &mut seen).unwrap_err();
        assert!(error.to_string().contains("read-only"), "{error}");
        assert!(error.to_string().contains(&*out.to_string_lossy()), "{error}");
        assert_eq!(seen, 0);
    }
}

#[test]
fn a_folder_that_becomes_read_only_keeps_what_was_saved() {
    let Some(disk) = SmallDisk::new("becomes-read-only", "8m") else { return };
    let mut interrupt = |progress: &Progress| {
        if progress.samples.len() == 9 { Control::Interrupt } else { Control::Continue }
    };
    let first = options(&disk.0.0, Start::New);
    driver::run(&fake(), &provenance(), &first, &mut interrupt).unwrap();
    disk.remount("ro");
    let error = run_counting(&disk.0.0, Start::Resume, &mut 0).unwrap_err();
    assert!(error.to_string().contains("read-only"), "{error}");
    assert_eq!(Run::load(&RunFiles::in_dir(&disk.0.0).record()).unwrap().samples.len(), 9);
    disk.remount("rw");
    assert_eq!(run_counting(&disk.0.0, Start::Resume, &mut 0).unwrap().samples.len(), 29);
}
