//! Runs cases and writes the ledger:
//! `cargo run --release -p sphcut-verification --example ledger -- [--tier quick|standard|long]
//! [--again] [--adopt CASE RUN FOLDER] [CASE...]`.
//!
//! Values of finished runs are kept in `validation/<case>/results`, one file per run: an
//! interrupted long case goes on with its next run, and a run whose scenario has not changed is
//! not repeated unless `--again` asks for it. From all values that are there it writes the page of
//! outcomes, `docs/validation.md`, and the figures of each case, `validation/<case>/RESULTS.md`.

use sphcut_verification::diagnoses::diagnoses_cases;
use sphcut_verification::grey_box::grey_box_cases;
use sphcut_verification::ledger::{self, Entry};
use sphcut_verification::store::Store;
use sphcut_verification::sweep_trends::{SweepCase, sweep_cases};
use sphcut_verification::{
    Case, Outcome, Progress, RunOptions, Tier, Verdict, adopt, cases, judge_stored, run_case,
};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

fn main() -> Result<(), Box<dyn Error>> {
    let mut tier = None;
    let mut again = false;
    let (mut names, mut adopted) = (Vec::new(), Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--tier" => tier = Some(tier_of(&arguments.next().unwrap_or_default())?),
            "--again" => again = true,
            "--adopt" => {
                let mut next = || arguments.next().ok_or("--adopt CASE RUN FOLDER");
                adopted.push([next()?, next()?, next()?]);
            }
            name => names.push(name.to_owned()),
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = root.join("validation");
    let store = Store::new(&folder);
    let cases = cases(&folder)?;
    for [case, run, folder] in &adopted {
        let case = cases.iter().find(|known| known.name == *case);
        let case = case.ok_or("--adopt: no such case")?;
        adopt(case, run, Path::new(folder), &RunOptions::default(), &store)?;
    }
    for case in cases.iter().filter(|case| is_wanted(&case.name, case.tier, tier, &names)) {
        if again {
            store.forget(&case.name)?;
        }
        run(case, &store);
    }
    let grey_boxes = grey_box_cases(&folder)?;
    for case in grey_boxes.iter().filter(|case| is_wanted(&case.name, case.tier, tier, &names)) {
        if again {
            store.forget(&case.name)?;
        }
        let told = Mutex::new(String::new());
        let verdict = case.run(&kept_in(&store), &|progress| {
            tell(progress, &mut told.lock().unwrap_or_else(PoisonError::into_inner));
        });
        say(&verdict);
    }
    let mut entries = cases
        .iter()
        .map(|case| Ok(Entry::of_case(case, judge_stored(case, &store)?)))
        .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    for case in &grey_boxes {
        entries.push(Entry::of_grey_box(case, &case.stored(&store)?));
    }
    for case in sweep_cases(&folder)? {
        if is_wanted(&case.name, SweepCase::TIER, tier, &names) {
            say(&case.judge());
        }
        entries.push(Entry::of_sweep(&case));
    }
    for case in diagnoses_cases(&folder)? {
        let verdict = case.judge();
        if is_wanted(&case.name, case.tier, tier, &names) {
            say(&verdict);
        }
        entries.push(Entry::of_diagnoses(&case, verdict));
    }
    entries.sort_by(|a, b| a.name().cmp(b.name()));
    for entry in &entries {
        fs::write(folder.join(entry.name()).join("RESULTS.md"), ledger::results(entry))?;
    }
    fs::write(root.join("docs/validation.md"), ledger::overview(&entries))?;
    Ok(())
}

fn tier_of(name: &str) -> Result<Tier, String> {
    match name {
        "quick" => Ok(Tier::Quick),
        "standard" => Ok(Tier::Standard),
        "long" => Ok(Tier::Long),
        other => Err(format!("no tier is called `{other}`: quick, standard or long")),
    }
}

/// Cases of the tier and below, or those named.
fn is_wanted(name: &String, of: Tier, tier: Option<Tier>, names: &[String]) -> bool {
    if names.is_empty() { tier.is_some_and(|tier| of <= tier) } else { names.contains(name) }
}

fn run(case: &Case, store: &Store) {
    let mut told = String::new();
    say(&run_case(case, &kept_in(store), &mut |progress| tell(progress, &mut told)));
}

fn kept_in(store: &Store) -> RunOptions {
    RunOptions { store: Some(store.clone()), ..RunOptions::default() }
}

/// Says what is run in steps of ten per cent.
fn tell(progress: &Progress<'_>, told: &mut String) {
    let share = (10.0 * progress.fraction).floor() * 10.0;
    let line = format!("{} / {}: {share:.0} %", progress.case, progress.run);
    if line != *told {
        eprintln!("{line}");
        *told = line;
    }
}

fn say(verdict: &Verdict) {
    println!("{}: {}", verdict.case, verdict.outcome.word());
    if let Outcome::Broken { reason } = &verdict.outcome {
        println!("  {reason}");
    }
    for finding in &verdict.findings {
        println!(
            "  {} {}: {} = {:?} {} ({}): {} {:.4e}, tolerance {:.1e}",
            if finding.holds { "holds" } else { "FAILS" },
            finding.run,
            finding.observable,
            finding.values,
            finding.unit,
            finding.reference,
            finding.metric.name(),
            finding.result,
            finding.tolerance
        );
    }
}
