//! The driver with a made-up simulation: what is recorded, when, and how a run ends.

mod support;

use sphcut_record::driver::{self, Control, Moment, Progress, RunOptions, Start};
use sphcut_record::{Outcome, Run, RunError, RunFiles};
use sphcut_sph::ChannelId;
use std::time::Duration;
use support::{Fake, Folder, assert_same_bits, options, provenance};

fn go_on(_: &Progress) -> Control {
    Control::Continue
}

fn run(fake: &Fake, options: &RunOptions) -> Result<Run, RunError> {
    driver::run(fake, &provenance(), options, &mut go_on)
}

#[test]
fn a_run_is_read_back_as_it_was_returned() {
    let folder = Folder::new("read-back");
    let fake = Fake::default();
    let run = run(&fake, &options(&folder.0, Start::New)).unwrap();
    assert_eq!(run.outcome, Outcome::Finished);
    // 200 steps, a sample every 7 and one at the end: 28 + 1.
    assert_eq!(run.samples.len(), 29);
    assert_eq!(run.performance.steps, 200);
    assert_eq!(run.performance.particles, 50);
    assert!(run.performance.updates_per_second() > 0.0);
    let files = RunFiles::in_dir(&folder.0);
    assert_eq!(Run::load(&files.record()).unwrap(), run);
    assert!(files.forces().exists() && files.vtkhdf().exists());
    assert!(!files.partial().exists(), "the unfinished run is cleared away");
}

#[test]
fn snapshots_are_evenly_spaced_from_the_start_to_the_end() {
    let folder = Folder::new("snapshots");
    let run = run(&Fake::default(), &options(&folder.0, Start::New)).unwrap();
    let steps: Vec<u64> = run.snapshots.index().iter().map(|info| info.step).collect();
    // 9 snapshots over 199.5 time steps: one every 24.9, at the first step not before.
    assert_eq!(steps, [0, 25, 50, 75, 100, 125, 150, 175, 200]);
    let last = run.snapshots.last().unwrap().unwrap();
    assert_eq!(last.step, 200);
    assert_eq!(last.temperature.len(), 50);
}

#[test]
fn one_snapshot_is_the_last_and_none_is_none() {
    let folder = Folder::new("few-snapshots");
    let few = |snapshots, start| RunOptions { snapshots, ..options(&folder.0, start) };
    let one = run(&Fake::default(), &few(1, Start::New)).unwrap();
    assert_eq!(one.snapshots.index().iter().map(|s| s.step).collect::<Vec<_>>(), [200]);
    let none = run(&Fake::default(), &few(0, Start::Replace)).unwrap();
    assert!(none.snapshots.is_empty());
    assert!(Run::load(&RunFiles::in_dir(&folder.0).record()).unwrap().snapshots.is_empty());
}

#[test]
fn a_stop_is_heeded_at_samples_only() {
    let folder = Folder::new("stop");
    let fake = Fake { delay: Duration::from_micros(700), ..Fake::default() };
    let mut clock_calls = 0;
    let mut control = |progress: &Progress| {
        clock_calls += usize::from(progress.moment == Moment::Clock);
        if progress.moment == Moment::Clock || progress.samples.len() == 20 {
            Control::Stop
        } else {
            Control::Continue
        }
    };
    let run =
        driver::run(&fake, &provenance(), &options(&folder.0, Start::New), &mut control).unwrap();
    assert_eq!(run.outcome, Outcome::Steady);
    assert_eq!((run.samples.len(), run.performance.steps), (20, 140));
    assert_eq!(run.snapshots.index().last().unwrap().step, 140);
    assert!(clock_calls > 0, "140 steps of 0.7 ms are more than one tenth of a second? {run:?}");
}

#[test]
fn progress_tells_where_the_run_is() {
    let folder = Folder::new("progress");
    let mut seen = Vec::new();
    let mut control = |progress: &Progress| {
        assert_eq!(progress.particles, 50);
        // The tool cuts at 2.5 m/s but for its return between two passes.
        let [first, second] = progress.facts.passes[..] else { panic!("two passes") };
        let later = (progress.time.min(second.end) - second.start).max(0.0);
        let travel = 2.5 * (progress.time.min(first.end) + later);
        assert!((progress.travel - travel).abs() < 1e-18);
        assert_eq!(progress.samples.last().unwrap().get(ChannelId::Time), progress.time);
        seen.push(progress.step);
        Control::Continue
    };
    let options = options(&folder.0, Start::New);
    driver::run(&Fake::default(), &provenance(), &options, &mut control).unwrap();
    assert_eq!((seen[0], seen[1], *seen.last().unwrap()), (7, 14, 200));
}

#[test]
fn an_interrupted_run_is_resumed_with_the_same_bits() {
    let whole = Folder::new("whole");
    run(&Fake::default(), &options(&whole.0, Start::New)).unwrap();
    let parts = Folder::new("parts");
    let mut interrupt_at = 3;
    loop {
        let start = if interrupt_at == 3 { Start::New } else { Start::Resume };
        let mut control = |progress: &Progress| {
            if progress.samples.len() >= interrupt_at {
                Control::Interrupt
            } else {
                Control::Continue
            }
        };
        let options = options(&parts.0, start);
        let run = driver::run(&Fake::default(), &provenance(), &options, &mut control).unwrap();
        let loaded = Run::load(&RunFiles::in_dir(&parts.0).record()).unwrap();
        assert_eq!(loaded, run, "the record of an interrupted run is complete up to there");
        if run.outcome == Outcome::Finished {
            break;
        }
        assert_eq!((run.outcome, run.samples.len()), (Outcome::Interrupted, interrupt_at));
        interrupt_at += 5;
    }
    let record = |folder: &Folder| RunFiles::in_dir(&folder.0).record();
    assert_same_bits(&record(&whole), &record(&parts));
}

#[test]
fn a_stop_at_the_sample_of_the_interruption_is_not_missed() {
    let stop_at_ten = |progress: &Progress| {
        if progress.samples.len() == 10 { Control::Stop } else { Control::Continue }
    };
    let folder = Folder::new("stop-after-interrupt");
    let mut interrupt = |progress: &Progress| {
        if progress.samples.len() == 10 { Control::Interrupt } else { Control::Continue }
    };
    let first = options(&folder.0, Start::New);
    driver::run(&Fake::default(), &provenance(), &first, &mut interrupt).unwrap();
    let second = options(&folder.0, Start::Resume);
    let run = driver::run(&Fake::default(), &provenance(), &second, &mut { stop_at_ten }).unwrap();
    assert_eq!((run.outcome, run.samples.len()), (Outcome::Steady, 10));
}

#[test]
fn the_interval_of_checkpoints_does_not_change_the_result() {
    let rare = Folder::new("rare");
    run(&Fake::default(), &options(&rare.0, Start::New)).unwrap();
    let often = Folder::new("often");
    let every_step =
        RunOptions { checkpoint_interval: Duration::ZERO, ..options(&often.0, Start::New) };
    run(&Fake::default(), &every_step).unwrap();
    let record = |folder: &Folder| RunFiles::in_dir(&folder.0).record();
    assert_same_bits(&record(&rare), &record(&often));
}

#[test]
fn resuming_a_complete_run_returns_it() {
    let folder = Folder::new("complete");
    let first = run(&Fake::default(), &options(&folder.0, Start::New)).unwrap();
    let again = run(&Fake::default(), &options(&folder.0, Start::Resume)).unwrap();
    assert_eq!(first, again);
}

#[test]
fn resuming_where_nothing_is_starts_at_the_beginning() {
    let folder = Folder::new("nothing");
    let run = run(&Fake::default(), &options(&folder.0, Start::Resume)).unwrap();
    assert_eq!(run.outcome, Outcome::Finished);
}

#[test]
fn a_diverged_run_keeps_its_record_up_to_the_last_good_state() {
    let folder = Folder::new("diverged");
    let fake = Fake { diverges_in: Some(101), ..Fake::default() };
    let error = run(&fake, &options(&folder.0, Start::New)).unwrap_err();
    let text = error.to_string();
    for part in ["step 101", "1.000000e-4 s", "temperature of particle 17", "NaN", "run.h5"] {
        assert!(text.contains(part), "`{part}` is missing in `{text}`");
    }
    let RunError::Diverged { divergence, record } = error else { panic!("{error}") };
    let saved = Run::load(&record).unwrap();
    // The value is not a number, which never equals itself.
    assert_eq!(format!("{:?}", saved.outcome), format!("{:?}", Outcome::Diverged(divergence)));
    assert_eq!(saved.samples.len(), 14);
    let last = saved.snapshots.last().unwrap().unwrap();
    assert_eq!(last.step, 100);
    let whole = Folder::new("not-diverged");
    let stops = Fake { diverges_in: None, steps: 100, ..fake.clone() };
    let good = run(&stops, &options(&whole.0, Start::New)).unwrap();
    assert_eq!(*last, *good.snapshots.last().unwrap().unwrap(), "not the last good state");
    assert_eq!(Run::load_state(&record).unwrap().unwrap().integer("clock/step"), Some(&[100][..]));
    let again = run(&fake, &options(&folder.0, Start::Resume)).unwrap_err();
    assert!(matches!(again, RunError::Diverged { .. }), "{again}");
}

#[test]
fn a_setup_that_cannot_be_built_leaves_no_folder() {
    let folder = Folder::new("setup");
    let out = folder.0.join("out");
    let fake = Fake { particles: 0, ..Fake::default() };
    let error = run(&fake, &options(&out, Start::New)).unwrap_err();
    assert!(matches!(error, RunError::Setup(_)), "{error}");
    assert!(!out.exists());
}
