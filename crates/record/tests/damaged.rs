//! Files that are foreign, cut short, changed, or of another run; results that
//! must not be overwritten.

mod support;

use sphcut_record::driver::{self, Control, Progress, RunOptions, Start};
use sphcut_record::{
    Outcome, Provenance, Run, RunError, RunFiles, Verified, recover, verify_h5, verify_run,
};
use std::fs;
use std::path::Path;
use std::time::Duration;
use support::{Fake, Folder, Random, assert_same_bits, options, provenance};

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

/// Everything that a record answers, as text.
fn everything(path: &Path) -> Result<String, RunError> {
    let run = Run::load(path)?;
    let snapshots = (0..run.snapshots.len()).map(|number| run.snapshots.get(number));
    let snapshots = snapshots.collect::<Result<Vec<_>, _>>()?;
    let (performance, state) = (run.performance, Run::load_state(path)?);
    let rest = (run.provenance, run.facts, run.samples, run.snapshots.index(), run.outcome);
    Ok(format!("{rest:?} {snapshots:?} {performance:?} {state:?}"))
}

/// Flips of single bits that a test tries: some, or the number in `SPHCUT_FLIPS`.
fn flips() -> usize {
    std::env::var("SPHCUT_FLIPS").map_or(60, |count| count.parse().unwrap())
}

/// Flips one bit after the other of the file `name` of a run, and asks `answer` and [`verify_h5`].
fn flip_bits(name: &str, answer: impl Fn(&Path) -> Result<String, RunError>) {
    let folder = Folder::in_memory(&format!("flips-{name}"));
    run(&folder.0, Start::New).unwrap();
    let path = folder.0.join(name);
    let (expected, bytes) = (answer(&path).unwrap(), fs::read(&path).unwrap());
    assert_eq!(verify_h5(&path).unwrap(), Verified::Whole);
    let (mut random, mut told, flips) = (Random(20_260_724), 0, flips());
    for _ in 0..flips {
        let (place, bit) = (random.below(bytes.len() as u64) as usize, random.below(8));
        let mut changed = bytes.clone();
        changed[place] ^= 1 << bit;
        fs::write(&path, &changed).unwrap();
        match answer(&path) {
            Ok(found) => assert!(found == expected, "bit {bit} of byte {place}: another answer"),
            Err(error) => {
                told += 1;
                assert!(verify_h5(&path).is_err(), "verify does not see: {error}");
            }
        }
    }
    eprintln!("{name}: {told} of {flips} flips told, the others change nothing");
    assert!(told > flips / 2);
}

#[test]
fn no_flipped_bit_of_a_record_gives_another_answer() {
    flip_bits("run.h5", everything);
}

#[test]
fn no_flipped_bit_of_the_snapshots_for_paraview_passes_the_check() {
    flip_bits("snapshots.vtkhdf", |path| verify_h5(path).map(|found| format!("{found:?}")));
}

#[test]
fn a_run_is_verified_with_its_companions() {
    let folder = Folder::new("verified");
    run(&folder.0, Start::New).unwrap();
    let files = RunFiles::in_dir(&folder.0);
    let found = verify_run(&files);
    assert_eq!(found.len(), 4);
    assert!(found.iter().all(|(_, found)| matches!(found, Ok(Verified::Whole))), "{found:?}");
    let forces = fs::read_to_string(files.forces()).unwrap();
    fs::write(files.forces(), forces.replacen("0.", "1.", 1)).unwrap();
    let text = verify_run(&files)[3].1.as_ref().unwrap_err().to_string();
    assert!(text.contains("differs from the channels"), "{text}");
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
    for name in ["run.h5", "forces.csv", "snapshots.vtkhdf", "tool.vtkhdf"] {
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
fn a_damaged_snapshot_is_noticed_and_the_rest_is_kept() {
    let whole = Folder::new("snapshot-whole");
    let expected = run(&whole.0, Start::New).unwrap();
    for damage in [Start::Resume, Start::New] {
        let folder = Folder::new("snapshot");
        interrupt(&folder.0);
        flip(&RunFiles::in_dir(&folder.0).partial().join("snapshot-000001.bin"));
        let found = match damage {
            Start::Resume => run(&folder.0, damage).unwrap(),
            _ => recover(&folder.0).unwrap(),
        };
        let told = found.provenance.warnings.last().unwrap();
        assert!(told.contains("snapshots 1 (from 0)"), "{told}");
        let mut index = expected.snapshots.index().to_vec();
        index.remove(1);
        assert_eq!(found.snapshots.index(), &index[..found.snapshots.len()]);
        let read = (0..found.snapshots.len()).map(|number| found.snapshots.get(number));
        assert_eq!(read.filter_map(Result::ok).count(), found.snapshots.len());
        if damage == Start::Resume {
            assert_eq!((&found.samples, index.len()), (&expected.samples, found.snapshots.len()));
        }
    }
}

/// One file damaged at a time, everywhere: the run goes on to the end with the same samples.
#[test]
fn one_bad_byte_loses_no_run_that_has_a_checkpoint() {
    let whole = Folder::in_memory("bad-byte-whole");
    let expected = run(&whole.0, Start::New).unwrap();
    let saved = Folder::in_memory("bad-byte-saved");
    interrupt(&saved.0);
    let partial = RunFiles::in_dir(&saved.0).partial();
    let mut names: Vec<_> =
        fs::read_dir(&partial).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    let mut random = Random(60);
    let mut tried = 0;
    for name in names.iter().filter(|name| *name != "lock") {
        for _ in 0..6 {
            let folder = Folder::in_memory("bad-byte");
            let copy = RunFiles::in_dir(&folder.0).partial();
            fs::create_dir_all(&copy).unwrap();
            for other in &names {
                fs::copy(partial.join(other), copy.join(other)).unwrap();
            }
            let mut bytes = fs::read(copy.join(name)).unwrap();
            let place = random.below(bytes.len() as u64) as usize;
            bytes[place] ^= 1 << random.below(8);
            fs::write(copy.join(name), bytes).unwrap();
            let recovered = recover(&folder.0).unwrap();
            assert!(recovered.samples.len() >= 20, "{name:?}, byte {place}");
            let found = run(&folder.0, Start::Resume)
                .unwrap_or_else(|error| panic!("{name:?}, byte {place}: {error}"));
            assert_eq!(found.samples, expected.samples, "{name:?}, byte {place}");
            assert_eq!(verify_run(&RunFiles::in_dir(&folder.0)).len(), 4);
            tried += 1;
        }
    }
    eprintln!("{tried} flips in run.partial, all resumed");
    assert!(tried >= 30);
}

#[test]
fn a_sample_cut_short_by_a_crash_is_dropped() {
    let folder = Folder::new("journal");
    interrupt(&folder.0);
    let journal = RunFiles::in_dir(&folder.0).partial().join("samples.journal");
    let length = fs::metadata(&journal).unwrap().len();
    shorten(&journal, length as usize - 100);
    // The checkpoint has all of them.
    assert_eq!(recover(&folder.0).unwrap().samples.len(), 20);
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

#[cfg(unix)]
#[test]
fn links_in_an_unfinished_run_are_not_written_through() {
    for name in ["lock", "samples.journal", "checkpoint.bin.tmp", "origin.bin.tmp"] {
        let folder = Folder::new("links");
        interrupt(&folder.0);
        let precious = folder.0.join("precious");
        fs::write(&precious, "mine").unwrap();
        let link = RunFiles::in_dir(&folder.0).partial().join(name);
        let _ = fs::remove_file(&link);
        std::os::unix::fs::symlink(&precious, &link).unwrap();
        let resumed = run(&folder.0, Start::Resume);
        assert_eq!(fs::read_to_string(&precious).unwrap(), "mine", "{name}: {resumed:?}");
        let refused = ["lock", "samples.journal"].contains(&name);
        assert!(resumed.is_ok() || refused, "{name}: {resumed:?}");
    }
}
