//! The store and the execution of plans, with runs that only pretend to compute.

mod support;

use sphcut_sweep::{
    Claim, Execution, Integrity, Needs, Retry, State, Store, StoreError, SweepPlan, execute, plan,
};
use std::collections::BTreeSet;
use std::sync::atomic::Ordering;
use std::time::Duration;
use support::{Failing, Stub, folder, sweep};

const ONE: Execution = Execution { threads: 1, retry: Retry::Never };

fn run(
    stub: &Stub,
    sweep: &sphcut_sweep::Sweep,
    plan: &SweepPlan,
    store: &Store,
    how: Execution,
) -> Vec<State> {
    execute(sweep, plan, store, how, stub, &|_| {}).unwrap()
}

#[test]
fn only_what_is_missing_is_computed() {
    let place = folder("missing");
    let store = Store::create(&place.join("store")).unwrap();
    let (few, many) = (sweep(&place, 4), sweep(&place, 6));
    let stub = Stub::default();
    let states = run(&stub, &few, &plan(&few).unwrap(), &store, ONE);
    assert_eq!(states, vec![State::Finished; 4]);
    let states = run(&stub, &many, &plan(&many).unwrap(), &store, ONE);
    assert_eq!(states.iter().filter(|state| **state == State::Reused).count(), 4);
    assert_eq!(stub.computed.lock().unwrap().len(), 6);
    let found = store.list().unwrap();
    assert_eq!((found.results.len(), found.unfinished.len(), found.failures.len()), (6, 0, 0));
    assert_eq!(found.results[0].as_ref().unwrap().files.len(), 2, "summary and scenario");
    std::fs::remove_dir_all(&place).unwrap();
}

/// Two processes are two stores on one folder: file locks do not know which process opened a file twice.
#[test]
fn two_sweeps_at_once_compute_every_run_once() {
    let place = folder("two");
    let sweep = sweep(&place, 40);
    let plan = plan(&sweep).unwrap();
    let stub = Stub { delay: Duration::from_millis(2), ..Stub::default() };
    let states: Vec<Vec<State>> = std::thread::scope(|scope| {
        let one = || {
            let store = Store::create(&place.join("store")).unwrap();
            run(&stub, &sweep, &plan, &store, Execution { threads: 2, retry: Retry::Never })
        };
        let both = [scope.spawn(one), scope.spawn(one)];
        both.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let computed = stub.computed.lock().unwrap();
    let different: BTreeSet<u64> = computed.iter().map(|(t, _)| t.to_bits()).collect();
    assert_eq!((computed.len(), different.len()), (40, 40), "no run twice, none lost");
    for (one, other) in states[0].iter().zip(&states[1]) {
        let pair = [one, other];
        assert!(pair.contains(&&State::Finished) && pair.contains(&&State::Reused), "{pair:?}");
    }
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_failing_run_is_noted_and_does_not_stop_the_others() {
    let place = folder("failing");
    let store = Store::create(&place.join("store")).unwrap();
    let sweep = sweep(&place, 6);
    let plan = plan(&sweep).unwrap();
    let fails = vec![(301.0, Failing::Lasting), (302.0, Failing::Passing), (303.0, Failing::Panic)];
    let stub = Stub { fails, ..Stub::default() };
    let states = run(&stub, &sweep, &plan, &store, Execution { threads: 2, retry: Retry::Never });
    let failed = |reason: &str| State::Failed(reason.to_owned());
    let expected = [
        State::Finished,
        failed("it diverged"),
        failed("the disk is full"),
        failed("sphcut has a bug: a stub that panics"),
        State::Finished,
        State::Finished,
    ];
    assert_eq!(states, expected);
    // What lasts is not tried again unless asked for; what passes is.
    let well = Stub::default();
    let states = run(&well, &sweep, &plan, &store, ONE);
    assert_eq!(states[1], failed("it diverged"));
    assert_eq!(states[2], State::Finished);
    let states = run(&well, &sweep, &plan, &store, Execution { threads: 1, retry: Retry::Failed });
    assert_eq!((&states[1], &states[3]), (&State::Finished, &State::Finished));
    assert!(store.list().unwrap().failures.is_empty());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_run_that_fails_again_is_not_tried_for_ever() {
    let place = folder("again");
    let store = Store::create(&place.join("store")).unwrap();
    let sweep = sweep(&place, 2);
    let plan = plan(&sweep).unwrap();
    let stub = Stub { fails: vec![(300.0, Failing::Lasting)], ..Stub::default() };
    for _ in 0..2 {
        let states =
            run(&stub, &sweep, &plan, &store, Execution { threads: 2, retry: Retry::Failed });
        assert!(matches!(states[0], State::Failed(_)), "{states:?}");
    }
    assert_eq!(stub.computed.lock().unwrap().len(), 3);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn cores_that_would_be_idle_go_to_the_last_runs() {
    let place = folder("idle");
    let store = Store::create(&place.join("store")).unwrap();
    let sweep = sweep(&place, 3);
    let plan = plan(&sweep).unwrap();
    let stub = Stub { delay: Duration::from_millis(20), ..Stub::default() };
    run(&stub, &sweep, &plan, &store, Execution { threads: 8, retry: Retry::Never });
    let mut threads: Vec<usize> = stub.computed.lock().unwrap().iter().map(|run| run.1).collect();
    threads.sort_unstable();
    assert_eq!(threads, [2, 3, 3]);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn what_is_stopped_is_gone_on_with() {
    let place = folder("stopped");
    let store = Store::create(&place.join("store")).unwrap();
    let sweep = sweep(&place, 5);
    let plan = plan(&sweep).unwrap();
    let stub = Stub::default();
    stub.stop.store(true, Ordering::Relaxed);
    assert_eq!(run(&stub, &sweep, &plan, &store, ONE), vec![State::Stopped; 5]);
    stub.stop.store(false, Ordering::Relaxed);
    assert_eq!(run(&stub, &sweep, &plan, &store, ONE), vec![State::Finished; 5]);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_claim_is_held_by_one_and_ends_with_its_holder() {
    let place = folder("claims");
    let store = Store::create(&place.join("store")).unwrap();
    let address = plan(&sweep(&place, 1)).unwrap().runs[0].address;
    let Claim::Mine(work) = store.claim(&address).unwrap() else { panic!("nobody has it") };
    std::fs::write(work.folder().join("half"), "what an earlier attempt has saved").unwrap();
    assert!(matches!(store.claim(&address).unwrap(), Claim::Busy));
    assert!(store.list().unwrap().unfinished[0].1, "computed now");
    drop(work);
    assert!(!store.list().unwrap().unfinished[0].1);
    let Claim::Mine(work) = store.claim(&address).unwrap() else { panic!("it was given back") };
    assert!(work.folder().join("half").exists());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn damage_is_found_and_what_nobody_needs_too() {
    let place = folder("damage");
    let store = Store::create(&place.join("store")).unwrap();
    let (sweep, out) = (sweep(&place, 3), place.join("out"));
    let plan = plan(&sweep).unwrap();
    run(&Stub::default(), &sweep, &plan, &store, ONE);
    let entry = store.entry(&plan.runs[1].address).unwrap().unwrap();
    assert_eq!(store.verify(&entry), Integrity::Whole);
    let file = store.result(&entry.address).join("summary.json");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace('3', "4")).unwrap();
    assert!(
        matches!(store.verify(&entry), Integrity::Damaged(reason) if reason.contains("has changed"))
    );
    std::fs::remove_file(&file).unwrap();
    assert!(
        matches!(store.verify(&entry), Integrity::Damaged(reason) if reason.contains("summary.json"))
    );

    // All are needed, then two, then none because the sweep's folder is gone.
    std::fs::create_dir(&out).unwrap();
    let mut needs =
        Needs { folder: out.clone(), addresses: plan.runs.iter().map(|r| r.address).collect() };
    store.note_needs(&needs).unwrap();
    assert!(store.leftovers().unwrap().is_empty());
    needs.addresses.remove(&entry.address);
    store.note_needs(&needs).unwrap();
    let leftovers = store.leftovers().unwrap();
    assert_eq!(leftovers.len(), 1);
    assert!(leftovers[0].path.ends_with(entry.address.to_string()));
    store.remove(&leftovers[0].path).unwrap();
    assert!(!store.has(&entry.address));
    std::fs::remove_dir(&out).unwrap();
    assert_eq!(store.leftovers().unwrap().len(), 2);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_folder_with_other_things_is_refused() {
    let place = folder("foreign");
    std::fs::write(place.join("letter.txt"), "dear").unwrap();
    assert!(matches!(Store::create(&place), Err(StoreError::Foreign(_))));
    assert!(matches!(Store::open(&place), Err(StoreError::Foreign(_))));
    assert!(matches!(Store::open(&place.join("none")), Err(StoreError::Io { .. })));
    let store = place.join("store");
    Store::create(&store).unwrap();
    std::fs::write(store.join("store.json"), "{ \"layout\": 99 }").unwrap();
    assert!(matches!(Store::open(&store), Err(StoreError::Layout(_, 99))));
    std::fs::remove_dir_all(&place).unwrap();
}

/// Flips single bits of the notes of a store: none may pass, and nothing that is needed may be called a leftover.
#[test]
fn no_flipped_bit_of_a_note_passes() {
    let place = folder("notes");
    let store = Store::create(&place.join("store")).unwrap();
    let (sweep, out) = (sweep(&place, 3), place.join("out"));
    let plan = plan(&sweep).unwrap();
    run(&Stub::default(), &sweep, &plan, &store, ONE);
    std::fs::create_dir(&out).unwrap();
    let addresses = plan.runs.iter().map(|run| run.address).collect();
    store.note_needs(&Needs { folder: out, addresses }).unwrap();
    assert!(store.damaged_notes().unwrap().is_empty());
    assert!(store.damaged_results().unwrap().is_empty());
    let entry = store.result(&plan.runs[1].address).join("entry.json");
    let sweeps = std::fs::read_dir(store.root().join("sweeps")).unwrap();
    let mut notes: Vec<_> = sweeps.map(|note| note.unwrap().path()).collect();
    assert_eq!(notes.len(), 2, "a note and its backup");
    notes.extend([entry, store.root().join("store.json")]);
    let mut flips = 0;
    for note in notes {
        let whole = std::fs::read(&note).unwrap();
        for place in (0..whole.len()).step_by(2) {
            let mut bytes = whole.clone();
            bytes[place] ^= 1 << (place % 8);
            std::fs::write(&note, bytes).unwrap();
            let seen = !store.damaged_notes().unwrap().is_empty()
                || !store.damaged_results().unwrap().is_empty();
            assert!(seen, "byte {place} of {}", note.display());
            assert!(store.leftovers().is_err() || store.leftovers().unwrap().is_empty());
            flips += 1;
        }
        std::fs::write(&note, &whole).unwrap();
    }
    assert!(flips > 500, "{flips}");
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_result_with_a_changed_summary_is_computed_again() {
    let place = folder("changed_summary");
    let store = Store::create(&place.join("store")).unwrap();
    let sweep = sweep(&place, 2);
    let plan = plan(&sweep).unwrap();
    run(&Stub::default(), &sweep, &plan, &store, ONE);
    let summary = store.result(&plan.runs[0].address).join("summary.json");
    let text = std::fs::read_to_string(&summary).unwrap();
    std::fs::write(&summary, text.replace('3', "4")).unwrap();
    assert!(!store.has(&plan.runs[0].address));
    let states = run(&Stub::default(), &sweep, &plan, &store, ONE);
    assert_eq!(states, [State::Finished, State::Reused]);
    assert_eq!(std::fs::read_to_string(&summary).unwrap(), text);
    std::fs::remove_dir_all(&place).unwrap();
}

/// A link in the folder of a claimed run leads nowhere: the lock is refused, the scenario takes the link's place.
#[cfg(unix)]
#[test]
fn links_in_a_claim_are_not_written_through() {
    let place = folder("links");
    let store = Store::create(&place.join("store")).unwrap();
    let (sweep, precious) = (sweep(&place, 2), place.join("precious"));
    std::fs::write(&precious, "mine").unwrap();
    let plan = plan(&sweep).unwrap();
    for (run, name) in plan.runs.iter().zip(["lock", "scenario.toml"]) {
        let work = place.join("store/work").join(run.address.to_string());
        std::fs::create_dir_all(&work).unwrap();
        std::os::unix::fs::symlink(&precious, work.join(name)).unwrap();
        match (store.claim(&run.address), name) {
            (Err(error), "lock") => assert!(error.to_string().contains("it is a link"), "{error}"),
            (Ok(Claim::Mine(work)), _) => store.keep_scenario(&work, "new").unwrap(),
            other => panic!("{other:?}"),
        }
        assert_eq!(std::fs::read_to_string(&precious).unwrap(), "mine", "{name}");
    }
    std::fs::remove_dir_all(&place).unwrap();
}
