//! What a program that holds sphcut calls gives what the command gives, and can be stopped and gone on with.

#[path = "end_to_end/common.rs"]
#[expect(dead_code, reason = "the workshop has more than is needed here")]
mod common;

use common::{TINY, Workshop};
use sphcut_cli::embedded::{SweepPlace, checked, run, sweep};
use sphcut_cli::{interrupt, started_by};
use sphcut_record::Outcome;
use sphcut_record::driver::Start;
use sphcut_scenario::{LoadOptions, Scenario, load};
use sphcut_sweep::{State, Sweep};
use std::path::Path;

fn scenario(path: &Path) -> Scenario {
    load(path, &LoadOptions::default()).expect("a scenario without mistakes")
}

fn forces(folder: &Path) -> Vec<u8> {
    std::fs::read(folder.join("forces.csv")).expect("a run leaves its forces")
}

/// One test: the request to stop is that of the whole process.
#[test]
fn a_program_that_holds_it_gets_what_the_command_gives() {
    let shop = Workshop::new("embedded");
    let file = shop.write("tiny.toml", TINY);
    let tiny = scenario(&file);
    let page = checked(&tiny, false).unwrap();
    assert_eq!(page["scenario"], "tiny");

    // Stopped by whoever listens: a checkpoint, and no results.
    let place = shop.path("held");
    let mut shares = Vec::new();
    let stopped = run(&tiny, (&place, Start::New), None, &mut |share, line| {
        assert!(line.contains(" mm, "), "{line}");
        shares.push(share);
        interrupt::request();
    });
    let (stopped, results) = stopped.unwrap();
    assert_eq!((stopped.outcome, results.is_none()), (Outcome::Interrupted, true));
    assert!(!shares.is_empty() && shares.iter().all(|share| (0.0..1.0).contains(share)));
    interrupt::withdraw();

    // Gone on with: the bits of the command.
    let (whole, results) = run(&tiny, (&place, Start::Resume), None, &mut |_, _| {}).unwrap();
    assert_eq!((whole.outcome, results.is_some()), (Outcome::Finished, true));
    let words = ["run", "tiny.toml", "--out", "commanded", "--quiet"];
    assert!(shop.command(&words).status().unwrap().success());
    assert_eq!(forces(&place), forces(&shop.path("commanded")));
    assert!(place.join("report.html").is_file() && place.join("summary.json").is_file());

    // A sweep starts processes of the program that it is told.
    started_by(vec![env!("CARGO_BIN_EXE_sphcut").into()]);
    let values = ["\"120 m/min\"", "\"180 m/min\""].map(|one| vec![one.to_owned()]);
    let base = (&tiny, file.as_path());
    let two = Sweep::listed(
        ("Two speeds", "two"),
        base,
        &LoadOptions::default(),
        (&["process.cutting_speed"], &values),
    );
    let place = SweepPlace { out: shop.path("two"), store: shop.path("store"), threads: None };
    let mut lines = Vec::new();
    let table = sweep(&two.unwrap(), &place, &mut |_, line| lines.push(line.to_owned())).unwrap();
    assert!(table.rows.iter().all(|row| row.state == State::Finished), "{table:?}");
    assert!(lines.last().is_some_and(|line| line.starts_with("2 finished")), "{lines:?}");
    assert!(shop.path("two").join("sweep.html").is_file());
}
