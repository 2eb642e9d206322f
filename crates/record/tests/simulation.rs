//! The driver with the real solver: a small cut.

mod support;

use sphcut_record::driver::{self, Control, Progress, Start};
use sphcut_record::{Outcome, Run, RunError, RunFiles};
use sphcut_sph::{ChannelId, Setup};
use support::cut::small_cut;
use support::{Folder, assert_same_bits, options, provenance};

fn run_with_threads(
    threads: usize,
    setup: &Setup,
    folder: &Folder,
    start: Start,
    interrupt_at: usize,
) -> Result<Run, RunError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut control = |progress: &Progress| {
        if progress.samples.len() == interrupt_at { Control::Interrupt } else { Control::Continue }
    };
    let options = options(&folder.0, start);
    pool.install(|| driver::run(setup, &provenance(), &options, &mut control))
}

const NEVER: usize = usize::MAX;

#[test]
fn a_cut_interrupted_on_one_thread_and_resumed_on_two_has_the_same_bits() {
    let (whole, parts) = (Folder::in_memory("cut-whole"), Folder::in_memory("cut-parts"));
    let setup = small_cut();
    let run = run_with_threads(2, &setup, &whole, Start::New, NEVER).unwrap();
    assert_eq!(run.outcome, Outcome::Finished);
    assert!(run.samples.len() >= 45, "{}", run.samples.len());
    let force = run.samples.channel(ChannelId::CuttingForce);
    assert!(force.iter().any(|force| *force > 0.0), "the tool never touched the workpiece");
    let part = run_with_threads(1, &setup, &parts, Start::New, 17).unwrap();
    assert_eq!((part.outcome, part.samples.len()), (Outcome::Interrupted, 17));
    run_with_threads(2, &setup, &parts, Start::Resume, NEVER).unwrap();
    let record = |folder: &Folder| RunFiles::in_dir(&folder.0).record();
    assert_same_bits(&record(&whole), &record(&parts));
}

#[test]
fn a_cut_that_blows_up_keeps_its_record_until_then() {
    let folder = Folder::in_memory("cut-diverged");
    let mut setup = small_cut();
    // Ten times faster than the waves of the scaled material: no chip can form any more.
    setup.tool.as_mut().unwrap().velocity = [6000.0, 0.0, 0.0];
    let error = run_with_threads(1, &setup, &folder, Start::New, NEVER).unwrap_err();
    let RunError::Diverged { divergence, record } = error else { panic!("{error}") };
    let saved = Run::load(&record).unwrap();
    assert_eq!(saved.snapshots.last().unwrap().unwrap().step + 1, divergence.step);
    let last = saved.snapshots.last().unwrap().unwrap();
    assert!(last.position.as_flattened().iter().all(|x| x.is_finite()), "not a good state");
    assert!(last.temperature.iter().all(|x| x.is_finite()), "not a good state");
}
