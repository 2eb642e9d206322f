//! Files that are foreign, cut short, changed, or of another run; results that
//! must not be overwritten.

mod support;

use sphcut_record::driver::{self, Control, Progress, RunOptions, Start};
use sphcut_record::{Outcome, Provenance, Run, RunError, RunFiles, recover};
use std::fs;
use std::path::Path;
use std::time::Duration;
use support::{Fake, Folder, assert_same_bits, options, provenance};

fn run(folder: &Path, start: Start) -> Result<Run, RunError> {
    run_as(&provenance(), folder, start)
}

fn run_as(provenance: &Provenance, folder: &Path, start: Start) -> Result<Run, RunError> {
    driver::run(&Fake::default(), provenance, &options(folder, start), &mut |_| Control::Continue)
}

/// Leaves an unfinished run with two checkpoints and 20 samples.
fn interrupt(folder: &Path) {
    let every_step =
        RunOptions { checkpoint_interval: Duration::ZERO, ..options(folder, Start::New) };
    let mut control = |progress: &Progress| {
        if progress.samples.len() == 20 { Control::Interrupt } else { Control::Continue }
    };
    let run = driver::run(&Fake::default(), &provenance(), &every_step, &mut control).unwrap();
    assert_eq!(run.outcome, Outcome::Interrupted);
}

/// Reads everything there is to read.
fn read_all(path: &Path) -> Result<(), RunError> {
    let run = Run::load(path)?;
    (0..run.snapshots.len()).try_for_each(|number| run.snapshots.get(number).map(|_| ()))?;
    Run::load_state(path).map(|_| ())
}

#[test]
fn a_record_cut_short_anywhere_is_a_clear_error() {
    let folder = Folder::new("truncated");
    run(&folder.0, Start::New).unwrap();
    let record = RunFiles::in_dir(&folder.0).record();
    let bytes = fs::read(&record).unwrap();
    let cut = folder.0.join("cut.h5");
    for part in 0..200 {
        fs::write(&cut, &bytes[..bytes.len() * part / 200]).unwrap();
        let error = read_all(&cut).expect_err("a file cut short was read");
        let text = error.to_string();
        assert!(text.contains("cut.h5"), "{text}");
        assert!(matches!(error, RunError::Damaged { .. } | RunError::Foreign { .. }), "{text}");
    }
    fs::write(&cut, &bytes[..bytes.len() - 1]).unwrap();
    let text = read_all(&cut).unwrap_err().to_string();
    assert!(text.contains("cut short"), "{text}");
}

#[test]
fn a_changed_byte_never_brings_the_reader_down() {
    let folder = Folder::new("changed");
    run(&folder.0, Start::New).unwrap();
    let bytes = fs::read(RunFiles::in_dir(&folder.0).record()).unwrap();
    let changed = folder.0.join("changed.h5");
    let mut noticed = 0;
    for part in 0..300 {
        let mut bytes = bytes.clone();
        let place = bytes.len() * part / 300 + part % 7;
        bytes[place] ^= 0x55;
        fs::write(&changed, &bytes).unwrap();
        noticed += usize::from(read_all(&changed).is_err());
    }
    assert!(noticed > 0, "no change in the structure was noticed");
}

#[test]
fn a_foreign_file_is_not_a_record() {
    let folder = Folder::new("foreign");
    let path = folder.0.join("run.h5");
    fs::write(&path, "these are my notes").unwrap();
    let text = Run::load(&path).unwrap_err().to_string();
    assert!(text.contains("not an HDF5 file"), "{text}");
    // An HDF5 file of somebody else.
    run(&folder.0.join("other"), Start::New).unwrap();
    let text = Run::load(&RunFiles::in_dir(&folder.0.join("other")).vtkhdf()).unwrap_err();
    assert!(text.to_string().contains("sphcut did not write it"), "{text}");
    let text = Run::load(&folder.0.join("missing.h5")).unwrap_err().to_string();
    assert!(text.contains("there is no such file"), "{text}");
}

#[test]
fn an_existing_result_is_replaced_by_force_only() {
    let folder = Folder::new("exists");
    let first = run(&folder.0, Start::New).unwrap();
    let before = fs::read(RunFiles::in_dir(&folder.0).record()).unwrap();
    let error = run(&folder.0, Start::New).unwrap_err();
    assert!(matches!(error, RunError::Exists { resumable: false, .. }), "{error}");
    assert!(error.to_string().contains("--force"), "{error}");
    assert_eq!(fs::read(RunFiles::in_dir(&folder.0).record()).unwrap(), before);
    let notes = folder.0.join("notes.txt");
    fs::write(&notes, "mine").unwrap();
    let second = run(&folder.0, Start::Replace).unwrap();
    assert_eq!(first.samples, second.samples);
    assert_eq!(fs::read_to_string(&notes).unwrap(), "mine");
}

#[test]
fn an_unfinished_run_is_replaced_by_force_only() {
    let folder = Folder::new("unfinished");
    interrupt(&folder.0);
    let notes = RunFiles::in_dir(&folder.0).partial().join("notes.txt");
    fs::write(&notes, "mine").unwrap();
    let error = run(&folder.0, Start::New).unwrap_err();
    assert!(matches!(error, RunError::Exists { resumable: true, .. }), "{error}");
    assert!(error.to_string().contains("--resume"), "{error}");
    run(&folder.0, Start::Replace).unwrap();
    assert_eq!(fs::read_to_string(&notes).unwrap(), "mine");
    assert_eq!(fs::read_dir(notes.parent().unwrap()).unwrap().count(), 1);
}

#[test]
fn force_does_not_replace_what_sphcut_did_not_write() {
    for name in ["run.h5", "forces.csv", "snapshots.vtkhdf"] {
        let folder = Folder::new(&format!("not-ours-{name}"));
        fs::write(folder.0.join(name), "mine").unwrap();
        for start in [Start::New, Start::Replace] {
            let error = run(&folder.0, start).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
            assert_eq!(fs::read_to_string(folder.0.join(name)).unwrap(), "mine");
        }
    }
}

#[test]
fn a_changed_scenario_is_not_resumed() {
    let folder = Folder::new("mismatch");
    interrupt(&folder.0);
    let text = provenance().scenario_text.replace("5 deg", "6 deg");
    let changed = Provenance { scenario_text: text, ..provenance() };
    let error = run_as(&changed, &folder.0, Start::Resume).unwrap_err().to_string();
    assert!(error.contains("line 3") && error.contains("6 deg"), "{error}");
    let newer = Provenance { version: "9.9.9".to_owned(), ..provenance() };
    let error = run_as(&newer, &folder.0, Start::Resume).unwrap_err().to_string();
    assert!(error.contains("version 0.1.0") && error.contains("9.9.9"), "{error}");
    run(&folder.0, Start::Resume).unwrap();
    let error = run_as(&changed, &folder.0, Start::Resume).unwrap_err().to_string();
    assert!(error.contains("run.h5") && error.contains("line 3"), "{error}");
}

#[test]
fn the_checkpoint_of_another_run_is_refused() {
    let (one, other) = (Folder::new("one"), Folder::new("other"));
    interrupt(&one.0);
    let else_where = Provenance { scenario_text: "something else".to_owned(), ..provenance() };
    let mut control = |progress: &Progress| {
        if progress.samples.len() == 5 { Control::Interrupt } else { Control::Continue }
    };
    let first = options(&other.0, Start::New);
    driver::run(&Fake::default(), &else_where, &first, &mut control).unwrap();
    let checkpoint = |folder: &Folder| RunFiles::in_dir(&folder.0).partial().join("checkpoint.bin");
    fs::copy(checkpoint(&other), checkpoint(&one)).unwrap();
    let error = run(&one.0, Start::Resume).unwrap_err();
    assert!(matches!(error, RunError::Mismatch { .. }), "{error}");
    assert!(error.to_string().contains("checkpoint.bin"), "{error}");
}

#[test]
fn a_damaged_checkpoint_falls_back_on_the_one_before() {
    let whole = Folder::new("fallback-whole");
    run(&whole.0, Start::New).unwrap();
    for cut in [0, 7, 40, 1000] {
        let folder = Folder::new("fallback");
        interrupt(&folder.0);
        let partial = RunFiles::in_dir(&folder.0).partial();
        shorten(&partial.join("checkpoint.bin"), cut);
        run(&folder.0, Start::Resume).unwrap();
        let record = |folder: &Folder| RunFiles::in_dir(&folder.0).record();
        assert_same_bits(&record(&whole), &record(&folder));
    }
}

#[test]
fn checkpoints_that_are_all_damaged_are_a_clear_error() {
    let folder = Folder::new("all-damaged");
    interrupt(&folder.0);
    let partial = RunFiles::in_dir(&folder.0).partial();
    shorten(&partial.join("checkpoint.bin"), 500);
    flip(&partial.join("checkpoint.previous.bin"));
    let error = run(&folder.0, Start::Resume).unwrap_err();
    assert!(matches!(error, RunError::Damaged { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("checkpoint.bin") && text.contains("cut short"), "{text}");
    assert!(text.contains("--force"), "{text}");
}

#[test]
fn a_damaged_snapshot_is_noticed() {
    let folder = Folder::new("snapshot");
    interrupt(&folder.0);
    flip(&RunFiles::in_dir(&folder.0).partial().join("snapshot-000001.bin"));
    let error = run(&folder.0, Start::Resume).unwrap_err();
    assert!(matches!(error, RunError::Damaged { .. }), "{error}");
    assert!(error.to_string().contains("snapshot-000001.bin"), "{error}");
}

#[test]
fn a_sample_cut_short_by_a_crash_is_dropped() {
    let folder = Folder::new("journal");
    interrupt(&folder.0);
    let journal = RunFiles::in_dir(&folder.0).partial().join("samples.journal");
    let length = fs::metadata(&journal).unwrap().len();
    shorten(&journal, length as usize - 100);
    assert_eq!(recover(&folder.0).unwrap().samples.len(), 19);
    // The checkpoint has all of them.
    assert_eq!(run(&folder.0, Start::Resume).unwrap().samples.len(), 29);
}

#[test]
fn two_processes_do_not_write_the_same_run() {
    let folder = Folder::new("locked");
    let mut nested = None;
    let mut control = |progress: &Progress| {
        if progress.samples.len() == 2 && nested.is_none() {
            nested = Some([Start::Resume, Start::Replace].map(|start| run(&folder.0, start)));
        }
        Control::Continue
    };
    let first = options(&folder.0, Start::New);
    driver::run(&Fake::default(), &provenance(), &first, &mut control).unwrap();
    for result in nested.unwrap() {
        let error = result.unwrap_err();
        assert!(matches!(error, RunError::InUse { .. }), "{error}");
    }
}

fn shorten(path: &Path, length: usize) {
    let bytes = fs::read(path).unwrap();
    fs::write(path, &bytes[..length]).unwrap();
}

fn flip(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    let place = bytes.len() - 9;
    bytes[place] ^= 1;
    fs::write(path, bytes).unwrap();
}
